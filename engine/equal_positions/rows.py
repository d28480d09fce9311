"""Sums and extremes of a row: one quantity of one variant over all positions.

A row with a NaN or infinity anywhere has NaN for its statistics, never the extreme of the rest. Every function
sums what it searches: one NaN spoils the sum, and the search itself may then be vectorised as if there were none.
"""

import math
from collections.abc import Callable

import numpy as np
from llvmlite import ir
from numba.extending import intrinsic

from engine.compiling.jit import scalar

SEGMENTS = 8


def _of_two(instruction: str) -> Callable[[float, float], float]:
    """One of two numbers by an instruction of the compiler's.

    Python's `max` and `min` are comparisons that prefer their first argument to NaN, so a loop of them has to
    keep its order. The instruction promises that neither number is NaN: its result is undefined if one is.
    """

    @intrinsic
    def of_two(typing: object, a: object, b: object) -> tuple:
        common = typing.unify_types(a, b)

        def generate(context: object, builder: ir.IRBuilder, signature: object, arguments: list) -> ir.Value:
            kind = arguments[0].type
            function = builder.module.declare_intrinsic(instruction, [kind], ir.FunctionType(kind, [kind, kind]))
            return builder.call(function, arguments, fastmath=("nnan", "nsz"))

        return common(common, common), generate

    return of_two


larger = _of_two("llvm.maxnum")
smaller = _of_two("llvm.minnum")


@scalar
def is_finite(value: float) -> bool:
    """Whether a number is neither infinite nor NaN.

    `math.isfinite` compiles to x − x == 0, and sums that may be reassociated let the compiler take that for true.
    """
    return abs(value) < math.inf


@scalar
def combined_max(a: np.ndarray, b: np.ndarray, slope: float) -> float:
    """Greatest of a − slope·b over a row; NaN if any value is NaN or infinite."""
    high = a[0] - slope * b[0]
    total = 0.0
    for k in range(a.shape[0]):
        value = a[k] - slope * b[k]
        total += value
        high = larger(high, value)
    return high if is_finite(total) else math.nan


@scalar
def combined_min(a: np.ndarray, b: np.ndarray, slope: float) -> float:
    """Least of a − slope·b over a row; NaN if any value is NaN or infinite."""
    low = a[0] - slope * b[0]
    total = 0.0
    for k in range(a.shape[0]):
        value = a[k] - slope * b[k]
        total += value
        low = smaller(low, value)
    return low if is_finite(total) else math.nan


@scalar
def greatest(row: np.ndarray) -> float:
    """Greatest value of a row; NaN if any value is NaN or infinite."""
    return combined_max(row, row, 0.0)


@scalar
def least(row: np.ndarray) -> float:
    """Least value of a row; NaN if any value is NaN or infinite."""
    return combined_min(row, row, 0.0)


@scalar
def total_of(row: np.ndarray) -> float:
    """Sum of a row."""
    total = 0.0
    for k in range(row.shape[0]):
        total += row[k]
    return total


@scalar
def mean_of(row: np.ndarray) -> float:
    """Mean over equally spaced positions; for a periodic row that is the trapezoid rule over the cycle."""
    return total_of(row) / row.shape[0]


@scalar
def place_of(row: np.ndarray, value: float) -> float:
    """First position index at which a row takes a value; NaN if it never does."""
    n = first = row.shape[0]
    for k in range(n):
        first = min(first, k if row[k] == value else n)
    return float(first) if first < n else math.nan


@scalar
def second_difference(before: float, here: float, after: float) -> float:
    """Second difference of three neighbours."""
    return before - here + (after - here)


@scalar
def sixth_difference(a: float, b: float, c: float, d: float, e: float, f: float, g: float) -> float:
    """Sixth difference of seven neighbours."""
    return a + g - 6.0 * (b + f) + 15.0 * (c + e) - 20.0 * d


@scalar
def roughness(row: np.ndarray, periodic: bool) -> float:
    """Root of the sum of squares of the jumps in a row; what a smooth row leaves is of the order h⁶.

    A unit jump makes sixth differences whose squares add up to 252; a kink in which the slope changes by K counts
    as a jump of about hK/2.

    Parameters
    ----------
    row : ndarray (positions,)
    periodic : bool
        Whether the last position is followed by the first.
    """
    n = row.shape[0]
    total = 0.0
    for k in range(n - 6):
        d = sixth_difference(row[k], row[k + 1], row[k + 2], row[k + 3], row[k + 4], row[k + 5], row[k + 6])
        total += d * d
    if periodic:
        # Negative indices count from the end, so the neighbours run on into the next cycle.
        for k in range(-6, 0):
            d = sixth_difference(row[k], row[k + 1], row[k + 2], row[k + 3], row[k + 4], row[k + 5], row[k + 6])
            total += d * d
    return math.sqrt(total / 252.0)


@scalar
def accumulate(row: np.ndarray) -> None:
    """Running sum of a row, in its place.

    Each addition waits for the one before. Eight segments are summed side by side, each from the sum of those
    before it, so that the processor has always eight additions to do.
    """
    length = row.shape[0] // SEGMENTS
    a, b, c, d = row[:length], row[length : 2 * length], row[2 * length : 3 * length], row[3 * length : 4 * length]
    e, f, g = row[4 * length : 5 * length], row[5 * length : 6 * length], row[6 * length : 7 * length]
    h = row[7 * length : 8 * length]
    ta = 0.0
    tb = ta + total_of(a)
    tc = tb + total_of(b)
    td = tc + total_of(c)
    te = td + total_of(d)
    tf = te + total_of(e)
    tg = tf + total_of(f)
    th = tg + total_of(g)
    for k in range(length):
        ta, tb, tc, td = ta + a[k], tb + b[k], tc + c[k], td + d[k]
        te, tf, tg, th = te + e[k], tf + f[k], tg + g[k], th + h[k]
        a[k], b[k], c[k], d[k] = ta, tb, tc, td
        e[k], f[k], g[k], h[k] = te, tf, tg, th
    for k in range(SEGMENTS * length, row.shape[0]):
        th += row[k]
        row[k] = th


@scalar
def halve(row: np.ndarray, half: np.ndarray) -> None:
    """Copy every second position of a row into `half`."""
    for k in range(half.shape[0]):
        half[k] = row[2 * k]


@scalar
def derivative_residual(row: np.ndarray, derivative: np.ndarray, h: float) -> float:
    """How far a periodic row's given derivative is from sixth-order central differences of the row itself.

    Returns
    -------
    float
        Greatest difference over the cycle relative to the greatest derivative; 0 where both vanish.
    """
    n = row.shape[0]
    worst = largest = total = 0.0
    for k in range(n):
        d1 = row[(k + 1) % n] - row[k - 1]
        d2 = row[(k + 2) % n] - row[k - 2]
        d3 = row[(k + 3) % n] - row[k - 3]
        difference = abs((45.0 * d1 - 9.0 * d2 + d3) / (60.0 * h) - derivative[k])
        worst = max(worst, difference)
        largest = max(largest, abs(derivative[k]))
        total += difference
    if not is_finite(total):
        return math.nan
    return worst / largest if largest > 0.0 else worst
