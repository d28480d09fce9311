"""A cam and its follower at one position: pressure angle, curvature, motion, forces, and what they carry of rounding.

The numbers of a variant stand in a row, in the order of the constants below; what a cam doesn't have isn't read.
"""

import math

import numpy as np

from engine.compiling.decorators import routine
from engine.elements.cams.pieces import DIRECTION, motion_in, sizes_in
from engine.laws.cams.profiles import (
    arm_angles_for_pressure,
    flat_face_support,
    least_arm_angle,
    least_height,
    least_height_for_angle,
    least_height_for_curvature,
    oscillating_place,
    oscillating_pressure,
    pitch_curvature,
    rolled_back,
    translating_place,
    translating_pressure,
)
from engine.laws.rounding import EPS

# Of a translating follower DISTANCE is the offset.
BASE, SPEED, ROLLER, DISTANCE, ARM, INERTIA, PRELOAD, STIFFNESS, LOAD, FRICTION, GUIDE, OVERHANG = range(12)
LIMIT_SLOPE, LIMIT_RADIUS, WIDTH, MODULUS, POISSON = range(12, 17)
NUMBERS = 17

# What a cam is: whether its follower swings, has a flat face; 1 where an arm opens against the rotation, else −1.
SWINGS, FLAT, SENSE, DYNAMIC, LIMITED = range(5)

(
    ALPHA,
    CURVE,
    VELOCITY,
    ACCELERATION,
    JERK,
    FORCE,
    MOMENT,
    INNER,
    OUTER,
    SHORTFALL,
    GROWTH,
    FACE,
    HEIGHT_RISING,
    HEIGHT_CURVED,
    ARM_TOO_HIGH,
) = range(15)
QUANTITIES = 15
# Instead of infinity, which no polynomial follows.
NEVER = 1e300


@routine
def first_place(traits: np.ndarray, numbers: np.ndarray, row: int) -> tuple[float, float]:
    """Height or arm angle where the displacement is zero, NaN where the base circle isn't reached; its size."""
    r = numbers[row, BASE] + numbers[row, ROLLER]
    d, arm = numbers[row, DISTANCE], numbers[row, ARM]
    if traits[SWINGS] == 0:
        y = least_height(r, d)
        return y, 2.0 * r * r / y
    if traits[FLAT] == 1:
        psi = math.asin(r / d)
        # A rounding of r/d near 1 turns the face by the root of it.
        return psi, psi + min(2.0 * math.tan(psi), 2.0 / math.sqrt(EPS))
    psi = least_arm_angle(r, arm, d)
    return psi, psi + (arm * arm + d * d + r * r) / (arm * d * abs(math.sin(psi)))


@routine
def fill_cam_place(
    traits: np.ndarray,
    numbers: np.ndarray,
    row: int,
    pieces: np.ndarray,
    i: int,
    u: float,
    first: float,
    size: float,
    wanted: int,
    found: np.ndarray,
    at: int,
) -> bool:
    """Write all quantities of a position to a row of `found`, after them the magnitudes whose rounding they carry.

    Parameters
    ----------
    traits : ndarray of int
        In the order of the constants above.
    numbers : ndarray (variants, NUMBERS + …)
    row : int
        Variant.
    pieces : ndarray (pieces, PIECE_NUMBERS)
    i : int
        Piece.
    u : float
        Place in it.
    first, size : float
        From `first_place`.
    wanted : int
        The quantity that is wanted; −1 for all.
    found : ndarray (rows, 2 QUANTITIES)
    at : int
        Its row.

    Returns
    -------
    bool
        Whether there is such a position: the arm or follower is on its side of the cam.
    """
    for q in range(2 * QUANTITIES):
        found[at, q] = 0.0
    s, s1, s2, s3 = motion_in(pieces, i, u)
    m0, m1, m2, m3 = sizes_in(pieces, i)
    speed, sense = numbers[row, SPEED], float(traits[SENSE])
    y, off = first + s, size + m0
    _write(found, at, VELOCITY, speed * s1, speed * m1)
    _write(found, at, ACCELERATION, speed**2 * s2, speed**2 * m2)
    _write(found, at, JERK, speed**3 * s3, speed**3 * m3)
    if VELOCITY <= wanted <= JERK:
        return True
    reached = y > 0.0 and (traits[SWINGS] == 0 or y < math.pi)
    d, arm = numbers[row, DISTANCE], numbers[row, ARM]
    sine, cosine, alpha_off, leverage = 0.0, 1.0, 0.0, 1.0
    if traits[FLAT] == 1:
        if traits[SWINGS] == 1:
            radius, place = flat_face_support(d, y, s1, s2, sense)
            turn = 1.0 + sense * s1
            reached = reached and turn > 0.0
            spread = (off * (1.0 + s1 * s1 + abs(s2)) + m1 * (1.0 + abs(s1)) + m2) * (1.0 + abs(s1)) ** 2
            _write(found, at, CURVE, radius, abs(radius) + 8.0 * d * spread / turn**3 * (1.0 + abs(s2) / turn))
            _write(found, at, FACE, place, abs(place) + d * off / turn + d * m1 / turn**2)
            leverage = place
        else:
            _write(found, at, CURVE, y + s2, off + m2)
            _write(found, at, FACE, s1, m1)
            _write(found, at, HEIGHT_CURVED, numbers[row, LIMIT_RADIUS] - s - s2, m0 + m2 + numbers[row, LIMIT_RADIUS])
    else:
        if traits[SWINGS] == 1:
            across, along = oscillating_pressure(arm, d, y, s1, sense)
            where = oscillating_place(arm, d, y, s1, s2)
            o0 = (arm + d) * (1.0 + off)
            o1 = o0 * (1.0 + abs(s1)) + arm * m1
            o2 = o1 + arm * (2.0 * abs(s1) * m1 + m2 + (s1 * s1 + abs(s2)) * (1.0 + off)) + o0
            leverage = arm
        else:
            across, along = translating_pressure(d, y, s1)
            where = translating_place(d, y, s1, s2)
            o0, o1 = off + abs(d), off + abs(d) + m1
            o2 = o1 + m1 + m2
        square = across * across + along * along
        long = math.sqrt(square)
        sine, cosine, alpha_off = across / long, along / long, 2.0 * (o1 if traits[SWINGS] == 1 else 0.0) / long
        if traits[SWINGS] == 0:
            alpha_off = ((m1 + abs(d)) * along + abs(across) * off) / square
        alpha = math.atan2(across, along)
        _write(found, at, ALPHA, alpha, abs(alpha) + alpha_off)
        if wanted == ALPHA:
            return reached
        kappa = pitch_curvature(where, sense)
        x1, y1, x2, y2 = rolled_back(where, sense)
        spread = (o1 * (abs(x2) + abs(y2)) + (abs(x1) + abs(y1)) * o2) / (long * square)
        _write(found, at, CURVE, kappa, spread + 3.0 * abs(kappa) * (o1 * (abs(x1) + abs(y1)) / square + 1.0))
        limited = traits[LIMITED] == 1 and (wanted < 0 or wanted >= HEIGHT_RISING)
        slope, radius = numbers[row, LIMIT_SLOPE], numbers[row, LIMIT_RADIUS] + numbers[row, ROLLER]
        if limited and traits[SWINGS] == 1 and slope > 0.0:
            low, high = arm_angles_for_pressure(s1, arm, d, sense, slope)
            part = arm * abs(1.0 + sense * s1) / (d * math.sqrt(1.0 + slope * slope))
            steep = (part + arm * m1 / d) / math.sqrt(max(1.0 - part * part, EPS))
            _write(found, at, HEIGHT_RISING, low - s if low < math.inf else NEVER, m0 + math.pi + steep)
            _write(found, at, ARM_TOO_HIGH, s - high if high < math.inf else NEVER, m0 + math.pi + steep)
        elif limited and traits[SWINGS] == 0:
            if slope > 0.0:
                height = least_height_for_angle(s, s1, d, slope)
                _write(found, at, HEIGHT_RISING, height, m0 + 2.0 * (m1 + abs(d)) / slope)
            if radius > 0.0:
                height = least_height_for_curvature(s, s1, s2, d, radius)
                _write(found, at, HEIGHT_CURVED, height, 4.0 * (abs(height) + m0 + m1 + m2 + abs(d) + radius))
    if traits[DYNAMIC] == 1 and (wanted < 0 or FORCE <= wanted <= GROWTH):
        preload, c, load = numbers[row, PRELOAD], numbers[row, STIFFNESS], numbers[row, LOAD]
        inertia = numbers[row, INERTIA]
        still, impelled = preload + c * s + load, inertia * speed**2 * s2
        weight = abs(preload) + c * m0 + abs(load)
        total, spread = still + impelled, weight + inertia * speed**2 * m2
        rub = pieces[i, DIRECTION] * numbers[row, FRICTION]
        if rub != 0.0:
            rub *= 1.0 + 2.0 * max(numbers[row, OVERHANG] - s, 0.0) / numbers[row, GUIDE]
        share = cosine - rub * abs(sine)
        reached = reached and not math.isnan(share)
        force = total / (share * leverage) if share > 0.0 else NEVER
        spread_force = (spread + abs(total) * (2.0 * alpha_off * (abs(sine) + abs(rub)) / share)) / (share * leverage)
        if traits[FLAT] == 1 and traits[SWINGS] == 1:
            spread_force += abs(force) * found[at, QUANTITIES + FACE] / leverage
        moment = total * s1 * (cosine / share)
        _write(found, at, FORCE, force, spread_force)
        _write(found, at, MOMENT, moment, spread_force * cosine * leverage * abs(s1) + abs(force * leverage) * m1)
        _write(found, at, SHORTFALL, preload - total, spread + abs(preload))
        _write(found, at, GROWTH, _growth(still, inertia * s2), 0.0)
        if still > 0.0:
            found[at, QUANTITIES + GROWTH] = inertia * m2 / still + abs(found[at, GROWTH]) * weight / still
        curve, off_curve = found[at, CURVE], found[at, QUANTITIES + CURVE]
        if traits[FLAT] == 1:
            _write(found, at, INNER, force / curve, spread_force / curve + force * off_curve / curve**2)
        elif numbers[row, ROLLER] > 0.0:
            r = numbers[row, ROLLER]
            inner, outer = 1.0 / (r * (1.0 - curve * r)), 1.0 / (r * (1.0 + curve * r))
            more = abs(force) * off_curve * r * r
            _write(found, at, INNER, force * inner, abs(spread_force * inner) + more * inner**2)
            _write(found, at, OUTER, -force * outer, abs(spread_force * outer) + more * outer**2)
    return reached


@routine
def _write(found: np.ndarray, at: int, q: int, value: float, size: float) -> None:
    found[at, q] = value
    found[at, QUANTITIES + q] = size


@routine
def _growth(still: float, impelled: float) -> float:
    """What the square of the speed takes off the contact force, as a share of it at rest."""
    return -impelled / still if still > 0.0 else NEVER
