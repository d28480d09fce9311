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

Small fluctuations and heavy machines are small differences of large energies. What is constant is therefore taken out
beforehand: of I its first value, which ½ω_max² − ½ω_min² = δ ω_m² gives back exactly, and of ½ω² that at mean speed.

Sources: Artobolevsky, Theory of Mechanisms and Machines, chapter on the motion of a machine; Levitsky.
"""

import math

import numpy as np

from engine.compiling.jit import routine, scalar
from engine.equal_positions.rows import (
    accumulate,
    greatest,
    is_finite,
    larger,
    least,
    mean_of,
    roughness,
    second_difference,
    smaller,
)


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
    half_step = 0.5 * h
    work[0] = 0.0
    for k in range(1, moment.shape[0]):
        work[k] = half_step * ((moment[k - 1] - mean) + (moment[k] - mean))
    accumulate(work)


# Of each of many rows: compiled once, not once more for every row.


@routine
def mean_and_work(moment: np.ndarray, h: float, work: np.ndarray) -> float:
    """Mean of a moment over the cycle; the work about it, as of `cumulative_work`, into `work`."""
    mean = mean_of(moment)
    cumulative_work(moment, mean, h, work)
    return mean


@routine
def jumps_of(moment: np.ndarray) -> float:
    """Roughness of a moment over the cycle."""
    return roughness(moment, True)


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
    worst = total = 0.0
    n = work.shape[0]
    for k in range(1, n - 1):
        here = work[k] - slope * inertia[k]
        before = work[k - 1] - slope * inertia[k - 1]
        after = work[k + 1] - slope * inertia[k + 1]
        bend = abs(second_difference(before, here, after))
        total += bend
        worst = larger(worst, bend)
    before, last = work[n - 2] - slope * inertia[n - 2], work[n - 1] - slope * inertia[n - 1]
    first, second = work[0] - slope * inertia[0], work[1] - slope * inertia[1]
    ends = larger(abs(second_difference(before, last, first)), abs(second_difference(last, first, second)))
    return 0.125 * larger(worst, ends) if is_finite(total) else math.nan


# Of no position: least and greatest W and W − ½ω² I, least W − ½ω_min² I, greatest W − ½ω_max² I, sum of W − ½ω² I.
NO_EXTREMES = (math.inf, -math.inf, math.inf, -math.inf, math.inf, -math.inf, 0.0)


@scalar
def energy_slopes(omega: float, delta: float) -> tuple[float, float, float]:
    """½ω² of the least, the mean and the greatest speed [rad²/s²]."""
    slow, fast = omega * (1.0 - 0.5 * delta), omega * (1.0 + 0.5 * delta)
    return 0.5 * slow * slow, 0.5 * omega * omega, 0.5 * fast * fast


@scalar
def widened(
    extremes: tuple[float, float, float, float, float, float, float],
    work: float,
    inertia: float,
    slow: float,
    middle: float,
    fast: float,
) -> tuple[float, float, float, float, float, float, float]:
    """Extremes (see NO_EXTREMES) after one position more; the slopes are those of `energy_slopes`."""
    low, high, low_middle, high_middle, bottom, top, total = extremes
    energy = work - middle * inertia
    low, high = smaller(low, work), larger(high, work)
    low_middle, high_middle = smaller(low_middle, energy), larger(high_middle, energy)
    bottom, top = smaller(bottom, work - slow * inertia), larger(top, work - fast * inertia)
    return low, high, low_middle, high_middle, bottom, top, total + energy


@scalar
def sizes(
    extremes: tuple[float, float, float, float, float, float, float], omega: float, delta: float, first_kind: float
) -> tuple[float, float, float, float]:
    """Excess work and flywheel's inertias from the extremes of a cycle; NaN if W or I is not finite anywhere."""
    low, high, low_middle, high_middle, bottom, top, total = extremes
    if not is_finite(total):
        return math.nan, math.nan, math.nan, math.nan
    excess, denominator = high - low, delta * omega * omega
    merzalov = (high_middle - low_middle) / denominator
    return excess, excess / denominator, merzalov - first_kind, (top - bottom) / denominator


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
    slow, middle, fast = energy_slopes(omega, delta)
    extremes, base = NO_EXTREMES, inertia[0]
    # One loop for all six extremes: it is bound by reading the rows.
    for k in range(work.shape[0]):
        extremes = widened(extremes, work[k], inertia[k] - base, slow, middle, fast)
    excess, by_excess_work, merzalov, wittenbauer = sizes(extremes, omega, delta, first_kind)
    return excess, by_excess_work, merzalov, wittenbauer - base


@scalar
def beyond_mean(
    inertia: np.ndarray, work: np.ndarray, flywheel: float, middle: float, surplus: float, other: float
) -> tuple[float, float, float, float]:
    """Least and greatest ½ω² − ½ω_m² of the cycle with a flywheel, for two initial energies.

    Parameters
    ----------
    inertia, work : ndarray (positions,)
        I [kg·m²] and W [J].
    flywheel, middle : float
        I_F [kg·m²] and ½ω_m² [rad²/s²].
    surplus, other : float
        Two kinetic energies at the first position, each less that at mean speed [J].
    """
    low = low_other = math.inf
    high = high_other = -math.inf
    total, base = 0.0, inertia[0]
    for k in range(work.shape[0]):
        share, gained = 1.0 / (inertia[k] + flywheel), work[k] - middle * (inertia[k] - base)
        here, there = (surplus + gained) * share, (other + gained) * share
        total += here
        low, high = smaller(low, here), larger(high, here)
        low_other, high_other = smaller(low_other, there), larger(high_other, there)
    if not is_finite(total):
        return math.nan, math.nan, math.nan, math.nan
    return low, high, low_other, high_other


@scalar
def faster_by(excess: float) -> float:
    """(ω − ω_m)/ω_m from (ω² − ω_m²)/ω_m²."""
    return excess / (1.0 + math.sqrt(max(1.0 + excess, 0.0)))


@scalar
def fluctuation_with_flywheel(
    inertia: np.ndarray, work: np.ndarray, flywheel: float, omega: float
) -> tuple[float, float]:
    """Initial energy and coefficient of speed fluctuation of the steady cycle with a given flywheel.

    Iterates on the initial energy until (ω_max + ω_min)/2 is the mean speed. Two energies at once show the inertias a
    and b at the least and the greatest speed, as dE/d(½ω²). Where v and w are ½ω² − ½ω_m² there and d = δ/2,
    a (½ω_m² (d² − 2d) − v) = E' − E = b (½ω_m² (d² + 2d) − w) is a quadratic for d; it is exact unless the least or
    greatest speed moves to another position. No step of it subtracts nearly equal numbers, however small δ is.

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
    fluctuation : float
        δ; both NaN where the machine would stop within the cycle (δ would exceed 2).
    """
    middle, swing = 0.5 * omega * omega, greatest(work) - least(work)
    usual = middle * (inertia[0] + flywheel)
    below, above = -least(work) - usual, math.inf
    _, high, _, _ = beyond_mean(inertia, work, flywheel, middle, below, below)
    if not high <= 3.0 * middle:
        return math.nan, math.nan
    surplus = max(middle * (mean_of(inertia) - inertia[0]), below + 0.5 * swing)
    scale = swing + middle * (greatest(inertia) - least(inertia)) + 1e-9 * usual
    for _ in range(100):
        low, high, low_other, high_other = beyond_mean(inertia, work, flywheel, middle, surplus, surplus + 0.01 * scale)
        a, b = 0.01 * scale / (low_other - low), 0.01 * scale / (high_other - high)
        rest, both = b * high - a * low, middle * (a + b)
        half = rest / (both + math.sqrt(both * both - middle * (a - b) * rest))
        ahead = surplus + a * (middle * half * (half - 2.0) - low)
        if abs(ahead - surplus) <= 1e-13 * scale:
            return ahead + usual, half + half
        if faster_by(low / middle) + faster_by(high / middle) > 0.0:
            above = surplus
        else:
            below = surplus
        surplus = ahead if below < ahead < above else 0.5 * (below + min(above, surplus + surplus + usual + swing))
    return math.nan, math.nan


@scalar
def speed_row(inertia: np.ndarray, work: np.ndarray, flywheel: float, energy: float, speed: np.ndarray) -> None:
    """ω(φ) = √(2 (E_0 + W)/(I + I_F)) into `speed` [rad/s]."""
    for k in range(work.shape[0]):
        speed[k] = math.sqrt(2.0 * (energy + work[k]) / (inertia[k] + flywheel))
