"""The functions of one machine, printed from its graph: what is asked at a position, what switches, what is held.

Four of them fill tiles, all with one signature (P, T, q, cos_q, sin_q, tile), so that compiled code takes those of any
machine as values:

- `events` fills curves that switch something where they cross a level, and their derivatives;
- `levels` fills numbers of the cycle, known once the ends of strokes are;
- `states` fills what a panel holds, in the panel's middle;
- `curves` fills all that is asked.

Besides, `fields` fills rows over equally spaced positions, one variant after another.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from engine.compiling.tiles import PANEL_POSITIONS
from engine.graph.nodes import Constant, Crossing, Found, Graph, Held, Memory, Node, Number, Result, Stage, reached
from engine.graph.printer import in_lanes, over_positions

_HEAD = '''"""{title}"""

import math

import numpy as np
from numba import njit

{imports}

dtype = np.{dtype}
'''


class Landmark(NamedTuple):
    """Ends of a curve over the cycle: which event it is, and rows of P for its ends and their places (−1: none)."""

    event: int
    low: int
    high: int
    low_at: int
    high_at: int


class Functions(NamedTuple):
    """The functions of one machine and how numbers are laid out for them.

    Attributes
    ----------
    text : str
        Source of a module with `events`, `levels`, `states`, `curves`.
    rows : dict of Node to int
        Row of P of each number: the range of the input first, then numbers of the variant, of the cycle, of the panel.
    numbers : tuple of Number or Constant
        Numbers of the variant, in the order of their rows, from row 0 on.
    events : tuple of (Node, Node)
        Curves that switch something, and their derivatives.
    landmarks : tuple of Landmark
    level_rows, held_rows : tuple of int
        Rows of P that `levels` and `states` fill, in order.
    crossings : tuple of (int, int)
        Event, and row of P with the level it crosses.
    curves : dict of Node to int
        Row of the tile of each curve.
    memory : ndarray
        All tables.
    """

    text: str
    rows: dict[Node, int]
    numbers: tuple[Number | Constant, ...]
    events: tuple[tuple[Node, Node], ...]
    landmarks: tuple[Landmark, ...]
    level_rows: tuple[int, ...]
    held_rows: tuple[int, ...]
    crossings: tuple[tuple[int, int], ...]
    curves: dict[Node, int]
    memory: np.ndarray


def functions_of(
    graph: Graph,
    title: str,
    first: Number,
    last: Number,
    curves: Sequence[Node],
    ends: Iterable[Found] = (),
    fields: Sequence[Node] = (),
) -> Functions:
    """Print the functions that compute some curves.

    Parameters
    ----------
    graph : Graph
    title : str
        What the module's docstring says.
    first, last : Number
        Range of the input.
    curves : sequence of Node
        What is asked at every position.
    ends : iterable of Found
        Ends of strokes that are asked for themselves.
    fields : sequence of Node
        Kept fields, whose numbers are to have rows too; `field_function` prints them.
    """
    curves = list(dict.fromkeys(curves))
    held = _of_kind(curves, Held)
    crossings = _switching(graph, held)
    levels = [c.level for c in crossings]
    found = list(dict.fromkeys([*ends, *_of_kind([*curves, *fields, *levels], Found)]))
    events = list(dict.fromkeys([(f.curve, f.rate) for f in found] + [(c.curve, c.rate) for c in crossings]))
    event_nodes = [node for event in events for node in event]
    everything = [*curves, *fields, *event_nodes, *levels]
    cycle = _read_numbers(everything)
    rows = _rows([first, last], everything, levels, found, cycle, held)
    places = {node: i for i, (node, _) in enumerate(events)}
    parts, laws, missing = [], [], []
    for name, doc, outputs, stage, positions, inline in (
        ("events", "Curves that switch something, and their derivatives.", event_nodes, Stage.POSITION, None, True),
        ("levels", "Numbers of the cycle, from the ends of strokes.", cycle, Stage.CYCLE, 1, True),
        ("states", "What a panel holds.", [h.operands[0] for h in held], Stage.POSITION, 1, True),
        ("curves", "All that is asked at a position.", curves, Stage.POSITION, PANEL_POSITIONS, False),
    ):
        if not outputs:
            missing.append(f"from engine.compiling.nothing import nothing as {name}")
            continue
        text, called = in_lanes(name, doc, outputs, rows, stage, positions, inline)
        parts.append(f"@njit(TILE_SIGNATURE, **TILE_OPTIONS)\n{text}")
        laws += called
    imports = [*missing, "from engine.compiling.tiles import TILE_OPTIONS, TILE_SIGNATURE", *_imports(laws)]
    text = "\n\n".join([_HEAD.format(title=title, imports="\n".join(imports), dtype="float64"), *parts])
    return Functions(
        text,
        rows,
        tuple(n for n in rows if isinstance(n, (Number, Constant))),
        tuple(events),
        tuple(
            _landmark(place, curve, found, rows) for (curve, _), place in zip(events, range(len(events)), strict=True)
        ),
        tuple(rows[n] for n in cycle),
        tuple(rows[n] for n in held),
        tuple((places[c.curve], rows[c.level]) for c in crossings),
        {node: i for i, node in enumerate(curves)},
        np.concatenate([np.zeros(0), *graph.tables]) if graph.tables else np.zeros(1),
    )


def field_function(title: str, fields: Sequence[Node], rows: dict[Node, int], dtype: np.dtype) -> str:
    """Text of a module with `fields`, which fills rows over equally spaced positions."""
    text, laws = over_positions("fields", "Rows over the positions of one variant after another.", fields, rows, dtype)
    imports = ["from engine.compiling.jit import KERNEL_OPTIONS", *_imports(laws)]
    head = _HEAD.format(title=title, imports="\n".join(imports), dtype=np.dtype(dtype).name)
    return f"{head}\n\n@njit(**KERNEL_OPTIONS)\n{text}"


def _of_kind(nodes: Iterable[Node], kind: type) -> list:
    return [node for node in reached(nodes) if isinstance(node, kind)]


def _switching(graph: Graph, held: list[Held]) -> list[Crossing]:
    """Crossings at which what is held may switch: those of curves that the held nodes depend on."""
    behind = set(reached(held))
    return [crossing for crossing in graph.crossings if crossing.curve in behind]


def _read_numbers(nodes: list[Node]) -> list[Node]:
    """Nodes of the cycle that those of positions, or what is asked itself, read as numbers; found ones left out."""
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
    return [node for node in kept if isinstance(node, Result) or node.operands]


def _rows(
    span: list[Number], everything: list[Node], levels: list[Node], found: list[Found], cycle: list[Node], held: list
) -> dict[Node, int]:
    numbers = [n for n in reached(everything) if isinstance(n, Number)]
    constants = [n for n in levels if isinstance(n, Constant)]
    order = dict.fromkeys([*span, *numbers, *constants, *found, *cycle, *held])
    return {node: row for row, node in enumerate(n for n in order if not isinstance(n, Memory))}


def _landmark(event: int, curve: Node, found: list[Found], rows: dict[Node, int]) -> Landmark:
    own = {f.which: rows[f] for f in found if f.curve is curve}
    return Landmark(event, *(own.get(which, -1) for which in ("low", "high", "low_at", "high_at")))


def _imports(laws: list) -> list[str]:
    """Import lines of the laws, one for each module."""
    by_module: dict[str, set[str]] = {}
    for law in laws:
        by_module.setdefault(law.py_func.__module__, set()).add(law.py_func.__name__)
    return [f"from {module} import {', '.join(sorted(names))}" for module, names in sorted(by_module.items())]
