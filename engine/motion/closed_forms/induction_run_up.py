"""Run-up and run-down of an induction motor against a constant load, in closed form.

M(s) by Kloss with I dω/dt = M − M_L gives time, angle and impulse as integrals of rational functions of the slip.
Scalar functions, floats in, floats out; NaN where a slip is never reached. Where the motor's surplus varies, times
are quotients by the logarithmic mean of its values at both ends, which stays accurate where they are equal.

Sources: R. Fischer, Elektrische Maschinen and G. K. Dubey, Fundamentals of Electrical Drives (run-up of motors).
"""

import math

from engine.compiling.decorators import scalar
from engine.motion.closed_forms.closed_forms import ahead, logarithmic_mean, over_argument

# Up to this argument the logarithm's series is summed, 0.5^48/50 < 1e-16; beyond it differences lose few digits.
SERIES_REACH = 0.5
SERIES_TERMS = 48
# Below this ratio of slips the integrals are expanded about an idle motor, above it about the breakdown.
LIGHT_LOAD = 0.5


@scalar
def induction_motor_to_slip(
    inertia: float,
    breakdown_torque: float,
    breakdown_slip: float,
    rotor_ratio: float,
    synchronous_speed: float,
    load: float,
    slip0: float,
    slip: float,
) -> tuple[float, float]:
    """Time and angle from one slip to another of an induction motor (Kloss) against a constant load torque.

    t = I omega_s int ds/(M(s) - M_L) from slip to slip0, and the angle with omega_s (1 - s) beside it. In
    x = s/s_b, with P = x² + a s_b x + 1, l = M_L/(M_b (2 + a s_b)) and Q = x - l P, that is
    (I omega_s s_b/(M_b (2 + a s_b))) int P/Q dx; the roots of Q are r and 1/r. Without load and stator
    resistance it is the textbooks' t = (I omega_s/(2 M_b)) ((s0² - s²)/(2 s_b) + s_b ln(s0/s)).

    Parameters
    ----------
    inertia : float
        I [kg·m²], of the motor and all that it drives.
    breakdown_torque, breakdown_slip, rotor_ratio, synchronous_speed : float
        M_b [N·m], s_b, a and omega_s [rad/s] of `engine.laws.motor_characteristics.induction_motor`.
    load : float
        M_L [N·m], resisting positive, in one direction beyond standstill too (slip > 1), as a hoist's.
    slip0, slip : float
        Slips at the beginning and the end; below 0 only where a s_b < 2, as the formula has poles there.

    Returns
    -------
    time, angle : float
        [s] and [rad]; NaN where the slip is never reached. The angle's error is relative to omega_s t.
    """
    if slip0 == slip:
        return 0.0, 0.0
    damping = rotor_ratio * breakdown_slip
    if damping >= 2.0 and min(slip0, slip) < 0.0:
        return math.nan, math.nan
    factor = breakdown_torque * (2 + damping)
    margin = (breakdown_torque - load) / breakdown_torque
    first, second = _kloss_integrals(load / factor, damping, margin, slip0 / breakdown_slip, slip / breakdown_slip)
    unit = inertia * synchronous_speed * breakdown_slip / factor
    time = ahead(slip0 - slip, unit * first)
    return time, synchronous_speed * (time - breakdown_slip * unit * second)


@scalar
def induction_motor_over_slip(
    breakdown_torque: float, breakdown_slip: float, rotor_ratio: float, slip0: float, slip: float
) -> float:
    """Integral of an induction motor's torque (Kloss) over the slip, from `slip` to `slip0`.

    In x = s/s_b with c = a s_b it is s_b M_b (2 + c) int x/(x² + c x + 1) dx, a logarithm less c/2 times an arc
    tangent of w = sqrt(1 - c²/4), or an area tangent where c > 2.

    Parameters
    ----------
    breakdown_torque, breakdown_slip, rotor_ratio : float
        M_b [N·m], s_b and a of `engine.laws.motor_characteristics.induction_motor`.
    slip0, slip : float
        Slips at the beginning and the end; below 0 only where a s_b < 2.

    Returns
    -------
    float
        [N·m].
    """
    half = rotor_ratio * breakdown_slip / 2
    x0, x = slip0 / breakdown_slip, slip / breakdown_slip
    if half >= 1.0 and min(x0, x) < 0.0:
        return math.nan
    y0, y, rise, w_squared = x0 + half, x + half, x0 - x, (1.0 - half) * (1.0 + half)
    p0, p = y0 * y0 + w_squared, y * y + w_squared
    w, middle = math.sqrt(abs(w_squared)), y0 * y + w_squared
    if w_squared > 0.0:
        reciprocal = math.atan2(w * rise, middle) / w
    else:
        reciprocal = rise / middle * over_argument(math.atanh(w * rise / middle), w * rise / middle)
    logarithm = rise * (y0 + y) / logarithmic_mean(p, p0) / 2
    return breakdown_slip * breakdown_torque * (2 + 2 * half) * (logarithm - half * reciprocal)


@scalar
def _kloss_integrals(share: float, damping: float, margin: float, x0: float, x: float) -> tuple[float, float]:
    """Integrals of P/Q and x P/Q from x to x0; r = 4 l/(sqrt m + sqrt n)² with m = 1 - M_L/M_b, n = m + 4 l."""
    other = margin + 4 * share
    if margin > 0.0 and other > 0.0:
        root = 4 * share / (math.sqrt(margin) + math.sqrt(other)) ** 2
        if abs(root) <= LIGHT_LOAD:
            return _light_load(root, damping, math.sqrt(margin * other), x0, x)
    return _heavy_load(share, margin, other, x0, x)


@scalar
def _light_load(root: float, damping: float, scale: float, x0: float, x: float) -> tuple[float, float]:
    """Integrals where r is small: P/Q = (P(r) (1/(x - r) + x/(1 - r x)) + 2 r + a s_b)/sqrt(m n)."""
    if not (1.0 - root * x0) * (1.0 - root * x) > 0.0:
        return math.nan, math.nan
    rise = x0 - x
    weight = 1.0 + root * (damping + root)
    slope = 2 * root + damping
    logarithm = rise / logarithmic_mean(x - root, x0 - root)
    squares = _logarithm_tail(root * x0, 2) * x0**2 - _logarithm_tail(root * x, 2) * x**2
    cubes = _logarithm_tail(root * x0, 3) * x0**3 - _logarithm_tail(root * x, 3) * x**3
    first = weight * (logarithm + squares) + slope * rise
    second = weight * (rise + root * logarithm + cubes) + slope * rise * (x0 + x) / 2
    return first / scale, second / scale


@scalar
def _heavy_load(share: float, margin: float, other: float, x0: float, x: float) -> tuple[float, float]:
    """Integrals where l is not small: P/Q = -1/l - x/(l² q) with q = (x - b)² - w² and w² = m n/(4 l²)."""
    centre = 1.0 + margin / (2 * share)
    w_squared = margin * other / (4 * share * share)
    y0, y, rise = x0 - centre, x - centre, x0 - x
    if w_squared < 0.0:
        w = math.sqrt(-w_squared)
        reciprocal = math.atan2(w * rise, y0 * y - w_squared) / w
        q0, q = y0 * y0 - w_squared, y * y - w_squared
    else:
        w = math.sqrt(w_squared)
        if not ((y0 - w) * (y - w) > 0.0 and (y0 + w) * (y + w) > 0.0):
            return math.nan, math.nan
        reciprocal = rise / logarithmic_mean((y0 + w) * (y - w), (y0 - w) * (y + w))
        q0, q = (y0 - w) * (y0 + w), (y - w) * (y + w)
    linear = rise * (y0 + y) / logarithmic_mean(q, q0) / 2 + centre * reciprocal
    first = -rise - linear / share
    second = -rise * (x0 + x) / 2 - (rise + 2 * centre * linear - reciprocal) / share
    return first / share, second / share


@scalar
def _logarithm_tail(y: float, start: int) -> float:
    """Sum of y^k/(k + start): what -ln|1 - y| leaves after its first terms, over y^start."""
    if abs(y) < SERIES_REACH:
        total = 0.0
        for k in range(SERIES_TERMS, -1, -1):
            total = total * y + 1.0 / (k + start)
        return total
    left = -math.log(abs(1.0 - y))
    for k in range(1, start):
        left -= y**k / k
    return left / y**start
