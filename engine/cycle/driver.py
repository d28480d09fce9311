"""The one function that runs every machine: block after block of variants, each through its cycle.

A machine's own part is handed over as four functions of one signature, and what is asked of it as index arrays.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import driver, routine
from engine.compiling.widths import LANES
from engine.cycle.events import (
    LANDMARKS,
    LOOKED_BESIDE,
    SCALE,
    find_crossings,
    find_landmarks,
    find_turns,
    lay_edges,
    note_coarse,
    of_landmarks,
    scan_positions,
)
from engine.cycle.measures.angles import ANGLE_ROWS, add_angle
from engine.cycle.measures.averages import AVERAGES, find_averages
from engine.cycle.measures.extremes import (
    CANDIDATE,
    EACH_TURN,
    EXTREME,
    GREATEST,
    LEAST,
    LEAST_MAGNITUDE,
    PERIOD,
    SEARCH,
    Search,
    find_extreme,
    of_candidates,
)
from engine.cycle.measures.fluctuation import FLUCTUATION, add_speed, find_fluctuation
from engine.cycle.measures.magnitudes import PartsRoom, integrate_roots, new_parts
from engine.cycle.measures.spaced import fill_spaced
from engine.cycle.measures.unloaded_arcs import ARCS, MOST_STRETCHES, STRETCH, find_unloaded_arcs
from engine.cycle.measures.works import WORK_ROWS, add_work
from engine.cycle.panels.chebyshev import MIDDLE, POSITIONS
from engine.cycle.panels.directions import change_by_rounding, panel_positions
from engine.cycle.panels.integrals import INTEGRAL, add_panels, of_integrals
from engine.cycle.panels.lanes import ASIDE, Memory, any_positive, in_lanes, in_panels, lane_of, rows, tiles
from engine.cycle.panels.record import (
    FIRST,
    Record,
    Room,
    begin_record,
    keep_curve,
    keep_panels,
    keep_rounding,
    new_room,
    record_in,
)
from engine.cycle.panels.series import FIGURES, of_figures, panel_figures
from engine.cycle.panels.walk import (
    ACCEPTED,
    EDGES,
    SCALES,
    TAKEN,
    WALK,
    compare_root,
    compare_with_tolerance,
    find_kink,
    judge,
    next_panels,
    note_rounding,
    of_edges,
    of_scales,
    set_out,
)
from engine.cycle.panels.walk import HALF as PANEL_HALF
from engine.cycle.panels.walk import MIDDLE as PANEL_MIDDLE
from engine.cycle.roots import PARTS, SampleRoom, new_samples, of_roots, sample, samples_in, solve_roots


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
    offsets : ndarray (crossings,) of float
        How far beyond that the level is.
    cuts : ndarray of int
        Rows of P with positions where the cycle is cut.
    kinks : ndarray of int
        Curves at whose zeros others bend.
    scan : int
        Positions at which switching functions are looked at.
    looks : int
        How many times: twice where some of them depend on landmarks of others.
    most_roots : int
        How often each may turn, or take one level.
    integrals : ndarray of int
        Curves to integrate.
    roots : ndarray of int
        Curves of the record whose roots are to be integrated.
    rooted : ndarray of int
        Curves that are nowhere negative and whose roots count.
    kept : ndarray of int
        Curves to keep over the cycle; they are the first curves of the record.
    works : ndarray (works, 2) of int
        Curves of the record whose running integrals are the record's next curves, and whether about the mean (1 or 0).
    angles : ndarray (angles, 2) of int
        Curves of the record with the components of the vectors whose angles are its next curves.
    speeds : ndarray of int
        Which fluctuations' speeds are the record's last curves.
    extremes : ndarray (extremes, 4) of int
        Curves a and b of the record, the row of P with the factor c and what is looked for, as of
        `engine.cycle.measures.extremes`, of a − c (b − b₀); the row is −1 where only a is meant.
    fluctuations : ndarray (fluctuations, 4) of int
        Curves of the record with the work and the inertia, rows of P with the mean speed and the flywheel's inertia.
    averages : ndarray of int
        Curves of the record whose mean and mean square are asked.
    arcs : ndarray (arcs, 3) of int
        Curves of the record with the components of forces and the squares of their magnitudes, whose unloaded arcs are
        asked.
    spaced : ndarray of int
        Curves of the record whose values at equally spaced positions are asked.
    intervals : int
        Into how many parts these positions divide the range.
    tolerances : ndarray (curves,) of float
        What may be left of each curve beyond its series, as a share of its greatest magnitude.
    only_integrals : ndarray (curves,) of float
        1 for curves of which nothing but integrals is asked, else 0.
    longest : ndarray (1,) of float
        Longest panel.
    periods : ndarray (2,) of float
        After which length positions are the same again, of extremes of all and of those of EACH_TURN.
    """

    sizes: np.ndarray
    ends: np.ndarray
    landmark_rows: np.ndarray
    level_rows: np.ndarray
    state_rows: np.ndarray
    crossings: np.ndarray
    offsets: np.ndarray
    cuts: np.ndarray
    kinks: np.ndarray
    scan: int
    looks: int
    most_roots: int
    integrals: np.ndarray
    roots: np.ndarray
    rooted: np.ndarray
    kept: np.ndarray
    works: np.ndarray
    angles: np.ndarray
    speeds: np.ndarray
    extremes: np.ndarray
    fluctuations: np.ndarray
    averages: np.ndarray
    arcs: np.ndarray
    spaced: np.ndarray
    intervals: int
    tolerances: np.ndarray
    only_integrals: np.ndarray
    longest: np.ndarray
    periods: np.ndarray


class DriverAnswers(NamedTuple):
    """What the driver fills in.

    Attributes
    ----------
    integrals : ndarray (integrals × 2, variants)
        Value and error.
    roots : ndarray (roots × 2, variants)
        Value and error of the integrals of roots.
    sizes : ndarray (curves, variants)
        Greatest magnitudes.
    extremes : ndarray (extremes × 2 × 4, variants)
        Of the least and the greatest value: value, its error, place, its error.
    fluctuations : ndarray (fluctuations × RESULTS, variants)
        As of `engine.cycle.measures.fluctuation`.
    averages : ndarray (averages × 4, variants)
        Mean, its error, mean square, its error.
    arcs : ndarray (arcs × 4, variants)
        Arc, its error, its middle, its error.
    landmarks : ndarray (functions × LANDMARKS, variants)
        As of `engine.cycle.events`.
    firsts : ndarray (kept, variants)
        First values of the kept curves.
    panels : ndarray (1, variants)
        How many panels were taken.
    broken_at : ndarray (1, variants)
        First position where a curve isn't finite; NaN where there is none, infinite where something switches too often.
    spaced : ndarray (spaced, variants, positions)
        Values at equally spaced positions.
    short_of_room : ndarray (blocks,) of bool
        Whether a block would have needed a longer record.
    """

    integrals: np.ndarray
    roots: np.ndarray
    sizes: np.ndarray
    extremes: np.ndarray
    fluctuations: np.ndarray
    averages: np.ndarray
    arcs: np.ndarray
    landmarks: np.ndarray
    firsts: np.ndarray
    panels: np.ndarray
    broken_at: np.ndarray
    spaced: np.ndarray
    short_of_room: np.ndarray


@routine
def gather(numbers: np.ndarray, begin: int, block: Memory) -> None:
    """Numbers of a block of variants; lanes beyond the last variant repeat it."""
    count = min(LANES, numbers.shape[1] - begin)
    for i in range(numbers.shape[0]):
        if count == LANES:
            for lane in range(LANES):
                block[i, lane] = numbers[i, begin + lane]
        else:
            for lane in range(LANES):
                block[i, lane] = numbers[i, begin + min(lane, count - 1)]


@routine
def hand_out(count: int, block: Memory, begin: int, row: int, answers: np.ndarray) -> None:
    """Write rows of a block to their variants, to rows of the answers from `row` on."""
    lanes = min(LANES, answers.shape[1] - begin)
    for i in range(count):
        if lanes == LANES:
            for lane in range(LANES):
                answers[row + i, begin + lane] = block[i, lane]
        else:
            for lane in range(lanes):
                answers[row + i, begin + lane] = block[i, lane]


@routine
def copy_rows(given: Memory, wanted: np.ndarray, block: Memory) -> None:
    """Copy rows to those rows of the block's numbers that are to receive them, if any."""
    for i in range(wanted.shape[0]):
        if wanted[i] >= 0:
            for lane in range(LANES):
                block[wanted[i], lane] = given[i, lane]


@routine
def mark_broken(curves: int, tile: Memory, q: Memory, walk: Memory, broken_at: Memory) -> None:
    """Note the first position where a curve isn't finite, in lanes where none was noted yet."""
    for lane in range(LANES):
        if walk[ACCEPTED, lane] == 0.0 or not math.isnan(broken_at[lane]):
            continue
        for i in range(POSITIONS):
            j = POSITIONS - 1 - i
            for c in range(curves):
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
        Input positions of each lane's panel with cosine and sine.
    tile, level_tile, state_tile : ndarray (curves, POSITIONS, LANES), (levels, 1, LANES), (states, 1, LANES)
    figures : ndarray (curves, FIGURES, LANES)
    scales : ndarray (curves, SCALES, LANES)
    integrals : ndarray (integrals, INTEGRAL, LANES)
    scan, scan_beside, turn, crossing : SampleRoom
        Switching functions at the positions scanned, at some of these changed by their rounding, where they turn, and
        where they take levels.
    turns, crossings : ndarray (rows, PARTS, LANES)
        Their roots.
    turn_sought, crossing_sought : ndarray (rows, 2) of int
        What is looked for.
    landmarks : ndarray (functions, LANDMARKS, LANES)
    edges : ndarray (edges, EDGES, LANES)
    sums : ndarray (WORK_ROWS, LANES)
    marks : ndarray (6, LANES)
        Zeros; first position where a curve isn't finite; three rows used meanwhile; whether positions scanned are too
        far apart, or something switches more often than there is room for.
    series : ndarray (2, POSITIONS, LANES)
    candidates : ndarray (steps, CANDIDATE, LANES)
    search : ndarray (SEARCH, LANES)
    found : ndarray (2 EXTREME, LANES)
    result : ndarray (FLUCTUATION, LANES)
    averages : ndarray (AVERAGES, LANES)
    arcs : ndarray (ARCS, LANES)
    signs : ndarray (3, LANES)
        1 and −1, and those of first values.
    angle : ndarray (ANGLE_ROWS, LANES)
    of_one : ndarray (1, FIGURES, LANES)
        Figures of one panel of one curve.
    parts : PartsRoom
        For a walk over parts of panels.
    root : ndarray (INTEGRAL, LANES)
        Integral of a root.
    stretches : ndarray (MOST_STRETCHES, STRETCH)
    order : ndarray (MOST_STRETCHES,) of int
    room : Room
        For the record.
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
    scan: SampleRoom
    scan_beside: SampleRoom
    turn: SampleRoom
    crossing: SampleRoom
    turns: np.ndarray
    crossings: np.ndarray
    turn_sought: np.ndarray
    crossing_sought: np.ndarray
    levels: np.ndarray
    landmarks: np.ndarray
    edges: np.ndarray
    sums: np.ndarray
    marks: np.ndarray
    series: np.ndarray
    candidates: np.ndarray
    search: np.ndarray
    found: np.ndarray
    result: np.ndarray
    averages: np.ndarray
    arcs: np.ndarray
    signs: np.ndarray
    angle: np.ndarray
    of_one: np.ndarray
    parts: PartsRoom
    root: np.ndarray
    stretches: np.ndarray
    order: np.ndarray
    room: Room


def new_workspace(task: Task, numbers: int, steps: int) -> Workspace:
    """Memory for a task, with room for so many steps of a walk."""
    functions, count = task.sizes[0] // 2, task.sizes[3]
    turns, crossings = functions * task.most_roots, len(task.crossings) * task.most_roots
    return Workspace(
        rows(numbers),
        rows(WALK, aside=ASIDE),
        tiles(3),
        tiles(count),
        rows(task.sizes[1], 1),
        rows(task.sizes[2], 1),
        rows(count, FIGURES, aside=ASIDE),
        rows(count, SCALES, aside=ASIDE),
        rows(task.integrals.size, INTEGRAL, aside=ASIDE),
        new_samples(functions, task.scan),
        new_samples(functions, LOOKED_BESIDE),
        new_samples(functions, turns),
        new_samples(functions, crossings),
        rows(turns, PARTS),
        rows(crossings, PARTS),
        np.zeros((turns, 2), np.int64),
        np.zeros((crossings, 2), np.int64),
        rows(max(len(task.crossings), 1)),
        rows(functions, LANDMARKS),
        rows(crossings + task.cuts.size, EDGES, aside=ASIDE),
        rows(WORK_ROWS, aside=ASIDE),
        rows(6, aside=ASIDE),
        tiles(2),
        rows(steps, CANDIDATE, aside=ASIDE),
        rows(SEARCH, aside=ASIDE),
        rows(2 * EXTREME, aside=ASIDE),
        rows(FLUCTUATION, aside=ASIDE),
        rows(AVERAGES, aside=ASIDE),
        rows(ARCS, aside=ASIDE),
        rows(3, aside=ASIDE),
        rows(ANGLE_ROWS, aside=ASIDE),
        rows(1, FIGURES, aside=ASIDE),
        new_parts(),
        rows(INTEGRAL, aside=ASIDE),
        np.zeros((MOST_STRETCHES if len(task.arcs) else 1, STRETCH)),
        np.zeros(MOST_STRETCHES if len(task.arcs) else 1, np.int64),
        new_room(task.kept.size + len(task.works) + len(task.angles) + task.speeds.size, steps),
    )


@routine
def fill(count: int, block: Memory, value: float) -> None:
    """Set rows to a value."""
    for i in range(count):
        for lane in range(LANES):
            block[i, lane] = value


@routine
def note_too_many(counts: Memory, most: int, scale: Memory, too_many: Memory) -> None:
    """Note the lanes in which there is no room for all roots, but of functions that aren't finite everywhere."""
    for lane in range(LANES):
        more = (counts[lane] > float(most)) & (abs(scale[lane]) < math.inf)
        too_many[lane] = 1.0 if more else too_many[lane]


@routine
def spoil(curves: int, lanes: Memory, tile: Memory) -> None:
    """Make all curves NaN in some lanes."""
    for c in range(curves):
        for j in range(POSITIONS):
            for lane in range(LANES):
                tile[c, j, lane] = math.nan if lanes[lane] > 0.0 else tile[c, j, lane]


@routine
def sample_beside(events: Callable, task: Task, tables: np.ndarray, work: Workspace) -> None:
    """Evaluate the switching functions at some of the positions scanned, changed by their rounding."""
    from_place, place, stride = work.scan.place, work.scan_beside.place, task.scan // LOOKED_BESIDE
    q, cos_q, sin_q = in_lanes(place[0]), in_lanes(place[1]), in_lanes(place[2])
    given_q, given_cos, given_sin = in_lanes(from_place[0]), in_lanes(from_place[1]), in_lanes(from_place[2])
    for k in range(LOOKED_BESIDE):
        change_by_rounding(k * stride, given_q, given_cos, given_sin, k, q, cos_q, sin_q)
    events(work.block, tables, place[0], place[1], place[2], work.scan_beside.tile)


@routine
def cut(
    events: Callable, levels: Callable, task: Task, tables: np.ndarray, walk: Memory, edges: Memory, work: Workspace
) -> int:
    """Find each lane's landmarks and what follows from them, and lay its edges; returns how many there are."""
    block, marks, counts, spare, too_many = (
        in_lanes(work.block),
        lane_of(work.marks[2]),
        lane_of(work.marks[3]),
        lane_of(work.marks[4]),
        lane_of(work.marks[5]),
    )
    scan, turned, crossed = samples_in(work.scan), samples_in(work.turn), samples_in(work.crossing)
    beside = samples_in(work.scan_beside)
    landmarks, turns, crossings = of_landmarks(work.landmarks), of_roots(work.turns), of_roots(work.crossings)
    functions = task.landmark_rows.shape[0]
    heights = in_lanes(work.levels)
    turn_rows = crossing_rows = 0 * functions
    for _ in range(task.looks):
        if functions > 0:
            turn_rows = 0 * functions
            scan_positions(block[task.ends[0]], block[task.ends[1]], task.scan, scan.q)
            sample(events, work.block, tables, task.scan, scan)
            sample_beside(events, task, tables, work)
            for f in range(functions):
                turn_rows = find_turns(f, scan, turn_rows, work.turn_sought, turns, marks, counts, task.most_roots)
            solve_roots(events, work.block, tables, turn_rows, work.turn_sought, heights, turned, turns)
            for f in range(functions):
                find_landmarks(f, scan, turn_rows, work.turn_sought, turned, turns, beside, spare, landmarks)
                note_coarse(f, scan, landmarks[f, SCALE], spare, marks, counts, too_many)
                copy_rows(landmarks[f], task.landmark_rows[f], block)
        if task.sizes[1] > 0:
            levels(work.block, tables, work.place[0, :1], work.place[1, :1], work.place[2, :1], work.level_tile)
            copy_rows(in_lanes(work.level_tile), task.level_rows, block)
    for c in range(task.crossings.shape[0]):
        f, row = task.crossings[c, 0], task.crossings[c, 1]
        for lane in range(LANES):
            heights[c, lane] = block[row, lane] + task.offsets[c]
        crossing_rows = find_crossings(
            f,
            c,
            heights[c],
            landmarks[f, SCALE],
            scan,
            turn_rows,
            work.turn_sought,
            turned,
            turns,
            crossing_rows,
            work.crossing_sought,
            crossings,
            marks,
            counts,
            task.most_roots,
        )
        note_too_many(counts, task.most_roots, landmarks[f, SCALE], too_many)
    solve_roots(events, work.block, tables, crossing_rows, work.crossing_sought, heights, crossed, crossings)
    return lay_edges(crossing_rows, work.crossing_sought, crossed, crossings, landmarks, task.cuts, block, walk, edges)


@routine
def follow(
    states: Callable,
    curves: Callable,
    task: Task,
    tables: np.ndarray,
    edges: Memory,
    edge_count: int,
    walk: Memory,
    figures: Memory,
    scales: Memory,
    integrals: Memory,
    broken_at: Memory,
    record: Record,
    work: Workspace,
) -> int:
    """Walk over each lane's range, add up what is to be integrated, keep what is to be kept; returns the steps kept.

    One more than there is room for where there isn't enough.
    """
    count, kept, step = task.sizes[3], task.kept.shape[0], 0 * edge_count
    block, tile, q = in_lanes(work.block), in_panels(work.tile), in_lanes(work.place[0])
    cos_q, sin_q, too_many = in_lanes(work.place[1]), in_lanes(work.place[2]), lane_of(work.marks[5])
    any_lost = any_positive(too_many)
    while next_panels(edges, edge_count, walk):
        panel_positions(walk[PANEL_MIDDLE], walk[PANEL_HALF], q, cos_q, sin_q)
        if task.sizes[2] > 0:
            middle_q, middle_cos = work.place[0, MIDDLE : MIDDLE + 1], work.place[1, MIDDLE : MIDDLE + 1]
            states(work.block, tables, middle_q, middle_cos, work.place[2, MIDDLE : MIDDLE + 1], work.state_tile)
            copy_rows(in_lanes(work.state_tile), task.state_rows, block)
        curves(work.block, tables, work.place[0], work.place[1], work.place[2], work.tile)
        if any_lost:
            spoil(count, too_many, tile)
        broken = False
        for c in range(count):
            panel_figures(tile, c, figures, c)
            note_rounding(tile, c, scales, c, walk)
            broken |= compare_with_tolerance(figures, c, task.tolerances[c], task.only_integrals[c], scales, walk)
        for k in range(task.rooted.shape[0]):
            c = task.rooted[k]
            compare_root(tile, figures, c, task.tolerances[c], scales, walk)
        for k in range(task.kinks.shape[0]):
            find_kink(tile, task.kinks[k], walk)
        if not judge(task.longest[0], walk):
            continue
        if broken:
            mark_broken(count, tile, q, walk, broken_at)
        for k in range(task.integrals.shape[0]):
            add_panels(tile, figures, task.integrals[k], walk, integrals, k)
        if kept > 0:
            if step == work.candidates.shape[0]:
                return step + 1
            keep_panels(walk, step, record.panels)
            for k in range(kept):
                c = task.kept[k]
                keep_curve(tile, c, figures, walk, record, k, step)
        step += 1
    for k in range(kept):
        keep_rounding(scales, task.kept[k], record, k)
    return step


@driver
def evaluate_blocks(
    begin: int,
    end: int,
    blocks: np.ndarray,
    events: Callable,
    levels: Callable,
    states: Callable,
    curves: Callable,
    task: Task,
    numbers: np.ndarray,
    tables: np.ndarray,
    to_coefficients: np.ndarray,
    to_integrals: np.ndarray,
    answers: DriverAnswers,
    work: Workspace,
    arcs_asked: int | None,
) -> None:
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
        The matrices of `engine.cycle.panels.chebyshev`.
    answers : DriverAnswers
    work : Workspace
    arcs_asked : int or None
        None where no unloaded arcs are asked: they are asked rarely, and without them there is less to compile.
    """
    kept, integrated, count = task.kept.shape[0], task.integrals.shape[0], task.sizes[3]
    block, walk, figures, scales = (
        in_lanes(work.block),
        in_lanes(work.walk),
        of_figures(work.figures),
        of_scales(work.scales),
    )
    integrals, edges, sums = of_integrals(work.integrals), of_edges(work.edges), in_lanes(work.sums)
    marks, found, result = in_lanes(work.marks), in_lanes(work.found), in_lanes(work.result)
    landmarks, record, of_one = of_landmarks(work.landmarks), record_in(work.room), of_figures(work.of_one)
    averages, arcs, signs, angle = (
        in_lanes(work.averages),
        in_lanes(work.arcs),
        in_lanes(work.signs),
        in_lanes(work.angle),
    )
    series, root = in_panels(work.series), in_lanes(work.root)
    search = Search(of_candidates(work.candidates), series[0], series[1], in_lanes(work.search))
    high, low, none, broken_at, spare = found, in_lanes(work.found[EXTREME:]), marks[0], marks[1], marks[2]
    too_many = marks[5]
    # Read off arrays, as a function is compiled once more for every number that is known.
    one, four = answers.panels.shape[0], work.arcs.shape[0]
    two = one + one
    first_work, first_angle = kept, kept + task.works.shape[0]
    first_speed = first_angle + task.angles.shape[0]
    for lane in range(LANES):
        signs[0, lane], signs[1, lane] = 1.0, -1.0
    of_landmark, of_fluctuation = work.landmarks.shape[1], work.result.shape[0] - 3
    for i in range(begin, end):
        b = blocks[i]
        first = b * LANES
        gather(numbers, first, block)
        begin_record(record)
        fill(count * SCALES, in_lanes(work.scales), 0.0)
        fill(integrated * INTEGRAL, in_lanes(work.integrals), 0.0)
        fill(1, in_lanes(work.marks[1:]), math.nan)
        fill(1, in_lanes(work.marks[5:]), 0.0)
        set_out(block[task.ends[0]], block[task.ends[1]], task.longest[0], walk)
        cuts = cut(events, levels, task, tables, walk, edges, work)
        for lane in range(LANES):
            # Not for a position of the input.
            broken_at[lane] = math.inf if too_many[lane] > 0.0 else broken_at[lane]
        steps = follow(
            states, curves, task, tables, edges, cuts, walk, figures, scales, integrals, broken_at, record, work
        )
        answers.short_of_room[b] = steps > work.candidates.shape[0]
        if answers.short_of_room[b]:
            continue
        for k in range(task.works.shape[0]):
            add_work(record, to_integrals, steps, task.works[k, 0], task.works[k, 1], first_work + k, sums)
        for k in range(task.angles.shape[0]):
            add_angle(record, steps, task.angles[k, 0], task.angles[k, 1], first_angle + k, of_one, angle)
        for f in range(task.landmark_rows.shape[0]):
            hand_out(of_landmark, landmarks[f], first, f * of_landmark, answers.landmarks)
        for k in range(integrated):
            hand_out(two, integrals[k], first, two * k, answers.integrals)
        for k in range(task.roots.shape[0]):
            tolerance = task.tolerances[task.kept[task.roots[k]]]
            integrate_roots(record, to_coefficients, steps, task.roots[k], tolerance, work.parts, root)
            hand_out(two, root, first, two * k, answers.roots)
        for c in range(count):
            hand_out(one, scales[c], first, c, answers.sizes)
        fill(1, in_lanes(work.search[PERIOD:]), task.periods[0])
        for k in range(task.fluctuations.shape[0]):
            x, y = task.fluctuations[k, 0], task.fluctuations[k, 1]
            speed, wheel = block[task.fluctuations[k, 2]], block[task.fluctuations[k, 3]]
            up, down = signs[0], signs[1]
            find_fluctuation(record, to_coefficients, steps, x, y, speed, wheel, search, up, down, high, low, result)
            hand_out(of_fluctuation, result, first, of_fluctuation * k, answers.fluctuations)
            for j in range(task.speeds.shape[0]):
                if task.speeds[j] == k:
                    add_speed(record, steps, x, y, speed, wheel, result, first_speed + j, of_one, spare)
        for k in range(task.extremes.shape[0]):
            x, y, row, sides = task.extremes[k, 0], task.extremes[k, 1], task.extremes[k, 2], task.extremes[k, 3]
            fill(1, in_lanes(work.search[PERIOD:]), task.periods[1 if sides & EACH_TURN else 0])
            for side in range(2):
                if sides == LEAST_MAGNITUDE:
                    for lane in range(LANES):
                        signs[2, lane] = 1.0 if record.whole[x, FIRST, lane] < 0.0 else -1.0
                if sides & (GREATEST if side == 1 else LEAST + LEAST_MAGNITUDE):
                    factor = block[row] if row >= 0 else none
                    sign = signs[2] if sides == LEAST_MAGNITUDE else signs[1 - side]
                    find_extreme(record, to_coefficients, steps, x, y, factor, sign, search, found)
                else:
                    fill(four, found, math.nan)
                hand_out(four, found, first, four * (two * k + side), answers.extremes)
        for k in range(task.averages.shape[0]):
            find_averages(record, steps, task.averages[k], of_one, spare, averages)
            hand_out(four, averages, first, four * k, answers.averages)
        if arcs_asked is not None:
            for k in range(task.arcs.shape[0]):
                x = task.arcs[k, 2]
                find_extreme(record, to_coefficients, steps, x, x, none, signs[0], search, found)
                for lane in range(LANES):
                    spare[lane] = math.sqrt(found[0, lane])
                x, y = task.arcs[k, 0], task.arcs[k, 1]
                find_unloaded_arcs(record, to_coefficients, steps, x, y, spare, work.stretches, work.order, arcs)
                hand_out(four, arcs, first, four * k, answers.arcs)
        for k in range(task.spaced.shape[0]):
            begins, ends = block[task.ends[0]], block[task.ends[1]]
            intervals, values = task.intervals, answers.spaced[k]
            fill_spaced(record, to_coefficients, steps, task.spaced[k], begins, ends, intervals, first, values)
        for k in range(kept):
            hand_out(one, in_lanes(work.room.whole[k, FIRST:]), first, k, answers.firsts)
        hand_out(one, in_lanes(work.walk[TAKEN:]), first, one - one, answers.panels)
        hand_out(one, in_lanes(work.marks[1:]), first, one - one, answers.broken_at)
