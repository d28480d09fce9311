"""Sums and extremes of a row over panels, its strokes and its flywheel.

Each function is what that of `engine.equal_positions.rows`, `engine.equal_positions.strokes`, … by the same name is
for equally spaced positions, with the panels as its first argument.

Integrals are those of the panels' polynomials, and extremes are searched between the positions too. What a number may
be off by is then its change from the panels of half the degree; the functions that tell of jumps hidden between
positions have nothing to tell, because panels end at jumps.
"""

import math

import numpy as np

from engine.compiling.jit import routine, scalar
from engine.equal_positions import flywheel as by_positions
from engine.equal_positions.efficiency import first_jammed as by_index
from engine.equal_positions.rows import greatest, is_finite, least
from engine.panels.panel_curves import combined_at, extreme, misfit, panel_at, root_near
from engine.panels.panels import (
    CLEAR,
    WEIGHTS,
    Panels,
    accumulated,
    integral_misfit,
    integral_of,
    integrals,
    length_of,
    mean_of,
)

EPS = float(np.finfo(np.float64).eps)
# Newton's rule ends when a step was this share: the next would be about its square.
ENOUGH = 1e-9

__all__ = [
    "cumulative_work",
    "derivative_residual",
    "extreme_of",
    "first_jammed",
    "fluctuation_with_flywheel",
    "flywheel_sizes",
    "mean_of",
    "means",
    "missed_extreme",
    "order_of",
    "place_of_extreme",
    "roughness",
    "stroke_ends",
    "swing_ends",
    "work_doubt",
    "work_over",
]


@routine
def signed_extreme(panels: Panels, row: np.ndarray, sign: float) -> tuple[float, float]:
    """Greatest (sign +1) or least (−1) value of a row, and how far polynomials of full and half the degree are apart.

    Of what comes near to zero without becoming negative, as the magnitude of a force does, the square is followed: it
    is smooth where the magnitude has a corner.
    """
    low, high = least(row), greatest(row)
    if not is_finite(low + high):
        return math.nan, math.nan
    followed = 0.0 <= low < 0.3 * high
    squares = row * row if followed else row
    value, at = extreme(panels, squares, squares, 0.0, sign)
    apart, value = misfit(panels, squares, squares, 0.0, at), sign * value
    if not followed:
        return value, apart
    # Squares round by their greatest, and roots of small ones magnify that.
    value, apart = max(value, 0.0), apart + 32.0 * EPS * high * high
    return math.sqrt(value), math.sqrt(value + apart) - math.sqrt(max(value - apart, 0.0))


@scalar
def unseen(panels: Panels, row: np.ndarray) -> float:
    """How much a row changes between the last position of a panel and its end, at most."""
    steepest = 0.0
    for p in range(panels.halves.shape[0]):
        first, last = panels.starts[p], panels.starts[p + 1] - 1
        rise = (row[first + 1] - row[first]) / (panels.nodes[first + 1] - panels.nodes[first])
        fall = (row[last] - row[last - 1]) / (panels.nodes[last] - panels.nodes[last - 1])
        steepest = max(steepest, abs(rise), abs(fall))
    return 2.0 * CLEAR * steepest


@routine
def extreme_of(panels: Panels, row: np.ndarray, sign: float, periodic: bool) -> tuple[float, float]:
    """Greatest (sign +1) or least (−1) value of a row, and what it may be off by.

    That is what the row still changes between a panel's last position and its end, and by how much the polynomials of
    the full and of half the degree are apart at the extreme.
    """
    value, apart = signed_extreme(panels, row, sign)
    return value, max(apart, unseen(panels, row))


@routine
def means(panels: Panels, row: np.ndarray, step: int, periodic: bool) -> tuple[float, float]:
    """Mean and root-mean-square value of a row; every `step`-th position would have panels of its own."""
    length = length_of(panels)
    integral, of_square, _ = integrals(panels, row)
    mean = integral / length
    return mean, math.sqrt(max(of_square / length, 0.0)) if is_finite(mean) else math.nan


@routine
def roughness(panels: Panels, row: np.ndarray, periodic: bool) -> float:
    """By how much the integrals of the polynomials of full and half the degree are apart.

    In the measure of `engine.equal_positions.rows.roughness`: of a jump, spread over the mean of all positions.
    """
    return 2.0 * integrals(panels, row)[2] / length_of(panels) * row.shape[0]


@routine
def place_of_extreme(
    panels: Panels, row: np.ndarray, sign: float, first: float, h: float, periodic: bool, rounding: float
) -> tuple[float, float]:
    """Where a row is greatest (sign +1) or least (−1), and its doubt.

    Around its extreme the row changes by no more than its rounding, as a parabola would; and every other position that
    comes as near to the value as the panels' polynomials are sure of may be meant.
    """
    if not is_finite(least(row) + greatest(row)):
        return math.nan, math.nan
    value, at = extreme(panels, row, row, 0.0, sign)
    unsure = misfit(panels, row, row, 0.0, at) + rounding * max(abs(greatest(row)), abs(least(row)))
    panel, x = panel_at(panels, at)
    half = panels.halves[panel]
    drop = value - sign * combined_at(panels, row, row, 0.0, at + half * (-0.01 if x > 0.0 else 0.01))
    doubt = 0.01 * abs(half) * (math.sqrt(unsure / drop) if drop > unsure else 1.0)
    for k in range(row.shape[0]):
        if value - sign * row[k] <= unsure:
            doubt = max(doubt, abs(panels.nodes[k] - at))
    return at, doubt


@routine
def stroke_ends(
    panels: Panels, d: np.ndarray, v: np.ndarray, start: float, h: float, periodic: bool
) -> tuple[float, float, float, float]:
    """Lowest and highest value of a coordinate, and where it takes them."""
    low, low_at = extreme(panels, d, d, 0.0, -1.0)
    high, high_at = extreme(panels, d, d, 0.0, 1.0)
    if not is_finite(high):
        return math.nan, math.nan, math.nan, math.nan
    # The place where the velocity is zero is known better than the one where the coordinate hardly changes.
    return -low, high, root_near(panels, v, low_at), root_near(panels, v, high_at)


@routine
def swing_ends(
    panels: Panels, c: np.ndarray, s: np.ndarray, w: np.ndarray, start: float, h: float, periodic: bool
) -> tuple[float, float, float, float]:
    """Extreme angles of a rocker [rad], and where it takes them; NaN for a link that turns all the way round."""
    turned = integral_of(panels, w)
    if not is_finite(turned) or (periodic and abs(turned) > math.pi):
        return math.nan, math.nan, math.nan, math.nan
    angle = np.empty_like(c)
    angle[0] = math.atan2(s[0], c[0])
    for k in range(1, c.shape[0]):
        angle[k] = angle[k - 1] + math.atan2(s[k] * c[k - 1] - c[k] * s[k - 1], c[k] * c[k - 1] + s[k] * s[k - 1])
    return stroke_ends(panels, angle, w, start, h, periodic)


@scalar
def turned(cosine: float, sine: float, times: int) -> tuple[float, float]:
    """Cosine and sine of a whole multiple of an angle, from those of the angle."""
    c, s = cosine, sine
    for _ in range(times - 1):
        c, s = c * cosine - s * sine, s * cosine + c * sine
    return c, s


@routine
def order_of(
    panels: Panels, x: np.ndarray, y: np.ndarray, order: int, cosines: np.ndarray, sines: np.ndarray
) -> tuple[float, float]:
    """Longer half axis of the ellipse that one order of a plane vector draws, and the mean size of its terms.

    Cosines and sines are those of the panels' nodes, or of panels of which these have half the degree.
    """
    starts, halves = panels.starts, panels.halves
    whole = cosines.shape[0] == x.shape[0]
    xc = xs = yc = ys = terms = 0.0
    for p in range(halves.shape[0]):
        start, degree = starts[p], starts[p + 1] - starts[p] - 1
        for i in range(degree + 1):
            k, share = start + i, halves[p] * WEIGHTS[degree >> 3, i]
            # A panel of twice the degree has a position less than twice as many.
            place = k if whole else 2 * k - p
            c, s = turned(cosines[place], sines[place], order)
            xc, xs, yc, ys = xc + share * x[k] * c, xs + share * x[k] * s, yc + share * y[k] * c, ys + share * y[k] * s
            terms += share * (abs(x[k]) + abs(y[k]))
    forward, backward = math.hypot(xc + ys, yc - xs), math.hypot(xc - ys, yc + xs)
    length = length_of(panels)
    return (forward + backward) / length, terms / length


@routine
def first_jammed(panels: Panels, margin: np.ndarray, least_margin: float) -> float:
    """Where a group's friction jams first; NaN if it never does."""
    k = by_index(margin, least_margin)
    return math.nan if math.isnan(k) else panels.nodes[int(k)]


# Work over the cycle, and the flywheel


@scalar
def cumulative_work(panels: Panels, moment: np.ndarray, mean: float, h: float, work: np.ndarray) -> None:
    """Work of the moments and of the driver's −mean from the first position, into `work` [J]."""
    accumulated(panels, moment, mean, work)


@routine
def work_over(panels: Panels, moment: np.ndarray, h: float, periodic: bool) -> tuple[float, float]:
    """Work of a moment over the range of the input, by magnitude [J], and its doubt."""
    return abs(integral_of(panels, moment)), integral_misfit(panels, moment)


@routine
def work_doubt(panels: Panels, moment: np.ndarray, h: float) -> float:
    """How much the work of a moment may be off within panels, and by rounding [J]."""
    _, of_square, apart = integrals(panels, moment)
    length = length_of(panels)
    # A mean magnitude is no greater than the root of the mean square.
    rounding = 16.0 * EPS * math.sqrt(max(of_square, 0.0) * length)
    # The ends of panels, where positions keep clear of a jump, weigh 1/63 of a panel at most.
    return apart + rounding + length / 63.0 * unseen(panels, moment)


@routine
def missed_extreme(panels: Panels, inertia: np.ndarray, work: np.ndarray, slope: float) -> float:
    """How far extremes of W − slope·I may be off within panels, and by rounding [J]."""
    apart, varying = 0.0, inertia - inertia[0]
    for sign in (1.0, -1.0):
        _, at = extreme(panels, work, varying, slope, sign)
        apart = max(apart, misfit(panels, work, varying, slope, at))
    return apart + 16.0 * EPS * (max(greatest(work), -least(work)) + slope * greatest(inertia))


@routine
def derivative_residual(panels: Panels, row: np.ndarray, derivative: np.ndarray, h: float) -> float:
    """How far a row is from the integral of its derivative, relative to the range times the greatest derivative."""
    reached = np.empty_like(row)
    accumulated(panels, derivative, 0.0, reached)
    worst = largest = 0.0
    for k in range(row.shape[0]):
        worst = max(worst, abs(row[k] - row[0] - reached[k]))
        largest = max(largest, abs(derivative[k]))
    return worst / (largest * length_of(panels)) if largest > 0.0 else worst


@routine
def flywheel_sizes(
    panels: Panels, inertia: np.ndarray, work: np.ndarray, omega: float, delta: float, first_kind: float
) -> tuple[float, float, float, float]:
    """Excess work [J] and the flywheel's inertia by three methods [kg·m²]; as of `equal_positions.flywheel`."""
    slow, middle, fast = by_positions.energy_slopes(omega, delta)
    varying, denominator = inertia - inertia[0], delta * omega * omega
    excess = extreme(panels, work, varying, 0.0, 1.0)[0] + extreme(panels, work, varying, 0.0, -1.0)[0]
    merzalov = extreme(panels, work, varying, middle, 1.0)[0] + extreme(panels, work, varying, middle, -1.0)[0]
    wittenbauer = extreme(panels, work, varying, fast, 1.0)[0] + extreme(panels, work, varying, slow, -1.0)[0]
    return (
        excess,
        excess / denominator,
        merzalov / denominator - first_kind,
        wittenbauer / denominator - inertia[0],
    )


@routine
def fluctuation_with_flywheel(
    panels: Panels, inertia: np.ndarray, work: np.ndarray, flywheel: float, omega: float
) -> tuple[float, float]:
    """Initial energy [J] and coefficient of speed fluctuation of the steady cycle with a given flywheel.

    Wittenbauer's tangents turned round: for the δ sought the flywheel they ask for is the one there is. From δ of the
    positions on, Newton's rule; as δ grows, a tangent's slope ½ω_m²(1 ± δ/2)² does, and the work above it falls by
    the inertia at the place where it touches.
    """
    _, delta = by_positions.fluctuation_with_flywheel(inertia, work, flywheel, omega)
    varying, heavy, square = inertia - inertia[0], inertia[0] + flywheel, omega * omega
    above = 0.0
    for _ in range(8):
        slow, _, fast = by_positions.energy_slopes(omega, delta)
        above, fast_at = extreme(panels, work, varying, fast, 1.0)
        below, slow_at = extreme(panels, work, varying, slow, -1.0)
        at_fast = combined_at(panels, varying, varying, 0.0, fast_at)
        at_slow = combined_at(panels, varying, varying, 0.0, slow_at)
        excess = above + below - heavy * square * delta
        steepness = 0.5 * square * (at_fast * (1.0 + 0.5 * delta) + at_slow * (1.0 - 0.5 * delta)) + heavy * square
        step = excess / steepness
        delta += step
        if not abs(step) > ENOUGH * abs(delta):
            break
    if not 0.0 <= delta < 2.0:
        return math.nan, math.nan
    _, _, fast = by_positions.energy_slopes(omega, delta)
    return fast * heavy - above, delta
