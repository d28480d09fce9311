"""Kept fields: curves at equally spaced positions, one variant after another."""

import numpy as np

from engine.compiling.jit import run_kernel
from engine.cycle.lanes import LANES
from engine.cycle.machine import Extremes
from engine.graph.functions import Functions, field_function
from engine.graph.nodes import Found, Node


class KeptFields:
    """Fields that are kept.

    Parameters
    ----------
    nodes : list of Node
    dtype : float64 or float32
    title : str
        Of the machine.
    """

    def __init__(self, nodes: list[Node], dtype: np.dtype, title: str) -> None:
        self.nodes, self.dtype, self.title = nodes, np.dtype(dtype), title

    def text(self, functions: Functions) -> str:
        """Source of the function that fills them."""
        return field_function(self.title, self.nodes, functions.rows, self.dtype)

    def fill(self, functions: Functions, table: np.ndarray, q: np.ndarray, fields: np.ndarray) -> None:
        """Fill the fields of all variants.

        Parameters
        ----------
        functions : Functions
        table : ndarray (numbers, variants)
            Those of the cycle known.
        q : ndarray (positions,) or (positions, variants)
            Input positions, the same for all variants or each variant's own.
        fields : ndarray (fields, variants, positions)
        """
        numbers = table.astype(self.dtype)
        if q.ndim == 1:
            self._run(functions, numbers, q, fields)
            return
        for v in range(table.shape[1]):
            self._run(functions, numbers[:, v : v + 1], q[:, v], fields[:, v : v + 1])

    def _run(self, functions: Functions, numbers: np.ndarray, q: np.ndarray, room: np.ndarray) -> None:
        places = (f.astype(self.dtype) for f in (q, np.cos(q), np.sin(q)))
        numbers = np.ascontiguousarray(numbers)
        run_kernel(self.text(functions), "fields", room.shape[1], numbers, functions.memory, *places, room)


def fill_cycle_numbers(functions: Functions, table: np.ndarray, landmarks: Extremes, levels: object) -> None:
    """Put what was found on the cycle into the numbers of the variants.

    Parameters
    ----------
    functions : Functions
    table : ndarray (numbers, variants)
        Written to.
    landmarks : Extremes
        Of the machine's events.
    levels : callable
        The machine's function of that name.
    """
    part = {"low": "least", "high": "greatest", "low_at": "least_at", "high_at": "greatest_at"}
    events = [curve for curve, _ in functions.events]
    for node, row in functions.rows.items():
        if isinstance(node, Found):
            table[row] = getattr(landmarks, part[node.which])[events.index(node.curve)].value
    if not functions.level_rows:
        return
    nowhere, tile = np.zeros((1, LANES)), np.empty((len(functions.level_rows), 1, LANES))
    for begin in range(0, table.shape[1], LANES):
        block = np.empty((table.shape[0], LANES))
        count = min(LANES, table.shape[1] - begin)
        block[:, :count] = table[:, begin : begin + count]
        block[:, count:] = block[:, count - 1 : count]
        levels(block, functions.memory, nowhere, nowhere, nowhere, tile)
        for row, values in zip(functions.level_rows, tile, strict=True):
            table[row, begin : begin + count] = values[0, :count]
