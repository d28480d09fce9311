"""The one function that runs every machine: block after block of variants, each through its cycle.

A machine's own part is handed over as four functions of one signature, and what is asked of it as index arrays.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.cycle.chebyshev import MIDDLE, POSITIONS
from engine.cycle.compiling import driver, routine
from engine.cycle.directions import directions, panel_positions
from engine.cycle.events import (
    GREATEST,
    GREATEST_AT,
    LANDMARKS,
    LEAST,
    LEAST_AT,
    MOST_ROOTS,
    SCALE,
    find_crossings,
    find_landmarks,
    find_turns,
    lay_edges,
    scan_positions,
)
from engine.cycle.extremes import EXTREME, SEARCH, find_extreme
from engine.cycle.fluctuation import FLUCTUATION, RESULTS, find_fluctuation
from engine.cycle.integrals import INTEGRAL, add_panels
from engine.cycle.lanes import ASIDE, LANES, rows, tiles
from engine.cycle.panels import ACCEPTED, ACTIVE, TAKEN, WALK, compare_with_tolerance, judge, next_panels, set_out
from engine.cycle.panels import HALF as PANEL_HALF
from engine.cycle.panels import MIDDLE as PANEL_MIDDLE
from engine.cycle.record import FIRST, Record, begin_record, keep_curve, keep_panels, new_record
from engine.cycle.roots import PARTS, solve_roots
from engine.cycle.series import FIGURES, panel_figures
from engine.cycle.within import value_at, zeros_of
from engine.cycle.works import WORK_ROWS, add_work

# Zeros of a curve that there is room for.
MOST_ZEROS = 16


class Task(NamedTuple):
    """What is asked of a machine, by the numbers of rows and curves.

    Attributes
    ----------
    sizes : ndarray (4,) of int
        Curves that the functions for events, levels, states and curves fill in.
    ends : ndarray (2,) of int
        Rows of P with the first and the last position of the input.
    landmark_rows : ndarray (functions, 4) of int
        Rows of P that receive each switching function's least and greatest value and their places; −1: none does.
    level_rows, state_rows : ndarray of int
        Rows of P that receive what `levels` and `states` give.
    crossings : ndarray (crossings, 2) of int
        Switching function and the row of P with a level of it where the cycle is cut.
    cuts : ndarray of int
        Rows of P with positions where the cycle is cut.
    scan : int
        Positions at which switching functions are looked at.
    integrals : ndarray of int
        Curves to integrate.
    kept : ndarray of int
        Curves to keep over the cycle; they are the first curves of the record.
    works : ndarray of int
        Curves of the record whose works about the mean are the record's further curves.
    extremes : ndarray (extremes, 3) of int
        Curves a and b of the record and the row of P with the factor c, for the extremes of a − c (b − b₀); the row is
        −1 where only a is meant.
    fluctuations : ndarray (fluctuations, 4) of int
        Curves of the record with the work and the inertia, rows of P with the mean speed and the flywheel's inertia.
    values : ndarray (values, 2) of int
        Curves of the record and rows of P with positions where their values are asked.
    zeros : ndarray of int
        Curves of the record whose zeros are asked.
    tolerances : ndarray (curves,) of float
        What may be left of each curve beyond its series, as a share of its greatest magnitude.
    longest : ndarray (1,) of float
        Longest panel.
    """

    sizes: np.ndarray
    ends: np.ndarray
    landmark_rows: np.ndarray
    level_rows: np.ndarray
    state_rows: np.ndarray
    crossings: np.ndarray
    cuts: np.ndarray
    scan: int
    integrals: np.ndarray
    kept: np.ndarray
    works: np.ndarray
    extremes: np.ndarray
    fluctuations: np.ndarray
    values: np.ndarray
    zeros: np.ndarray
    tolerances: np.ndarray
    longest: np.ndarray


class Answers(NamedTuple):
    """What the driver fills in.

    Attributes
    ----------
    integrals : ndarray (integrals, 2, variants)
        Value and error.
    extremes : ndarray (extremes, 2, 4, variants)
        Of the least and the greatest value: value, its error, place, its error.
    fluctuations : ndarray (fluctuations, RESULTS, variants)
        As of `engine.cycle.fluctuation`.
    values : ndarray (values, 2, variants)
        Value and error.
    zeros : ndarray (curves, most, 2, variants)
        Places and errors, then NaN.
    zero_counts : ndarray (curves, variants)
        How many zeros there are.
    landmarks : ndarray (functions, LANDMARKS, variants)
        As of `engine.cycle.events`.
    firsts : ndarray (kept, variants)
        First values of the kept curves.
    panels : ndarray (variants,)
        How many panels were taken.
    broken_at : ndarray (variants,)
        First position where a curve isn't finite; NaN where there is none.
    short_of_room : ndarray (blocks,) of bool
        Whether a block would have needed a longer record.
    """

    integrals: np.ndarray
    extremes: np.ndarray
    fluctuations: np.ndarray
    values: np.ndarray
    zeros: np.ndarray
    zero_counts: np.ndarray
    landmarks: np.ndarray
    firsts: np.ndarray
    panels: np.ndarray
    broken_at: np.ndarray
    short_of_room: np.ndarray


@routine
def any_active(walk: np.ndarray) -> bool:
    """Whether any lane is still on its way."""
    going = False
    for lane in range(LANES):
        going |= walk[ACTIVE, lane] > 0.0
    return going


@routine
def gather(numbers: np.ndarray, begin: int, block: np.ndarray) -> None:
    """Numbers of a block of variants; lanes beyond the last variant repeat it."""
    last = numbers.shape[1] - 1
    for i in range(numbers.shape[0]):
        for lane in range(LANES):
            block[i, lane] = numbers[i, min(begin + lane, last)]


@routine
def hand_out(block: np.ndarray, begin: int, answers: np.ndarray) -> None:
    """Write a row of a block to its variants."""
    for lane in range(min(LANES, answers.shape[0] - begin)):
        answers[begin + lane] = block[lane]


@routine
def copy_landmarks(landmarks: np.ndarray, function: int, wanted: np.ndarray, block: np.ndarray) -> None:
    """Copy landmarks of a switching function to the rows of the block's numbers that receive them."""
    for i, part in enumerate((LEAST, GREATEST, LEAST_AT, GREATEST_AT)):
        row = wanted[function, i]
        if row >= 0:
            for lane in range(LANES):
                block[row, lane] = landmarks[function, part, lane]


@routine
def copy_to_rows(tile: np.ndarray, wanted: np.ndarray, block: np.ndarray) -> None:
    """Copy curves at the one position of a tile to rows of the block's numbers."""
    for i in range(wanted.shape[0]):
        for lane in range(LANES):
            block[wanted[i], lane] = tile[i, 0, lane]


@routine
def mark_broken(tile: np.ndarray, q: np.ndarray, walk: np.ndarray, broken_at: np.ndarray) -> None:
    """Note the first position where a curve isn't finite, in lanes where none was noted yet."""
    for lane in range(LANES):
        if walk[ACCEPTED, lane] == 0.0 or not math.isnan(broken_at[lane]):
            continue
        for j in range(POSITIONS - 1, -1, -1):
            for c in range(tile.shape[0]):
                if not abs(tile[c, j, lane]) < math.inf:
                    broken_at[lane] = q[j, lane]


class Workspace(NamedTuple):
    """Memory for a block of variants, used again for the next.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
        Numbers of the block's variants.
    walk : ndarray (WALK, LANES)
    place : ndarray (3, POSITIONS, LANES)
        Input positions with cosine and sine.
    tile, level_tile, state_tile : ndarray (curves, POSITIONS, LANES), (levels, 1, LANES), (states, 1, LANES)
    figures : ndarray (curves, FIGURES, LANES)
    scales : ndarray (curves, LANES)
    integrals : ndarray (integrals, INTEGRAL, LANES)
    scan_place, turn_place, crossing_place : ndarray (3, rows, LANES)
        Input positions with cosine and sine: those scanned, those of turns, and those of levels.
    scan_tile, turn_tile, crossing_tile : ndarray (2 functions, rows, LANES)
        Switching functions with their derivatives there.
    turns, crossings : ndarray (PARTS, rows, LANES)
    turn_sought, crossing_sought : ndarray (rows, 2) of int
        What is looked for.
    landmarks : ndarray (functions, LANDMARKS, LANES)
    edges : ndarray (2, edges, LANES)
    sums : ndarray (WORK_ROWS, LANES)
    marks : ndarray (4, LANES)
        Zeros; first position where a curve isn't finite; two rows used meanwhile.
    search : ndarray (2 POSITIONS + SEARCH + 1 + steps, LANES)
    found : ndarray (2 EXTREME, LANES)
    result : ndarray (FLUCTUATION, LANES)
    zeros : ndarray (most, 2, LANES)
    record : Record
    """

    block: np.ndarray
    walk: np.ndarray
    place: np.ndarray
    tile: np.ndarray
    level_tile: np.ndarray
    state_tile: np.ndarray
    figures: np.ndarray
    scales: np.ndarray
    integrals: np.ndarray
    scan_place: np.ndarray
    turn_place: np.ndarray
    crossing_place: np.ndarray
    scan_tile: np.ndarray
    turn_tile: np.ndarray
    crossing_tile: np.ndarray
    turns: np.ndarray
    crossings: np.ndarray
    turn_sought: np.ndarray
    crossing_sought: np.ndarray
    landmarks: np.ndarray
    edges: np.ndarray
    sums: np.ndarray
    marks: np.ndarray
    search: np.ndarray
    found: np.ndarray
    result: np.ndarray
    zeros: np.ndarray
    record: Record


def new_workspace(task: Task, numbers: int, steps: int) -> Workspace:
    """Memory for a task, with room for so many steps of a walk."""
    functions, count = task.sizes[0] // 2, task.sizes[3]
    turns, crossings = functions * MOST_ROOTS, len(task.crossings) * MOST_ROOTS
    return Workspace(
        rows(numbers),
        rows(WALK, aside=ASIDE),
        tiles(3),
        tiles(count),
        rows(task.sizes[1], 1),
        rows(task.sizes[2], 1),
        rows(count, FIGURES, aside=ASIDE),
        rows(count, aside=ASIDE),
        rows(task.integrals.size, INTEGRAL, aside=ASIDE),
        rows(3, task.scan),
        rows(3, turns),
        rows(3, crossings),
        rows(2 * functions, task.scan),
        rows(2 * functions, turns),
        rows(2 * functions, crossings),
        rows(PARTS, turns),
        rows(PARTS, crossings),
        np.zeros((turns, 2), np.int64),
        np.zeros((crossings, 2), np.int64),
        rows(functions, LANDMARKS),
        rows(2, crossings + task.cuts.size, aside=ASIDE),
        rows(WORK_ROWS, aside=ASIDE),
        rows(4, aside=ASIDE),
        rows(2 * POSITIONS + SEARCH + 1 + steps, aside=ASIDE),
        rows(2 * EXTREME, aside=ASIDE),
        rows(FLUCTUATION, aside=ASIDE),
        rows(MOST_ZEROS, 2, aside=ASIDE),
        new_record(task.kept.size + task.works.size, steps),
    )


@routine
def fill(array: np.ndarray, value: float) -> None:
    """Set all rows to a value."""
    for i in range(array.shape[0]):
        for lane in range(LANES):
            array[i, lane] = value


@routine
def cut(events: Callable, levels: Callable, task: Task, tables: np.ndarray, walk: np.ndarray, work: Workspace) -> int:
    """Find each lane's landmarks and what follows from them, and lay its edges; returns how many there are."""
    block, marks, counts, landmarks = work.block, work.marks[2], work.marks[3], work.landmarks
    place, tile, turned, turns = work.scan_place, work.scan_tile, work.turn_tile, work.turns
    functions = task.landmark_rows.shape[0]
    turn_rows = crossing_rows = functions - functions
    if functions > 0:
        q = place[0]
        scan_positions(block[task.ends[0]], block[task.ends[1]], q)
        directions(q, place[1], place[2])
        events(block, tables, q, place[1], place[2], tile)
        for f in range(functions):
            turn_rows = find_turns(f, q, tile, turn_rows, work.turn_sought, turns, marks, counts)
        solve_roots(events, block, tables, turn_rows, work.turn_sought, work.turn_place, turned, turns)
        for f in range(functions):
            find_landmarks(f, q, tile, turn_rows, work.turn_sought, turned, turns, landmarks)
            copy_landmarks(landmarks, f, task.landmark_rows, block)
    if task.sizes[1] > 0:
        levels(block, tables, work.place[0, :1], work.place[1, :1], work.place[2, :1], work.level_tile)
        copy_to_rows(work.level_tile, task.level_rows, block)
    for c in range(task.crossings.shape[0]):
        f, row = task.crossings[c, 0], task.crossings[c, 1]
        crossing_rows = find_crossings(
            f,
            row,
            block[row],
            landmarks[f, SCALE],
            place[0],
            tile,
            turn_rows,
            work.turn_sought,
            turned,
            turns,
            crossing_rows,
            work.crossing_sought,
            work.crossings,
            marks,
            counts,
        )
    solve_roots(
        events,
        block,
        tables,
        crossing_rows,
        work.crossing_sought,
        work.crossing_place,
        work.crossing_tile,
        work.crossings,
    )
    return lay_edges(
        crossing_rows,
        work.crossing_sought,
        work.crossing_tile,
        work.crossings,
        landmarks,
        task.cuts,
        block,
        walk,
        work.edges,
    )


@driver
def evaluate_blocks(
    begin,
    end,
    blocks,
    events,
    levels,
    states,
    curves,
    task,
    numbers,
    tables,
    to_coefficients,
    to_integrals,
    answers,
    work,
):
    """Evaluate blocks of variants.

    Parameters
    ----------
    begin, end : int
        Range of entries of `blocks`, `end` not among them.
    blocks : ndarray of int
        Blocks of LANES variants.
    events, levels, states, curves : callable
        The machine's functions.
    task : Task
    numbers : ndarray (numbers, variants)
    tables : ndarray
        Handed on to the machine's functions.
    to_coefficients, to_integrals : ndarray
        The matrices of `engine.cycle.chebyshev`.
    answers : Answers
    work : Workspace
    """
    count, kept = task.sizes[3], task.kept.shape[0]
    block, walk, tile, figures, scales = work.block, work.walk, work.tile, work.figures, work.scales
    q, cos_q, sin_q = work.place[0], work.place[1], work.place[2]
    integrals, record, found = work.integrals, work.record, work.found
    zeros, broken_at = work.marks[0], work.marks[1]
    for i in range(begin, end):
        b = blocks[i]
        first = b * LANES
        gather(numbers, first, block)
        begin_record(record)
        fill(scales, 0.0)
        for k in range(integrals.shape[0]):
            fill(integrals[k], 0.0)
        for lane in range(LANES):
            broken_at[lane] = math.nan
        set_out(block[task.ends[0]], block[task.ends[1]], task.longest[0], walk)
        edges, step = cut(events, levels, task, tables, walk, work), b - b
        for f in range(task.landmark_rows.shape[0]):
            for part in range(LANDMARKS):
                hand_out(work.landmarks[f, part], first, answers.landmarks[f, part])
        while next_panels(work.edges, edges, walk):
            panel_positions(walk[PANEL_MIDDLE], walk[PANEL_HALF], q, cos_q, sin_q)
            if task.sizes[2] > 0:
                states(
                    block,
                    tables,
                    q[MIDDLE : MIDDLE + 1],
                    cos_q[MIDDLE : MIDDLE + 1],
                    sin_q[MIDDLE : MIDDLE + 1],
                    work.state_tile,
                )
                copy_to_rows(work.state_tile, task.state_rows, block)
            curves(block, tables, q, cos_q, sin_q, tile)
            broken = False
            for c in range(count):
                panel_figures(tile, c, figures)
                broken |= compare_with_tolerance(figures, c, task.tolerances[c], scales, walk)
            if not judge(task.longest[0], walk):
                continue
            if broken:
                mark_broken(tile, q, walk, broken_at)
            for k in range(integrals.shape[0]):
                add_panels(tile, figures, task.integrals[k], walk, integrals, k)
            if kept > 0:
                if step == record.panels.shape[0]:
                    break
                keep_panels(walk, step, record.panels)
                for k in range(kept):
                    keep_curve(tile, task.kept[k], figures, walk, record, k, step)
            step += 1
        for k in range(task.works.shape[0]):
            add_work(record, to_integrals, step, task.works[k], kept + k, work.sums)
        for k in range(integrals.shape[0]):
            for part in range(2):
                hand_out(integrals[k, part], first, answers.integrals[k, part])
        for k in range(task.extremes.shape[0]):
            x, y, row = task.extremes[k, 0], task.extremes[k, 1], task.extremes[k, 2]
            for side in range(2):
                sign = 2.0 * side - 1.0
                factor = block[row] if row >= 0 else zeros
                find_extreme(record, to_coefficients, step, x, y, factor, sign, work.search, found)
                for part in range(4):
                    hand_out(found[part], first, answers.extremes[k, side, part])
        for k in range(task.fluctuations.shape[0]):
            x, y = task.fluctuations[k, 0], task.fluctuations[k, 1]
            speed, wheel = task.fluctuations[k, 2], task.fluctuations[k, 3]
            find_fluctuation(
                record, to_coefficients, step, x, y, block[speed], block[wheel], work.search, found, work.result
            )
            for part in range(RESULTS):
                hand_out(work.result[part], first, answers.fluctuations[k, part])
        for k in range(task.values.shape[0]):
            x, row = task.values[k, 0], task.values[k, 1]
            value_at(record, to_coefficients, step, x, block[row], work.search[: SEARCH + 1], work.result)
            for part in range(2):
                hand_out(work.result[part], first, answers.values[k, part])
        for k in range(task.zeros.shape[0]):
            counts, lengths = work.marks[2], work.marks[3]
            zeros_of(record, to_coefficients, step, task.zeros[k], work.search, counts, lengths, work.zeros)
            for i in range(work.zeros.shape[0]):
                for part in range(2):
                    hand_out(work.zeros[i, part], first, answers.zeros[k, i, part])
            hand_out(counts, first, answers.zero_counts[k])
        for k in range(kept):
            hand_out(record.whole[k, FIRST], first, answers.firsts[k])
        hand_out(walk[TAKEN], first, answers.panels)
        hand_out(broken_at, first, answers.broken_at)
        answers.short_of_room[b] = any_active(walk)
