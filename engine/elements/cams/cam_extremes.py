"""Greatest and least values over the turn of a cam, with their places; the mean of its moment.

Each smooth piece is sampled at Chebyshev points, and halved until the polynomial through every other point meets the
rest. Near the samples that stand out, the extreme is then sought on the quantities themselves, by Brent's method.

Source: R. P. Brent, Algorithms for Minimization Without Derivatives, chapter 5.
"""

import math
from enum import IntEnum

import numpy as np

from engine.compiling.decorators import driver, routine
from engine.elements.cams.cam_places import (
    ACCELERATION,
    ALPHA,
    ARM_TOO_HIGH,
    CURVE,
    DYNAMIC,
    EPS,
    FACE,
    FLAT,
    FORCE,
    GROWTH,
    HEIGHT_CURVED,
    HEIGHT_RISING,
    INNER,
    JERK,
    MOMENT,
    NEVER,
    NUMBERS,
    OUTER,
    QUANTITIES,
    ROLLER,
    SHORTFALL,
    SPEED,
    VELOCITY,
    fill_cam_place,
    first_place,
)
from engine.elements.cams.pieces import (
    BETA,
    DIRECTION,
    FROM,
    KIND,
    ORIGIN,
    PIECE_NUMBERS,
    TO,
    TURN,
    cut_sections,
    motion_in,
)
from engine.laws.cams.motion_laws import DWELL
from engine.verdicts import Verdict

LAST = 16
SAMPLES = LAST + 1
# Share of a quantity's range that the coarse polynomial may miss, and how often a piece is halved for it.
COARSE, HALVINGS = 1e-3, 6
# Share of a piece to which a place is found: nearer, rounding hides the difference between values.
NEAR = 1e-8
GOLDEN = 0.5 * (3.0 - math.sqrt(5.0))
ROUNDING = 16
# Values that differ by less than this many roundings are equal.
EQUAL = 8


class TurnExtreme(IntEnum):
    """What is sought over the turn, in the order of the columns."""

    RISE_ANGLE = 0
    RISE_ANGLE_BACK = 1
    RETURN_ANGLE = 2
    RETURN_ANGLE_BACK = 3
    CURVED = 4
    HOLLOW = 5
    OUTWARDS = 6
    INWARDS = 7
    ACCELERATED = 8
    DECELERATED = 9
    JERKED = 10
    JERKED_BACK = 11
    FACE_TO = 12
    FACE_FROM = 13
    HEIGHT_FOR_ANGLE = 14
    HEIGHT_FOR_CURVATURE = 15
    ARM_ANGLE_ABOVE = 16
    PRESSED = 17
    SLACK = 18
    DRIVEN = 19
    DRIVING = 20
    INNER_FLANK = 21
    OUTER_FLANK = 22
    PRELOAD = 23
    LIFT_OFF = 24


# Of each a quantity, its sign (the greatest of it or of its negative), and in which sections: 1 for rises, −1 for
# returns, 0 for all.
_OF = {
    TurnExtreme.RISE_ANGLE: (ALPHA, 1, 1),
    TurnExtreme.RISE_ANGLE_BACK: (ALPHA, -1, 1),
    TurnExtreme.RETURN_ANGLE: (ALPHA, 1, -1),
    TurnExtreme.RETURN_ANGLE_BACK: (ALPHA, -1, -1),
    TurnExtreme.CURVED: (CURVE, 1, 0),
    TurnExtreme.HOLLOW: (CURVE, -1, 0),
    TurnExtreme.OUTWARDS: (VELOCITY, 1, 0),
    TurnExtreme.INWARDS: (VELOCITY, -1, 0),
    TurnExtreme.ACCELERATED: (ACCELERATION, 1, 0),
    TurnExtreme.DECELERATED: (ACCELERATION, -1, 0),
    TurnExtreme.JERKED: (JERK, 1, 0),
    TurnExtreme.JERKED_BACK: (JERK, -1, 0),
    TurnExtreme.FACE_TO: (FACE, 1, 0),
    TurnExtreme.FACE_FROM: (FACE, -1, 0),
    TurnExtreme.HEIGHT_FOR_ANGLE: (HEIGHT_RISING, 1, 0),
    TurnExtreme.HEIGHT_FOR_CURVATURE: (HEIGHT_CURVED, 1, 0),
    TurnExtreme.ARM_ANGLE_ABOVE: (ARM_TOO_HIGH, 1, 0),
    TurnExtreme.PRESSED: (FORCE, 1, 0),
    TurnExtreme.SLACK: (FORCE, -1, 0),
    TurnExtreme.DRIVEN: (MOMENT, 1, 0),
    TurnExtreme.DRIVING: (MOMENT, -1, 0),
    TurnExtreme.INNER_FLANK: (INNER, 1, 0),
    TurnExtreme.OUTER_FLANK: (OUTER, 1, 0),
    TurnExtreme.PRELOAD: (SHORTFALL, 1, 0),
    TurnExtreme.LIFT_OFF: (GROWTH, 1, 0),
}
SOUGHT = np.array([_OF[e] for e in TurnExtreme])
EXTREMES = len(SOUGHT)
_HEIGHTS = int(TurnExtreme.HEIGHT_FOR_ANGLE)
WITHOUT_FORCES = int(TurnExtreme.PRESSED)
# After the extremes of a variant: velocity's and acceleration's greatest jumps, the velocity's greatest drop, the mean
# moment.
VELOCITY_JUMP, ACCELERATION_JUMP, VELOCITY_DROP, MEAN_MOMENT = range(EXTREMES, EXTREMES + 4)
ANSWERS = EXTREMES + 4

_POINTS = -np.cos(np.pi * np.arange(SAMPLES) / LAST)


def _coarse_rows() -> np.ndarray:
    """What the polynomial through every other point is at the points between (Berrut and Trefethen's formula)."""
    known, between = _POINTS[::2], _POINTS[1::2]
    weights = (-1.0) ** np.arange(known.size)
    weights[[0, -1]] /= 2
    rows = weights / (between[:, None] - known)
    return rows / rows.sum(axis=1, keepdims=True)


def _integral_weights(n: int) -> np.ndarray:
    """Weights of Clenshaw and Curtis on n + 1 points, n even."""
    k = np.arange(0, n + 1, 2)
    moments = 2.0 / (1.0 - k.astype(float) ** 2)
    moments[[0, -1]] /= 2
    weights = np.cos(np.pi * np.outer(np.arange(n + 1), k) / n) @ moments * 2 / n
    weights[[0, -1]] /= 2
    return weights


_BETWEEN = _coarse_rows()
_FINE_WEIGHTS, _COARSE_WEIGHTS = _integral_weights(LAST), _integral_weights(LAST // 2)

_CANNOT_ASSEMBLE, _OUTSIDE, _OK = int(Verdict.CANNOT_ASSEMBLE), int(Verdict.OUTSIDE_LIMITS), int(Verdict.OK)
_JAMS = int(Verdict.JAMS)


@driver
def find_extremes(
    kinds: np.ndarray,
    directions: np.ndarray,
    traits: np.ndarray,
    numbers: np.ndarray,
    tabled: np.ndarray,
    values: np.ndarray,
    sizes: np.ndarray,
    places: np.ndarray,
    spreads: np.ndarray,
    verdicts: np.ndarray,
    pieces: np.ndarray,
    samples: np.ndarray,
    stack: np.ndarray,
) -> None:
    """Fill in the extremes of a set of variants.

    Parameters
    ----------
    kinds, directions, traits : ndarray of int
    numbers : ndarray (variants, NUMBERS + 2 sections)
    tabled : ndarray (pieces, PIECE_NUMBERS)
        The pieces of a table; none where there are sections.
    values, sizes, places, spreads : ndarray (variants, ANSWERS)
        To be filled: what is SOUGHT, and what else there is; magnitudes whose rounding they carry; cam angles, and what
        these may be off.
    verdicts : ndarray (variants,) of uint8
    pieces : ndarray (pieces, PIECE_NUMBERS)
    samples : ndarray (SAMPLES + 1, 2 QUANTITIES)
    stack : ndarray (2 HALVINGS + 4, 2)
        Room to work in.
    """
    for row in range(numbers.shape[0]):
        count = pieces_of_turn(kinds, directions, numbers, row, tabled, pieces)
        first, off = first_place(traits, numbers, row)
        verdicts[row] = over_turn(
            traits, numbers, row, pieces, count, first, off, values, sizes, places, spreads, samples, stack
        )


@routine
def pieces_of_turn(
    kinds: np.ndarray,
    directions: np.ndarray,
    numbers: np.ndarray,
    row: int,
    tabled: np.ndarray,
    pieces: np.ndarray,
) -> int:
    """Write a variant's pieces, of its sections or its table; how many, 0 where they don't make a turn."""
    if tabled.shape[0] == 0:
        return cut_sections(kinds, directions, numbers, row, NUMBERS, pieces)
    for i in range(tabled.shape[0]):
        for k in range(PIECE_NUMBERS):
            pieces[i, k] = tabled[i, k]
    return tabled.shape[0]


@routine
def over_turn(
    traits: np.ndarray,
    numbers: np.ndarray,
    row: int,
    pieces: np.ndarray,
    count: int,
    first: float,
    off: float,
    values: np.ndarray,
    sizes: np.ndarray,
    places: np.ndarray,
    spreads: np.ndarray,
    samples: np.ndarray,
    stack: np.ndarray,
) -> int:
    """Fill in the extremes of one variant whose displacements begin at a height or arm angle `first`; its verdict."""
    if count == 0:
        return _OUTSIDE
    if not (first > 0.0 and first < math.inf):
        return _CANNOT_ASSEMBLE
    sought = EXTREMES if traits[DYNAMIC] == 1 else WITHOUT_FORCES
    for e in range(ANSWERS):
        values[row, e], sizes[row, e], places[row, e], spreads[row, e] = -math.inf, 0.0, 0.0, 0.0
    values[row, MEAN_MOMENT] = 0.0
    _jumps(traits, numbers, row, pieces, count, values, sizes, places, spreads)
    for i in range(count):
        stack[0, 0], stack[0, 1] = pieces[i, FROM], pieces[i, TO]
        waiting = 1
        flat = int(pieces[i, KIND]) == DWELL
        while waiting > 0:
            waiting -= 1
            left, right = stack[waiting, 0], stack[waiting, 1]
            middle, half = 0.5 * (left + right), 0.5 * (right - left)
            used = 1 if flat else SAMPLES
            for k in range(used):
                u = middle + half * _POINTS[k]
                if not fill_cam_place(traits, numbers, row, pieces, i, u, first, off, -1, samples, k):
                    return _CANNOT_ASSEMBLE
                if traits[DYNAMIC] == 1 and samples[k, FORCE] == NEVER:
                    return _JAMS
            narrow = half <= 0.5 * (pieces[i, TO] - pieces[i, FROM]) * 2.0**-HALVINGS * 1.5
            if not flat and not narrow and not _resolved(row, samples, values):
                stack[waiting, 0], stack[waiting, 1] = left, middle
                stack[waiting + 1, 0], stack[waiting + 1, 1] = middle, right
                waiting += 2
                continue
            for e in range(sought):
                _see(
                    e, traits, numbers, row, pieces, i, left, right, used, first, off, samples,
                    values, sizes, places, spreads,
                )  # fmt: skip
            if not flat and traits[DYNAMIC] == 1:
                fine, coarse, size = 0.0, 0.0, 0.0
                for k in range(SAMPLES):
                    fine += _FINE_WEIGHTS[k] * samples[k, MOMENT]
                    size += _FINE_WEIGHTS[k] * samples[k, QUANTITIES + MOMENT]
                    if k % 2 == 0:
                        coarse += _COARSE_WEIGHTS[k // 2] * samples[k, MOMENT]
                share = half * pieces[i, BETA] / TURN
                values[row, MEAN_MOMENT] += share * fine
                sizes[row, MEAN_MOMENT] += share * (size + abs(fine - coarse) / (ROUNDING * EPS))
    return _OK


@routine
def _jumps(
    traits: np.ndarray,
    numbers: np.ndarray,
    row: int,
    pieces: np.ndarray,
    count: int,
    values: np.ndarray,
    sizes: np.ndarray,
    places: np.ndarray,
    spreads: np.ndarray,
) -> None:
    """Fill in the greatest jumps between pieces; such as rounding makes count as none."""
    speed, most, most2 = numbers[row, SPEED], 0.0, 0.0
    for e in (VELOCITY_JUMP, ACCELERATION_JUMP, VELOCITY_DROP):
        values[row, e] = 0.0
    for i in range(count):
        # Not the middle, where many laws have no acceleration.
        _, s1, s2, _ = motion_in(pieces, i, 0.7 * pieces[i, FROM] + 0.3 * pieces[i, TO])
        most, most2 = max(most, abs(s1)), max(most2, abs(s2))
        for end in (FROM, TO):
            _, s1, s2, _ = motion_in(pieces, i, pieces[i, end])
            most, most2 = max(most, abs(s1)), max(most2, abs(s2))
    for i in range(count):
        after = (i + 1) % count
        _, a1, a2, _ = motion_in(pieces, i, pieces[i, TO])
        _, b1, b2, _ = motion_in(pieces, after, pieces[after, FROM])
        for e, jump, limit, scale in (
            (VELOCITY_JUMP, abs(b1 - a1), most, speed),
            (VELOCITY_DROP, a1 - b1, most, speed),
            (ACCELERATION_JUMP, abs(b2 - a2), most2, speed**2),
        ):
            if jump > 1e-9 * limit and jump * scale > values[row, e]:
                values[row, e], sizes[row, e] = jump * scale, 4.0 * limit * scale
                places[row, e] = pieces[after, ORIGIN] + pieces[after, BETA] * pieces[after, FROM]


@routine
def _resolved(row: int, samples: np.ndarray, values: np.ndarray) -> bool:
    """Whether polynomials of half the degree follow all quantities; heights matter where they may be the greatest."""
    for q in range(QUANTITIES):
        low = high = samples[0, q]
        great = 0.0
        for k in range(SAMPLES):
            low, high = min(low, samples[k, q]), max(high, samples[k, q])
            great = max(great, samples[k, QUANTITIES + q])
        so_far = values[row, _HEIGHTS + q - HEIGHT_RISING] if q >= HEIGHT_RISING else -math.inf
        if high + 0.25 * (high - low) < so_far or high == NEVER:
            continue
        allowed = COARSE * (high - low) + 1e3 * EPS * great
        for b in range(LAST // 2):
            guess = 0.0
            for k in range(LAST // 2 + 1):
                guess += _BETWEEN[b, k] * samples[2 * k, q]
            if abs(guess - samples[2 * b + 1, q]) > allowed:
                return False
    return True


@routine
def _see(
    e: int,
    traits: np.ndarray,
    numbers: np.ndarray,
    row: int,
    pieces: np.ndarray,
    i: int,
    left: float,
    right: float,
    used: int,
    first: float,
    off: float,
    samples: np.ndarray,
    values: np.ndarray,
    sizes: np.ndarray,
    places: np.ndarray,
    spreads: np.ndarray,
) -> None:
    """Compare one of the extremes so far with a sampled stretch of a piece."""
    q, sign, where = SOUGHT[e, 0], float(SOUGHT[e, 1]), float(SOUGHT[e, 2])
    if where != 0.0 and where != pieces[i, DIRECTION]:
        return
    if (q == FACE and traits[FLAT] == 0) or (q == OUTER and numbers[row, ROLLER] == 0.0):
        return
    middle, half = 0.5 * (left + right), 0.5 * (right - left)
    for k in range(used):
        value, size = sign * samples[k, q], samples[k, QUANTITIES + q]
        # Of equals the first is told, whatever rounding makes of them.
        if not value > values[row, e] + EQUAL * EPS * size:
            continue
        values[row, e], sizes[row, e] = value, size
        places[row, e] = pieces[i, ORIGIN] + pieces[i, BETA] * (middle + half * _POINTS[k])
        spreads[row, e] = ROUNDING * EPS * TURN
    if used == 1:
        return
    for k in range(SAMPLES):
        # A stretch of three samples whose middle stands out, or in which a parabola does beside the piece's end.
        j = min(max(k, 1), LAST - 1)
        xa, xb, xc = _POINTS[j - 1], _POINTS[j], _POINTS[j + 1]
        fa, fb, fc = sign * samples[j - 1, q], sign * samples[j, q], sign * samples[j + 1, q]
        bend = ((fc - fb) / (xc - xb) - (fb - fa) / (xb - xa)) / (xc - xa)
        if not bend < 0.0:
            continue
        top = 0.5 * (xa + xb) - (fb - fa) / (xb - xa) / (2.0 * bend)
        low, high = xa, xc
        if k == 0:
            high = xb
        elif k == LAST:
            low = xb
        if not low < top < high or (k == j and not (fb >= fa and fb >= fc)):
            continue
        rise = fb - bend * (top - xb) ** 2
        if not rise + 4.0 * (rise - max(fa, fb, fc)) > values[row, e]:
            continue
        u, value, size = _top(
            q, sign, traits, numbers, row, pieces, i, middle + half * low, middle + half * top, middle + half * high,
            first, off, samples,
        )  # fmt: skip
        margin = EQUAL * EPS * size
        beta = pieces[i, BETA]
        found = pieces[i, ORIGIN] + beta * u
        near = abs(places[row, e] - found) <= beta * half * (high - low)
        higher = value > values[row, e] + margin
        if higher or (near and value > values[row, e] - margin):
            flat = half * math.sqrt(ROUNDING * EPS * size / -bend)
            spread = beta * (2.0 * flat + 4.0 * NEAR * (pieces[i, TO] - pieces[i, FROM]))
            # Between two places of equal height, as at the end of a rise that begins very gently, either may be it.
            spreads[row, e] = spread if higher else spread + abs(found - places[row, e])
            values[row, e], sizes[row, e], places[row, e] = value, size, found


@routine
def _top(
    q: int,
    sign: float,
    traits: np.ndarray,
    numbers: np.ndarray,
    row: int,
    pieces: np.ndarray,
    i: int,
    low: float,
    start: float,
    high: float,
    first: float,
    off: float,
    samples: np.ndarray,
) -> tuple[float, float, float]:
    """Place, value and size of a maximum in a bracket, by Brent's method."""
    near = NEAR * (pieces[i, TO] - pieces[i, FROM])
    a, b, x = low, high, start
    fill_cam_place(traits, numbers, row, pieces, i, x, first, off, q, samples, SAMPLES)
    fx, size = sign * samples[SAMPLES, q], samples[SAMPLES, QUANTITIES + q]
    w, v, fw, fv = x, x, fx, fx
    before, step = 0.0, 0.0
    for _ in range(80):
        middle = 0.5 * (a + b)
        if abs(x - middle) <= 2.0 * near - 0.5 * (b - a):
            break
        golden = True
        if abs(before) > near:
            r, t = (x - w) * (fv - fx), (x - v) * (fw - fx)
            p, d = (x - v) * t - (x - w) * r, 2.0 * (t - r)
            if d > 0.0:
                p = -p
            d = abs(d)
            last, before = before, step
            if abs(p) < abs(0.5 * d * last) and a * d < x * d + p < b * d:
                step = p / d
                golden = False
                if x + step - a < 2.0 * near or b - x - step < 2.0 * near:
                    step = near if x < middle else -near
        if golden:
            before = (b - x) if x < middle else (a - x)
            step = GOLDEN * before
        new = x + (step if abs(step) >= near else (near if step > 0.0 else -near))
        fill_cam_place(traits, numbers, row, pieces, i, new, first, off, q, samples, SAMPLES)
        value = sign * samples[SAMPLES, q]
        if value >= fx:
            if new >= x:
                a = x
            else:
                b = x
            v, fv, w, fw = w, fw, x, fx
            x, fx, size = new, value, samples[SAMPLES, QUANTITIES + q]
        else:
            if new < x:
                a = new
            else:
                b = new
            if value >= fw or w == x:
                v, fv, w, fw = w, fw, new, value
            elif value >= fv or v in (x, w):
                v, fv = new, value
    return x, fx, size
