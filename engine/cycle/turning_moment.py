"""A flywheel straight from a turning-moment diagram, without a mechanism.

The diagram is the moment T(φ) of an engine against a constant load, or the difference of engine and load; its mean
is carried by whatever is constant. The work of T − mean is integrated exactly: on a table's pieces it is a
polynomial, and its extremes lie where T crosses the mean, continuously or by a step. With a constant inertia I the
speed follows from ½I(ω_max² − ω_min²) = A_exc, so I = A_exc/(δω_m²) is exact for ω_m = (ω_max + ω_min)/2.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, ch. 16; T. Bevan, The Theory of Machines, ch. 12.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy import interpolate

from engine.laws.tables import Table, TableError, make_table

# Areas are read from a drawing: what a planimeter misses of their sum, relative to the sum of their magnitudes.
AREA_TOLERANCE = 0.01

# Peaks that are equal on paper differ by rounding; relative to the excess work.
SAME_PEAK = 1e-12


class TurningMoment(NamedTuple):
    """A turning-moment diagram and its flywheel.

    Attributes
    ----------
    mean_moment : float
        [N·m]; NaN from areas alone.
    excess_work : float
        A_exc, greatest minus least kinetic energy of the cycle [J].
    fastest_at, slowest_at : float
        Angle of the greatest and of the least speed, of several equal ones the first [rad]; from areas: how many
        areas precede it.
    flywheel_inertia : float
        What must be added to the inertia that is there [kg·m²]; 0 or less: nothing.
    speed_fluctuation : float
        δ = (ω_max − ω_min)/ω_m that follows: the one asked for, or less where the inertia that is there gives less.
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
    """Flywheel from a table of moments over the crank angle.

    Parameters
    ----------
    phi : array_like (rows,)
        Crank angles [rad], ascending; with "linear" interpolation an angle given twice is a step.
    moment : array_like (rows,)
        [N·m].
    speed : float
        Mean speed ω_m = (ω_max + ω_min)/2, of either sign [rad/s].
    speed_fluctuation : float
        δ asked for, between 0 and 2.
    cycle : float, optional
        Length of the cycle [rad]; without it the rows span the cycle, and the last repeats the first.
    interpolation : {"linear", "pchip", "spline"}
    inertia : float
        Constant inertia that the machine has already [kg·m²].

    Raises
    ------
    TableError
        Rows from which no periodic table can be made, and numbers outside their limits.
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
    """Flywheel from the areas between a turning-moment diagram and its mean line, as measured on a drawing.

    Parameters
    ----------
    areas : array_like (areas,)
        In the order of the cycle, positive above the mean line, in any unit.
    energy_per_area : float
        Energy that a unit of area stands for [J].
    speed, speed_fluctuation, inertia : float
        As in `turning_moment_from_table`.

    Raises
    ------
    TableError
        Areas that aren't finite numbers or don't balance, and numbers outside their limits.
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
    """Coefficient of speed fluctuation that a constant inertia leaves, δ = A_exc/(I ω_m²).

    Parameters
    ----------
    excess_work : float
        [J].
    inertia : float
        The whole inertia [kg·m²].
    speed : float
        Mean speed [rad/s].

    Returns
    -------
    float
        NaN from 2 on, where the machine would stop within the cycle.
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
    """Mean of a periodic table, the places where its work may be extreme, and the work there."""
    # A step is a piece without length.
    long = np.diff(table.breaks) > 0.0
    breaks = np.append(table.breaks[:-1][long], table.breaks[-1])
    moment = interpolate.PPoly(table.coefficients[long].T, breaks)
    mean = float(moment.integrate(breaks[0], breaks[-1]) / table.period)
    excess = interpolate.PPoly(moment.c.copy(), breaks)
    excess.c[-1] -= mean
    crossings = excess.roots(discontinuity=False, extrapolate=False)
    # A piece that lies on the mean has a NaN among the roots; its ends are places anyway.
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
