"""Characteristics given as tables: piecewise cubics, set up by SciPy, evaluated point by point.

Every interpolation has the same form, one cubic per interval, so compiled code needs a single evaluator. The behaviour
of a table outside its rows is stored as pieces too.

Sources: C. de Boor, A Practical Guide to Splines (cubic splines, piecewise form); F. N. Fritsch and J. Butland, A
method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci. Stat. Comput. 5 (1984) (slopes of
"pchip", as in SciPy).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen
from engine.words.glossary import listed
from engine.words.user_error import UserError

INTERPOLATIONS = ("linear", "pchip", "spline")
OUTSIDE = ("hold", "zero")

# Angles and times come rounded (6.28319 for a revolution, degrees converted to radians). A last row this close to a
# whole period, relative to the period, is the closing row; values this close, relative to the largest, are equal.
CLOSING_TOLERANCE = 1e-5

# Iterations that find the slopes of a spline, or bound their rounding; each halves the error.
_HALVINGS = 60

# Numbers of a table in memory before its breaks.
HEAD = 3


class TableError(UserError, ValueError):
    """Rows that don't form a table; the message names the row, the value and the remedy."""


class Table(NamedTuple):
    """A piecewise cubic.

    Attributes
    ----------
    breaks : numpy.ndarray, shape (n + 1,)
        Ends of the pieces. The first and the last piece extend to infinity.
    coefficients : numpy.ndarray, shape (n, 4)
        Coefficients of each piece, highest power first, in the distance from the piece's first break.
    start : float
        Start of the period covered by the rows.
    period : float
        Length of the period; 0.0 for a table that isn't periodic.
    """

    breaks: np.ndarray
    coefficients: np.ndarray
    start: float
    period: float


def make_table(
    x: ArrayLike,
    y: ArrayLike,
    interpolation: str,
    period: float = 0.0,
    outside: str = "hold",
    names: tuple[str, str] = ("x", "y"),
) -> Table:
    """Make a piecewise cubic through rows of x and y.

    Parameters
    ----------
    x : array_like, shape (rows,)
        Ascending. With "linear" interpolation two rows may share an x: a step, at which the value is that of the second
        row.
    y : array_like, shape (rows,)
        Value of each row.
    interpolation : {"linear", "pchip", "spline"}
        Straight lines; monotone cubics (no overshoot, continuous slope); the cubic spline (continuous curvature),
        natural or, with a period, periodic.
    period : float
        0.0 (not periodic) or the length of the period in x; the rows span at most one period. Without a row at the end
        of the period, the first row closes it.
    outside : {"hold", "zero"}
        Value beyond the rows: that of the end row, or zero (the end rows themselves belong to the table). Ignored for a
        periodic table.
    names : (str, str)
        Names of x and y in messages.

    Returns
    -------
    Table
        Its arrays are float64. In float32, "zero" begins at the last row, not just after it.

    Raises
    ------
    TableError
        If rows are NaN, infinite, mismatched, too few or out of order; if the interpolation doesn't allow a step; if
        the period is too short or doesn't close; for unknown names.
    """
    _check_name("interpolation", interpolation, INTERPOLATIONS)
    _check_name("outside", outside, OUTSIDE)
    if not (np.isfinite(period) and period >= 0.0):
        raise TableError(f"period = {period}: give a positive length, or 0 for a table that doesn't repeat")
    x, y = _numbers(x, y, names)
    if period:
        x, y = _closed(x, y, float(period), names)
    _check_order(x, interpolation, names[0])
    coefficients = _coefficients(x, y, interpolation, bool(period), names[0])
    if period:
        return Table(x, coefficients, float(x[0]), float(period))
    breaks, coefficients = _with_ends(x, y, coefficients, outside)
    return Table(breaks, coefficients, float(x[0]), 0.0)


@scalar
def piece_of(memory: np.ndarray, breaks: int, pieces: int, u: float) -> int:
    """Index of the piece of a table at u, at a step the piece after it; the table's breaks start at index `breaks`."""
    piece, above = 0, pieces
    while above - piece > 1:
        middle = (piece + above) // 2
        if memory[breaks + middle] <= u:
            piece = middle
        else:
            above = middle
    return piece


def in_memory(table: Table) -> np.ndarray:
    """Flatten a table for `table_segment`.

    Parameters
    ----------
    table : Table

    Returns
    -------
    numpy.ndarray, shape (4 + 5 n,)
        Number n of pieces, start, period, the breaks, and the coefficients piece by piece.
    """
    head = (float(table.coefficients.shape[0]), table.start, table.period)
    return np.concatenate((head, table.breaks, table.coefficients.ravel()))


@scalar
def table_segment(memory: np.ndarray, offset: float, x: float) -> tuple[float, float, float, float, float]:
    """The cubic piece of a table at x: c3 t³ + c2 t² + c1 t + c0, t = x − left.

    Held over a range of x without a break of the table, it is smooth up to both ends of the range.

    Parameters
    ----------
    memory : array of float64, one-dimensional
        Several tables, each as from `in_memory`.
    offset : float
        Index at which the table begins.
    x : float

    Returns
    -------
    left : float
        Start of the piece; for a periodic table, in the period of x.
    c3, c2, c1, c0 : float
        At a step, the coefficients after it.
    """
    at = int(offset)
    pieces, start, period = int(memory[at]), memory[at + 1], memory[at + 2]
    breaks = at + HEAD
    shift = 0.0
    if period > 0.0 and (x < start or x >= start + period):
        shift = math.floor((x - start) / period) * period
    piece = piece_of(memory, breaks, pieces, x - shift)
    left = memory[breaks + piece] + shift
    first = breaks + pieces + 1 + 4 * piece
    return left, memory[first], memory[first + 1], memory[first + 2], memory[first + 3]


def rounding_of_rows(table: Table, interpolation: str) -> np.ndarray:
    """Bounds on what the rounding of its rows changes in a periodic table and its derivatives.

    The equations for the slopes of a spline are diagonally dominant. With the signs of the other coefficients reversed,
    they bound the changes of the slopes by those of the right sides. (A. M. Ostrowski, Über die Determinanten mit
    überwiegender Hauptdiagonale, Comment. Math. Helv. 10 (1937).)

    Parameters
    ----------
    table : Table
        Its rows don't repeat an x.
    interpolation : {"pchip", "spline"}

    Returns
    -------
    numpy.ndarray, shape (4, n)
        For each piece, changes of the value and of three derivatives if all x and y change by a unit relative error.
    """
    x, gap = np.abs(table.breaks), np.diff(table.breaks)
    c3, c2, slope, y = table.coefficients.T
    after = np.roll(slope, -1)
    chord = slope + gap * (c2 + gap * c3)
    of_gap, of_y = x[:-1] + x[1:], np.abs(y)
    of_chord = (of_y + np.roll(of_y, -1) + np.abs(chord) * of_gap) / gap
    before, chord_before, of_before = (np.roll(part, 1) for part in (gap, chord, of_chord))
    both = gap + before
    of_share = (of_gap + np.roll(of_gap, 1)) / both
    if interpolation == "spline":
        share, other = gap / both, before / both
        bends = 3.0 * np.abs(chord - chord_before) + np.abs(after - np.roll(slope, 1))
        right = 3.0 * (share * of_before + other * of_chord) + 2.0 * of_share * bends
        of_slope = np.zeros_like(right)
        for _ in range(_HALVINGS):
            of_slope = 0.5 * (right + share * np.roll(of_slope, 1) + other * np.roll(of_slope, -1))
    else:
        weight = (2.0 * gap + before) / (3.0 * both)
        with np.errstate(divide="ignore", invalid="ignore"):
            parts = weight * (slope / chord_before) ** 2 * of_before, (1.0 - weight) * (slope / chord) ** 2 * of_chord
        of_slope = np.where(slope == 0.0, 0.0, sum(parts) + 2.0 * of_share * np.abs(slope))
    ends, of_length = of_slope + np.roll(of_slope, -1), of_gap / gap
    bend = np.maximum(np.abs(2.0 * c2), np.abs(2.0 * c2 + 6.0 * c3 * gap))
    return np.array(
        [
            of_y + np.roll(of_y, -1) + 0.25 * gap * ends,
            ends + 1.5 * of_chord,
            (4.0 * ends + 6.0 * of_chord) / gap + bend * of_length,
            (6.0 * ends + 12.0 * of_chord) / gap**2 + 12.0 * np.abs(c3) * of_length,
        ]
    )


def on_piece(x: object, left: object, c3: object, c2: object, c1: object, c0: object) -> tuple[object, object]:
    """Value and slope of a table at x on a piece, as from `table_segment`; numbers, arrays or nodes."""
    t = x - left
    return ((c3 * t + c2) * t + c1) * t + c0, (3.0 * c3 * t + 2.0 * c2) * t + c1


@scalar
def sum_of_segments(
    memory: np.ndarray, offsets: float, count: float, numbers: np.ndarray, begin: int, apart: int, x: float
) -> tuple[float, float, float, float]:
    """The cubic piece of a weighted sum of tables at x, in the distance from x.

    Parameters
    ----------
    memory : array of float64, one-dimensional
        Several tables, each as from `in_memory`, and the indices at which those of the sum begin.
    offsets, count : float
        Index of the first of these indices, and their number.
    numbers, begin, apart
        A table of numbers: the weights.
    x : float

    Returns
    -------
    c3, c2, c1, c0 : float
        At a step, the coefficients after it.
    """
    s3, s2, s1, s0 = 0.0, 0.0, 0.0, 0.0
    first = int(offsets)
    for k in range(int(count)):
        left, c3, c2, c1, c0 = table_segment(memory, memory[first + k], x)
        weight, t = numbers[begin + k * apart], x - left
        s3 += weight * c3
        s2 += weight * (3.0 * c3 * t + c2)
        s1 += weight * ((3.0 * c3 * t + 2.0 * c2) * t + c1)
        s0 += weight * (((c3 * t + c2) * t + c1) * t + c0)
    return s3, s2, s1, s0


@scalar
def periods_before(start: float, period: float, x: float) -> float:
    """Total length of the whole periods between the start of a periodic table and x."""
    return period * math.floor((x - start) / period)


@scalar
def cycles_before(cycle: float, q: float) -> float:
    """Total length of the whole cycles before a position; the end of a cycle belongs to the cycle.

    A number that restarts in each cycle therefore reaches its final value at the cycle's end.
    """
    whole = math.floor(q / cycle)
    return cycle * (whole - 1.0) if whole > 0.0 and cycle * whole == q else cycle * whole


@scalar
def entry(memory: np.ndarray, index: float) -> float:
    """Number at an index of the memory."""
    return memory[int(index)]


@scalar
def entry_from(memory: np.ndarray, index: float, at: float, x: float, before: float) -> float:
    """Number at `index` of the memory if x has reached the number at `at`, else `before`.

    Parameters
    ----------
    memory : array of float
    index, at : float
        Indices of the number, and of the x at which it starts to hold.
    x, before : float
    """
    return chosen(memory[int(at)] <= x, memory[int(index)], before)


def _check_name(key: str, name: str, allowed: tuple[str, ...]) -> None:
    if name not in allowed:
        raise TableError(f"{key} = {name!r}; {listed(str(name), allowed, 'choose one of')}")


def _numbers(x: ArrayLike, y: ArrayLike, names: tuple[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Convert both columns to float64; raise `TableError` unless they have equal lengths and at least 2 finite rows."""
    columns = []
    for key, column in zip(names, (x, y), strict=True):
        try:
            numbers = np.asarray(column, dtype=np.float64)
        except (TypeError, ValueError) as error:
            raise TableError(f"{key}: {error}; every row needs one plain number") from error
        if numbers.ndim != 1:
            raise TableError(f"{key} has {numbers.ndim} dimensions; give it as one list of numbers")
        columns.append(numbers)
    if columns[0].size != columns[1].size:
        raise TableError(
            f"{names[0]} has {columns[0].size} rows, {names[1]} has {columns[1].size};"
            f" give one {names[1]} for every {names[0]}"
        )
    if columns[0].size < 2:
        raise TableError(f"the table has {columns[0].size} row(s); give at least 2")
    for key, numbers in zip(names, columns, strict=True):
        wrong = np.flatnonzero(~np.isfinite(numbers))
        if wrong.size:
            row = wrong[0]
            raise TableError(f"row {row + 1}: {key} = {numbers[row]} is not finite; correct or remove it")
    return columns[0], columns[1]


def _closed(x: np.ndarray, y: np.ndarray, period: float, names: tuple[str, str]) -> tuple[np.ndarray, np.ndarray]:
    """Extend rows to exactly one period, with the first value again in the last row."""
    end = x[0] + period
    # Only the closing row may be rounded; a row slightly before it is a separate row.
    closes = (x == x[-1]) & (np.abs(x - end) <= CLOSING_TOLERANCE * period)
    x = np.where(closes, end, x)
    beyond = np.flatnonzero(x > end)
    if beyond.size:
        row = beyond[0]
        raise TableError(
            f"row {row + 1}: {names[0]} = {x[row]:.9g} is more than one period ({period:.9g}) after the first row"
            f" ({x[0]:.9g}); remove the rows from there on, or correct the period"
        )
    if x[-1] < end:
        return np.append(x, end), np.append(y, y[0])
    if abs(y[-1] - y[0]) > CLOSING_TOLERANCE * np.abs(y).max():
        raise TableError(
            f"row {x.size}: {names[1]} = {y[-1]:g} one period after the first row, whose {names[1]} = {y[0]:g}; make"
            f' them equal: repeat row 1 there (for a step: interpolation "linear", row {x.size} as it is, and row 1'
            f" after it again, with the {names[0]} of row {x.size})"
        )
    return x, np.append(y[:-1], y[0])


def _check_order(x: np.ndarray, interpolation: str, name: str) -> None:
    gaps = np.diff(x)
    if (gaps < 0.0).any():
        row = np.flatnonzero(gaps < 0.0)[0] + 1
        raise TableError(f"row {row + 1}: {name} is below that of row {row}; sort the rows by {name}")
    steps = np.flatnonzero(gaps == 0.0) + 1
    if steps.size and interpolation != "linear":
        row = steps[0]
        raise TableError(
            f"row {row + 1}: {name} = {x[row]} is also row {row}'s; remove one of them, or, if a step is meant,"
            f' use interpolation "linear" instead of {interpolation!r}'
        )
    thirds = np.flatnonzero((gaps[1:] == 0.0) & (gaps[:-1] == 0.0)) + 2
    if thirds.size:
        row = thirds[0]
        raise TableError(f"row {row + 1}: {name} = {x[row]} for the third time; a step needs two rows, remove one")
    if gaps.max() == 0.0:
        raise TableError(f"row {x.size}: every row has {name} = {x[0]}; give at least two different ones")


def _coefficients(x: np.ndarray, y: np.ndarray, interpolation: str, periodic: bool, name: str) -> np.ndarray:
    """Coefficients of the pieces between the rows, shape (rows - 1, 4)."""
    with np.errstate(all="ignore"):
        try:
            if interpolation == "linear":
                pieces = _straight(x, y)
            elif interpolation == "pchip":
                pieces = _monotone(x, y, periodic)
            else:
                pieces = _spline(x, y, periodic)
        except ValueError:
            pieces = np.full((x.size - 1, 4), np.nan)
    if not np.isfinite(pieces).all():
        gap = np.diff(x)
        row = np.flatnonzero(gap == gap[gap > 0.0].min())[0] + 1
        raise TableError(
            f"rows {row} and {row + 1}: {name} = {x[row - 1]} and {x[row]} are too close to put a curve through;"
            " remove one of them"
        )
    return np.ascontiguousarray(pieces)


def _straight(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    step = np.diff(x) == 0.0
    pieces = np.zeros((x.size - 1, 4))
    pieces[:, 2] = np.where(step, 0.0, np.diff(y) / np.diff(x))
    pieces[:, 3] = np.where(step, y[1:], y[:-1])
    return pieces


def _spline(x: np.ndarray, y: np.ndarray, periodic: bool) -> np.ndarray:
    """Cubic spline with the slopes of SciPy, improved: their rounding is that of the largest.

    Each iteration solves the equation of a row, λ m₋ + 2 m + μ m₊ = r, for its own slope m.
    """
    from scipy import interpolate

    slope = interpolate.CubicSpline(x, y, bc_type="periodic" if periodic else "natural")(x, 1)
    gap = np.diff(x)
    chord = np.diff(y) / gap
    before, after = (np.concatenate(([gap[-1]], gap)), np.concatenate((gap, [gap[0]])))
    # Both are computed separately: next to a long gap, 1 − share would be lost in rounding.
    share, other = after / (before + after), before / (before + after)
    if not periodic:
        share[[0, -1]], other[[0, -1]] = (0.0, 1.0), (1.0, 0.0)
    right = 3.0 * (share * np.concatenate(([chord[-1]], chord)) + other * np.concatenate((chord, [chord[0]])))
    for _ in range(_HALVINGS):
        ahead, behind = np.concatenate((slope[1:], [slope[1]])), np.concatenate(([slope[-2]], slope[:-1]))
        slope = 0.5 * (right - share * behind - other * ahead)
    left, end = slope[:-1], slope[1:]
    return np.array([(left + end - 2.0 * chord) / gap**2, (3.0 * chord - 2.0 * left - end) / gap, left, y[:-1]]).T


def _monotone(x: np.ndarray, y: np.ndarray, periodic: bool) -> np.ndarray:
    """PCHIP; slopes depend only on neighbouring rows, so one more row on each side makes it periodic."""
    from scipy import interpolate

    if not periodic:
        return interpolate.PchipInterpolator(x, y).c.T
    period = x[-1] - x[0]
    x = np.concatenate(([x[-2] - period], x, [x[1] + period]))
    y = np.concatenate((y[-2:-1], y, y[1:2]))
    return interpolate.PchipInterpolator(x, y).c.T[1:-1]


def _with_ends(x: np.ndarray, y: np.ndarray, coefficients: np.ndarray, outside: str) -> tuple[np.ndarray, np.ndarray]:
    """Add a constant piece before the first row and one after the last."""
    before, after = np.zeros((2, 1, 4))
    end = x[-1]
    if outside == "hold":
        before[0, 3], after[0, 3] = y[0], y[-1]
    else:
        end = np.nextafter(end, np.inf)
    breaks = np.concatenate((x[:1], x[:-1], [end, end]))
    return breaks, np.concatenate((before, coefficients, after))
