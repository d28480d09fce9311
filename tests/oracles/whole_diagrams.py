"""Whole indicator diagrams, stroke by stroke, as textbooks write them: the branches of the laws make them up."""

import math


def _gas_length(travel: float, stroke: float, clearance: float) -> float:
    """Gas volume over piston area [m]."""
    # Rounding puts the dead centre at a travel just below 0; without clearance the volume would be negative.
    return max(travel, 0.0) + clearance * stroke


def _polytropic(pressure: float, before: float, after: float, exponent: float) -> float:
    """Pressure after a polytropic change of volume, p V^n constant."""
    return math.inf if after == 0.0 else pressure * (before / after) ** exponent


def _compressor_compression(length: float, most: float, suction: float, discharge: float, exponent: float) -> float:
    return min(_polytropic(suction, most, length, exponent), discharge)


def polytropic_compressor(travel, stroke, clearance, toward_head, suction, discharge, n_compression, n_expansion):
    """Pressure in a compressor cylinder with polytropic compression and re-expansion.

    Toward the head p = suction · (V_max/V)^n until the discharge valve opens; away from it the gas left in
    the clearance expands, p = discharge · (V_min/V)^n, until the suction valve opens. Where the clearance is
    so large that the discharge pressure isn't reached, the expansion begins at the pressure that is.

    Parameters
    ----------
    travel : float
        From the head-end dead centre [m], 0 ... stroke.
    stroke : float
        [m].
    clearance : float
        Clearance volume / swept volume, 0 and above.
    toward_head : bool
        Whether the piston moves toward the head.
    suction, discharge : float
        Pressures of the lines [Pa], suction below discharge.
    n_compression, n_expansion : float
        Polytropic exponents.

    Returns
    -------
    float
        Pressure [Pa].
    """
    length = _gas_length(travel, stroke, clearance)
    least = clearance * stroke
    most = stroke + least
    if toward_head:
        return _compressor_compression(length, most, suction, discharge, n_compression)
    if length == 0.0:
        # Without clearance no gas is left that could expand.
        return suction
    reached = _compressor_compression(least, most, suction, discharge, n_compression)
    return max(_polytropic(reached, least, length, n_expansion), suction)


def pump(toward_head: bool, suction: float, discharge: float) -> float:
    """Pressure in the cylinder of a pump for a liquid: the rectangular diagram.

    Parameters
    ----------
    toward_head : bool
        Whether the piston moves toward the head.
    suction, discharge : float
        Pressures of the lines [Pa].

    Returns
    -------
    float
        Pressure [Pa].
    """
    return discharge if toward_head else suction


def four_stroke_engine(travel, stroke, clearance, stroke_number, intake, exhaust, peak, n_compression, n_expansion):
    """Pressure in a four-stroke engine with combustion at constant volume (Otto cycle).

    Parameters
    ----------
    travel : float
        From the head-end dead centre [m], 0 ... stroke.
    stroke : float
        [m].
    clearance : float
        Clearance volume / swept volume, 1/(compression ratio - 1).
    stroke_number : int
        0 power, 1 exhaust, 2 intake, 3 compression.
    intake, exhaust, peak : float
        Pressure of intake, of exhaust, and after combustion at the head-end dead centre [Pa].
    n_compression, n_expansion : float
        Polytropic exponents.

    Returns
    -------
    float
        Pressure [Pa].
    """
    if stroke_number == 1:
        return exhaust
    if stroke_number == 2:
        return intake
    length = _gas_length(travel, stroke, clearance)
    least = clearance * stroke
    if stroke_number == 0:
        return _polytropic(peak, least, length, n_expansion)
    return _polytropic(intake, stroke + least, length, n_compression)


def two_stroke_engine(
    travel, stroke, clearance, stroke_number, intake, exhaust, peak, n_compression, n_expansion, port
):
    """Pressure in a two-stroke engine whose ports the piston opens and closes.

    The cylinder is at exhaust pressure while the ports are open, and charged to intake pressure when they
    close.

    Parameters
    ----------
    travel : float
        From the head-end dead centre [m], 0 ... stroke.
    stroke : float
        [m].
    clearance : float
        Clearance volume / swept volume.
    stroke_number : int
        0 power (away from the head), 1 compression (toward it).
    intake, exhaust, peak : float
        Pressure of the fresh charge, of exhaust, and after combustion at the head-end dead centre [Pa].
    n_compression, n_expansion : float
        Polytropic exponents.
    port : float
        Fraction of the stroke beyond which the ports are open.

    Returns
    -------
    float
        Pressure [Pa].
    """
    if travel > port * stroke:
        return exhaust
    length = _gas_length(travel, stroke, clearance)
    least = clearance * stroke
    if stroke_number == 0:
        return _polytropic(peak, least, length, n_expansion)
    return _polytropic(intake, port * stroke + least, length, n_compression)
