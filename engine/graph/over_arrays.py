"""A scalar law applied to arrays: printed as a function over lanes, compiled once, its machine code kept."""

from collections.abc import Callable
from functools import cache

import numpy as np
from numba import types

from engine.compiling.decorators import driver
from engine.compiling.printed import load_printed
from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE, TileFunction
from engine.compiling.widths import LANES
from engine.graph.functions import number_function
from engine.graph.nodes import Graph

_ROWS = types.float64[:, ::1]
_TYPES = types.intp, types.intp, FILLS_TILE, _ROWS, _ROWS, _ROWS, types.float64[:, :, ::1], _ROWS, types.float64[::1]


def over_arrays(law: Callable, *arguments: float | np.ndarray) -> np.ndarray:
    """Results of a scalar law, (results, ...).

    Parameters
    ----------
    law : callable
        A compiled scalar law that gives a tuple of floats, or one.
    arguments : float or ndarray (...)
        At least one of them an array.
    """
    function, count = _printed(law, len(arguments))
    table = np.array(np.broadcast_arrays(*arguments), float)
    shape, table = table.shape[1:], table.reshape(len(table), -1)
    found = np.empty((count, table.shape[1]))
    nowhere, no_tables = np.zeros((1, LANES)), np.zeros(1)

    def memory() -> tuple:
        block, tile = np.empty((len(table), LANES)), np.empty((count, 1, LANES))
        return (function, table, found, block, tile, nowhere, no_tables)

    prepare(_fill, _TYPES)
    spread(_fill, -(-table.shape[1] // LANES), memory)
    return found.reshape(count, *shape)


@cache
def _printed(law: Callable, count: int) -> tuple[TileFunction, int]:
    """A law of `count` numbers as a function that fills a tile of one position, and how many results it has."""
    graph = Graph()
    given = [graph.derived(f"number {i}", lambda numbers: 0.0) for i in range(count)]
    results = graph.apply(law, *given)
    results = results if isinstance(results, tuple) else (results,)
    text = number_function(f"{law.__name__} over variants.", results, {node: i for i, node in enumerate(given)})
    return TileFunction(load_printed(text).numbers), len(results)


@driver
def _fill(
    begin: int,
    end: int,
    function: Callable,
    table: np.ndarray,
    found: np.ndarray,
    block: np.ndarray,
    tile: np.ndarray,
    nowhere: np.ndarray,
    no_tables: np.ndarray,
) -> None:
    """Fill in what a function finds for blocks `begin` … `end` − 1 of LANES variants."""
    for b in range(begin, end):
        first = b * LANES
        count = min(LANES, table.shape[1] - first)
        for row in range(table.shape[0]):
            for lane in range(LANES):
                block[row, lane] = table[row, first + min(lane, count - 1)]
        function(block, no_tables, nowhere, nowhere, nowhere, tile)
        for row in range(found.shape[0]):
            for lane in range(count):
                found[row, first + lane] = tile[row, 0, lane]
