"""A plate on three bars, tracked along its crank with 50 digits, by the lengths of the bars.

The unknowns are the plate's position and direction; the equations are |P − F|² = l² of its three bars. Only the
geometry is shared with the engine.
"""

from collections.abc import Sequence
from decimal import Decimal, localcontext
from typing import NamedTuple

import mpmath

DIGITS = 50
# Maximum first correction [m, rad], and factor by which each must be shorter than the one before it.
_LONGEST, _SHORTER = Decimal("0.02"), Decimal("0.2")
# A correction after which only rounding remains, as errors decrease quadratically.
_LAST = Decimal(10) ** -26
# Halvings of a step before a path ends.
_HALVINGS = 30
# Minimum share of the determinant that remains after a step.
_LEAST_SHARE = Decimal("0.2")

Pair = tuple[Decimal, Decimal]


class ExactTriad(NamedTuple):
    """A plate on three bars.

    Attributes
    ----------
    corners : tuple of (Decimal, Decimal)
        The plate's joints in its own axes; the first belongs to the bar on the crank.
    pivots : tuple of (Decimal, Decimal)
        Frame joints of the second and the third bar; the crank turns about the origin.
    lengths : tuple of Decimal
    crank : Decimal
    """

    corners: tuple[Pair, ...]
    pivots: tuple[Pair, ...]
    lengths: tuple[Decimal, ...]
    crank: Decimal


class Pose(NamedTuple):
    """Position and direction of the plate."""

    x: Decimal
    y: Decimal
    c: Decimal
    s: Decimal


class ExactPath(NamedTuple):
    """A path over a turn.

    Attributes
    ----------
    poses : list of Pose
        At each of the steps until it ends.
    lost_at : Decimal or None
        Share of the turn at which two modes meet.
    """

    poses: list[Pose]
    lost_at: Decimal | None


def _equations(triad: ExactTriad, pose: Pose, pin: Pair) -> tuple[list[Decimal], list[tuple], list[Pair]]:
    """Residuals of the bar lengths, their derivatives by the unknowns, and the bars."""
    x, y, c, s = pose
    misses, rows, bars = [], [], []
    for (u, v), (fx, fy), length in zip(triad.corners, (pin, *triad.pivots), triad.lengths, strict=True):
        ax, ay = c * u - s * v, s * u + c * v
        dx, dy = x + ax - fx, y + ay - fy
        misses.append((dx * dx + dy * dy - length * length) / 2)
        rows.append((dx, dy, dy * ax - dx * ay))
        bars.append((dx, dy))
    return misses, rows, bars


def solved_triple(rows: Sequence[tuple], right: Sequence) -> tuple[tuple, object]:
    """Solution of three linear equations in any number type, and their determinant."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    m0, m1, m2 = e * i - f * h, f * g - d * i, d * h - e * g
    whole = a * m0 + b * m1 + c * m2
    p, q, r = right
    return (
        (p * m0 + q * (c * h - b * i) + r * (b * f - c * e)) / whole,
        (p * m1 + q * (a * i - c * g) + r * (c * d - a * f)) / whole,
        (p * m2 + q * (b * g - a * h) + r * (a * e - b * d)) / whole,
    ), whole


def _moved(pose: Pose, by: Sequence[Decimal]) -> Pose:
    t = by[2] / 2
    per = 1 / (1 + t * t)
    cosine, sine = (1 - t * t) * per, 2 * t * per
    return Pose(pose.x + by[0], pose.y + by[1], pose.c * cosine - pose.s * sine, pose.s * cosine + pose.c * sine)


def corrected(triad: ExactTriad, pose: Pose, pin: Pair) -> tuple[Pose, Decimal] | None:
    """The root near a pose and the determinant there; None if corrections don't decrease as they do near a root."""
    before = _LONGEST / _SHORTER
    while True:
        misses, rows, _ = _equations(triad, pose, pin)
        step, determinant = solved_triple(rows, [-miss for miss in misses])
        size = max(abs(part) for part in step)
        if not size <= _SHORTER * before:
            return None
        pose, before = _moved(pose, step), size
        if size < _LAST:
            return pose, determinant


def followed_exactly(triad: ExactTriad, start: Pose, steps: int) -> ExactPath:
    """A mode over a turn in equal steps, halved where corrections don't decrease as they do near a root.

    Parameters
    ----------
    triad : ExactTriad
    start : Pose
        Near the mode at the first position, where the crank is on the x axis.
    steps : int
    """
    with localcontext() as context, mpmath.workdps(DIGITS + 5):
        context.prec = DIGITS
        whole = 2 * mpmath.pi / steps
        turns = [whole / 2**k for k in range(_HALVINGS + 1)]
        spans = [(Decimal(str(t)), Decimal(str(mpmath.cos(t))), Decimal(str(mpmath.sin(t)))) for t in turns]
        c, s = Decimal(1), Decimal(0)
        found = corrected(triad, start, (triad.crank, Decimal(0)))
        assert found is not None, "a mode begins at a root"
        pose, determinant = found
        poses, rate, old, halved, done = [pose], None, None, 0, 0
        left = 1 << _HALVINGS
        while len(poses) <= steps:
            if rate is None:
                _, rows, bars = _equations(triad, pose, (triad.crank * c, triad.crank * s))
                # The pin moves perpendicular to the crank; only the first bar depends on it.
                miss = triad.crank * (bars[0][1] * c - bars[0][0] * s)
                rate, _ = solved_triple(rows, (miss, Decimal(0), Decimal(0)))
            h, cosine, sine = spans[halved]
            bend = Decimal(0) if old is None else h * h / (2 * old[1])
            guess = [h * v + bend * (v - (v if old is None else old[0][i])) for i, v in enumerate(rate)]
            ahead = (c * cosine - s * sine, s * cosine + c * sine)
            tried = corrected(triad, _moved(pose, guess), (triad.crank * ahead[0], triad.crank * ahead[1]))
            if tried is None or tried[1] / determinant < _LEAST_SHARE:
                halved += 1
                if halved > _HALVINGS:
                    return ExactPath(poses, (done + 1 - Decimal(left) / (1 << _HALVINGS)) / steps)
                continue
            (pose, determinant), (c, s), old, rate = tried, ahead, (rate, h), None
            left -= 1 << (_HALVINGS - halved)
            if left == 0:
                poses.append(pose)
                left, done = 1 << _HALVINGS, done + 1
            # Return to a longer step if it ends on the grid of steps.
            if halved and left % (1 << (_HALVINGS - halved + 1)) == 0:
                halved -= 1
        return ExactPath(poses, None)
