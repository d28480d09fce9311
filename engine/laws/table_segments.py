"""Tables in a flat memory: the piece that an abscissa lies in, as the coefficients of its cubic.

A long table is searched. A short one is looked through piece by piece, which goes for many variants side by side: from
`first_piece` on, each `next_piece` takes the place of the one before where the abscissa has reached it.
"""

import math

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
def periods_before(start: float, period: float, x: float) -> float:
    """Length of the whole periods between the start of a periodic table and x."""
    return period * math.floor((x - start) / period)


@scalar
def first_piece(memory: np.ndarray, offset: float, pieces: float, x: float) -> tuple[float, float, float, float, float]:
    """The first piece of a table at `offset` in the memory; results as of `table_segment`, parameters as there."""
    at = int(offset) + 3
    left, at = memory[at], at + int(pieces) + 1
    return left, memory[at], memory[at + 1], memory[at + 2], memory[at + 3]


@scalar
def next_piece(
    memory: np.ndarray,
    offset: float,
    pieces: float,
    piece: float,
    x: float,
    left: float,
    c3: float,
    c2: float,
    c1: float,
    c0: float,
) -> tuple[float, float, float, float, float]:
    """A piece of a table where x has reached it, otherwise the one before, `left` … `c0`.

    Parameters
    ----------
    memory : array of float
    offset, pieces, piece : float
        Where in the memory the table begins, how many pieces it has, and the number of this one.
    x, left, c3, c2, c1, c0 : float
        Abscissa, without whole periods; results for the piece before, as of `table_segment`.
    """
    begin, count, i = int(offset) + 3, int(pieces), int(piece)
    here, at = memory[begin + i], begin + count + 1 + 4 * i
    # Read whether wanted or not, so that there is nothing to branch for.
    d3, d2, d1, d0 = memory[at], memory[at + 1], memory[at + 2], memory[at + 3]
    reached = here <= x
    left = here if reached else left
    c3 = d3 if reached else c3
    c2 = d2 if reached else c2
    c1 = d1 if reached else c1
    return left, c3, c2, c1, d0 if reached else c0


@scalar
def segment_value(left: float, c3: float, c2: float, c1: float, c0: float, x: float) -> float:
    """Value of a piece of a table, from `table_segment`, at x."""
    t = x - left
    return ((c3 * t + c2) * t + c1) * t + c0
