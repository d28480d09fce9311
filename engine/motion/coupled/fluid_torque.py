"""Torque of a fluid coupling over the speeds of both sides, one smooth piece of its table at a time.

A piece is ±(1 + its index in the table), + where the shaft is faster, − where the crank is; 0 for the one at the slip
itself. A step stays on one piece, extended beyond its ends, and ends where the slip leaves it.
"""

import numpy as np

from engine.compiling.decorators import scalar
from engine.laws.tables import HEAD

# Slip between equal and opposite speeds, from which on the other side is the faster one.
OPPOSITE = 2.0


@scalar
def slip_between(shaft_drives: bool, crank: float, shaft: float) -> tuple[float, float]:
    """Speed of the faster side, and the slip."""
    fast, slow = (shaft, crank) if shaft_drives else (crank, shaft)
    return fast, 1.0 - slow / fast if fast != 0.0 else 0.0


@scalar
def fluid_piece(memory: np.ndarray, table: float, held: float, crank: float, shaft: float) -> float:
    """Piece at the slip, where that of `held` ends; a break of the table belongs to the piece before it."""
    # At equal speeds the side that was faster no longer is.
    shaft_drives = abs(shaft) > abs(crank) or (abs(shaft) == abs(crank) and held <= 0.0)
    breaks = int(table) + HEAD
    slip, last = slip_between(shaft_drives, crank, shaft)[1], int(memory[int(table)]) - 1
    # The first one lies before any slip.
    piece = 1
    while piece < last and slip > memory[breaks + piece + 1]:
        piece += 1
    return 1.0 + piece if shaft_drives else -1.0 - piece


@scalar
def fluid_moment(memory: np.ndarray, table: float, factor: float, held: float, crank: float, shaft: float) -> float:
    """Torque on the crank on a piece; `factor` is the torque over λ ω² [kg·m²]."""
    piece = held if held != 0.0 else fluid_piece(memory, table, held, crank, shaft)
    fast, slip = slip_between(piece > 0.0, crank, shaft)
    pieces, own = int(memory[int(table)]), int(abs(piece)) - 1
    begin = int(table) + HEAD + own
    t, first = slip - memory[begin], int(table) + HEAD + pieces + 1 + 4 * own
    c3, c2, c1, c0 = memory[first], memory[first + 1], memory[first + 2], memory[first + 3]
    moment = factor * (((c3 * t + c2) * t + c1) * t + c0) * fast * abs(fast)
    return moment if piece > 0.0 else -moment


@scalar
def slip_guards(
    memory: np.ndarray, table: float, held: float, crank: float, shaft: float, crank_rise: float, shaft_rise: float
) -> tuple[float, float]:
    """Guards: positive until the slip leaves a piece; positive until it no longer would within a radian.

    The second one ends a step before the slip might leave the piece and return to it; `crank_rise` and `shaft_rise` are
    the accelerations [rad/s²].
    """
    if held == 0.0:
        return 1.0, -1.0
    fast, slip = slip_between(held > 0.0, crank, shaft)
    fast_rise, slow_rise = (shaft_rise, crank_rise) if held > 0.0 else (crank_rise, shaft_rise)
    change = ((1.0 - slip) * fast_rise - slow_rise) / (fast * abs(fast)) if fast != 0.0 else 0.0
    own, first = int(abs(held)) - 1, int(table) + HEAD
    is_last = own == int(memory[int(table)]) - 1
    end = OPPOSITE if is_last or memory[first + own + 1] > OPPOSITE else memory[first + own + 1]
    below, above = slip - memory[first + own], end - slip
    return (below, -change - below) if below < above else (above, change - above)
