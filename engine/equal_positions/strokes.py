"""Ends of stroke: the dead centres of a slider or rocker, its stroke, and the strokes of an engine's cycle."""

import math

import numpy as np

from engine.compiling.jit import scalar
from engine.equal_positions.rows import is_finite, mean_of


@scalar
def extreme_between(d0: float, d1: float, v0: float, v1: float, h: float) -> tuple[float, float]:
    """Extreme of the cubic through two positions with given values and derivatives.

    Parameters
    ----------
    d0, d1 : float
        Values at the ends of the interval.
    v0, v1 : float
        Derivatives there, of opposite signs.
    h : float
        Length of the interval.

    Returns
    -------
    t : float
        Place of the extreme as a fraction of the interval.
    d : float
        Its value; the error is (h⁴/384) max|d⁗|.
    """
    m0, m1, rise = h * v0, h * v1, d1 - d0
    a = 3.0 * (m0 + m1 - 2.0 * rise)
    half_b = 3.0 * rise - 2.0 * m0 - m1
    if m0 == 0.0:
        return 0.0, d0
    root = math.sqrt(max(half_b * half_b - a * m0, 0.0))
    # The root of a t² + 2 half_b t + m0 in (0, 1), in the form that doesn't subtract nearly equal numbers.
    if m0 > 0.0:
        t = m0 / (root - half_b) if half_b <= 0.0 else -(half_b + root) / a
    else:
        t = -m0 / (root + half_b) if half_b >= 0.0 else (root - half_b) / a
    return t, d0 + t * (m0 + t * (half_b + t * a / 3.0))


@scalar
def cubic_doubt(
    v: np.ndarray, start: float, h: float, at: float, rounded: float, periodic: bool
) -> tuple[float, float]:
    """How far the cubic of `extreme_between` may be off, from the third differences of the derivative about it.

    Parameters
    ----------
    v : ndarray (positions,)
        Derivative by q at equally spaced positions.
    start, h : float
        First position and spacing.
    at : float
        Place of the extreme.
    rounded : float
        What values may be off by rounding.
    periodic : bool
        Whether the last position is followed by the first.

    Returns
    -------
    value, place : float
        (h⁴/384) |d⁗|, and (h³/124.7) |d⁗/d″| with what rounding moves a place where d is flat; NaN where the place is.
    """
    n = v.shape[0]
    if not is_finite(at):
        return math.nan, math.nan
    k, third = int((at - start) / h), 0.0
    for i in range(k - 2, k + 1):
        if periodic or 0 <= i < n - 3:
            a, b, c, d = v[i % n], v[(i + 1) % n], v[(i + 2) % n], v[(i + 3) % n]
            third = max(third, abs(3.0 * (b - c) + (d - a)))
    bend = abs(v[(k + 1) % n] - v[k % n])
    return h * third / 384.0, (h * third / 124.7 + rounded) / bend if bend > 0.0 else 0.0


@scalar
def stroke_ends(
    d: np.ndarray, v: np.ndarray, start: float, h: float, periodic: bool
) -> tuple[float, float, float, float]:
    """Lowest and highest value of a coordinate over the cycle, and where it takes them.

    Parameters
    ----------
    d, v : ndarray (positions,)
        Coordinate and its derivative by q at equally spaced positions.
    start, h : float
        First position and spacing.
    periodic : bool
        Whether the last position is followed by the first.

    Returns
    -------
    low, high : float
        [unit of d]; NaN where any position is.
    low_at, high_at : float
        Positions, the unit of h.
    """
    n = d.shape[0]
    if not is_finite(mean_of(d) + mean_of(v)):
        return math.nan, math.nan, math.nan, math.nan
    low = high = d[0]
    low_at = high_at = start
    last = n if periodic else n - 1
    for k in range(last):
        after = k + 1 if k + 1 < n else 0
        if (v[k] > 0.0) != (v[after] > 0.0):
            t, extreme = extreme_between(d[k], d[after], v[k], v[after], h)
            if extreme < low:
                low, low_at = extreme, start + (k + t) * h
            if extreme > high:
                high, high_at = extreme, start + (k + t) * h
    if not periodic:
        if d[n - 1] < low:
            low, low_at = d[n - 1], start + last * h
        if d[n - 1] > high:
            high, high_at = d[n - 1], start + last * h
    return low, high, low_at, high_at


@scalar
def angle_near(c: float, s: float, guess: float) -> float:
    """Angle of a direction, of all that differ by full turns the one nearest to a guess [rad]."""
    turn = 2.0 * math.pi
    angle = math.atan2(s, c)
    return angle + turn * math.floor((guess - angle) / turn + 0.5)


@scalar
def swing_ends(
    c: np.ndarray, s: np.ndarray, w: np.ndarray, start: float, h: float, periodic: bool
) -> tuple[float, float, float, float]:
    """Extreme angles of a rocker, and where it takes them; NaN for a link that turns all the way round.

    Angles are made only where the rocker turns back: in between the sum of its angular velocity tells the turn.

    Parameters
    ----------
    c, s, w : ndarray (positions,)
        Cosine and sine of the link's angle, and the angle's derivative by q.
    start, h : float
        First position and spacing.
    periodic : bool
        Whether the last position is followed by the first.

    Returns
    -------
    low, high : float
        [rad]; NaN where any position is.
    low_at, high_at : float
        Positions, the unit of h.
    """
    n = c.shape[0]
    mean = mean_of(w)
    if not is_finite(mean + mean_of(c) + mean_of(s)) or (periodic and abs(mean) * n * h > math.pi):
        return math.nan, math.nan, math.nan, math.nan
    about = low = high = math.atan2(s[0], c[0])
    low_at = high_at = start
    last = n if periodic else n - 1
    for k in range(last):
        after = k + 1 if k + 1 < n else 0
        turned = 0.5 * h * (w[k] + w[after])
        if (w[k] > 0.0) != (w[after] > 0.0):
            angle = angle_near(c[k], s[k], about)
            t, extreme = extreme_between(angle, angle_near(c[after], s[after], angle), w[k], w[after], h)
            if extreme < low:
                low, low_at = extreme, start + (k + t) * h
            if extreme > high:
                high, high_at = extreme, start + (k + t) * h
        about += turned
    if not periodic:
        angle = angle_near(c[n - 1], s[n - 1], about)
        if angle < low:
            low, low_at = angle, start + last * h
        if angle > high:
            high, high_at = angle, start + last * h
    return low, high, low_at, high_at


@scalar
def quick_return_ratio(low_at: float, high_at: float) -> float:
    """Quick-return ratio: crank angle of the slow stroke over that of the fast one, at least 1.

    Parameters
    ----------
    low_at, high_at : float
        Crank angles of the two dead centres [rad].
    """
    turn = 2.0 * math.pi
    up = (high_at - low_at) % turn
    return max(up, turn - up) / min(up, turn - up)


@scalar
def four_stroke_number(head_at: float, firing: float, forward: float, phi: float, toward_head: bool) -> int:
    """Which stroke of a four-stroke engine: 0 power, 1 exhaust, 2 intake, 3 compression.

    Parameters
    ----------
    head_at : float
        Crank angle of a head-end dead centre [rad].
    firing : float
        The power stroke begins at the first head-end dead centre that follows this angle [rad].
    forward : float
        Sign of the crank's speed.
    phi : float
        Crank angle [rad].
    toward_head : bool
        Whether the piston moves towards the head.
    """
    turn = 2.0 * math.pi
    # A dead centre within rounding of the firing angle is meant, not the one a whole turn later.
    turns_to_fire = math.ceil(forward * (firing - head_at) / turn - 1e-6)
    since = forward * (phi - head_at) / turn - turns_to_fire
    first_turn = math.floor(since) % 2 == 0
    if first_turn:
        return 1 if toward_head else 0
    return 3 if toward_head else 2


@scalar
def two_stroke_number(toward_head: bool) -> int:
    """Which stroke of a two-stroke engine: 0 power, 1 compression."""
    return 1 if toward_head else 0


@scalar
def unwrap_angle(c: np.ndarray, s: np.ndarray, angle: np.ndarray) -> None:
    """Angle of a link as a continuous function of the position, written into `angle`.

    Parameters
    ----------
    c, s : ndarray (positions,)
        Cosine and sine of the link's angle.
    angle : ndarray (positions,)
        Receives the angle [rad], starting in (−π, π]; each step turns by less than half a revolution.
    """
    angle[0] = math.atan2(s[0], c[0])
    for k in range(1, c.shape[0]):
        turned = math.atan2(s[k] * c[k - 1] - c[k] * s[k - 1], c[k] * c[k - 1] + s[k] * s[k - 1])
        angle[k] = angle[k - 1] + turned
