"""Measures of a block's cycles from its record, each a separate compiled function: a plan needs only some.

All have one signature. Those that add curves to the record run before those that measure these.
"""

import math

from engine.compiling.blocks import LANES, in_lanes, scatter_rows
from engine.compiling.decorators import separate
from engine.compiling.packed import unpacked
from engine.cycle.driver import DriverAnswers, Task, Workspace
from engine.cycle.measures.angles import add_angle
from engine.cycle.measures.averages import fill_spaced, find_averages
from engine.cycle.measures.extremes import (
    EACH_TURN,
    GREATEST,
    LEAST,
    LEAST_MAGNITUDE,
    ExtremeRows,
    SoughtExtreme,
    find_extreme,
)
from engine.cycle.measures.fluctuation import SteadyWheel, add_speed, find_fluctuation
from engine.cycle.measures.magnitudes import integrate_roots
from engine.cycle.measures.unloaded_arcs import find_unloaded_arcs
from engine.cycle.measures.works import add_work
from engine.cycle.panels.lanes import fill

_EXTREME = len(ExtremeRows._fields)


@separate
def measure_works(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Add the running integrals to the record."""
    for k in range(task.works.shape[0]):
        add_work(unpacked(work.record), task.works[k, 0], task.works[k, 1], task.kept + k, work.sums)


@separate
def measure_angles(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Add the angles of vectors to the record."""
    begin = task.kept + task.works.shape[0]
    for k in range(task.angles.shape[0]):
        add_angle(unpacked(work.record), task.angles[k, 0], task.angles[k, 1], begin + k, work.turning)


@separate
def measure_fluctuations(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Find the speed fluctuations, and add speeds to the record."""
    record, block, search = work.record, in_lanes(work.block), work.search
    begin = task.kept + task.works.shape[0] + task.angles.shape[0]
    for k in range(task.fluctuations.shape[0]):
        asked = task.fluctuations[k]
        steady = SteadyWheel(asked[0], asked[1], block[asked[2]], block[asked[3]], task.period)
        find_fluctuation(record, steady, search, work.ends, work.fluctuation)
        scatter_rows(work.fluctuation, first, answers.fluctuations[k])
        for j in range(task.speeds.shape[0]):
            if task.speeds[j] == k:
                add_speed(unpacked(record), steady, work.ends, work.fluctuation, begin + j)


@separate
def measure_roots(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Integrate square roots of curves."""
    for k in range(task.roots.shape[0]):
        c = task.roots[k]
        integrate_roots(unpacked(work.record), c, task.tolerance[c], work.parts, work.root)
        scatter_rows(work.root, first, answers.roots[k])


@separate
def measure_extremes(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Find the extremes."""
    record, block, search, found, sign = work.record, in_lanes(work.block), work.search, work.found, work.sign
    for k in range(task.extremes.shape[0]):
        a, b, row, sides = task.extremes[k, 0], task.extremes[k, 1], task.extremes[k, 2], task.extremes[k, 3]
        factor = block[row] if row >= 0 else search.zero
        period = task.turn if sides & EACH_TURN else task.period
        for side in range(2):
            if sides & (GREATEST if side == 1 else LEAST + LEAST_MAGNITUDE):
                for lane in range(LANES):
                    away = sides == LEAST_MAGNITUDE and record.whole[a].first[lane] < 0.0
                    sign[lane] = 1.0 if side == 1 or away else -1.0
                find_extreme(record, SoughtExtreme(a, b, factor, sign, period), search, found)
            else:
                fill(found, _EXTREME, math.nan)
            scatter_rows(found, first, answers.extremes[k, side])


@separate
def measure_averages(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Find means and mean squares."""
    for k in range(task.averages.shape[0]):
        find_averages(unpacked(work.record), task.averages[k], work.averages)
        scatter_rows(work.averages, first, answers.averages[k])


@separate
def measure_arcs(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Find unloaded arcs."""
    record, search, found, arcs = work.record, work.search, work.found, work.stretches
    for k in range(task.arcs.shape[0]):
        square = task.arcs[k, 2]
        find_extreme(record, SoughtExtreme(square, square, search.zero, search.up, task.period), search, found)
        find_unloaded_arcs(unpacked(record), task.arcs[k, 0], task.arcs[k, 1], found, arcs)
        scatter_rows(arcs.arc, first, answers.arcs[k])


@separate
def measure_spaced(task: Task, answers: DriverAnswers, work: Workspace, first: int) -> None:
    """Evaluate curves at equally spaced positions."""
    block = in_lanes(work.block)
    for k in range(task.spaced.shape[0]):
        starts, ends = block[task.ends[0]], block[task.ends[1]]
        fill_spaced(unpacked(work.record), task.spaced[k], starts, ends, task.intervals, first, answers.spaced[k])


# Measures that search for extremes.
SEARCHES = ("fluctuations", "extremes", "arcs")
# In the order in which they run, by the field of the task with what they measure.
MEASURES = {
    "works": measure_works,
    "angles": measure_angles,
    "fluctuations": measure_fluctuations,
    "roots": measure_roots,
    "extremes": measure_extremes,
    "averages": measure_averages,
    "arcs": measure_arcs,
    "spaced": measure_spaced,
}
