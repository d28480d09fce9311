"""Numbers in practical units (mm, rpm, kN·m instead of m, rad s-1, N m) with significant digits only."""

import math
import re
from collections import Counter
from collections.abc import Iterable, Mapping
from contextvars import ContextVar
from types import MappingProxyType

import numpy as np

from engine import described_dimension, in_text

# Units for each SI unit in ascending order: (name, size in SI units).
_SCALES: dict[str, tuple[tuple[str, float], ...]] = {
    "m": (("mm", 1e-3), ("m", 1.0)),
    "rad": (("°", math.pi / 180), ("rev", 2 * math.pi)),
    "rad s-1": (("rpm", math.pi / 30),),
    "kg": (("g", 1e-3), ("kg", 1.0), ("t", 1e3)),
    "N": (("N", 1.0), ("kN", 1e3), ("MN", 1e6)),
    "N m": (("N·m", 1.0), ("kN·m", 1e3), ("MN·m", 1e6)),
    "N m rad-1": (("N·m/rad", 1.0), ("kN·m/rad", 1e3), ("MN·m/rad", 1e6)),
    "J": (("J", 1.0), ("kJ", 1e3), ("MJ", 1e6)),
    "W": (("W", 1.0), ("kW", 1e3), ("MW", 1e6)),
    "Pa": (("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6)),
    "kg m2": (("kg·m²", 1.0),),
    "kg m": (("g·mm", 1e-6), ("kg·mm", 1e-3)),
}
_POWERS = str.maketrans("23456789", "²³⁴⁵⁶⁷⁸⁹")
_PLAIN = {
    "m s-1": "m/s",
    "m s-2": "m/s²",
    "rad s-2": "rad/s²",
    "kg m-3": "kg/m³",
    "m2": "m²",
    "m3": "m³",
    "N m-1": "N/m",
    "N s m-1": "N·s/m",
    "N m s rad-1": "N·m·s/rad",
    "kg m2 rad-1": "kg·m²/rad",
    "m rad-1": "m/rad",
    "m rad-2": "m/rad²",
    "rad rad-1": "rad/rad",
    "rad rad-2": "rad/rad²",
}


# Non-SI units, displayed if a scene mostly uses them.
_OTHER_SYSTEMS = frozenset(
    (
        *("in", "inch", "ft", "yd", "mil", "thou", "lb", "lbm", "oz", "slug", "mph", "hp", "PS"),
        *("lbf", "ozf", "kip", "kgf", "kp", "gf", "psi", "ksi", "atm"),
    )
)
# Factor from SI and label by SI unit, for the scene read last.
_as_given: ContextVar[Mapping[str, tuple[float, str]]] = ContextVar("units as given", default=MappingProxyType({}))
# The same for all units, as spelled in the scene.
_as_written: ContextVar[Mapping[str, tuple[float, str]]] = ContextVar("units as written", default=MappingProxyType({}))


def show_in_units(given: Iterable[tuple[str, str]]) -> None:
    """Display numbers in the non-SI units of a scene from now on.

    Parameters
    ----------
    given : iterable of (str, str)
        Dimension and unit of each of its numbers; the majority counts.
    """
    counts: dict[str, Counter[str]] = {}
    for dimension, unit in given:
        if unit and dimension != "number":
            counts.setdefault(dimension, Counter())[unit] += 1
    usual = {dimension: units.most_common(1)[0][0] for dimension, units in counts.items()}
    _as_written.set({described_dimension(d).unit: (1.0 / in_text(f"1 {unit}", d), unit) for d, unit in usual.items()})
    usual = {d: unit for d, unit in usual.items() if _OTHER_SYSTEMS.intersection(re.findall("[A-Za-z]+", unit))}
    length, force = usual.get("length"), usual.get("force")
    derived = {"speed": f"{length}/s", "acceleration": f"{length}/s2"} if length else {}
    derived |= {"moment": f"{force} {length}", "stiffness": f"{force}/{length}"} if length and force else {}
    shown = {}
    for dimension, unit in (derived | usual).items():
        label = re.sub(r"(?<=[A-Za-z])[2-9]", lambda power: power[0].translate(_POWERS), unit).replace(" ", "·")
        shown[described_dimension(dimension).unit] = (1.0 / in_text(f"1 {unit}", dimension), label)
    _as_given.set(shown)


def units_shown() -> Mapping[str, tuple[float, str]]:
    """Factor from SI and label of the displayed non-SI units, by SI unit."""
    return dict(_as_given.get())


def units_written() -> Mapping[str, tuple[float, str]]:
    """Factor from SI and spelling of a scene's most frequent units, by SI unit."""
    return dict(_as_written.get())


def show_units(shown: Mapping[str, tuple[float, str]], written: Mapping[str, tuple[float, str]]) -> None:
    """Restore units from `units_shown` and `units_written`."""
    for kept, given in ((_as_given, shown), (_as_written, written)):
        kept.set({units: (float(factor), label) for units, (factor, label) in given.items()})


def engineer_unit(units: str, values: np.ndarray) -> tuple[float, str]:
    """Factor from SI and label of the most readable unit.

    Parameters
    ----------
    units : str
        CF unit ("kg m2").
    values : ndarray
        Displayed values; the largest finite one decides between mm and m, N and kN.

    Returns
    -------
    factor : float
        Multiply SI values by it.
    label : str
        Unit label ("kN·m"); "1" for plain numbers.
    """
    if (own := _as_given.get().get(units)) is not None:
        return own
    scale = _SCALES.get(units)
    if scale is None and units not in _PLAIN and units.endswith(" m-1"):
        # Derivatives with respect to a length.
        scale = tuple((f"{name}/mm", size * 1e3) for name, size in _SCALES.get(units.removesuffix(" m-1"), ()))
    if not scale:
        return 1.0, unit_label(units) or units
    finite = np.abs(np.asarray(values, float)[np.isfinite(values)])
    largest = float(finite.max()) if finite.size else 0.0
    # Metres only from 10 m on: drawings of machines are in millimetres. Angles within a cycle are in degrees.
    threshold = 10.0 if units in ("m", "rad") else 1.0
    fitting = [step for step in scale if largest >= threshold * step[1]]
    name, size = fitting[-1] if fitting else scale[0]
    return 1.0 / size, name


def unit_label(units: str) -> str:
    """An SI unit as a fraction: "W s rad-1" as "W·s/rad"; "" for plain numbers."""
    if units in ("", "1"):
        return units.removesuffix("1")
    if units in _PLAIN:
        return _PLAIN[units]
    above, below = [], []
    for part in units.split():
        symbol = part.rstrip("-0123456789")
        power = int(part[len(symbol) :] or 1)
        size = "" if abs(power) == 1 else str(abs(power)).translate(_POWERS)
        (below if power < 0 else above).append(symbol + size)
    if not below:
        return "·".join(above) or units
    bar = "·".join(below)
    return f"{'·'.join(above) or '1'}/{f'({bar})' if len(below) > 1 else bar}"


def quantity_text(value: float, units: str, error: float | None = None) -> str:
    """A value with its error estimate in a practical unit."""
    if not math.isfinite(value):
        return "–"
    factor, label = engineer_unit(units, np.array([value]))
    unit = f" {label}" if label not in ("", "1") else ""
    return figure_text(value * factor + 0.0, None if error is None else error * factor, 5) + unit


def figure_text(value: float, error: float | None, digits: int) -> str:
    """A value with its error estimate, rounded to significant digits.

    Parameters
    ----------
    value : float
    error : float or None
        Shown with one digit.
    digits : int
        Maximum number of significant digits.
    """
    plain = f"{value:.{digits}g}"
    if error is None or not math.isfinite(error):
        return plain
    first, last = _exponent(value), _exponent(error, 0)
    if error == 0 or first - last >= digits:
        return f"{plain} ± {error:.1g}"
    # Adding 0 turns −0 into 0.
    rounded = round(value, -last) + 0.0
    if -5 < last < digits:
        places = max(-last, 0)
        return f"{rounded:.{places}f} ± {round(error, -last):.{places}f}"
    shown = f"{rounded:.{max(first - last, 0)}e}" if rounded else "0"
    return f"{shown} ± {error:.0e}"


def _exponent(number: float, places: int = 16) -> int:
    """The power of ten of a number's first digit after rounding."""
    return int(f"{number:.{places}e}".partition("e")[2])
