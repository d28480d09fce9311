"""Flywheel from a turning-moment diagram, without a mechanism.

The diagram is the torque T(φ) of an engine against a constant load, or the difference of engine and load torque; its
mean is balanced by a constant torque. The work of T − mean is integrated exactly: on each piece of a table it is a
polynomial, whose extremes lie where T crosses the mean, continuously or by a step. With a constant inertia I the speed
follows from ½I(ω_max² − ω_min²) = A_exc, so I = A_exc/(δω_m²) is exact for ω_m = (ω_max + ω_min)/2.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, ch. 16; T. Bevan, The Theory of Machines, ch. 12.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import interpolate

from engine.laws.tables import Table, TableError, make_table

# Admissible imbalance of areas measured on a drawing, relative to the sum of their magnitudes.
AREA_TOLERANCE = 0.01

# Peaks that are equal in theory differ by rounding; relative to the excess work.
SAME_PEAK = 1e-12


class TurningMoment(NamedTuple):
    """Results of a turning-moment diagram.

    Attributes
    ----------
    mean_moment : float
        [N·m]; NaN if only areas are given.
    excess_work : float
        A_exc, maximum minus minimum kinetic energy of the cycle [J].
    fastest_at, slowest_at : float
        Angle of maximum and of minimum speed [rad], the first of several equal ones; from areas, the number of areas
        before it.
    flywheel_inertia : float
        Inertia to add to the existing one [kg·m²]; 0 or less if none is needed.
    speed_fluctuation : float
        Resulting δ = (ω_max − ω_min)/ω_m: the required one, or less if the existing inertia suffices.
    """

    mean_moment: float
    excess_work: float
    fastest_at: float
    slowest_at: float
    flywheel_inertia: float
    speed_fluctuation: float


def turning_moment_from_table(
    phi: ArrayLike,
    moment: ArrayLike,
    speed: float,
    speed_fluctuation: float,
    cycle: float | None = None,
    interpolation: str = "linear",
    inertia: float = 0.0,
) -> TurningMoment:
    """Design a flywheel from a table of torque over the crank angle.

    Parameters
    ----------
    phi : array_like (rows,)
        Crank angles [rad], ascending; with "linear" interpolation a repeated angle is a step.
    moment : array_like (rows,)
        Torque [N·m].
    speed : float
        Mean speed ω_m = (ω_max + ω_min)/2, of either sign [rad/s].
    speed_fluctuation : float
        Required δ, between 0 and 2.
    cycle : float, optional
        Length of the cycle [rad]; by default the rows span the cycle, and the last row equals the first.
    interpolation : {"linear", "pchip", "spline"}
    inertia : float
        Existing constant inertia of the machine [kg·m²].

    Raises
    ------
    TableError
        If the rows don't form a periodic table, or a number is outside its limits.
    """
    _check(speed, speed_fluctuation, inertia)
    if cycle is None:
        make_table(phi, moment, interpolation)
        cycle = float(phi[-1] - phi[0])
    elif not cycle > 0.0:
        raise TableError(f"cycle = {cycle}: give a positive angle in radians, such as 2π or 4π, or leave it out")
    mean, places, work = _extremes(make_table(phi, moment, interpolation, cycle))
    return _sized(mean, places, work, speed, speed_fluctuation, inertia)


def turning_moment_from_areas(
    areas: ArrayLike,
    energy_per_area: float,
    speed: float,
    speed_fluctuation: float,
    inertia: float = 0.0,
) -> TurningMoment:
    """Design a flywheel from the areas between a turning-moment diagram and its mean line, as measured on a drawing.

    Parameters
    ----------
    areas : array_like (areas,)
        In the order of the cycle, positive above the mean line, in any unit.
    energy_per_area : float
        Energy per unit of area [J].
    speed, speed_fluctuation, inertia : float
        As in `turning_moment_from_table`.

    Raises
    ------
    TableError
        If areas are NaN, infinite or don't balance, or a number is outside its limits.
    """
    _check(speed, speed_fluctuation, inertia)
    if not (math.isfinite(energy_per_area) and energy_per_area > 0.0):
        raise TableError(f"energy_per_area = {energy_per_area}: give the energy of a unit of area, above 0")
    try:
        areas = np.asarray(areas, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise TableError(f"areas: {error}; give one list of plain numbers") from error
    if areas.ndim != 1 or areas.size < 2:
        raise TableError(f"areas has shape {areas.shape}; give one list of at least 2 areas")
    wrong = np.flatnonzero(~np.isfinite(areas))
    if wrong.size:
        raise TableError(f"area {wrong[0] + 1}: {areas[wrong[0]]} is not finite; correct or remove it")
    if abs(areas.sum()) > AREA_TOLERANCE * np.abs(areas).sum():
        raise TableError(
            f"areas: their sum is {areas.sum():g}, but above and below the mean line they must balance to"
            f" {AREA_TOLERANCE:.0%} of their magnitudes; check the signs and that the cycle is complete"
        )
    work = energy_per_area * np.concatenate(([0.0], np.cumsum(areas)))
    return _sized(math.nan, np.arange(work.size, dtype=float), work, speed, speed_fluctuation, inertia)


def fluctuation(excess_work: float, inertia: float, speed: float) -> float:
    """Coefficient of speed fluctuation with a constant inertia, δ = A_exc/(I ω_m²).

    Parameters
    ----------
    excess_work : float
        [J].
    inertia : float
        Total inertia [kg·m²].
    speed : float
        Mean speed [rad/s].

    Returns
    -------
    float
        NaN for δ ≥ 2, where the machine would stop within the cycle.
    """
    energy = inertia * speed * speed
    return excess_work / energy if excess_work < 2.0 * energy else math.nan


def _check(speed: float, speed_fluctuation: float, inertia: float) -> None:
    if not (math.isfinite(speed) and speed != 0.0):
        raise TableError(f"speed = {speed}: the mean speed must not be 0")
    if not 0.0 < speed_fluctuation < 2.0:
        raise TableError(f"speed_fluctuation = {speed_fluctuation}: give δ between 0 and 2, such as 0.02")
    if not (math.isfinite(inertia) and inertia >= 0.0):
        raise TableError(f"inertia = {inertia}: give the inertia that is there in kg·m², 0 or more")


def _extremes(table: Table) -> tuple[float, np.ndarray, np.ndarray]:
    """Mean of a periodic table, the positions at which its work may be extreme, and the work there."""
    # A step is a piece of zero length.
    long = np.diff(table.breaks) > 0.0
    breaks = np.append(table.breaks[:-1][long], table.breaks[-1])
    moment = interpolate.PPoly(table.coefficients[long].T, breaks)
    mean = float(moment.integrate(breaks[0], breaks[-1]) / table.period)
    excess = interpolate.PPoly(moment.c.copy(), breaks)
    excess.c[-1] -= mean
    crossings = excess.roots(discontinuity=False, extrapolate=False)
    # A piece that lies on the mean yields NaN as a root; its ends are among the positions anyway.
    places = np.unique(np.concatenate((breaks, crossings[np.isfinite(crossings)])))
    return mean, places, excess.antiderivative()(places)


def _sized(
    mean: float, places: np.ndarray, work: np.ndarray, speed: float, asked: float, inertia: float
) -> TurningMoment:
    excess = float(work.max() - work.min())
    flywheel = excess / (asked * speed * speed) - inertia
    fastest = np.flatnonzero(work >= work.max() - SAME_PEAK * excess)[0]
    slowest = np.flatnonzero(work <= work.min() + SAME_PEAK * excess)[0]
    return TurningMoment(
        mean_moment=mean,
        excess_work=excess,
        fastest_at=float(places[fastest]),
        slowest_at=float(places[slowest]),
        flywheel_inertia=flywheel,
        speed_fluctuation=asked if flywheel > 0.0 else fluctuation(excess, inertia, speed),
    )
