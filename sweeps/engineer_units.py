"""Units as an engineer reads them: mm, rpm, kN·m instead of m, rad s-1, N m."""

import math

import numpy as np

# For each SI unit, the units to choose from, from small to large: (name, size in SI units).
_SCALES: dict[str, tuple[tuple[str, float], ...]] = {
    "m": (("mm", 1e-3), ("m", 1.0)),
    "rad": (("°", math.pi / 180),),
    "rad s-1": (("rpm", math.pi / 30),),
    "kg": (("g", 1e-3), ("kg", 1.0), ("t", 1e3)),
    "N": (("N", 1.0), ("kN", 1e3), ("MN", 1e6)),
    "N m": (("N·m", 1.0), ("kN·m", 1e3), ("MN·m", 1e6)),
    "J": (("J", 1.0), ("kJ", 1e3), ("MJ", 1e6)),
    "W": (("W", 1.0), ("kW", 1e3), ("MW", 1e6)),
    "Pa": (("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6)),
    "kg m2": (("kg·m²", 1.0),),
}
_PLAIN = {
    "m s-1": "m/s",
    "m s-2": "m/s²",
    "kg m-3": "kg/m³",
    "m2": "m²",
    "m3": "m³",
    "N m-1": "N/m",
    "N s m-1": "N·s/m",
    "N m rad-1": "N·m/rad",
    "N m s rad-1": "N·m·s/rad",
    "kg m2 rad-1": "kg·m²/rad",
    "m rad-1": "m/rad",
    "m rad-2": "m/rad²",
    "rad rad-1": "rad/rad",
    "rad rad-2": "rad/rad²",
}


def engineer_unit(units: str, values: np.ndarray) -> tuple[float, str]:
    """Factor from SI and label of the unit in which values read best.

    Parameters
    ----------
    units : str
        SI unit as CF spells it ("kg m2").
    values : ndarray
        The values to be shown; the largest finite one decides between mm and m, N and kN.

    Returns
    -------
    factor : float
        Multiply SI values by it.
    label : str
        Unit as written on an axis ("kN·m"); "1" for plain numbers.
    """
    scale = _SCALES.get(units)
    if scale is None:
        return 1.0, _PLAIN.get(units, units)
    finite = np.abs(np.asarray(values, float)[np.isfinite(values)])
    largest = float(finite.max()) if finite.size else 0.0
    # Metres only from 10 m on: drawings of machines are in millimetres.
    threshold = 10.0 if units == "m" else 1.0
    fitting = [step for step in scale if largest >= threshold * step[1]]
    name, size = fitting[-1] if fitting else scale[0]
    return 1.0 / size, name
