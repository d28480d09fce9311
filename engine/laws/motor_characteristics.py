"""Motors: torque as a function of speed, and its constants from nameplate data.

The speed omega and the torque have the same positive direction; a motor that turns clockwise has negative speed and
torque throughout. Scalar functions take one speed; the set-up takes arrays of variants.

Sources: R. Fischer, Elektrische Maschinen (Kloss' formula, nameplate data); A. E. Fitzgerald, C. Kingsley
and S. D. Umans, Electric Machinery (equivalent circuit, DC motors).
"""

import numpy as np
from numpy.typing import ArrayLike

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen
from engine.units.display import quantity_text

# Relative difference below which two nameplate values count as equal.
NAMEPLATE_TOLERANCE = 1e-12


@scalar
def straight_motor(level: float, slope: float, omega: float) -> float:
    """Torque of a motor whose characteristic is a straight line: level + slope ω [N·m]."""
    return level + slope * omega


@scalar
def straight_motor_slope(level: float, slope: float, omega: float) -> float:
    """Derivative of `straight_motor` by the speed [N·m·s]."""
    return slope


@scalar
def ramp_motor(level: float, slope: float, at: float, low: float, high: float, omega: float) -> float:
    """Part of a torque by a table, level + slope (ω − at) with ω − at between low and high, and constant beyond [N·m].

    The sum of a table's parts is accurate beside the steepest of them, unlike a sum of changes of the slope.
    """
    off = omega - at
    return level + slope * chosen(off < low, low, chosen(off > high, high, off))


@scalar
def ramp_motor_slope(level: float, slope: float, at: float, low: float, high: float, omega: float) -> float:
    """Derivative of `ramp_motor` by the speed; at a bend, that below it [N·m·s]."""
    off = omega - at
    return chosen(off > low, chosen(off > high, 0.0, slope), 0.0)


@scalar
def _kloss(
    breakdown_torque: float, breakdown_slip: float, rotor_ratio: float, synchronous_speed: float, omega: float
) -> tuple[float, float, float, float]:
    """Slip speed d = s omega_s, b = s_b omega_s, d² + b² + a s_b b d, and M_b (2 + a s_b) b of Kloss' formula.

    Slip speeds in place of slips save a division.
    """
    slip, breakdown = synchronous_speed - omega, breakdown_slip * synchronous_speed
    damping = rotor_ratio * breakdown_slip
    denominator = slip * slip + breakdown * breakdown + damping * breakdown * slip
    return slip, breakdown, denominator, (2.0 + damping) * breakdown_torque * breakdown


@scalar
def induction_motor(
    breakdown_torque: float, breakdown_slip: float, rotor_ratio: float, synchronous_speed: float, omega: float
) -> float:
    """Torque of an induction motor by Kloss' formula.

    M = M_b (2 + a s_b) / (s/s_b + s_b/s + a s_b) with the slip s = (omega_s - omega)/omega_s, multiplied out by s s_b
    so that it is 0 at s = 0. It holds for motoring (0 < s < 1), plugging (s > 1) and generating (s < 0).

    Parameters
    ----------
    breakdown_torque : float
        M_b, maximum motoring torque [N·m].
    breakdown_slip : float
        s_b, slip at the breakdown torque.
    rotor_ratio : float
        a, twice the ratio of stator resistance to rotor resistance (referred to the stator); 0 gives Kloss' simple
        formula.
    synchronous_speed : float
        omega_s [rad/s].
    omega : float
        Speed [rad/s].

    Returns
    -------
    float
        Torque [N·m]. An equivalent circuit has a s_b < 2. If a fit gives a s_b >= 2, the formula has two poles above
        synchronous speed and drives a generator forwards between them, so it returns NaN there.
    """
    slip, breakdown, denominator, factor = _kloss(
        breakdown_torque, breakdown_slip, rotor_ratio, synchronous_speed, omega
    )
    # 0/0 gives NaN in the arguments' own precision and without a branch, so that motors of many variants vectorise.
    zero = slip - slip
    between = (slip * breakdown < 0.0) & (denominator <= 0.0)
    return (zero if between else factor * slip) / (zero if between else denominator)


@scalar
def induction_motor_slope(
    breakdown_torque: float, breakdown_slip: float, rotor_ratio: float, synchronous_speed: float, omega: float
) -> float:
    """Derivative of `induction_motor` by the speed, dM/domega = −dM/dd [N·m·s]; parameters as there."""
    slip, breakdown, denominator, factor = _kloss(
        breakdown_torque, breakdown_slip, rotor_ratio, synchronous_speed, omega
    )
    return -factor * (breakdown - slip) * (breakdown + slip) / (denominator * denominator)


@scalar
def induction_motor_curvature(
    breakdown_torque: float, breakdown_slip: float, rotor_ratio: float, synchronous_speed: float, omega: float
) -> float:
    """Second derivative of `induction_motor` by the speed [N·m·s²]; parameters as there."""
    slip, breakdown, denominator, factor = _kloss(
        breakdown_torque, breakdown_slip, rotor_ratio, synchronous_speed, omega
    )
    rise = (breakdown - slip) * (breakdown + slip)
    bend = slip * denominator + rise * (slip + slip + rotor_ratio * breakdown_slip * breakdown)
    return -2.0 * factor * bend / (denominator * denominator * denominator)


# Derivative of each law of motors by the speed, its last argument; None where it is 0.
BY_SPEED = {
    straight_motor: straight_motor_slope,
    straight_motor_slope: None,
    ramp_motor: ramp_motor_slope,
    ramp_motor_slope: None,
    induction_motor: induction_motor_slope,
    induction_motor_slope: induction_motor_curvature,
}


def dc_motor_from_nameplate(power: ArrayLike, rated_speed: ArrayLike, no_load_speed: ArrayLike) -> np.ndarray:
    """Stall torque of a DC motor from its nameplate.

    Parameters
    ----------
    power : array_like
        Rated mechanical power [W].
    rated_speed, no_load_speed : array_like
        [rad/s]; the rated speed lies between 0 and the no-load speed. All three broadcast.

    Returns
    -------
    numpy.ndarray
        Stall torque [N·m]; NaN for impossible nameplate data.
    """
    power, rated_speed, no_load_speed = _floats(power, rated_speed, no_load_speed)
    with np.errstate(all="ignore"):
        slip = (no_load_speed - rated_speed) / no_load_speed
        valid = (power > 0.0) & (slip > 0.0) & (slip < 1.0)
        return np.where(valid, power / rated_speed / slip, np.nan)


def kloss_from_nameplate(
    power: ArrayLike,
    rated_speed: ArrayLike,
    synchronous_speed: ArrayLike,
    breakdown_ratio: ArrayLike,
    starting_ratio: ArrayLike | None = None,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Constants of Kloss' formula from an induction motor's nameplate.

    With rated slip s_n, rated torque M_n = power / rated speed, λ = M_b/M_n and σ = M(1)/M_n. Without σ the
    simple formula (a = 0) through the rated point gives s_b = s_n (λ + √(λ² - 1)). With σ the formula passes
    through the rated point and the starting point. Both conditions are linear in a s_b,

        (λ - 1) a s_b = s_n/s_b + s_b/s_n - 2 λ,        (λ - σ) a s_b = σ (1/s_b + s_b) - 2 λ.

    Eliminating a s_b leaves a quadratic in s_b: P s_b² + 2 λ (σ - 1) s_b + Q = 0 with
    P = (λ - σ)/s_n - (λ - 1) σ and Q = (λ - σ) s_n - (λ - 1) σ. Its left side is
    -σ (λ - 1) (1 - s_n)² < 0 at s_n and (λ - σ) (1 - s_n)²/s_n > 0 at 1, so for σ < λ exactly one root lies
    between.

    Parameters
    ----------
    power : array_like
        Rated mechanical power [W].
    rated_speed, synchronous_speed : array_like
        [rad/s].
    breakdown_ratio : array_like
        λ, breakdown torque / rated torque.
    starting_ratio : array_like, optional
        σ, starting torque / rated torque. All arguments broadcast.

    Returns
    -------
    breakdown_torque : numpy.ndarray
        [N·m].
    breakdown_slip : numpy.ndarray
    rotor_ratio : numpy.ndarray
        a >= 0. All three are NaN where there is no solution; `nameplate_trouble` gives the reason.
    """
    # 1.0 is a placeholder for a missing starting ratio.
    start = 1.0 if starting_ratio is None else starting_ratio
    power, rated, synchronous, most, start = _floats(power, rated_speed, synchronous_speed, breakdown_ratio, start)
    with np.errstate(all="ignore"):
        rated_slip = (synchronous - rated) / synchronous
        valid = (power > 0.0) & (rated_slip > 0.0) & (rated_slip < 1.0) & (most > 1.0) & (most < np.inf)
        breakdown_slip = _simple_breakdown_slip(rated_slip, most)
        ratio = np.zeros_like(breakdown_slip)
        if starting_ratio is not None:
            least = _simple_starting_ratio(breakdown_slip, most) * (1.0 - NAMEPLATE_TOLERANCE)
            valid &= (breakdown_slip < 1.0) & (start >= least) & (start < most)
            breakdown_slip = _breakdown_slip(rated_slip, most, start)
            excess = rated_slip / breakdown_slip + breakdown_slip / rated_slip - 2.0 * most
            ratio = np.maximum(excess, 0.0) / (most - 1.0) / breakdown_slip
        constants = (most * power / rated, breakdown_slip, ratio)
        return tuple(np.where(valid, constant, np.nan) for constant in constants)


def nameplate_trouble(
    power: float,
    rated_speed: float,
    synchronous_speed: float,
    breakdown_ratio: float,
    starting_ratio: float | None = None,
) -> str | None:
    """Reason why `kloss_from_nameplate` has no solution for one motor.

    Parameters
    ----------
    power, rated_speed, synchronous_speed, breakdown_ratio, starting_ratio : float
        As for `kloss_from_nameplate`, of one variant.

    Returns
    -------
    str or None
        Reason and remedy in words; None if there is a solution.
    """
    if not power > 0.0:
        return f"power = {quantity_text(float(power), 'W')}: a motor's rated power is positive"
    rated_slip = (synchronous_speed - rated_speed) / synchronous_speed if synchronous_speed else np.nan
    if not 0.0 < rated_slip < 1.0:
        return (
            f"rated_speed = {quantity_text(float(rated_speed), 'rad s-1')}: it lies between 0 and the synchronous speed"
            f" ({quantity_text(float(synchronous_speed), 'rad s-1')}), usually 1 to 8 % below it"
        )
    if not 1.0 < breakdown_ratio < np.inf:
        return f"breakdown_ratio = {breakdown_ratio}: it is above 1, usually 2 to 3.5 times the rated torque"
    if starting_ratio is None:
        return None
    if not starting_ratio < breakdown_ratio:
        return (
            f"starting_ratio = {starting_ratio}: the starting torque is below the breakdown torque"
            f" ({breakdown_ratio} times the rated torque); for another kind of motor give a table"
        )
    slip = float(_simple_breakdown_slip(rated_slip, breakdown_ratio))
    if not slip < 1.0:
        return (
            f"rated_speed = {quantity_text(float(rated_speed), 'rad s-1')}: with breakdown_ratio = "
            f"{breakdown_ratio} this slip puts the"
            f" breakdown at or below standstill (slip {slip:.3g}); leave starting_ratio out"
        )
    least = float(_simple_starting_ratio(slip, breakdown_ratio))
    if starting_ratio < least * (1.0 - NAMEPLATE_TOLERANCE):
        return (
            f"starting_ratio = {starting_ratio}: with this slip and breakdown_ratio Kloss' formula gives"
            f" {least:.4g} or more; leave starting_ratio out, or give the curve as a table"
        )
    return None


def _floats(*values: ArrayLike) -> list[np.ndarray]:
    return list(np.broadcast_arrays(*(np.asarray(value, dtype=np.float64) for value in values)))


def _simple_breakdown_slip(rated_slip: ArrayLike, most: ArrayLike) -> np.ndarray:
    """s_b of Kloss' simple formula; λ² - 1 is factored to avoid cancellation for λ near 1."""
    return rated_slip * (most + np.sqrt((most - 1.0) * (most + 1.0)))


def _simple_starting_ratio(breakdown_slip: ArrayLike, most: ArrayLike) -> np.ndarray:
    """M(1)/M_n of Kloss' simple formula: the minimum for a >= 0."""
    return 2.0 * most / (1.0 / breakdown_slip + breakdown_slip)


def _breakdown_slip(rated_slip: np.ndarray, most: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Root of the quadratic with positive slope, in a form without cancellation for either sign of σ - 1."""
    p = (most - start) / rated_slip - (most - 1.0) * start
    q = (most - start) * rated_slip - (most - 1.0) * start
    half = most * (start - 1.0)
    root = np.sqrt(half * half - p * q)
    return np.where(half >= 0.0, -q / (half + root), (root - half) / p)
