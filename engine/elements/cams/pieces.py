"""The turn of a cam as smooth pieces: where they begin and end, and the follower's motion in each of them.

A piece is a row of numbers, in the order of the constants below. Its own variable u goes from FROM to TO; the cam's
angle is ORIGIN + BETA·u.
"""

import math

import numpy as np

from engine.compiling.decorators import routine
from engine.laws.cams.motion_laws import DWELL, LAW_BREAKS, LAW_KINDS, Motion, unit_motion
from engine.laws.tables import Table

KIND, ORIGIN, BETA, FROM, TO, START, STROKE, C3, C2, C1, DIRECTION, FREE = range(12)
PIECE_NUMBERS = 12
# Beside the kinds of `motion_laws`: a cubic of a table.
CUBIC = 9
# The most pieces that a law consists of.
PIECES_OF_A_SECTION = 5
TURN = 2.0 * math.pi
# Shares of a turn, or of a stroke, by which sums of a variant's sections may miss their end.
MISSED = 1e-9
_BREAKS = np.ones((CUBIC, PIECES_OF_A_SECTION + 1))
_BREAKS[:, 0] = 0.0
for _kind in LAW_KINDS.values():
    _BREAKS[_kind, 1 : 1 + len(LAW_BREAKS.get(_kind, ()))] = LAW_BREAKS.get(_kind, ())


@routine
def break_of(kind: int, k: int) -> float:
    """Place on the unit interval where the pieces of a law of this kind meet; 1 after the last."""
    return _BREAKS[kind, k]


@routine
def cut_sections(
    kinds: np.ndarray, directions: np.ndarray, numbers: np.ndarray, row: int, first: int, pieces: np.ndarray
) -> int:
    """Pieces of a turn described by sections.

    Parameters
    ----------
    kinds, directions : ndarray (sections,) of int
        Law of each section; 1 for a rise, −1 for a return, 0 for a dwell.
    numbers : ndarray (variants, numbers)
        From the column `first` on, angle and stroke of each section; the angle NaN of one that takes what is left, the
        stroke NaN of a return all the way.
    row, first : int
    pieces : ndarray (pieces, PIECE_NUMBERS)
        To be written to.

    Returns
    -------
    int
        How many they are; 0 where the sections don't make a turn that ends where it begins.
    """
    given, count, angle, s, greatest = 0.0, 0, 0.0, 0.0, 0.0
    open_ends = 0
    for k in range(kinds.shape[0]):
        beta = numbers[row, first + 2 * k]
        open_ends += 1 if math.isnan(beta) else 0
        given += 0.0 if math.isnan(beta) else beta
    missed = TURN - given
    if (open_ends and not missed > 0.0) or (not open_ends and not abs(missed) <= MISSED * TURN):
        return 0
    for k in range(kinds.shape[0]):
        kind, beta, stroke = kinds[k], numbers[row, first + 2 * k], numbers[row, first + 2 * k + 1]
        free = math.isnan(beta)
        if free:
            beta = missed
        change = 0.0
        if directions[k] > 0:
            change = stroke
        elif directions[k] < 0:
            change = -s if math.isnan(stroke) else -stroke
        for part in range(PIECES_OF_A_SECTION):
            u = break_of(kind, part)
            if u >= 1.0:
                break
            pieces[count, KIND], pieces[count, ORIGIN], pieces[count, BETA] = kind, angle, beta
            pieces[count, FROM], pieces[count, TO] = u, break_of(kind, part + 1)
            pieces[count, START], pieces[count, STROKE] = s, change
            pieces[count, C3], pieces[count, C2], pieces[count, C1] = 0.0, 0.0, 0.0
            pieces[count, DIRECTION], pieces[count, FREE] = directions[k], TURN / beta if free else 0.0
            count += 1
        angle += beta
        s += change
        greatest = max(greatest, s)
        if s < -MISSED * greatest:
            return 0
    return count if abs(s) <= MISSED * greatest else 0


def cut_table(table: Table) -> np.ndarray:
    """Pieces of a turn described by a table: its cubics, cut once more where the follower turns back.

    Parameters
    ----------
    table : Table
        Periodic over a turn.

    Returns
    -------
    ndarray (pieces, PIECE_NUMBERS)
    """
    pieces = []
    for left, right, (c3, c2, c1, c0) in zip(table.breaks, table.breaks[1:], table.coefficients, strict=False):
        length = right - left
        turns = np.roots([3 * c3, 2 * c2, c1]) if c3 or c2 else np.empty(0)
        real = np.sort(turns[np.abs(turns.imag) < 1e-12 * length].real)
        inside = real[(real > 1e-9 * length) & (real < (1 - 1e-9) * length)]
        for a, b in zip([0.0, *inside], [*inside, length], strict=True):
            middle = (a + b) / 2
            direction = np.sign((3 * c3 * middle + 2 * c2) * middle + c1)
            pieces.append((CUBIC, left, 1.0, a, b, c0, 0.0, c3, c2, c1, direction, 0.0))
    return np.array(pieces)


@routine
def motion_in(pieces: np.ndarray, i: int, u: float) -> Motion:
    """Displacement of the follower in a piece, and its derivatives by the cam's angle."""
    kind = int(pieces[i, KIND])
    if kind == DWELL:
        return pieces[i, START], 0.0, 0.0, 0.0
    if kind == CUBIC:
        c3, c2, c1 = pieces[i, C3], pieces[i, C2], pieces[i, C1]
        return (
            ((c3 * u + c2) * u + c1) * u + pieces[i, START],
            (3.0 * c3 * u + 2.0 * c2) * u + c1,
            6.0 * c3 * u + 2.0 * c2,
            6.0 * c3,
        )
    found = unit_motion(kind, u, 0.5 * (pieces[i, FROM] + pieces[i, TO]))
    h, rate = pieces[i, STROKE], 1.0 / pieces[i, BETA]
    return pieces[i, START] + h * found[0], h * rate * found[1], h * rate**2 * found[2], h * rate**3 * found[3]


@routine
def sizes_in(pieces: np.ndarray, i: int) -> tuple[float, float, float, float]:
    """Magnitudes whose rounding the motion in a piece carries, that of the sections' numbers with it."""
    if int(pieces[i, KIND]) == CUBIC:
        u = max(abs(pieces[i, FROM]), abs(pieces[i, TO]))
        c3, c2, c1 = abs(pieces[i, C3]), abs(pieces[i, C2]), abs(pieces[i, C1])
        return (
            ((c3 * u + c2) * u + c1) * u + abs(pieces[i, START]),
            (3.0 * c3 * u + 2.0 * c2) * u + c1,
            6.0 * c3 * u + 2.0 * c2,
            6.0 * c3,
        )
    # Peaks of the laws, and what an angle's rounding does to their powers; a free angle has that of the others.
    h, rate, off = abs(pieces[i, STROKE]), 1.0 / pieces[i, BETA], 1.0 + pieces[i, FREE]
    return pieces[i, START] + h, 2.5 * h * rate * off, 16.0 * h * rate**2 * off, 250.0 * h * rate**3 * off
