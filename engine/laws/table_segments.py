"""Tables in a flat memory: the piece that an abscissa lies in, as the coefficients of its cubic."""

import numpy as np

from engine.compiling.jit import scalar
from engine.laws.tables import Table, piece_of


def in_memory(table: Table) -> np.ndarray:
    """A table laid out flat: pieces, start, period, breaks, coefficients."""
    head = [float(table.coefficients.shape[0]), table.start, table.period]
    return np.concatenate((head, table.breaks, table.coefficients.ravel()))


@scalar
def table_segment(memory: np.ndarray, offset: float, x: float) -> tuple[float, float, float, float, float]:
    """The piece of a table in which x lies: where it begins, and its cubic from the highest power on.

    Parameters
    ----------
    memory : array of float
    offset : float
        Where in the memory the table begins.
    x : float
        A periodic table's piece is given where x is, periods away.
    """
    begin = int(offset)
    pieces, start, period = int(memory[begin]), memory[begin + 1], memory[begin + 2]
    breaks = memory[begin + 3 : begin + 4 + pieces]
    u = x
    if period > 0.0 and (x < start or x >= start + period):
        u = start + (x - start) % period
    piece = piece_of(breaks, pieces, u)
    at = begin + 4 + pieces + 4 * piece
    return breaks[piece] + (x - u), memory[at], memory[at + 1], memory[at + 2], memory[at + 3]


@scalar
def segment_value(left: float, c3: float, c2: float, c1: float, c0: float, x: float) -> float:
    """Value of a piece of a table, from `table_segment`, at x."""
    t = x - left
    return ((c3 * t + c2) * t + c1) * t + c0
