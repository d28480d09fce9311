"""A cycle in panels: from one place where a load sets in or bends to the next, each with positions of its own.

Within a panel every row is smooth, and a polynomial through its positions follows it closely: sums over the positions
with the right weights are then integrals, however loads jump between one panel and the next. The positions of a panel
of degree d are x_i = −cos(πi/d) on [−1, 1]; every second of them makes the panel of half the degree. What a
row is between its positions is told by `engine.panels.panel_curves`.

Sources: C. W. Clenshaw and A. R. Curtis, A method for numerical integration on an automatic computer (1960);
L. N. Trefethen, Approximation Theory and Approximation Practice, ch. 19.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.jit import over_variants, routine, scalar

# Degrees of panels: of a long one, of a short one, and of half of the short one.
DEGREES = (4, 8, 16)
LONG, SHORT = 16, 8
# Positions stay this far from a panel's ends [rad]: beyond the rounding of the place where a load sets in.
CLEAR = 1e-10
# Ends that are closer than this are one.
SAME = 4.0 * CLEAR


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


@routine
def lay_half(panels: Panels, starts: np.ndarray, nodes: np.ndarray) -> int:
    """Starts and positions of the panels of half the degree; returns how many positions they have."""
    starts[0] = made = 0
    for p in range(panels.halves.shape[0]):
        for k in range(panels.starts[p], panels.starts[p + 1], 2):
            nodes[made] = panels.nodes[k]
            made += 1
        starts[p + 1] = made
    return made


@routine
def halve(panels: Panels, row: np.ndarray, half: np.ndarray) -> None:
    """Copy a row at every second position of each panel into `half`."""
    made = 0
    for p in range(panels.halves.shape[0]):
        for k in range(panels.starts[p], panels.starts[p + 1], 2):
            half[made] = row[k]
            made += 1


def _summing(degree: int) -> Callable:
    """Sums over one panel; loops whose length is known are vectorised however short they are."""
    positions = degree + 1
    fine, coarse = WEIGHTS[degree >> 3, :positions].copy(), np.zeros(positions)
    coarse[::2] = WEIGHTS[degree >> 4, : degree // 2 + 1]

    @scalar
    def sums(row: np.ndarray, start: int) -> tuple[float, float, float]:
        whole = square = half = 0.0
        for i in range(positions):
            value = row[start + i]
            whole += fine[i] * value
            square += fine[i] * value * value
            half += coarse[i] * value
        return whole, square, half

    return sums


_sums_long, _sums_short, _sums_shortest = (_summing(degree) for degree in DEGREES[::-1])


@routine
def integrals(panels: Panels, row: np.ndarray) -> tuple[float, float, float]:
    """Integrals over the range of the input, and how well they are known.

    Returns
    -------
    integral, of_square : float
        Of the row and of its square.
    misfit : float
        How far integrals of polynomials of full and of half the degree are apart, panel by panel, added up.
    """
    integral = of_square = apart = 0.0
    # Taken out of the tuple once: each time counts references.
    starts, halves = panels.starts, panels.halves
    for p in range(halves.shape[0]):
        start, positions = starts[p], starts[p + 1] - starts[p]
        if positions > LONG:
            whole, square, half = _sums_long(row, start)
        elif positions > SHORT:
            whole, square, half = _sums_short(row, start)
        else:
            whole, square, half = _sums_shortest(row, start)
        integral += halves[p] * whole
        of_square += halves[p] * square
        apart += abs(halves[p] * (whole - half))
    return integral, of_square, apart


@scalar
def integral_of(panels: Panels, row: np.ndarray) -> float:
    """Integral of a row over the range of the input."""
    return integrals(panels, row)[0]


@scalar
def integral_misfit(panels: Panels, row: np.ndarray) -> float:
    """How far integrals of polynomials of full and of half the degree are apart, panel by panel, added up."""
    return integrals(panels, row)[2]


@routine
def length_of(panels: Panels) -> float:
    """Length of the range of the input."""
    total = 0.0
    for p in range(panels.halves.shape[0]):
        total += panels.halves[p]
    return total + total


@routine
def mean_of(panels: Panels, row: np.ndarray) -> float:
    """Mean of a row over the range of the input."""
    return integral_of(panels, row) / length_of(panels)


def _accumulating(degree: int) -> Callable:
    """Running integral over one panel; loops whose length is known are vectorised however short they are."""
    positions = degree + 1
    # Of every position's share in the integrals to each: side by side those that one row's value goes into.
    shares = np.ascontiguousarray(RUNNING[degree >> 3, :positions, :positions].T)

    @scalar
    def accumulate(row: np.ndarray, mean: float, half: float, reached: float, work: np.ndarray) -> None:
        work[0] = reached
        for i in range(1, positions):
            part = 0.0
            for j in range(positions):
                part += shares[j, i] * (row[j] - mean)
            work[i] = reached + half * part

    return accumulate


_long, _short, _shortest = (_accumulating(degree) for degree in DEGREES[::-1])


@routine
def accumulated(panels: Panels, row: np.ndarray, mean: float, work: np.ndarray) -> float:
    """Integral of row − mean from the first position to each, into `work`; returns that over the whole range."""
    reached = 0.0
    for p in range(panels.halves.shape[0]):
        start, end, half = panels.starts[p], panels.starts[p + 1], panels.halves[p]
        if end - start > LONG:
            _long(row[start:end], mean, half, reached, work[start:end])
        elif end - start > SHORT:
            _short(row[start:end], mean, half, reached, work[start:end])
        else:
            _shortest(row[start:end], mean, half, reached, work[start:end])
        reached = work[end - 1]
    return reached
