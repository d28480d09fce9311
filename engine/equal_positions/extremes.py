"""Extremes of a row, one quantity of one variant over all positions, and what they and its means may be off by.

Where a row is smooth about an extreme, the extreme is the top of the polynomial through five neighbours, and two more
neighbours tell how far that may be off. Where it bends or jumps, the extreme is the one at the positions, and what may
hide between two of them counts as doubt.
"""

import math

import numpy as np

from engine.compiling.jit import routine, scalar
from engine.equal_positions.rows import (
    greatest,
    is_finite,
    larger,
    least,
    place_of,
    second_difference,
    sixth_difference,
    smaller,
)

# A row is smooth where its fourth and sixth differences together are no more than this share of its second, and those
# of the order five and six no more than this share of those of the order three and four.
SMOOTH, FALLING = 0.5, 0.7
# What the terms of a series that fall by such shares leave is told by the next two, but for a margin.
MARGIN = 4.0


@scalar
def smooth_top(
    a: float, b: float, c: float, d: float, e: float, f: float, g: float, noise: float
) -> tuple[bool, float, float, float, float]:
    """Top of the polynomial through the middle five of seven neighbours, the middle one of which is the highest.

    Stirling's formula in central differences: f(t) = d + t μδ + t²/2 δ² + t (t² − 1)/6 μδ³ + t² (t² − 1)/24 δ⁴; the
    next two terms, t (t² − 1)(t² − 4)/120 μδ⁵ and t² (t² − 1)(t² − 4)/720 δ⁶, tell its error. What the neighbours
    themselves are off by, `noise`, moves the top aside.

    Returns
    -------
    smooth : bool
        Whether the neighbours look like a polynomial's; if not, the rest means nothing.
    rise : float
        Of the top above the middle.
    t : float
        Place of the top beside the middle, in positions.
    off, aside : float
        What the rise and the place may be off by.
    """
    d1, d2 = 0.5 * (e - c), second_difference(c, d, e)
    d3 = 0.5 * ((f - b) - 2.0 * (e - c))
    d4 = second_difference(second_difference(b, c, d), d2, second_difference(d, e, f))
    d5 = 0.5 * ((g - a) - 4.0 * (f - b) + 5.0 * (e - c))
    d6 = sixth_difference(a, b, c, d, e, f, g)
    bend, next_terms, last_terms = abs(d2), abs(d3) + abs(d4), abs(d5) + abs(d6)
    smooth = d2 < 0.0 and abs(d4) + abs(d6) <= SMOOTH * bend and abs(d3) + abs(d5) <= SMOOTH * bend
    # Where rounding is all that is left, nothing falls any more.
    smooth = smooth and (last_terms <= FALLING * next_terms or last_terms <= 1e-5 * bend)
    left = MARGIN / (1.0 - min(last_terms / next_terms, FALLING)) if next_terms > 0.0 else MARGIN
    t = -d1 / d2
    for _ in range(3):
        slope = d1 + t * (d2 + t * (0.5 * d3 + t * d4 / 6.0)) - d3 / 6.0 - t * d4 / 12.0
        t -= slope / (d2 + t * (d3 + 0.5 * t * d4) - d4 / 12.0)
    square = t * t
    odd, even = t * (square - 1.0) / 6.0, square * (square - 1.0) / 24.0
    rise = t * d1 + 0.5 * square * d2 + odd * d3 + even * d4
    aside = (left * (abs(d5) / 30.0 + abs(t * d6) / 90.0) + noise) / bend
    off = left * abs(square - 4.0) * (abs(odd * d5) / 20.0 + abs(even * d6) / 30.0) + 0.5 * bend * aside * aside
    return smooth, rise, t, off, aside


@scalar
def missed_beside(row: np.ndarray, centre: int, side: int, sign: float, periodic: bool) -> float:
    """How far the curve may go beyond an extreme at a position, before it comes to the next one on a side.

    Where a kink hides between the two, no farther than the second difference at either, nor than half of the greater;
    the same holds, four times over, for a parabola. Where a jump does, the second differences are the jump itself, but
    either branch goes on from its last two positions, and stays within a step's rise of them.

    Parameters
    ----------
    row : ndarray (positions,)
    centre : int
        Position of the extreme.
    side : int
        +1 towards the next position, −1 towards the one before.
    sign : float
        +1 for a greatest value, −1 for a least.
    periodic : bool
        Whether the last position is followed by the first.
    """
    n = row.shape[0]
    if not (periodic or 0 <= centre + side < n):
        return 0.0
    here, near = row[centre], row[(centre + side) % n]
    greater, lesser, rise = 0.0, math.inf, 0.0
    if periodic or 0 <= centre - side < n:
        behind = row[(centre - side) % n]
        bend = abs(second_difference(behind, here, near))
        greater, lesser, rise = bend, bend, sign * (here - behind)
    if periodic or 0 <= centre + 2 * side < n:
        far = row[(centre + 2 * side) % n]
        bend = abs(second_difference(here, near, far))
        greater, lesser = max(greater, bend), min(lesser, bend)
        rise = max(rise, sign * (near + (near - far) - here))
    return max(min(0.5 * greater, lesser, rise), 0.0)


@routine
def top_about(row: np.ndarray, k: int, sign: float, periodic: bool, noise: float) -> tuple[float, float, float, float]:
    """Extreme of the curve about a position that none of its neighbours exceeds.

    Parameters
    ----------
    row : ndarray (positions,)
    k : int
        The position.
    sign : float
        +1 for a greatest value, −1 for a least.
    periodic : bool
        Whether the last position is followed by the first.
    noise : float
        What values of the row may be off by.

    Returns
    -------
    top : float
        The extreme times its sign.
    place : float
        In positions; before the first it is negative.
    off, aside : float
        How far beyond the top the curve may go, and how far away it may be.
    """
    n = row.shape[0]
    here = sign * row[k]
    if n >= 7 and (periodic or 3 <= k < n - 3):
        a, b, c = sign * row[k - 3], sign * row[k - 2], sign * row[k - 1]
        e, f, g = sign * row[k + 1 - n], sign * row[k + 2 - n], sign * row[k + 3 - n]
        smooth, rise, t, off, aside = smooth_top(a, b, c, here, e, f, g, noise)
        if smooth and here <= 0.0 < here + rise:
            # What no position has beyond zero, such as a magnitude, isn't taken there by a polynomial.
            return 0.0, k + t, off + here + rise, aside
        if smooth:
            return here + rise, k + t, off, aside
    missed = max(missed_beside(row, k, -1, sign, periodic), missed_beside(row, k, 1, sign, periodic))
    return here, float(k), missed, 1.0


@scalar
def missed_within(behind: float, here: float, near: float, far: float, sign: float) -> float:
    """As `missed_beside`, from the four positions themselves, without a branch."""
    bend, next_bend = abs(second_difference(behind, here, near)), abs(second_difference(here, near, far))
    rise = larger(sign * (here - behind), sign * (near + (near - far) - here))
    return smaller(smaller(0.5 * larger(bend, next_bend), smaller(bend, next_bend)), rise)


@scalar
def reach(a: float, b: float, here: float, c: float, d: float, sign: float) -> float:
    """How far the curve may go about the middle of five positions if it turns there, times its sign; else −∞."""
    beyond = sign * here + larger(missed_within(c, here, b, a, sign), missed_within(b, here, c, d, sign))
    return beyond if sign * (here - b) >= 0.0 and sign * (here - c) >= 0.0 else -math.inf


@scalar
def highest_turn(row: np.ndarray, sign: float) -> float:
    """Bound of `highest_reach` by less work: nothing is missed beyond a whole second difference."""
    n, highest = row.shape[0], -math.inf
    before, here, after = row[: n - 2], row[1 : n - 1], row[2:]
    for k in range(before.shape[0]):
        top = sign * here[k] + abs(second_difference(before[k], here[k], after[k]))
        turns = sign * (here[k] - before[k]) >= 0.0 and sign * (here[k] - after[k]) >= 0.0
        highest = larger(highest, top if turns else -math.inf)
    return highest


@scalar
def highest_reach(row: np.ndarray, sign: float) -> float:
    """How far the curve may go, times its sign, wherever a row turns but at its first and last two positions."""
    n, highest = row.shape[0], -math.inf
    # Views such that equal indices are five neighbours: without negative indices loops are vectorised.
    a, b, here, c, d = row[: n - 4], row[1 : n - 3], row[2 : n - 2], row[3 : n - 1], row[4:]
    for k in range(a.shape[0]):
        highest = larger(highest, reach(a[k], b[k], here[k], c[k], d[k], sign))
    return highest


@scalar
def is_rivalled(row: np.ndarray, centre: int, sign: float, periodic: bool, level: float) -> bool:
    """Whether the curve may come to a level, times its sign, anywhere but about one position."""
    n = row.shape[0]
    if n < 7:
        return True
    if periodic:
        for k in range(-2, 2):
            away = abs(k % n - centre)
            there = reach(row[k - 2], row[k - 1], row[k], row[k + 1], row[k + 2], sign)
            if min(away, n - away) > 1 and there >= level:
                return True
    before, after = row[: max(centre + 1, 5)], row[min(centre, n - 5) :]
    if larger(highest_turn(before[1:-1], sign), highest_turn(after[1:-1], sign)) < level:
        return False
    return larger(highest_reach(before, sign), highest_reach(after, sign)) >= level


@routine
def extreme_and_place(row: np.ndarray, sign: float, periodic: bool, noise: float) -> tuple[float, float, float, float]:
    """Greatest or least value of a row, between its positions too, and where it is.

    A narrow valley that isn't the deepest at the positions may be so between them: every other position where the
    row turns is looked at if the curve may come as far there.

    Parameters
    ----------
    row : ndarray (positions,)
    sign : float
        +1 for the greatest value, −1 for the least.
    periodic : bool
        Whether the last position is followed by the first.
    noise : float
        What values of the row may be off by.

    Returns
    -------
    value, place : float
        The extreme, and where it is, in positions; NaN if any value is NaN or infinite.
    off, aside : float
        What they may be off by.
    """
    value = greatest(row) if sign > 0.0 else least(row)
    if not is_finite(value):
        return math.nan, math.nan, math.nan, math.nan
    centre = int(place_of(row, value))
    top, place, off, aside = top_about(row, centre, sign, periodic, noise)
    if is_rivalled(row, centre, sign, periodic, top - off):
        return among_rivals(row, centre, sign, periodic, noise)
    return sign * top, place, off, aside


@routine
def among_rivals(
    row: np.ndarray, centre: int, sign: float, periodic: bool, noise: float
) -> tuple[float, float, float, float]:
    """`extreme_and_place` by a look at every position where a row turns; `centre` is that of its extreme value."""
    n = row.shape[0]
    top, place, off, aside = top_about(row, centre, sign, periodic, noise)
    end = top + off
    for k in range(0 if periodic else 1, n if periodic else n - 1):
        away = abs(k - centre)
        here = sign * row[k]
        turns = here >= sign * row[k - 1] and here >= sign * row[k + 1 - n]
        if not turns or min(away, n - away if periodic else n) < 2:
            continue
        other, other_place, other_off, other_aside = top_about(row, k, sign, periodic, noise)
        if other + other_off < top - off:
            continue
        apart = abs(other_place - place)
        apart = min(apart, n - apart) if periodic else apart
        if other > top:
            top, place, off = other, other_place, other_off
        end = max(end, other + other_off)
        aside = max(aside, apart + other_aside)
    return sign * top, place, end - top, aside


@scalar
def extreme_of(row: np.ndarray, sign: float, periodic: bool) -> tuple[float, float]:
    """Greatest (sign +1) or least (−1) value of a row, between its positions too, and what it may be off by."""
    value, _, off, _ = extreme_and_place(row, sign, periodic, 0.0)
    return value, off


@scalar
def place_of_extreme(
    row: np.ndarray, sign: float, first: float, h: float, periodic: bool, rounding: float
) -> tuple[float, float]:
    """Where a row is greatest (sign +1) or least (−1), of positions from `first` on with spacing h, and its doubt.

    Parameters
    ----------
    row : ndarray (positions,)
    sign, first, h : float
    periodic : bool
        Whether the last position is followed by the first.
    rounding : float
        What values may be off by, as a share of the greatest magnitude.
    """
    noise = rounding * max(abs(greatest(row)), abs(least(row)))
    _, place, _, aside = extreme_and_place(row, sign, periodic, noise)
    place = place + row.shape[0] if place < 0.0 else place
    return first + h * place, h * aside


@scalar
def means(row: np.ndarray, step: int, periodic: bool) -> tuple[float, float]:
    """Mean and root-mean-square value of every `step`-th position of a row, by the trapezoid rule; NaN if not finite.

    Parameters
    ----------
    row : ndarray (positions,)
    step : int
    periodic : bool
        Whether the last position is followed by the first.
    """
    n = row.shape[0]
    total = squares = 0.0
    for k in range(0, n, step):
        # Squares of small float32 numbers would be zero in float32.
        value = float(row[k])
        total += value
        squares += value * value
    if not is_finite(squares):
        return math.nan, math.nan
    count = (n + step - 1) // step
    if not periodic:
        last = row[(count - 1) * step]
        count -= 1
        total -= 0.5 * (row[0] + last)
        squares -= 0.5 * (row[0] * row[0] + last * last)
    return total / count, math.sqrt(squares / count)


@scalar
def least_magnitude(low: float, high: float) -> float:
    """Least |value| between two extremes; 0 where the sign changes."""
    return max(low, -high, 0.0) if is_finite(low + high) else math.nan


@scalar
def doubt_of_extreme(value: float, of_half: float, off: float, off_of_half: float) -> float:
    """What an extreme may be off by, if that of half the positions was so by its own measure; else by how much it was.

    A curve bent in its third derivative still changes eight times less than that of half the positions did.
    """
    change = abs(value - of_half)
    return max(off, 0.125 * change) if change <= off + off_of_half else max(off, change)


@scalar
def doubt_of_mean(
    value: float, of_half: float, of_quarter: float, rough: float, rough_half: float, jumps: float
) -> float:
    """What a mean over equally spaced positions may be off by.

    With jumps, by its change from half the positions and by what jumps hide between two positions. Where a row is
    smooth, that change falls with every doubling by as much as it did or more: of a periodic row, for which the
    trapezoid rule converges faster than by any power, by the square of it.

    Parameters
    ----------
    value, of_half, of_quarter : float
        The mean over all positions, every second one and every fourth.
    rough, rough_half : float
        Roughness over all positions and over every second one: equal for jumps; of a smooth row, half as many sixth
        differences are each up to 64 times as large, and their squares add up to 2048 times as much.
    jumps : float
        What jumps as great as the roughness may hide.
    """
    change, before = abs(value - of_half), abs(of_half - of_quarter)
    if rough * rough > rough_half * rough_half / 1500.0:
        return change + jumps
    fall = change / before if before > change else 1.0
    # A jump of a part of what is smooth may still hide.
    return change * min(1.0, 4.0 * fall * min(1.0, 64.0 * fall)) + 0.25 * jumps
