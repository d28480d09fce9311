"""Sizing a flywheel from the rows I(φ) and M(φ) of a steady cycle, by four methods.

M is the reduced moment of everything but the driver; the driver gives the constant moment −mean(M), so that the
work over the cycle closes. W(φ) is the work of both from the first position, which is also the change of the
machine's kinetic energy. Asked is the coefficient of speed fluctuation δ = (ω_max − ω_min)/ω_m about the mean
speed ω_m = (ω_max + ω_min)/2.

- Excess work: I_F = A_exc/(δ ω_m²), A_exc = max W − min W; leaves the machine's own inertia out.
- Merzalov: the energy of the links with variable reduced inertia is taken at ω_m;
  I_F + I_0 = (max − min)[W − ½ω_m² (I − I_0)]/(δ ω_m²), I_0 the constant ("first kind") inertia.
- Wittenbauer: tangents of slope ½ω_max² and ½ω_min² to the loop W(I). With ω_max,min = ω_m (1 ± δ/2) exactly,
  I_F = {max[W − ½ω_max² I] − min[W − ½ω_min² I]}/(δ ω_m²), in closed form and without approximation.
- The speed that follows with a given flywheel: ω² = 2 (E_0 + W)/(I + I_F), E_0 such that the mean speed is ω_m.

Sources: Artobolevsky, Theory of Mechanisms and Machines, chapter on the motion of a machine; Levitsky.
"""

import math

import numpy as np

from engine.jit import scalar
from engine.rows import combined_max, combined_min, greatest, is_finite, least, mean_of, roughness


@scalar
def cumulative_work(moment: np.ndarray, mean: float, h: float, work: np.ndarray) -> None:
    """Work of the moments and of the driver's −mean from the first position, by the trapezoid rule, into `work`.

    Parameters
    ----------
    moment : ndarray (positions,)
        Reduced moment [N·m].
    mean : float
        Its mean over the cycle [N·m].
    h : float
        Spacing of the positions [rad].
    work : ndarray (positions,)
        Receives W [J], 0 at the first position.
    """
    total = 0.0
    half_step = 0.5 * h
    work[0] = 0.0
    for k in range(1, moment.shape[0]):
        total += half_step * ((moment[k - 1] - mean) + (moment[k] - mean))
        work[k] = total


@scalar
def work_doubt(moment: np.ndarray, h: float) -> float:
    """How much the work may be off because a moment jumps or bends somewhere between two positions [J].

    A jump ΔM hidden in a step h moves work by up to hΔM/2 either way; several jumps add up as their squares do.
    """
    return 0.5 * h * roughness(moment, True)


@scalar
def missed_extreme(inertia: np.ndarray, work: np.ndarray, slope: float) -> float:
    """How far an extreme of W − slope·I between two positions can lie beyond those at the positions [J].

    An eighth of the greatest second difference: the height of a parabola over the middle of its chord.
    """
    worst = 0.0
    for k in range(1, work.shape[0] - 1):
        here = work[k] - slope * inertia[k]
        before = work[k - 1] - slope * inertia[k - 1]
        after = work[k + 1] - slope * inertia[k + 1]
        worst = max(worst, abs(before - here + (after - here)))
    return 0.125 * worst


@scalar
def flywheel_sizes(
    inertia: np.ndarray, work: np.ndarray, omega: float, delta: float, first_kind: float
) -> tuple[float, float, float, float]:
    """Excess work and the flywheel's inertia by three methods.

    Parameters
    ----------
    inertia : ndarray (positions,)
        Reduced moment of inertia I of the whole machine without the flywheel [kg·m²].
    work : ndarray (positions,)
        W, from `cumulative_work` [J].
    omega : float
        Mean speed of the input link [rad/s].
    delta : float
        Coefficient of speed fluctuation asked for.
    first_kind : float
        The constant part I_0 of the inertia [kg·m²].

    Returns
    -------
    excess : float
        A_exc [J].
    by_excess_work, merzalov, wittenbauer : float
        Inertia of the flywheel on the input link [kg·m²]; 0 or less: the machine needs none.
    """
    check = mean_of(inertia) + mean_of(work)
    if not is_finite(check):
        return math.nan, math.nan, math.nan, math.nan
    denominator = delta * omega * omega
    fast = omega * (1.0 + 0.5 * delta)
    slow = omega * (1.0 - 0.5 * delta)
    excess = greatest(work) - least(work)
    slope = 0.5 * omega * omega
    merzalov = (combined_max(work, inertia, slope) - combined_min(work, inertia, slope)) / denominator
    top = combined_max(work, inertia, 0.5 * fast * fast)
    bottom = combined_min(work, inertia, 0.5 * slow * slow)
    return excess, excess / denominator, merzalov - first_kind, (top - bottom) / denominator


@scalar
def speeds_squared(
    inertia: np.ndarray, work: np.ndarray, flywheel: float, energy: float
) -> tuple[float, float, float, float]:
    """Least and greatest ω² with a flywheel and an initial energy, and the inertia where each occurs.

    Parameters
    ----------
    inertia, work : ndarray (positions,)
        I [kg·m²] and W [J].
    flywheel, energy : float
        I_F [kg·m²] and kinetic energy at the first position [J].
    """
    low, high = math.inf, -math.inf
    low_inertia = high_inertia = math.nan
    for k in range(work.shape[0]):
        total = inertia[k] + flywheel
        square = 2.0 * (energy + work[k]) / total
        if square < low:
            low, low_inertia = square, total
        if square > high:
            high, high_inertia = square, total
    return low, high, low_inertia, high_inertia


@scalar
def speed_with_flywheel(
    inertia: np.ndarray, work: np.ndarray, flywheel: float, omega: float
) -> tuple[float, float, float]:
    """Initial energy, least and greatest speed of the steady cycle with a given flywheel.

    Newton's iteration on the initial energy until (ω_max + ω_min)/2 is the mean speed.

    Parameters
    ----------
    inertia, work : ndarray (positions,)
        I [kg·m²] and W [J].
    flywheel : float
        I_F [kg·m²].
    omega : float
        Mean speed [rad/s], by its magnitude.

    Returns
    -------
    energy : float
        Kinetic energy at the first position [J].
    slowest, fastest : float
        [rad/s]; NaN where the machine would stop within the cycle (δ would exceed 2).
    """
    mean = abs(omega)
    energy = 0.5 * (mean_of(inertia) + flywheel) * mean * mean
    floor = -least(work)
    if not is_finite(energy + mean_of(work)):
        return math.nan, math.nan, math.nan
    if energy <= floor:
        energy = floor + 0.5 * (greatest(work) + floor)
    for _ in range(60):
        low, high, low_inertia, high_inertia = speeds_squared(inertia, work, flywheel, energy)
        slowest, fastest = math.sqrt(max(low, 0.0)), math.sqrt(high)
        gap = 0.5 * (slowest + fastest) - mean
        slope = 0.5 * (1.0 / (low_inertia * slowest) + 1.0 / (high_inertia * fastest))
        ahead = energy - gap / slope
        if ahead <= floor:
            ahead = 0.5 * (energy + floor)
        settled = abs(ahead - energy) <= 1e-14 * energy
        energy = ahead
        if settled:
            break
    # What is left is rounding; a large gap, at the least energy that there is, means that there is no such motion.
    if abs(gap) <= 1e-12 * mean:
        return energy, slowest, fastest
    return math.nan, math.nan, math.nan


@scalar
def speed_row(inertia: np.ndarray, work: np.ndarray, flywheel: float, energy: float, speed: np.ndarray) -> None:
    """ω(φ) = √(2 (E_0 + W)/(I + I_F)) into `speed` [rad/s]."""
    for k in range(work.shape[0]):
        speed[k] = math.sqrt(2.0 * (energy + work[k]) / (inertia[k] + flywheel))
