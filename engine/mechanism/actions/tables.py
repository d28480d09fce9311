"""Characteristics given as tables over the crank angle, a stroke or time, as nodes.

The piece of the table that holds in the middle of a panel holds throughout it; panels end at the table's rows.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.laws.tables import in_memory, make_table, segment_value, table_segment
from engine.mechanism.kinematics import Kinematics
from engine.scene.actions import Tabled
from engine.scene.parts import CrankInput


class _Place(NamedTuple):
    """Where in a table the machine is: the abscissa; a curve that passes levels where it passes rows; its derivative.

    `levels` are those of the rows; of a periodic table of all that lie in the cycle.
    """

    abscissa: Node
    curve: Node
    rate: Node
    levels: list[Node | float]


def tabled(kinematics: Kinematics, action: Tabled, factor: Node) -> Node:
    """Value of an action's table.

    Parameters
    ----------
    kinematics : Kinematics
    action : Tabled
    factor : Node
        What the value is multiplied by; held throughout a panel like the piece of the table.
    """
    graph = kinematics.graph
    period = _period(kinematics, action)
    table = make_table(action.abscissae, action.ordinates, action.interpolation, period, action.outside)
    place = _place(kinematics, action, period)
    for level in place.levels:
        graph.switches(place.curve, place.rate, level)
    begin, *cubic = graph.apply(table_segment, graph.memory, graph.store(in_memory(table)), place.abscissa)
    held = [graph.held(begin), *(graph.held(c * factor) for c in cubic)]
    return graph.apply(segment_value, *held, place.abscissa)


def _period(kinematics: Kinematics, action: Tabled) -> float:
    """Period of a table: that of the cycle over the angle of a crank that turns fully, 0 otherwise."""
    drive = kinematics.scene.input
    full = isinstance(drive, CrankInput) and drive.start is None
    return 2.0 * math.pi * drive.revolutions if full and action.over_angle is not None else 0.0


def _place(kinematics: Kinematics, action: Tabled, period: float) -> _Place:
    graph, rows = kinematics.graph, [float(x) for x in np.unique(action.abscissae)]
    if action.over_angle is not None:
        return _Place(graph.q, graph.q, graph.one, _within_cycle(rows, period))
    if action.over_time is not None:
        clock = time_of(kinematics)
        return _Place(clock, clock, time_per_input(kinematics), rows)
    slide = kinematics.slides[action.slider]
    d = slide.d
    if action.measured_from == "guide":
        return _Place(d, d, slide.v, rows)
    # The slider never gets beyond the end that its distance is measured from.
    inside = [x for x in rows if x > 0.0]
    if action.measured_from == "low end":
        low = graph.found(d, slide.v, "low")
        return _Place(d - low, d, slide.v, [low + x for x in inside])
    high = graph.found(d, slide.v, "high")
    return _Place(high - d, d, slide.v, [high - x for x in inside])


def _within_cycle(rows: list[float], period: float) -> list[float]:
    """Rows of a periodic table as angles of the cycle, its ends left out; of any other table its rows."""
    if period == 0.0:
        return rows
    return sorted({x % period for x in rows} - {0.0, period})


def time_of(kinematics: Kinematics) -> Node:
    """Time since the begin of the cycle [s], in the direction in which the input moves."""
    drive = kinematics.scene.input
    full = isinstance(drive, CrankInput) and drive.start is None

    def begin(numbers: dict) -> float | np.ndarray:
        first = 0.0 if full else numbers["input.start"]
        last = 2.0 * math.pi * drive.revolutions if full else numbers["input.stop"]
        forward = np.asarray(numbers["input.speed"]) > 0.0
        return np.where(forward, np.minimum(first, last), np.maximum(first, last))

    graph = kinematics.graph
    return (graph.q - graph.derived("position at the begin", begin)) * time_per_input(kinematics)


def time_per_input(kinematics: Kinematics) -> Node:
    """Time that passes for each unit of the input's motion [s/rad or s/m]."""
    return kinematics.graph.derived("time for the input's unit", lambda n: 1.0 / n["input.speed"])
