"""Characteristics given as tables over the crank angle, a stroke or time, as nodes.

A table stays on one piece throughout a panel, the piece at the panel's middle; panels end at the table's rows.
"""

import math
from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Alike, Constant, Graph, Node, Number, value_of
from engine.laws.tables import (
    HEAD,
    Table,
    entry,
    entry_from,
    in_memory,
    make_table,
    periods_before,
    sum_of_segments,
    table_segment,
)
from engine.mechanism.actions.paths import time_per_input
from engine.mechanism.kinematics import Kinematics
from engine.parts.actions import Tabled

# Tables with more pieces are searched by a law. Shorter ones are compared row by row in straight-line code of bounded
# length, with which the stages of a motion run a sixth faster.
MOST_LOOKED_THROUGH = 16


class _Place(NamedTuple):
    """Position of the machine in a table: the abscissa; a curve that crosses levels at the rows; its derivative.

    `rows` holds the distance of each level from `base`; for a periodic table, all rows within the cycle.
    """

    abscissa: Node
    curve: Node
    rate: Node
    base: Node
    rows: list[float]


def tabled(kinematics: Kinematics, action: Tabled, factor: Node, time: Node) -> Node:
    """Value of an action's table.

    Parameters
    ----------
    kinematics : Kinematics
    action : Tabled
    factor : Node
        Factor of the value; held over a panel, as the piece of the table is.
    time : Node
        Abscissa of a table over time [s].
    """
    graph = kinematics.graph
    period = _period(kinematics, action)
    table = make_table(action.abscissae, action.ordinates, action.interpolation, period, action.outside)
    place = _place(kinematics, action, period, time)
    for row in place.rows:
        graph.switches(place.curve, place.rate, place.base, row)
    return _value(graph, table, place.abscissa, factor)


def rows_over_angle(
    kinematics: Kinematics, angles: Sequence[float], values: Sequence[float], interpolation: str, outside: str
) -> Node:
    """Curve through rows over the crank angle, all within one cycle.

    Parameters
    ----------
    kinematics : Kinematics
    angles, values : sequence of float
    interpolation, outside : str
        As in `make_table`.
    """
    graph = kinematics.graph
    for angle in dict.fromkeys(angles):
        graph.switches(graph.q, graph.one, angle)
    return _value(graph, make_table(angles, values, interpolation, 0.0, outside), graph.q, graph.one)


def _value(graph: Graph, table: Table, x: Node, factor: Node) -> Node:
    """Value of a table; the polynomial of the piece at x, times the factor, is held."""
    begin, *coefficients = _piece(graph, table, x)
    value = _polynomial([graph.held(c * factor) for c in coefficients], x - graph.held(begin))

    def total(tables: list[tuple[Number | Constant, float]]) -> Node:
        """Weighted sum of tables, each given by its weight and its offset in the memory."""
        weights, begins = zip(*tables, strict=True)
        offsets = graph.store(np.array(begins))
        name = f"tables at {offsets.value:.0f} by {', '.join(w.label for w in weights)}"
        numbers = [graph.derived(f"{w.label} of {name}", partial(value_of, w)) for w in weights]
        place = graph.memory, offsets, float(len(weights)), graph.number_table(name, numbers), x
        cubic = graph.apply(sum_of_segments, *place)
        return _polynomial([graph.held(c * factor) for c in cubic], x - graph.held(x))

    return graph.alike(value, Alike(("table", x, factor), graph.store(in_memory(table)).value, total))


def _polynomial(coefficients: Sequence[Node], t: Node) -> Node:
    """Evaluate a polynomial by Horner's rule, highest power first."""
    value, *others = coefficients
    for coefficient in others:
        value = value * t + coefficient
    return value


def _piece(graph: Graph, table: Table, x: Node) -> tuple[Node, ...]:
    """Start of the table's piece that contains x, and its polynomial, highest power first."""
    offset, pieces = graph.store(in_memory(table)), table.coefficients.shape[0]
    powers = [power for power in range(4) if table.coefficients[:, : power + 1].any() or power == 3]
    if pieces > MOST_LOOKED_THROUGH:
        begin, *cubic = graph.apply(table_segment, graph.memory, offset, x)
        return begin, *(cubic[power] for power in powers)
    away = graph.apply(periods_before, table.start, table.period, x) if table.period else graph.zero
    breaks = offset + HEAD
    found = []
    for first, apart in [(breaks, 1), *((breaks + pieces + 1 + power, 4) for power in powers)]:
        number = graph.apply(entry, graph.memory, first)
        for piece in range(1, pieces):
            places = (first + apart * piece, breaks + piece)
            number = graph.apply(entry_from, graph.memory, *places, x - away, number)
        found.append(number)
    return found[0] + away, *found[1:]


def _period(kinematics: Kinematics, action: Tabled) -> float:
    """Period of a table: the cycle for a table over the angle of a fully turning crank, else 0."""
    closed = kinematics.scene.has_cycle and action.over_angle is not None
    return math.tau * kinematics.scene.input.revolutions if closed else 0.0


def jumps_of(action: Tabled) -> set[float]:
    """Rows at which a table that isn't periodic jumps."""
    x, y = np.array(action.abscissae), np.array(action.ordinates)
    jumps = {float(row) for row in x[1:][np.diff(x) == 0.0]}
    return jumps | {float(x[i]) for i in (0, -1) if action.outside == "zero" and y[i] != 0.0}


def _place(kinematics: Kinematics, action: Tabled, period: float, time: Node) -> _Place:
    graph, rows = kinematics.graph, list(dict.fromkeys(map(float, action.abscissae)))
    if action.over_angle is not None:
        return _Place(graph.q, graph.q, graph.one, graph.zero, sorted({x % period for x in rows}) if period else rows)
    if action.over_time is not None:
        return _Place(time, time, time_per_input(kinematics), graph.zero, rows)
    slide = kinematics.slides[action.slider]
    d = slide.d
    if action.measured_from == "guide":
        return _Place(d, d, slide.v, graph.zero, rows)
    # The slider never passes the end from which the distance is measured.
    inside = [x for x in rows if x > 0.0]
    if action.measured_from == "low end":
        low = graph.found(d, slide.v, "low")
        return _Place(d - low, d, slide.v, low, inside)
    high = graph.found(d, slide.v, "high")
    return _Place(high - d, d, slide.v, high, [-x for x in inside])
