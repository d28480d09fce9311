"""Rows between the positions of panels: the values, extremes and zeros of the polynomials through them.

A panel's polynomial is evaluated in the barycentric form, its derivatives by the rules of Schneider and Werner. Loops
over one panel are compiled for each degree that there is: as their lengths are known, they are vectorised.

Sources: L. N. Trefethen, Approximation Theory and Approximation Practice, ch. 5; C. Schneider and W. Werner, Some new
aspects of rational interpolation (1986).
"""

import math
from collections.abc import Callable

import numpy as np

from engine.compiling.jit import routine, scalar
from engine.equal_positions.rows import combined_max, combined_min, is_finite, smaller
from engine.panels.panels import DEGREES, LONG, PLACES, SHORT, Panels

# The last of Newton's steps towards an extreme: as a share of the panel, it leaves the square of this.
FOUND = 1e-5
# How far a curve may go beyond three neighbours, by what they differ: twice what any parabola does.
BEYOND = 0.25
# More than there are positions.
MANY = 2.0**24
# A place on a position itself is taken this far beside it, where the barycentric form has a value.
BESIDE = 1e-12


def _signs(degree: int, step: int) -> np.ndarray:
    """Barycentric weights of every `step`-th position of a panel; of the others zero."""
    signs = np.zeros(degree + 1)
    signs[::step] = (-1.0) ** np.arange(degree // step + 1)
    signs[[0, -1]] *= 0.5
    return signs


@scalar
def vertex(xa: float, xb: float, xc: float, fa: float, fb: float, fc: float) -> float:
    """Place of the extreme of the parabola through three points; NaN of a straight line."""
    left, right = (xb - xa) * (fb - fc), (xb - xc) * (fb - fa)
    return xb - 0.5 * ((xb - xa) * left - (xb - xc) * right) / (left - right)


@scalar
def combined(a: np.ndarray, b: np.ndarray, slope: float, i: int) -> float:
    """Combination a − slope·b at a position."""
    return a[i] - slope * b[i]


def _curves(degree: int) -> tuple[Callable, Callable, Callable]:
    """What is evaluated of a − slope·b in a panel of a degree, given a and b at its positions.

    Returns
    -------
    value_at : (a, b, slope, x) to its value at x of −1 … 1
    misfit_at : (a, b, slope, x) to how far it is there from the polynomial of half the degree
    highest : (a, b, slope, sign, best) to the greatest sign·(a − slope·b) and its place, −∞ if that can't reach `best`
    """
    positions = degree + 1
    places = PLACES[degree >> 3, :positions].copy()
    fine, coarse = _signs(degree, 1), _signs(degree, 2)

    @scalar
    def value_at(a: np.ndarray, b: np.ndarray, slope: float, x: float) -> float:
        above = below = 0.0
        for i in range(positions):
            share = fine[i] / (x - places[i])
            above += share * combined(a, b, slope, i)
            below += share
        return above / below

    @scalar
    def misfit_at(a: np.ndarray, b: np.ndarray, slope: float, x: float) -> float:
        above = below = above_coarse = below_coarse = 0.0
        for i in range(positions):
            value, inverse = combined(a, b, slope, i), 1.0 / (x - places[i])
            above += fine[i] * inverse * value
            below += fine[i] * inverse
            above_coarse += coarse[i] * inverse * value
            below_coarse += coarse[i] * inverse
        return abs(above / below - above_coarse / below_coarse)

    @scalar
    def about(a: np.ndarray, b: np.ndarray, slope: float, centre: int, x: float) -> tuple[float, float, float]:
        """Value at x beyond that at a position, and the first two derivatives."""
        here = combined(a, b, slope, centre)
        one_0 = one_1 = one_2 = value_0 = value_1 = value_2 = 0.0
        for i in range(positions):
            value, inverse = combined(a, b, slope, i) - here, 1.0 / (x - places[i])
            share = fine[i] * inverse
            one_0 += share
            value_0 += share * value
            one_1 += share * inverse
            value_1 += share * inverse * value
            one_2 += share * inverse * inverse
            value_2 += share * inverse * inverse * value
        value = value_0 / one_0
        rise = (value * one_1 - value_1) / one_0
        return value, rise, 2.0 * (rise * one_1 - value * one_2 + value_2) / one_0

    @routine
    def peak(
        a_row: np.ndarray, b_row: np.ndarray, slope: float, sign: float, start: int, centre: int
    ) -> tuple[float, float]:
        """Greatest value near a position inside the panel, and its place: Newton's rule from a parabola on."""
        a, b = a_row[start : start + positions], b_row[start : start + positions]
        xa, xb, xc = places[centre - 1], places[centre], places[centre + 1]
        here = combined(a, b, slope, centre)
        fa = sign * (combined(a, b, slope, centre - 1) - here)
        fc = sign * (combined(a, b, slope, centre + 1) - here)
        best, at = 0.0, xb
        if fa > best:
            best, at = fa, xa
        if fc > best:
            best, at = fc, xc
        x = vertex(xa, xb, xc, fa, 0.0, fc)
        for _ in range(6):
            if not xa < x < xc:
                break
            value, rise, bend = about(a, b, slope, centre, x)
            step = -rise / bend if sign * bend < 0.0 else math.nan
            last = not abs(step) > FOUND
            if abs(step) <= FOUND:
                value += 0.5 * rise * step
                x += step
            if sign * value >= best:
                best, at = sign * value, x
            if last:
                break
            x += step
        return sign * here + best, at

    return value_at, misfit_at, peak


(_value_long, _misfit_long, _peak_long), (_value_short, _misfit_short, _peak_short), _shortest = (
    _curves(degree) for degree in DEGREES[::-1]
)
_value_shortest, _misfit_shortest, _peak_shortest = _shortest


@scalar
def peak_in(
    a: np.ndarray, b: np.ndarray, slope: float, sign: float, start: int, end: int, k: int
) -> tuple[float, float]:
    """Greatest sign·(a − slope·b) near a position of a panel, and its place in −1 … 1."""
    # The ends of a panel belong to the position beside them.
    centre = min(max(k, start + 1), end - 2) - start
    if end - start > LONG:
        found = _peak_long(a, b, slope, sign, start, centre)
    elif end - start > SHORT:
        found = _peak_short(a, b, slope, sign, start, centre)
    else:
        found = _peak_shortest(a, b, slope, sign, start, centre)
    return found


@scalar
def only_top(a: np.ndarray, b: np.ndarray, slope: float, sign: float, best: float) -> int:
    """The one position higher than its neighbours that may have `best` beside it; −1 where there are others.

    As if there were no panels; the first and the last position are left out. One sum without a branch tells how many
    there are, and where.
    """
    n, total = a.shape[0] - 2, 0.0
    a_before, a_here, a_after = a[:n], a[1 : n + 1], a[2:]
    b_before, b_here, b_after = b[:n], b[1 : n + 1], b[2:]
    for k in range(n):
        here = sign * (a_here[k] - slope * b_here[k])
        rise = here - sign * (a_before[k] - slope * b_before[k])
        fall = here - sign * (a_after[k] - slope * b_after[k])
        top = smaller(smaller(rise, fall), here + BEYOND * (rise + fall) - best) >= 0.0
        total += (MANY + k) * (1.0 if top else 0.0)
    return int(total - MANY) + 1 if MANY <= total < 2.0 * MANY else -1


@scalar
def may_hide(outside: float, here: float, inside: float, best: float) -> bool:
    """Whether `best` may be beside the end of a panel that is passed over for what is higher outside of it."""
    return outside > here >= inside and here + BEYOND * (here - inside) >= best


@scalar
def hides_at_ends(starts: np.ndarray, a: np.ndarray, b: np.ndarray, slope: float, sign: float, best: float) -> bool:
    """Whether `best` may be beside an end of any panel that `only_top` passes over."""
    hidden, outside = False, math.inf
    for p in range(starts.shape[0] - 1):
        start, last = starts[p], starts[p + 1] - 1
        here, inside = sign * combined(a, b, slope, start), sign * combined(a, b, slope, start + 1)
        hidden |= may_hide(outside, here, inside, best)
        here, inside = sign * combined(a, b, slope, last), sign * combined(a, b, slope, last - 1)
        after = sign * combined(a, b, slope, min(last + 1, a.shape[0] - 1))
        hidden |= may_hide(after if p < starts.shape[0] - 2 else math.inf, here, inside, best)
        outside = here
    return hidden


@scalar
def panel_of(starts: np.ndarray, k: int) -> int:
    """Panel of a position."""
    panel = 0
    for p in range(1, starts.shape[0] - 1):
        if starts[p] <= k:
            panel = p
    return panel


@scalar
def highest_peak(
    starts: np.ndarray, a: np.ndarray, b: np.ndarray, slope: float, sign: float, best: float
) -> tuple[float, int, float]:
    """Greatest value beside any position that may have `best` beside it; its panel, and its place there."""
    most, panel, place = -math.inf, 0, 0.0
    for p in range(starts.shape[0] - 1):
        start, end = starts[p], starts[p + 1]
        before, here = sign * combined(a, b, slope, start), sign * combined(a, b, slope, start + 1)
        for k in range(start + 1, end - 1):
            after = sign * combined(a, b, slope, k + 1)
            if (here >= before or k == start + 1) and (here >= after or k == end - 2):
                beyond = BEYOND * (abs(here - before) + abs(here - after))
                if max(before, here, after) + beyond >= best:
                    value, x = peak_in(a, b, slope, sign, start, end, k)
                    if value > most:
                        most, panel, place, best = value, p, x, max(best, value)
            before, here = here, after
    return most, panel, place


@routine
def extreme(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, sign: float) -> tuple[float, float]:
    """Greatest value of sign·(a − slope·b) over the range, between the positions too.

    Parameters
    ----------
    panels : Panels
    a, b : ndarray (positions,)
    slope : float
    sign : float
        +1 for the greatest a − slope·b, −1 for minus the least.

    Returns
    -------
    value : float
        NaN if any position is.
    at : float
        Where, as the nodes of the panels.
    """
    best = combined_max(a, b, slope) if sign > 0.0 else -combined_min(a, b, slope)
    if math.isnan(best):
        return math.nan, math.nan
    # Taken out of the tuple once: each time counts references.
    starts, nodes = panels.starts, panels.nodes
    top = only_top(a, b, slope, sign, best)
    if top >= 0 and not hides_at_ends(starts, a, b, slope, sign, best):
        panel = panel_of(starts, top)
        most, place = peak_in(a, b, slope, sign, starts[panel], starts[panel + 1], top)
    else:
        most, panel, place = highest_peak(starts, a, b, slope, sign, best)
    middle = 0.5 * (nodes[starts[panel]] + nodes[starts[panel + 1] - 1])
    return most, middle + panels.halves[panel] * place


@scalar
def panel_at(panels: Panels, at: float) -> tuple[int, float]:
    """Panel of a place of the input, and the place in its −1 … 1."""
    panel = 0
    while panel + 1 < panels.halves.shape[0] and (at - panels.nodes[panels.starts[panel + 1]]) * panels.halves[0] > 0.0:
        panel += 1
    middle = 0.5 * (panels.nodes[panels.starts[panel]] + panels.nodes[panels.starts[panel + 1] - 1])
    return panel, min(max((at - middle) / panels.halves[panel], -1.0), 1.0)


@scalar
def value_in(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, panel: int, x: float) -> float:
    """Combination a − slope·b at a place x of −1 … 1 in a panel; NaN or infinite on a position."""
    start, end = panels.starts[panel], panels.starts[panel + 1]
    if end - start > LONG:
        value = _value_long(a[start:end], b[start:end], slope, x)
    elif end - start > SHORT:
        value = _value_short(a[start:end], b[start:end], slope, x)
    else:
        value = _value_shortest(a[start:end], b[start:end], slope, x)
    return value


@scalar
def misfit_in(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, panel: int, x: float) -> float:
    """How far it is there from the polynomial of half the degree; NaN or infinite on a position."""
    start, end = panels.starts[panel], panels.starts[panel + 1]
    if end - start > LONG:
        apart = _misfit_long(a[start:end], b[start:end], slope, x)
    elif end - start > SHORT:
        apart = _misfit_short(a[start:end], b[start:end], slope, x)
    else:
        apart = _misfit_shortest(a[start:end], b[start:end], slope, x)
    return apart


@scalar
def beside(x: float) -> float:
    """A place next to x of −1 … 1, towards the middle of the panel."""
    return x - BESIDE if x > 0.0 else x + BESIDE


# Of what is seldom needed, one copy.


@routine
def value_apart(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, panel: int, x: float) -> float:
    """As of `value_in`; beside a position that x is on."""
    value = value_in(panels, a, b, slope, panel, x)
    if not is_finite(value):
        value = value_in(panels, a, b, slope, panel, beside(x))
    return value


@routine
def misfit_beside(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, panel: int, x: float) -> float:
    """As of `misfit_in`, beside a position that x is on."""
    return misfit_in(panels, a, b, slope, panel, beside(x))


@routine
def combined_at(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, at: float) -> float:
    """Combination a − slope·b at a place of the input."""
    panel, x = panel_at(panels, at)
    value = value_in(panels, a, b, slope, panel, x)
    if not is_finite(value):
        value = value_apart(panels, a, b, slope, panel, x)
    return value


@routine
def misfit(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, at: float) -> float:
    """How far the polynomials of a − slope·b of full and of half the degree are apart at a place of the input."""
    panel, x = panel_at(panels, at)
    apart = misfit_in(panels, a, b, slope, panel, x)
    if not is_finite(apart):
        apart = misfit_beside(panels, a, b, slope, panel, x)
    return apart


@routine
def root_near(panels: Panels, row: np.ndarray, at: float) -> float:
    """Place near another one where a row's polynomial is zero, by the secant rule; the same place if it leads away."""
    panel, x = panel_at(panels, at)
    before, here = x - 1e-4 if x > 0.0 else x + 1e-4, x
    value_before = value_apart(panels, row, row, 0.0, panel, before)
    for _ in range(4):
        value = value_apart(panels, row, row, 0.0, panel, here)
        if value == value_before:
            break
        step = value * (here - before) / (value - value_before)
        before, value_before, here = here, value, here - step
        if not abs(here - x) < 1e-2:
            return at
        if abs(step) < 1e-15:
            break
    return at + panels.halves[panel] * (here - x)
