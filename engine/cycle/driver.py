"""The function that runs every machine: blocks of variants, one after another, each through its cycle.

A machine supplies three functions of one signature, the measures of its plan, and index arrays of the results.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, Rows, copy_rows, gather, in_lanes, scatter_row, scatter_rows
from engine.compiling.decorators import driver, routine, separate
from engine.compiling.packed import call_at, unpacked
from engine.cycle.close_turns import ADDED, CloseTurns, add_close_turns, begin_close_turns, new_close_turns
from engine.cycle.events import (
    LOOKED_BESIDE,
    LandmarkRows,
    Level,
    Noted,
    find_crossings,
    find_landmarks,
    find_turns,
    lay_edges,
    note_coarse,
    scan_positions,
    store_crossings,
)
from engine.cycle.measures.angles import FollowedAngle
from engine.cycle.measures.averages import Averages
from engine.cycle.measures.extremes import ExtremeRows, Search
from engine.cycle.measures.fluctuation import Fluctuation, SpeedEnds
from engine.cycle.measures.magnitudes import Parts
from engine.cycle.measures.unloaded_arcs import MOST_STRETCHES, Stretches, new_stretches
from engine.cycle.measures.works import WorkSums
from engine.cycle.panels.chebyshev import POSITIONS
from engine.cycle.panels.directions import change_by_rounding, panel_positions
from engine.cycle.panels.integrals import IntegralRows, add_panels
from engine.cycle.panels.lanes import Panels, any_positive, fill, in_panels, many, new_record, one, rows
from engine.cycle.panels.record import Record, begin_record, keep_curve, keep_panels, keep_rounding, room_for
from engine.cycle.panels.series import Figures, panel_figures
from engine.cycle.panels.walk import (
    Edge,
    Scales,
    Walk,
    compare_root,
    compare_with_tolerance,
    find_kink,
    find_touch,
    judge,
    next_panels,
    note_rounding,
    set_out,
)
from engine.cycle.roots import GivenNumbers, Roots, Samples, new_roots, new_samples, sample, solve_roots

_SCALES, _INTEGRAL = len(Scales._fields), len(IntegralRows._fields)


class MachineFunctions(NamedTuple):
    """The functions of a machine; see `engine.cycle.cycle_machine`."""

    events: Callable
    levels: Callable
    curves: Callable


class Task(NamedTuple):
    """The requested results of a machine: the plan of `engine.cycle.cycle_machine` as arrays.

    Attributes not listed are those of the plan. Curves are numbered as in the record; those to integrate, as in the
    machine.

    Attributes
    ----------
    functions : MachineFunctions
    most_roots : int
        Room for turning points of each switching function, and for its crossings of one level.
    kept : int
        Number of curves to keep over the cycle, the first ones: the first curves of the record.
    works : ndarray (works, 2) of int
        Curves whose running integrals are the next curves of the record, and 1 if about the mean, else 0.
    angles : ndarray (angles, 2) of int
        Curves with the components of the vectors whose angles are its next curves.
    speeds : ndarray of int
        Indices of the fluctuations whose speeds are its last curves.
    extremes : ndarray (extremes, 4) of int
        Curves a and b, the row of P with the factor c, and the kind of extreme of a − c (b − b₀), as in
        `engine.cycle.measures.extremes`; row −1 for the extreme of a only.
    only_integrals : ndarray (curves,) of float
        1 for curves of the machine that are only integrated, else 0.
    """

    functions: MachineFunctions
    ends: np.ndarray
    landmarks: np.ndarray
    levels: np.ndarray
    states: np.ndarray
    crossings: np.ndarray
    cuts: np.ndarray
    kinks: np.ndarray
    scan: int
    looks: int
    most_roots: int
    integrals: np.ndarray
    roots: np.ndarray
    rooted: np.ndarray
    kept: int
    works: np.ndarray
    angles: np.ndarray
    speeds: np.ndarray
    extremes: np.ndarray
    fluctuations: np.ndarray
    averages: np.ndarray
    arcs: np.ndarray
    spaced: np.ndarray
    intervals: int
    degree: int
    tolerance: np.ndarray
    only_integrals: np.ndarray
    longest: float
    period: float
    turn: float


class EvaluatedVariants(NamedTuple):
    """The variants to evaluate.

    Attributes
    ----------
    blocks : ndarray of int
        Indices of blocks of LANES variants.
    numbers : ndarray (numbers, variants)
        P of all variants.
    tables : ndarray
        T.
    """

    blocks: np.ndarray
    numbers: np.ndarray
    tables: np.ndarray


class DriverAnswers(NamedTuple):
    """Arrays that the driver fills, (results, fields of a record, variants) unless stated otherwise.

    Attributes
    ----------
    integrals, roots : ndarray
        Integrals of curves and of square roots of curves: value and error estimate.
    sizes : ndarray (curves, variants)
        Maximum magnitudes.
    extremes : ndarray (extremes, 2, 4, variants)
        Minimum and maximum: value, its error estimate, position, its error estimate.
    fluctuations, averages, arcs, landmarks : ndarray
    firsts : ndarray (kept, variants)
        Initial values of the kept curves.
    panels : ndarray (variants,)
        Number of panels.
    broken_at : ndarray (variants,)
        First position at which a curve is NaN or infinite; NaN if there is none, infinite if a function switches too
        often.
    crossings : ndarray (crossings, roots, variants)
        Positions of the crossings of each level, NaN for missing ones.
    spaced : ndarray (spaced, variants, positions)
        Values at equally spaced positions.
    short_of_room : ndarray (blocks,) of bool
        Whether a block needs a longer record.
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
    crossings: np.ndarray
    spaced: np.ndarray
    short_of_room: np.ndarray


class Workspace(NamedTuple):
    """Scratch arrays for one block of variants, reused for the next.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
        Numbers of the block's variants.
    place : ndarray (3, POSITIONS, LANES)
        Positions of each lane's panel, with cosine and sine.
    tile : ndarray (curves of all steps, POSITIONS, LANES)
        Values of the record. A panel's curves are evaluated in place; those that aren't kept lie behind the others, and
        are overwritten by the works and by the next step.
    level_tile : ndarray (levels, 1, LANES)
    figures, scales : many
        One for each curve.
    scan, scan_beside : Samples
        Switching functions at the scan positions, and their changes when some of these are perturbed by their rounding.
    turns, crossings : Roots
        Turning points of the switching functions, and their crossings of levels.
    middle : Samples
        What `events` fills at the middle of a panel.
    heights : rows
        Levels of the crossings.
    edges, laid : many, ndarray (1,) of int
        Cuts of the cycle, and their number.
    broken_at : row
        First position at which a curve is NaN or infinite.
    too_many : row
        1 if the scan positions are too coarse or there are more roots than room, else 0.
    sign : row
        Sign of the extreme searched for.
    """

    block: np.ndarray
    place: np.ndarray
    tile: np.ndarray
    level_tile: np.ndarray
    walk: one(Walk)
    figures: many(Figures)
    scales: many(Scales)
    integrals: many(IntegralRows)
    scan: Samples
    scan_beside: Samples
    close_turns: CloseTurns
    turns: Roots
    crossings: Roots
    middle: Samples
    noted: one(Noted)
    heights: Rows
    landmarks: many(LandmarkRows)
    edges: many(Edge)
    laid: np.ndarray
    sums: one(WorkSums)
    turning: one(FollowedAngle)
    search: Search
    found: one(ExtremeRows)
    fluctuation: one(Fluctuation)
    ends: SpeedEnds
    averages: one(Averages)
    stretches: Stretches
    parts: Parts
    root: one(IntegralRows)
    broken_at: Row
    too_many: Row
    sign: Row
    record: Record


def recorded_curves(task: Task) -> int:
    """Number of curves in the record."""
    return task.kept + len(task.works) + len(task.angles) + task.speeds.size


def new_workspace(task: Task, numbers: int, steps: int) -> Workspace:
    """Allocate the workspace of a task, with a given number of rows of P and of steps of the walk."""
    functions, count = len(task.landmarks), task.tolerance.size
    outputs = 2 * functions + task.states.size
    crossings, positions = len(task.crossings) * task.most_roots, (1 + ADDED) * task.scan
    search = new_record(Search, candidates=steps, series=POSITIONS, other_series=POSITIONS, finder=0)
    search.up[:], search.down[:] = 1.0, -1.0
    record = room_for(recorded_curves(task), steps, task.degree, count)
    return new_record(
        Workspace,
        block=rows(numbers),
        place=rows(3, POSITIONS),
        tile=record.values,
        level_tile=rows(task.levels.size, 1),
        figures=count,
        scales=count,
        integrals=task.integrals.size,
        scan=new_samples(outputs, positions),
        scan_beside=new_samples(outputs, LOOKED_BESIDE),
        close_turns=new_close_turns(outputs, positions),
        turns=new_roots(outputs, functions * task.most_roots),
        crossings=new_roots(outputs, crossings),
        middle=new_samples(outputs, 1),
        heights=max(len(task.crossings), 1),
        landmarks=functions,
        edges=crossings + task.cuts.size,
        laid=np.zeros(1, np.int64),
        search=search,
        ends=new_record(SpeedEnds),
        stretches=new_stretches(MOST_STRETCHES if len(task.arcs) else 0),
        parts=new_record(Parts, edges=1),
        record=record,
    )


@routine
def mark_broken(curves: int, degree: int, tile: Panels, q: Rows, walk: Walk, broken_at: Row) -> None:
    """Record the first position at which a curve is NaN or infinite, in lanes that have none yet."""
    for lane in range(LANES):
        if walk.accepted[lane] == 0.0 or not math.isnan(broken_at[lane]):
            continue
        for i in range(degree + 1):
            j = degree - i
            for c in range(curves):
                if not abs(tile[c, j, lane]) < math.inf:
                    broken_at[lane] = q[j, lane]


@routine
def note_too_many(counts: Row, most: int, scale: Row, too_many: Row) -> None:
    """Mark lanes with more roots than room, except where the function is NaN or infinite somewhere."""
    for lane in range(LANES):
        more = (counts[lane] > float(most)) & (abs(scale[lane]) < math.inf)
        too_many[lane] = 1.0 if more else too_many[lane]


@routine
def spoil(curves: int, lanes: Row, tile: Panels) -> None:
    """Set all curves to NaN in the marked lanes."""
    for c in range(curves):
        for j in range(POSITIONS):
            for lane in range(LANES):
                tile[c, j, lane] = math.nan if lanes[lane] > 0.0 else tile[c, j, lane]


@routine
def sample_beside(events: Callable, given: GivenNumbers, samples: Samples, beside: Samples) -> None:
    """Fill changes of the switching functions when some of the scan positions are perturbed by their rounding."""
    at, place, stride = samples.place, beside.place, samples.used[0] // LOOKED_BESIDE
    q, cos_q, sin_q = in_lanes(place[0]), in_lanes(place[1]), in_lanes(place[2])
    given_q, given_cos, given_sin = in_lanes(at[0]), in_lanes(at[1]), in_lanes(at[2])
    for k in range(LOOKED_BESIDE):
        change_by_rounding(k * stride, given_q, given_cos, given_sin, k, q, cos_q, sin_q)
    events(given.block, given.tables, place[0], place[1], place[2], beside.tile)
    for f in range(beside.tile.shape[0]):
        for k in range(LOOKED_BESIDE):
            for lane in range(LANES):
                beside.tile[f, k, lane] -= samples.tile[f, k * stride, lane]


@separate
def find_cuts(task: Task, variants: EvaluatedVariants, work: Workspace) -> None:
    """Find each lane's landmarks and the numbers that follow from them, and lay its edges."""
    given = GivenNumbers(work.block, variants.tables)
    events, levels = task.functions.events, task.functions.levels
    block, most, place = in_lanes(given.block), task.most_roots, work.place
    turns, crossings, noted, count = unpacked(work.turns), unpacked(work.crossings), work.noted, task.landmarks.shape[0]
    scan, beside, close_turns = unpacked(work.scan), unpacked(work.scan_beside), unpacked(work.close_turns)
    crossings.used[0] = 0
    for _ in range(task.looks):
        if count > 0:
            turns.used[0] = 0
            scan_positions(block[task.ends[0]], block[task.ends[1]], task.scan, in_lanes(scan.place[0]))
            sample(events, given, task.scan, scan)
            begin_close_turns(task.scan, scan, close_turns)
            sample_beside(events, given, scan, beside)
            for f in range(count):
                note_coarse(f, scan, noted, work.too_many)
            for f in range(count):
                add_close_turns(f, events, given, work.walk.range, scan, close_turns)
            for f in range(count):
                find_turns(f, scan, most, noted, turns)
            solve_roots(events, given, work.heights, turns)
            for f in range(count):
                find_landmarks(f, scan, beside, turns, task.turn, noted.steepest, work.landmarks[f])
                copy_rows(work.landmarks[f], task.landmarks[f], block)
        if task.levels.shape[0] > 0:
            levels(given.block, given.tables, place[0, :1], place[1, :1], place[2, :1], work.level_tile)
            copy_rows(in_lanes(work.level_tile), task.levels, block)
    for c in range(task.crossings.shape[0]):
        f, row, offset = int(task.crossings[c, 0]), int(task.crossings[c, 1]), task.crossings[c, 2]
        height, scale = work.heights[c], work.landmarks[f].scale
        for lane in range(LANES):
            height[lane] = block[row, lane] + offset
        find_crossings(Level(f, c, height, scale), scan, turns, most, noted, crossings)
        note_too_many(noted.counts, most, scale, work.too_many)
    solve_roots(events, given, work.heights, crossings)
    work.laid[0] = lay_edges(crossings, work.landmarks, task.cuts, block, work.walk, work.edges)


@routine
def follow(task: Task, given: GivenNumbers, work: Workspace) -> bool:
    """Walk over each lane's range, integrate and keep curves; returns False if the record has no room for a step."""
    events, curves = task.functions.events, task.functions.curves
    count, kept, degree = task.tolerance.shape[0], task.kept, task.degree
    walk, record, place, middle = work.walk, unpacked(work.record), work.place, task.degree // 2
    block, figures, scales = in_lanes(given.block), work.figures, work.scales
    q, cos_q, sin_q = in_lanes(place[0]), in_lanes(place[1]), in_lanes(place[2])
    any_lost = any_positive(work.too_many)
    while next_panels(work.edges, work.laid[0], walk):
        step = record.steps[0]
        if step == record.most_steps:
            return False
        slots = work.tile[step * record.curves : step * record.curves + count]
        tile = in_panels(slots)
        panel_positions(walk.middle, walk.half, degree, q, cos_q, sin_q)
        if task.states.shape[0] > 0:
            held = work.middle.tile
            middle_q, middle_cos = place[0, middle : middle + 1], place[1, middle : middle + 1]
            middle_sin = place[2, middle : middle + 1]
            events(given.block, given.tables, middle_q, middle_cos, middle_sin, held)
            copy_rows(in_lanes(held[2 * task.landmarks.shape[0] :]), task.states, block)
        rows_q, rows_cos, rows_sin = place[0, : degree + 1], place[1, : degree + 1], place[2, : degree + 1]
        curves(given.block, given.tables, rows_q, rows_cos, rows_sin, slots)
        if any_lost:
            spoil(count, work.too_many, tile)
        broken = False
        for c in range(count):
            panel_figures(tile[c], degree, work.search.zero, figures[c])
            note_rounding(tile[c], degree, scales[c], walk)
            broken |= compare_with_tolerance(figures[c], task.tolerance[c], task.only_integrals[c], scales[c], walk)
        for k in range(task.rooted.shape[0]):
            c = task.rooted[k]
            compare_root(tile[c], degree, figures[c], task.tolerance[c], scales[c], walk)
        for k in range(task.kinks.shape[0]):
            c = task.kinks[k]
            find_kink(tile[c], degree, walk)
            find_touch(tile[c], degree, scales[c], walk)
        if not judge(task.longest, degree, walk):
            continue
        if broken:
            mark_broken(count, degree, tile, q, walk, work.broken_at)
        # Kinks are located only as closely as panels require. Where one is left inside, estimate errors as for a kink.
        if any_positive(walk.bent):
            for c in range(count):
                panel_figures(tile[c], degree, walk.bent, figures[c])
        for k in range(task.integrals.shape[0]):
            c = task.integrals[k]
            add_panels(tile[c], degree, figures[c], walk, work.integrals[k])
        if kept > 0:
            keep_panels(walk, record.panels[step])
            for c in range(kept):
                keep_curve(figures[c], walk, record, step, c)
            record.steps[0] = step + 1
    for c in range(kept):
        keep_rounding(scales[c], record.whole[c])
    return True


@routine
def begin_block(task: Task, work: Workspace) -> None:
    """Reset sums, scales and marks for a new block."""
    begin_record(work.record)
    for c in range(task.tolerance.shape[0]):
        fill(work.scales[c], _SCALES, 0.0)
    for k in range(task.integrals.shape[0]):
        fill(work.integrals[k], _INTEGRAL, 0.0)
    for lane in range(LANES):
        work.broken_at[lane], work.too_many[lane] = math.nan, 0.0


@driver
def evaluate_blocks(
    begin: int,
    end: int,
    task: Task,
    answers: DriverAnswers,
    work: Workspace,
    variants: EvaluatedVariants,
    cuts: int,
    measures: np.ndarray,
) -> None:
    """Evaluate blocks of variants.

    Parameters
    ----------
    begin, end : int
        Range of entries of `variants.blocks`; `end` is excluded.
    task : Task
    answers : DriverAnswers
    work : Workspace
    variants : EvaluatedVariants
    cuts : int
        Address of `find_cuts`; 0 if nothing cuts the cycle.
    measures : ndarray of int
        Addresses of functions of `engine.cycle.block_measures`.
    """
    given, block = GivenNumbers(work.block, variants.tables), in_lanes(work.block)
    record, walk, starts, ends = unpacked(work.record), work.walk, block[task.ends[0]], block[task.ends[1]]
    for i in range(begin, end):
        b = variants.blocks[i]
        first = b * LANES
        gather(variants.numbers, first, block)
        begin_block(task, work)
        set_out(starts, ends, task.longest, walk)
        if cuts != 0:
            call_at(cuts, (task, variants, work))
        for lane in range(LANES):
            # Infinite, because the cause has no single position.
            work.broken_at[lane] = math.inf if work.too_many[lane] > 0.0 else work.broken_at[lane]
        if answers.crossings.shape[0] > 0:
            store_crossings(unpacked(work.crossings), first, answers.crossings)
        answers.short_of_room[b] = task.tolerance.shape[0] > 0 and not follow(task, given, work)
        if answers.short_of_room[b]:
            continue
        for k in range(measures.shape[0]):
            call_at(measures[k], (task, answers, work, first))
        for f in range(task.landmarks.shape[0]):
            scatter_rows(work.landmarks[f], first, answers.landmarks[f])
        for k in range(task.integrals.shape[0]):
            scatter_rows(work.integrals[k], first, answers.integrals[k])
        for c in range(task.tolerance.shape[0]):
            scatter_row(work.scales[c].greatest, first, answers.sizes[c])
        for c in range(task.kept):
            scatter_row(record.whole[c].first, first, answers.firsts[c])
        scatter_row(walk.taken, first, answers.panels)
        scatter_row(work.broken_at, first, answers.broken_at)
