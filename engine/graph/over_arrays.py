"""Laws and nodes over arrays: printed as a function over lanes, compiled once, its machine code cached."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, gather, hand_out, in_lanes
from engine.compiling.decorators import driver
from engine.compiling.kept_code import load_printed
from engine.compiling.running import spread
from engine.compiling.tiles import TileFunction
from engine.graph.functions import number_function
from engine.graph.nodes import Given, Graph, Node, Number, Stage, reached


class _Scratch(NamedTuple):
    """Arrays for one block of variants: numbers, results, the position that no law reads, and all tables."""

    block: np.ndarray
    tile: np.ndarray
    nowhere: np.ndarray
    tables: np.ndarray


class NodesOverArrays:
    """Nodes as a function of arrays: of numbers of the variant, and of numbers that are given.

    Parameters
    ----------
    title : str
    given : sequence of Given
        Their rows come first.
    results : sequence of Node
    """

    def __init__(self, title: str, given: Sequence[Given], results: Sequence[Node]) -> None:
        self._numbers = [node for node in reached(results) if isinstance(node, Number)]
        rows = {node: row for row, node in enumerate([*given, *self._numbers])}
        text, self._results = number_function(title, results, rows), len(results)
        self._function, self._tables = TileFunction(load_printed(text).numbers), results[0].graph.all_tables
        self._given = len(given)

    def table(self, numbers: Mapping[str, np.ndarray], variants: int) -> np.ndarray:
        """Table (numbers, variants) for a call: rows for the given numbers, still 0, then those of the variants."""
        table = np.zeros((self._given + len(self._numbers), variants))
        for row, node in enumerate(self._numbers, self._given):
            table[row] = node.compute(numbers)
        return table

    def __call__(self, table: np.ndarray, found: np.ndarray | None = None) -> np.ndarray:
        """Results (results, variants) of rows as in `table`, written to `found` where that is given."""
        found = np.empty((self._results, table.shape[1])) if found is None else found
        fill_numbers(self._function, table, self._tables, found)
        return found


def fill_numbers(function: TileFunction, table: np.ndarray, tables: np.ndarray, found: np.ndarray) -> None:
    """Fill results (results, variants) of a printed function that reads numbers of the variant alone.

    Parameters
    ----------
    function : TileFunction
    table : ndarray (numbers, variants)
    tables : ndarray
        All tables of the graph, flat.
    found : ndarray (results, variants)
        Output.
    """

    def arguments() -> tuple:
        block, tile = np.empty((len(table), LANES)), np.empty((len(found), 1, LANES))
        return function, table, found, _Scratch(block, tile, np.zeros((1, LANES)), tables)

    spread(_fill, -(-table.shape[1] // LANES), arguments)


def over_arrays(law: Callable, *arguments: float | np.ndarray) -> np.ndarray:
    """Apply a scalar law to arrays; returns its results (results, …).

    Parameters
    ----------
    law : callable
        A compiled scalar law that returns a float or a tuple of floats.
    arguments : float or ndarray (…)
        At least one is an array; broadcast against each other.
    """
    table = np.array(np.broadcast_arrays(*arguments), float)
    shape = table.shape[1:]
    found = _of_law(law, len(arguments))(table.reshape(len(table), math.prod(shape)))
    return found.reshape(len(found), *shape)


@cache
def _of_law(law: Callable, count: int) -> NodesOverArrays:
    """A law of `count` numbers over arrays."""
    graph = Graph()
    given = [graph.given(f"number {i}", Stage.VARIANT) for i in range(count)]
    results = graph.apply(law, *given)
    return NodesOverArrays(
        f"{law.__name__} over variants.", given, results if isinstance(results, tuple) else (results,)
    )


@driver
def _fill(begin: int, end: int, function: Callable, table: np.ndarray, found: np.ndarray, scratch: _Scratch) -> None:
    """Evaluate `function` for blocks `begin` … `end` − 1 of LANES variants, and store its results in `found`."""
    nowhere = scratch.nowhere
    for b in range(begin, end):
        first = b * LANES
        gather(table, first, in_lanes(scratch.block))
        function(scratch.block, scratch.tables, nowhere, nowhere, nowhere, scratch.tile)
        hand_out(in_lanes(scratch.tile), first, found)
