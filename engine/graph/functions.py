"""Functions of one machine, printed from its graph.

Three functions fill tiles. They share one signature, (P, T, q, cos_q, sin_q, tile), so compiled code takes those of any
machine as values:

- `events` fills the switching functions, at whose level crossings something switches, and their derivatives, and then
  the held nodes, whose values at the middle of a panel count;
- `levels` fills the numbers of the cycle, if any of them follows from extremes of the switching functions;
- `curves` fills all requested curves.

A fourth, `fields`, fills rows over equally spaced positions, for one variant at a time.

Each is printed as the function `fill` of a separate module, so equal ones are compiled once.
"""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import PANEL_POSITIONS
from engine.compiling.printed_code import PrintedCode
from engine.graph.nodes import (
    Constant,
    Crossing,
    Found,
    Given,
    Graph,
    Held,
    LawResult,
    Node,
    Number,
    Operation,
    Stage,
    Sum,
    TableMemory,
    reached,
)
from engine.graph.printer import in_lanes, over_positions


class Landmark(NamedTuple):
    """Rows of P for the minimum and maximum of a curve over the cycle, and for their positions; −1: none."""

    low: int
    high: int
    low_at: int
    high_at: int


class Functions(NamedTuple):
    """The functions of one machine and the layout of their numbers.

    Attributes
    ----------
    codes : dict of str to PrintedCode
        Some of `events`, `levels`, `curves`, …; none of those without outputs.
    rows : dict of Node to int
        Row of P of each number: the input's range first, then numbers of the variant, the cycle and the panel.
    numbers : tuple of Number or Constant
        Numbers of the variant, in the order of their rows, from row 0 on.
    events : tuple of (Node, Node)
        Switching functions and their derivatives by the input.
    landmarks : tuple of Landmark
        One for each event.
    level_rows, held_rows : tuple of int
        Rows of P for what `levels` fills, and for the held nodes, in order.
    crossings : tuple of (int, int, float)
        Index of the event, row of P with the level it crosses, and the offset added to that level.
    curves : dict of Node to int
        Row of the tile of each curve.
    memory : ndarray
        All tables, flat.
    looks : int
        Number of passes over the events: 2 if some depend on numbers of the cycle, such as extremes of other events.
    """

    codes: Mapping[str, PrintedCode]
    rows: dict[Node, int]
    numbers: tuple[Number | Constant, ...]
    events: tuple[tuple[Node, Node], ...]
    landmarks: tuple[Landmark, ...]
    level_rows: tuple[int, ...]
    held_rows: tuple[int, ...]
    crossings: tuple[tuple[int, int, float], ...]
    curves: dict[Node, int]
    memory: np.ndarray
    looks: int

    @property
    def levels(self) -> list[Node]:
        """Nodes of the rows that `levels` fills."""
        return [node for node, row in self.rows.items() if row in self.level_rows]

    @property
    def found_levels(self) -> tuple[int, ...]:
        """Rows that `levels` fills once extremes are found; none where nothing follows from these."""
        return self.level_rows if _behind_extremes(self.levels) else ()


def functions_of(
    graph: Graph,
    first: Number,
    last: Number,
    curves: Sequence[Node],
    ends: Iterable[Found] = (),
    fields: Sequence[Node] = (),
) -> Functions:
    """Print the functions that compute curves over panels.

    Parameters
    ----------
    graph : Graph
    first, last : Number
        Range of the input [rad].
    curves : sequence of Node
        Nodes required at every position.
    ends : iterable of Found
        Extremes of curves required for themselves.
    fields : sequence of Node
        Kept fields, whose numbers get rows too; `field_function` prints them.
    """
    plan = _planned(graph, first, last, curves, curves, ends, fields)
    return _printed(
        graph,
        plan,
        _events(plan),
        _levels(plan),
        _Part("curves", "All curves, over a panel.", plan.curves, positions=PANEL_POSITIONS, inline_held=False),
    )


def functions_at(
    graph: Graph,
    first: Number,
    last: Number,
    curves: Sequence[Node],
    watched: Sequence[Node] | None = None,
    numbers: Sequence[Node] = (),
) -> Functions:
    """Print the functions that compute curves at single positions, with held nodes evaluated at the position itself.

    There is `curves_at`, and with `watched` also `events` and, if any of them follows from extremes, `levels`.

    Parameters
    ----------
    graph : Graph
    first, last : Number
        Range of the input [rad].
    curves : sequence of Node
        Nodes required at a position; they may depend on given numbers.
    watched : sequence of Node, optional
        Curves whose extremes and crossings are located too.
    numbers : sequence of Node
        Further nodes whose numbers get rows.
    """
    plan = _planned(graph, first, last, curves, [*curves, *(watched or ())], fields=numbers)._replace(held=[])
    return _printed(
        graph,
        plan,
        *([] if watched is None else [_events(plan), _levels(plan)]),
        _at_one_position(plan.curves),
    )


def functions_in_motion(
    graph: Graph,
    first: Number,
    last: Number,
    rates: Sequence[Node],
    watched: Sequence[Node],
    states: Sequence[Given],
) -> Functions:
    """Print the functions of a motion: `places` for nodes of the position, `rates` and `watch` for nodes of a state.

    The first rows of P are those that `places` reads; the last ones those that it fills, in the order of `curves`, and
    then the states. `rates` and `watch` read all.

    Parameters
    ----------
    graph : Graph
    first, last : Number
        Range of the input [rad].
    rates, watched : sequence of Node
        Nodes required in a state.
    states : sequence of Given
    """
    asked = [*rates, *watched]
    rated = places_of(rates)
    # Nodes of the rates come first. The others follow from the last one back, so that nodes which belong to the rates
    # in another form of the motion come next: both forms then have the same text.
    places = [*graph.in_order(rated), *graph.in_order(set(places_of(watched)).difference(rated))[::-1]]
    plan = _planned(graph, first, last, places, places, fields=asked)
    tail, behind = [*places, *states], {first, last, *reached(places)}
    others = sorted((node for node in plan.rows if node not in tail), key=lambda node: node not in behind)
    rows = {node: row for row, node in enumerate([*others, *tail])}
    return _printed(
        graph,
        plan._replace(held=[], rows=rows),
        _Part("places", "Nodes of the position that nodes of the state depend on.", places),
        _Part("rates", "Rates of the states and of the integrals.", list(rates), Stage.STATE),
        _Part("watch", "Watched nodes of the state.", list(watched), Stage.STATE),
    )


def places_of(rates: Sequence[Node]) -> list[Node]:
    """Nodes independent of the state from which nodes of a state are computed, and which have no separate row.

    These are nodes of the position, and nodes computed from numbers given for a variant.
    """
    found, made = reached(rates, lambda node: node.stage < Stage.STATE), (Operation, Sum, LawResult)
    return [
        node
        for node in found
        if Stage.PANEL <= node.stage < Stage.STATE or (node.stage == Stage.VARIANT and isinstance(node, made))
    ]


class _Plan(NamedTuple):
    """Lists of the nodes to print, and the row of P of each number."""

    curves: list[Node]
    held: list[Held]
    crossings: list[Crossing]
    found: list[Found]
    events: list[tuple[Node, Node]]
    cycle: list[Node]
    rows: dict[Node, int]

    @property
    def event_nodes(self) -> list[Node]:
        """Switching functions, each followed by its derivative."""
        return [node for event in self.events for node in event]


class _Part(NamedTuple):
    """One function to print: its name, its docstring and its outputs; the rest as for `in_lanes`."""

    name: str
    doc: str
    outputs: Sequence[Node]
    stage: Stage = Stage.POSITION
    positions: int | None = 1
    inline_held: bool = True


def _events(plan: _Plan) -> _Part:
    doc = "Switching functions and their derivatives by the input; held nodes."
    return _Part("events", doc, [*plan.event_nodes, *(node.operands[0] for node in plan.held)], positions=None)


def _levels(plan: _Plan) -> _Part:
    doc = "Numbers of the cycle, from extremes of the switching functions."
    return _Part("levels", doc, _behind_extremes(plan.cycle), Stage.CYCLE)


def _at_one_position(curves: Sequence[Node], stage: Stage = Stage.POSITION) -> _Part:
    return _Part("curves_at", "All curves, at one position.", curves, stage)


def _behind_extremes(levels: Sequence[Node]) -> list[Node]:
    """All numbers of the cycle, if any of them follows from extremes of curves; else none."""
    return list(levels) if _of_kind(levels, Found) else []


def _planned(
    graph: Graph,
    first: Number,
    last: Number,
    curves: Sequence[Node],
    watched: Sequence[Node],
    ends: Iterable[Found] = (),
    fields: Sequence[Node] = (),
) -> _Plan:
    curves = list(dict.fromkeys(curves))
    held = _of_kind(watched, Held)
    crossings = _switching(graph, held)
    levels = [c.level for c in crossings]
    found = list(dict.fromkeys([*ends, *_of_kind([*watched, *fields, *levels], Found)]))
    events = list(dict.fromkeys([(f.curve, f.rate) for f in found] + [(c.curve, c.rate) for c in crossings]))
    everything = [*curves, *fields, *(node for event in events for node in event), *levels]
    cycle = _cycle_numbers(everything)
    rows = _rows([first, last], everything, levels, found, cycle, held)
    return _Plan(curves, held, crossings, found, events, cycle, rows)


def _printed(graph: Graph, plan: _Plan, *parts: _Part) -> Functions:
    rows = plan.rows
    places = {curve: i for i, (curve, _) in enumerate(plan.events)}
    return Functions(
        {part.name: _of_part(part, rows) for part in parts if part.outputs},
        rows,
        tuple(n for n in rows if isinstance(n, (Number, Constant))),
        tuple(plan.events),
        tuple(_landmark(curve, plan.found, rows) for curve, _ in plan.events),
        tuple(rows[n] for n in plan.cycle),
        tuple(rows[n] for n in plan.held),
        tuple((places[c.curve], rows[c.level], c.offset) for c in plan.crossings),
        {node: i for i, node in enumerate(plan.curves)},
        graph.all_tables,
        2 if any(node.stage == Stage.CYCLE for node in reached(plan.event_nodes)) else 1,
    )


def field_function(fields: Sequence[Node], rows: dict[Node, int], dtype: np.dtype) -> PrintedCode:
    """Print `fields`, which fills rows over equally spaced positions, stored as float64 or float32."""
    return over_positions(fields, rows, np.dtype(dtype).name)


def function_at(curves: Sequence[Node], rows: dict[Node, int], stage: Stage = Stage.POSITION) -> PrintedCode:
    """Print only `curves_at`, for a layout of numbers.

    Parameters
    ----------
    curves : sequence of Node
    rows : dict of Node to int
        Row of P of each number.
    stage : Stage
        CYCLE for numbers of the variant and of the cycle, which depend on no position.
    """
    return _of_part(_at_one_position(curves, stage), rows)


def _of_part(part: _Part, rows: dict[Node, int]) -> PrintedCode:
    return in_lanes(part.doc, part.outputs, rows, part.stage, part.positions, part.inline_held)


def _of_kind(nodes: Iterable[Node], kind: type) -> list:
    return [node for node in reached(nodes) if isinstance(node, kind)]


def _switching(graph: Graph, held: list[Held]) -> list[Crossing]:
    """Crossings where held nodes may switch: those of curves that the held nodes depend on."""
    behind = set(reached(held))
    return [crossing for crossing in graph.crossings if crossing.curve in behind]


def _cycle_numbers(nodes: list[Node]) -> list[Node]:
    """Computed nodes of the cycle that need a row: those in `nodes`, or read by nodes of later stages."""
    kept: dict[Node, None] = {}

    def read(node: Node) -> None:
        if node.stage == Stage.CYCLE and not isinstance(node, Found):
            kept[node] = None

    for node in nodes:
        read(node)
    for node in reached(nodes):
        if node.stage > Stage.CYCLE:
            for operand in node.operands:
                read(operand)
    return [node for node in kept if isinstance(node, LawResult) or node.operands]


def _rows(
    span: list[Number], everything: list[Node], levels: list[Node], found: list[Found], cycle: list[Node], held: list
) -> dict[Node, int]:
    numbers = [n for n in reached(everything) if isinstance(n, Number)]
    given = [n for n in reached(everything) if isinstance(n, Given)]
    constants = [n for n in levels if isinstance(n, Constant)]
    order = dict.fromkeys([*span, *numbers, *constants, *given, *found, *cycle, *held])
    return {node: row for row, node in enumerate(n for n in order if not isinstance(n, TableMemory))}


def _landmark(curve: Node, found: list[Found], rows: dict[Node, int]) -> Landmark:
    own = {f.which: rows[f] for f in found if f.curve is curve}
    return Landmark(*(own.get(which, -1) for which in ("low", "high", "low_at", "high_at")))
