"""A scalar law applied to arrays: printed as a function over lanes, compiled once, its machine code cached."""

from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.blocks import gather, hand_out, in_lanes
from engine.compiling.decorators import driver
from engine.compiling.printed import load_printed
from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE, TileFunction
from engine.compiling.widths import LANES
from engine.graph.functions import number_function
from engine.graph.nodes import Graph


class _Scratch(NamedTuple):
    """Arrays for one block of variants: their numbers, their results, and the position and tables that no law reads."""

    block: np.ndarray
    tile: np.ndarray
    nowhere: np.ndarray
    no_tables: np.ndarray


def over_arrays(law: Callable, *arguments: float | np.ndarray) -> np.ndarray:
    """Apply a scalar law to arrays; returns its results (results, …).

    Parameters
    ----------
    law : callable
        A compiled scalar law that returns a float or a tuple of floats.
    arguments : float or ndarray (…)
        At least one is an array; broadcast against each other.
    """
    function, count = _printed(law, len(arguments))
    table = np.array(np.broadcast_arrays(*arguments), float)
    shape, table = table.shape[1:], table.reshape(len(table), -1)
    found = np.empty((count, table.shape[1]))

    def arguments() -> tuple:
        block, tile = np.empty((len(table), LANES)), np.empty((count, 1, LANES))
        return function, table, found, _Scratch(block, tile, np.zeros((1, LANES)), np.zeros(1))

    prepare(_fill, [types.intp, types.intp, FILLS_TILE, *(numba.typeof(argument) for argument in arguments()[1:])])
    spread(_fill, -(-table.shape[1] // LANES), arguments)
    return found.reshape(count, *shape)


@cache
def _printed(law: Callable, count: int) -> tuple[TileFunction, int]:
    """Compile a law of `count` numbers to fill a tile of one position; also returns its number of results."""
    graph = Graph()
    given = [graph.derived(f"number {i}", lambda numbers: 0.0) for i in range(count)]
    results = graph.apply(law, *given)
    results = results if isinstance(results, tuple) else (results,)
    text = number_function(f"{law.__name__} over variants.", results, {node: i for i, node in enumerate(given)})
    return TileFunction(load_printed(text).numbers), len(results)


@driver
def _fill(begin: int, end: int, function: Callable, table: np.ndarray, found: np.ndarray, scratch: _Scratch) -> None:
    """Evaluate `function` for blocks `begin` … `end` − 1 of LANES variants, and store its results in `found`."""
    nowhere = scratch.nowhere
    for b in range(begin, end):
        first = b * LANES
        gather(table, first, in_lanes(scratch.block))
        function(scratch.block, scratch.no_tables, nowhere, nowhere, nowhere, scratch.tile)
        hand_out(in_lanes(scratch.tile), first, found)
