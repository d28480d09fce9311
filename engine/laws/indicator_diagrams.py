"""Indicator diagrams: pressure in the cylinder over the travel of the piston.

Travel is the distance of the piston from its head-end dead centre [m]. Gas volume divided by piston area is
travel + clearance · stroke, with the clearance as a fraction of the swept volume. Pressures are absolute [Pa].
Valves are ideal: they open at line pressure without loss. At a jump of the diagram (combustion, opening of a valve or
port), the value is that of the named stroke. Functions of a position: floats in and out.

Each diagram consists of at most four branches: expansion along a polytrope p V^n, outflow and inflow at the pressures
of the lines, compression along another polytrope. A law for each kind of cylinder selects the branch at a position, and
`branch_pressure` gives the pressure along it, a smooth function of travel that extends beyond the ends of the branch.

Sources: J. B. Heywood, Internal Combustion Engine Fundamentals (ideal cycles); any textbook of reciprocating
compressors for the polytropic diagram with clearance.
"""

import math

import numpy as np
from numpy.typing import ArrayLike

from engine.compiling.decorators import scalar
from engine.laws.elementary import power

# Stroke [m]; clearance volume / swept volume, above 0; fraction of the stroke at which compression begins: where the
# ports close, otherwise 1.
Cylinder = tuple[float, float, float]
# Pressure of the suction or intake line, of the discharge or exhaust line, and at the head-end dead centre before
# expansion: after combustion, or `compressor_peak` [Pa].
Pressures = tuple[float, float, float]
# Polytropic exponents of compression and expansion.
Exponents = tuple[float, float]
# Fraction of a turn within which an angle counts as a dead centre.
_SAME_TURN = 1e-6
# Branches of a diagram, in the order of a four-stroke engine's strokes.
EXPANSION, OUTFLOW, INFLOW, COMPRESSION = 0.0, 1.0, 2.0, 3.0


@scalar
def compressor_branch(travel: float, stroke: float, rate: float, discharge_opens: float, suction_opens: float) -> float:
    """Branch of a compressor's diagram.

    Parameters
    ----------
    travel, stroke : float
        [m].
    rate : float
        Rate of travel in any unit, negative while the piston moves toward the head.
    discharge_opens, suction_opens : float
        Travel at which the valves open, as fractions of the stroke; from `compressor_opening_travels`.

    Returns
    -------
    float
        EXPANSION, OUTFLOW, INFLOW or COMPRESSION; NaN if travel or rate is NaN.
    """
    if math.isnan(travel) or math.isnan(rate):
        return math.nan
    if rate < 0.0:
        return OUTFLOW if travel < discharge_opens * stroke else COMPRESSION
    return EXPANSION if travel < suction_opens * stroke else INFLOW


@scalar
def pump_branch(rate: float) -> float:
    """Branch of a pump's diagram: OUTFLOW toward the head, where the rate is negative, else INFLOW; NaN for NaN."""
    if math.isnan(rate):
        return rate
    return OUTFLOW if rate < 0.0 else INFLOW


@scalar
def four_stroke_branch(rate: float, phi: float, head_at: float, firing: float, forward: float) -> float:
    """Branch of a four-stroke engine's diagram.

    Parameters
    ----------
    rate : float
        Rate of travel in any unit, negative while the piston moves toward the head.
    phi : float
        Crank angle [rad].
    head_at : float
        Crank angle of a head-end dead centre [rad].
    firing : float
        Expansion starts at the first head-end dead centre at or after this angle [rad].
    forward : float
        Sign of the crank's speed.

    Returns
    -------
    float
        EXPANSION, OUTFLOW, INFLOW or COMPRESSION; NaN if rate or crank angle is NaN.
    """
    if math.isnan(rate) or math.isnan(phi):
        return math.nan
    turn = math.tau
    # A dead centre within rounding of the firing angle counts, not the one a turn later.
    turns_to_fire = math.ceil(forward * (firing - head_at) / turn - _SAME_TURN)
    since = forward * (phi - head_at) / turn - turns_to_fire
    # At a dead centre the rate selects the stroke before or after it.
    since += -_SAME_TURN if rate < 0.0 else _SAME_TURN
    if math.floor(since) % 2 == 0:
        return OUTFLOW if rate < 0.0 else EXPANSION
    return COMPRESSION if rate < 0.0 else INFLOW


@scalar
def two_stroke_branch(travel: float, stroke: float, rate: float, port: float) -> float:
    """Branch of a two-stroke engine's diagram.

    Parameters
    ----------
    travel, stroke : float
        [m].
    rate : float
        Rate of travel in any unit, negative while the piston moves toward the head.
    port : float
        Fraction of the stroke beyond which the ports are open.

    Returns
    -------
    float
        EXPANSION, OUTFLOW (ports open) or COMPRESSION; NaN if travel or rate is NaN.
    """
    if math.isnan(travel) or math.isnan(rate):
        return math.nan
    if travel > port * stroke:
        return OUTFLOW
    return COMPRESSION if rate < 0.0 else EXPANSION


@scalar
def flows_in(branch: float) -> float:
    """1 on the branch INFLOW of a diagram, 0 on any other; NaN for NaN."""
    if math.isnan(branch):
        return branch
    return 1.0 if branch == INFLOW else 0.0


@scalar
def line_pressure(branch: float, inflow: float, outflow: float) -> float:
    """Pressure of the line to which the cylinder is open [Pa].

    Parameters
    ----------
    branch : float
        INFLOW or OUTFLOW.
    inflow, outflow : float
        Pressures of the lines [Pa].

    Returns
    -------
    float
        [Pa]; NaN on any other branch.
    """
    other = outflow if branch == OUTFLOW else math.nan
    return inflow if branch == INFLOW else other


@scalar
def branch_pressure(
    branch: float, travel: float, cylinder: Cylinder, pressures: Pressures, exponents: Exponents
) -> float:
    """Pressure along a branch of a diagram: a smooth function of travel.

    Parameters
    ----------
    branch : float
        EXPANSION, OUTFLOW, INFLOW or COMPRESSION.
    travel : float
        [m].
    cylinder : Cylinder
    pressures : Pressures
    exponents : Exponents

    Returns
    -------
    float
        [Pa]; NaN if branch or travel is NaN.
    """
    stroke, clearance, port = cylinder
    inflow, outflow, peak = pressures
    n_compression, n_expansion = exponents
    least = clearance * stroke
    length = travel + least
    # Rounding can make the travel at the dead centre slightly negative.
    length = least if travel < 0.0 else length
    expands = branch == EXPANSION
    before = least if expands else port * stroke + least
    pressure = peak if expands else inflow
    exponent = n_compression if branch == COMPRESSION else math.nan
    exponent = n_expansion if expands else exponent
    # At line pressure the exponent is 0.
    pressure = outflow if branch == OUTFLOW else pressure
    exponent = 0.0 if (branch == INFLOW) | (branch == OUTFLOW) else exponent
    # p V^n is constant.
    return pressure * power(before / length, exponent)


def compressor_peak(
    clearance: ArrayLike, suction: ArrayLike, discharge: ArrayLike, n_compression: ArrayLike
) -> np.ndarray:
    """Pressure at the head-end dead centre of a compressor: discharge pressure, or that reached by compression [Pa].

    Parameters
    ----------
    clearance : array_like
        Clearance volume / swept volume, above 0.
    suction, discharge : array_like
        Line pressures [Pa].
    n_compression : array_like
        Polytropic exponent.
    """
    clearance = np.asarray(clearance, float)
    return np.minimum(discharge, suction * ((1.0 + clearance) / clearance) ** n_compression)


def compressor_opening_travels(
    clearance: ArrayLike, suction: ArrayLike, discharge: ArrayLike, n_compression: ArrayLike, n_expansion: ArrayLike
) -> tuple[np.ndarray, np.ndarray]:
    """Travel at which the valves of a compressor open, as a fraction of the stroke.

    Parameters
    ----------
    clearance, suction, discharge, n_compression : array_like
        As in `compressor_peak`.
    n_expansion : array_like
        Polytropic exponent.

    Returns
    -------
    discharge_opens, suction_opens : numpy.ndarray
        Toward the head, 0 or less if the valve never opens; on the return stroke, 1 or more if it never opens.
    """
    clearance = np.asarray(clearance, float)
    peak = compressor_peak(clearance, suction, discharge, n_compression)
    compressed = (suction / np.asarray(discharge, float)) ** (1.0 / np.asarray(n_compression, float))
    expanded = (peak / suction) ** (1.0 / np.asarray(n_expansion, float))
    return (1.0 + clearance) * compressed - clearance, clearance * expanded - clearance
