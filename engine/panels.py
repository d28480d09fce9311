"""A cycle in panels: from one place where a load sets in or bends to the next, each with positions of its own.

Within a panel every row is smooth, and a polynomial through its positions follows it closely: sums over the positions
with the right weights are then integrals, however loads jump between one panel and the next. The positions of a panel
of degree d are x_i = −cos(πi/d) on [−1, 1]; every second of them makes the panel of half the degree. What a row is
between its positions is told by its polynomial in the barycentric form.

Sources: C. W. Clenshaw and A. R. Curtis, A method for numerical integration on an automatic computer (1960);
L. N. Trefethen, Approximation Theory and Approximation Practice, ch. 5 and 19.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.jit import over_variants, routine, scalar

# Degrees of panels: of a long one, of a short one, and of half of the short one.
DEGREES = (4, 8, 16)
LONG, SHORT = 16, 8
# Positions stay this far from a panel's ends [rad]: beyond the rounding of the place where a load sets in.
CLEAR = 1e-10
# Ends that are closer than this are one.
SAME = 4.0 * CLEAR
# A place between positions counts as found when the last step towards it was this share of the panel.
FOUND = 1e-7


def _tables() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions on [−1, 1], weights of an integral over it, and of integrals from −1 to each position, by degree."""
    size = DEGREES[-1] + 1
    places, weights, running = np.zeros((3, size)), np.zeros((3, size)), np.zeros((3, size, size))
    for i, degree in enumerate(DEGREES):
        x = -np.cos(np.pi * np.arange(degree + 1) / degree)
        # Exactly antisymmetric.
        x = 0.5 * (x - x[::-1])
        values = np.polynomial.chebyshev.chebvander(x, degree)
        of_polynomials = [np.polynomial.chebyshev.chebint(row, lbnd=-1.0) for row in np.eye(degree + 1)]
        integrals = np.array([np.polynomial.chebyshev.chebval(x, c) for c in of_polynomials]).T
        from_start = np.linalg.solve(values.T, integrals.T).T
        places[i, : degree + 1], weights[i, : degree + 1] = x, from_start[-1]
        running[i, : degree + 1, : degree + 1] = from_start
    return places, weights, running


PLACES, WEIGHTS, RUNNING = _tables()


class Panels(NamedTuple):
    """How the positions of a variant lie in panels.

    Attributes
    ----------
    starts : ndarray (panels + 1,) of int
        First position of each panel; last, how many positions there are.
    halves : ndarray (panels,)
        Half the length of each panel, the unit of the input.
    nodes : ndarray (positions,)
        The input's position.
    """

    starts: np.ndarray
    halves: np.ndarray
    nodes: np.ndarray


@over_variants
def cut(begin: int, end: int, breaks: np.ndarray, first: float, last: float, longest: float, edges: np.ndarray) -> None:
    """Cut the range of the input at each variant's breaks, and what is longer than `longest` into equal panels.

    Parameters
    ----------
    begin, end : int
        Variants to cut, `end` not among them.
    breaks : ndarray (variants, places)
        In rising order; NaN where a variant has none.
    first, last : float
        The range.
    longest : float
        Greatest length of a panel.
    edges : ndarray (variants, most edges)
        Receives the ends of the panels, then NaN.
    """
    for v in range(begin, end):
        edges[v, 0], made, near = first, 1, first
        for i in range(breaks.shape[1] + 1):
            far = breaks[v, i] if i < breaks.shape[1] else last
            inside = near + SAME < far < last - SAME
            if not (inside or i == breaks.shape[1]):
                continue
            pieces = math.ceil((far - near) / longest * (1.0 - 1e-12))
            for j in range(1, pieces + 1):
                edges[v, made] = near + (far - near) * j / pieces if j < pieces else far
                made += 1
            near = far
        edges[v, made:] = math.nan


def most_edges(breaks: int, length: float, longest: float) -> int:
    """How many ends of panels there may be at most, with so many breaks in a range of a length."""
    return breaks + 2 + math.ceil(length / longest)


@scalar
def cosine_near_zero(x: float) -> float:
    """Cosine of an angle of at most π/4 by its series, to the last bit or two; in a loop it is vectorised."""
    z = x * x
    rest = 1 / 3628800 - z * (1 / 479001600 - z * (1 / 87178291200 - z / 20922789888000))
    return 1.0 - z * (1 / 2 - z * (1 / 24 - z * (1 / 720 - z * (1 / 40320 - z * rest))))


@scalar
def sine_near_zero(x: float) -> float:
    """Sine of an angle of at most π/4 by its series, to the last bit or two; in a loop it is vectorised."""
    z = x * x
    rest = 1 / 39916800 - z * (1 / 6227020800 - z * (1 / 1307674368000 - z / 355687428096000))
    return x * (1.0 - z * (1 / 6 - z * (1 / 120 - z * (1 / 5040 - z * (1 / 362880 - z * rest)))))


@routine
def lay_positions(
    edges: np.ndarray,
    short: float,
    outer: float,
    starts: np.ndarray,
    halves: np.ndarray,
    nodes: np.ndarray,
    cosines: np.ndarray,
    sines: np.ndarray,
) -> tuple[int, int]:
    """Lay the positions of a variant into its panels, with cosine and sine of each.

    Parameters
    ----------
    edges : ndarray (most edges,)
        As of `cut`.
    short : float
        Panels that are no longer are of the lower degree.
    outer : float
        How far positions stay from the ends of the whole range.
    starts, halves, nodes, cosines, sines : ndarray
        Receive what `Panels` holds, and the cosine and sine of each position.

    Returns
    -------
    panels, positions : int
        How many there are.
    """
    made = panel = 0
    starts[0] = 0
    while panel + 1 < edges.shape[0] and not math.isnan(edges[panel + 1]):
        near, far = edges[panel], edges[panel + 1]
        half = 0.5 * (far - near)
        degree = SHORT if half + half <= short else LONG
        middle = near + half
        before = CLEAR if panel else outer
        last = panel + 2 == edges.shape[0] or math.isnan(edges[panel + 2])
        after = outer if last else CLEAR
        for i in range(degree + 1):
            q = middle + half * PLACES[degree >> 3, i]
            nodes[made + i] = min(max(q, near + before), far - after)
        c, s = math.cos(middle), math.sin(middle)
        for k in range(made, made + degree + 1):
            x = nodes[k] - middle
            cosine, sine = cosine_near_zero(x), sine_near_zero(x)
            cosines[k], sines[k] = c * cosine - s * sine, s * cosine + c * sine
        made, halves[panel] = made + degree + 1, half
        panel += 1
        starts[panel] = made
    return panel, made


@scalar
def lay_half(panels: Panels, starts: np.ndarray, nodes: np.ndarray) -> int:
    """Starts and positions of the panels of half the degree; returns how many positions they have."""
    starts[0] = made = 0
    for p in range(panels.halves.shape[0]):
        for k in range(panels.starts[p], panels.starts[p + 1], 2):
            nodes[made] = panels.nodes[k]
            made += 1
        starts[p + 1] = made
    return made


@scalar
def halve(panels: Panels, row: np.ndarray, half: np.ndarray) -> None:
    """Copy a row at every second position of each panel into `half`."""
    made = 0
    for p in range(panels.halves.shape[0]):
        for k in range(panels.starts[p], panels.starts[p + 1], 2):
            half[made] = row[k]
            made += 1


@scalar
def integral_of(panels: Panels, row: np.ndarray) -> float:
    """Integral of a row over the range of the input."""
    total = 0.0
    for p in range(panels.halves.shape[0]):
        start = panels.starts[p]
        degree = panels.starts[p + 1] - start - 1
        part = 0.0
        for i in range(degree + 1):
            part += WEIGHTS[degree >> 3, i] * row[start + i]
        total += panels.halves[p] * part
    return total


@scalar
def integral_misfit(panels: Panels, row: np.ndarray) -> float:
    """How far integrals of polynomials of full and of half the degree are apart, panel by panel, added up."""
    total = 0.0
    for p in range(panels.halves.shape[0]):
        start = panels.starts[p]
        degree = panels.starts[p + 1] - start - 1
        fine = coarse = 0.0
        for i in range(degree + 1):
            fine += WEIGHTS[degree >> 3, i] * row[start + i]
        for i in range(degree // 2 + 1):
            coarse += WEIGHTS[degree >> 4, i] * row[start + 2 * i]
        total += abs(panels.halves[p] * (fine - coarse))
    return total


@scalar
def length_of(panels: Panels) -> float:
    """Length of the range of the input."""
    total = 0.0
    for p in range(panels.halves.shape[0]):
        total += panels.halves[p]
    return total + total


@scalar
def mean_of(panels: Panels, row: np.ndarray) -> float:
    """Mean of a row over the range of the input."""
    return integral_of(panels, row) / length_of(panels)


@routine
def accumulated(panels: Panels, row: np.ndarray, mean: float, work: np.ndarray) -> float:
    """Integral of row − mean from the first position to each, into `work`; returns that over the whole range."""
    reached = 0.0
    for p in range(panels.halves.shape[0]):
        start = panels.starts[p]
        degree = panels.starts[p + 1] - start - 1
        for i in range(degree + 1):
            part = 0.0
            for j in range(degree + 1):
                part += RUNNING[degree >> 3, i, j] * (row[start + j] - mean)
            work[start + i] = reached + panels.halves[p] * part
        reached = work[start + degree]
    return reached


# Between the positions


@scalar
def combined_at(a: np.ndarray, b: np.ndarray, slope: float, start: int, degree: int, x: float) -> float:
    """The polynomial of a − slope·b at a place x of −1 … 1 in the panel from position `start` on."""
    above = below = 0.0
    sign = 1.0
    for i in range(degree + 1):
        apart = x - PLACES[degree >> 3, i]
        value = a[start + i] - slope * b[start + i]
        if apart == 0.0:
            return value
        share = sign / apart if 0 < i < degree else 0.5 * sign / apart
        above += share * value
        below += share
        sign = -sign
    return above / below


@scalar
def vertex(xa: float, xb: float, xc: float, fa: float, fb: float, fc: float) -> float:
    """Place of the extreme of the parabola through three points; NaN of a straight line."""
    left, right = (xb - xa) * (fb - fc), (xb - xc) * (fb - fa)
    return xb - 0.5 * ((xb - xa) * left - (xb - xc) * right) / (left - right)


@scalar
def peak_near(
    a: np.ndarray, b: np.ndarray, slope: float, sign: float, start: int, degree: int, centre: int
) -> tuple[float, float]:
    """Greatest value of sign·(a − slope·b) near a position inside a panel, and its place in −1 … 1.

    Parabolas through the last three points, as long as they lead upwards.
    """
    row = degree >> 3
    xa, xb, xc = PLACES[row, centre - 1], PLACES[row, centre], PLACES[row, centre + 1]
    fa = sign * (a[start + centre - 1] - slope * b[start + centre - 1])
    fb = sign * (a[start + centre] - slope * b[start + centre])
    fc = sign * (a[start + centre + 1] - slope * b[start + centre + 1])
    best, at = fb, xb
    if fa > best:
        best, at = fa, xa
    if fc > best:
        best, at = fc, xc
    low, high = xa, xc
    for _ in range(6):
        x = vertex(xa, xb, xc, fa, fb, fc)
        if not low < x < high or x in (xa, xb, xc):
            break
        value = sign * combined_at(a, b, slope, start, degree, x)
        step = abs(x - at)
        if value >= best:
            best, at = value, x
        # The new point takes the place of the least of the three.
        if fa <= fb and fa <= fc:
            xa, fa = x, value
        elif fb <= fc:
            xb, fb = x, value
        else:
            xc, fc = x, value
        if step < FOUND:
            break
    return best, at


@scalar
def coarse_at(row: np.ndarray, start: int, degree: int, x: float) -> float:
    """The polynomial of half the degree at a place x of −1 … 1 in the panel from position `start` on."""
    above = below = 0.0
    sign = 1.0
    for i in range(0, degree + 1, 2):
        apart = x - PLACES[degree >> 3, i]
        if apart == 0.0:
            return row[start + i]
        share = sign / apart if 0 < i < degree else 0.5 * sign / apart
        above += share * row[start + i]
        below += share
        sign = -sign
    return above / below


@scalar
def panel_at(panels: Panels, at: float) -> tuple[int, float]:
    """Panel of a place of the input, and the place in its −1 … 1."""
    panel = 0
    while panel + 1 < panels.halves.shape[0] and (at - panels.nodes[panels.starts[panel + 1]]) * panels.halves[0] > 0.0:
        panel += 1
    middle = 0.5 * (panels.nodes[panels.starts[panel]] + panels.nodes[panels.starts[panel + 1] - 1])
    return panel, min(max((at - middle) / panels.halves[panel], -1.0), 1.0)


@scalar
def misfit(panels: Panels, row: np.ndarray, at: float) -> float:
    """How far a panel's polynomial and that of half its degree are apart at a place of the input."""
    panel, x = panel_at(panels, at)
    start = panels.starts[panel]
    degree = panels.starts[panel + 1] - start - 1
    return abs(combined_at(row, row, 0.0, start, degree, x) - coarse_at(row, start, degree, x))


@scalar
def root_near(panels: Panels, row: np.ndarray, at: float) -> float:
    """Place near another one where a row's polynomial is zero, by the secant rule; the same place if it leads away."""
    panel, x = panel_at(panels, at)
    start = panels.starts[panel]
    degree = panels.starts[panel + 1] - start - 1
    before, here = x - 1e-4 if x > 0.0 else x + 1e-4, x
    value_before = combined_at(row, row, 0.0, start, degree, before)
    for _ in range(4):
        value = combined_at(row, row, 0.0, start, degree, here)
        if value == value_before:
            break
        step = value * (here - before) / (value - value_before)
        before, value_before, here = here, value, here - step
        if not abs(here - x) < 1e-2:
            return at
        if abs(step) < 1e-15:
            break
    return at + panels.halves[panel] * (here - x)


@routine
def extreme(panels: Panels, a: np.ndarray, b: np.ndarray, slope: float, sign: float) -> tuple[float, float, float]:
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
    b_there : float
        b at this place.
    """
    best, spoiled = -math.inf, 0.0
    for k in range(panels.nodes.shape[0]):
        value = sign * (a[k] - slope * b[k])
        spoiled += 0.0 * value
        best = max(best, value)
    if spoiled != 0.0:
        return math.nan, math.nan, math.nan
    most, place, panel = -math.inf, 0.0, 0
    for p in range(panels.halves.shape[0]):
        start = panels.starts[p]
        degree = panels.starts[p + 1] - start - 1
        for i in range(1, degree):
            before = sign * (a[start + i - 1] - slope * b[start + i - 1])
            here = sign * (a[start + i] - slope * b[start + i])
            after = sign * (a[start + i + 1] - slope * b[start + i + 1])
            # The ends of a panel belong to the position beside them.
            top = (here >= before or i == 1) and (here >= after or i == degree - 1)
            reach = abs(before - here) + abs(after - here)
            if top and max(before, here, after) + reach >= best:
                value, x = peak_near(a, b, slope, sign, start, degree, i)
                if value > most:
                    most, place, panel = value, x, p
                    best = max(best, value)
    start = panels.starts[panel]
    degree = panels.starts[panel + 1] - start - 1
    middle = 0.5 * (panels.nodes[start] + panels.nodes[start + degree])
    there = combined_at(b, b, 0.0, start, degree, place)
    return most, middle + panels.halves[panel] * place, there
