"""Numbers as a reader sees them: in one system of units, chosen once for each scene, with significant digits only.

Text, tables, plots, pages, exports and messages all take their units from here. Results files keep SI units.

"mm" is the metric system of drawings (mm, rpm, kN), "US" the inch-pound system (in, lbf, hp), "SI" the coherent units
only (m, rad/s, N). Angles are in degrees in all of them.

Error estimates are shown where they matter: above `TELLING` of the value, where something depends on them, or all of
them after `show_errors`.
"""

import functools
import math
import re
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import suppress
from contextvars import ContextVar
from types import MappingProxyType
from typing import Any, Literal, NamedTuple, get_args

import numpy as np

from engine.units.dimensions import DIMENSIONS
from engine.units.reading import UnitError, dimension_of_unit, in_any_unit, unit_in, units_in

UnitSystem = Literal["mm", "SI", "US"]

# Spellings follow the CF conventions ("lbf in", "in s-2"). Each row: units of an SI unit and the smallest size, in that
# unit, from which each is used; the first is also that of tables, whose columns have one unit for all sizes.
# Metric prefixes follow the size; inch-pound units don't, as nobody converts 12 and 144 mentally within one list.
_Row = Mapping[str, float]
_ANGLES: dict[str, _Row] = {"rad": {"deg": 0, "rev": 10}, "rad s-1": {"rpm": 0}} | {
    units: {units: 0} for units in ("rad s-2", "rad rad-1", "rad rad-2")
}
_METRIC = ("m s-1", "m s-2", "N m-1", "N s m-1", "N s2 m-2", "kg m-1", "kg m-2", "kg m-3", "rad N-1 m-1")
_ROWS: dict[str, dict[str, _Row]] = {
    "SI": _ANGLES | {"rad": {"deg": 0}, "rad s-1": {"rad s-1": 0}},
    "mm": _ANGLES
    | {
        # Metres only from 10 m on: drawings of machines are in millimetres.
        "m": {"mm": 0, "m": 10},
        "m2": {"mm2": 0, "m2": 1},
        "m3": {"cm3": 0, "L": 1, "m3": 1},
        "m3 s-1": {"L min-1": 0, "m3 min-1": 10},
        "kg": {"kg": 1, "g": 0, "t": 1},
        "N": {"N": 0, "kN": 1, "MN": 1},
        "N m": {"N m": 0, "kN m": 1, "MN m": 1},
        "J": {"J": 0, "kJ": 1, "MJ": 1},
        "W": {"W": 0, "kW": 1, "MW": 1},
        "Pa": {"MPa": 1, "kPa": 1, "Pa": 0},
        "kg m2": {"kg m2": 0},
        "kg m": {"kg mm": 1, "g mm": 0},
        "rad m-1": {"deg mm-1": 0},
    }
    | {units: {units: 0} for units in _METRIC},
    "US": _ANGLES
    | {
        "m": {"in": 0},
        "kg": {"lb": 0},
        "N": {"lbf": 0},
        "N m": {"lbf in": 0},
        "J": {"ft lbf": 0},
        "W": {"hp": 0},
        "Pa": {"psi": 0},
        "kg m2": {"lb ft2": 0},
        "kg m": {"oz in": 0},
        "m3 s-1": {"ft3 min-1": 0},
        "rad m-1": {"deg in-1": 0},
    },
}
# Units of the single factors of a compound that has no row above, or of those that its row leaves over.
_BASES = {
    "SI": {},
    "mm": {"m": "mm"},
    "US": {"m": "in", "kg": "lb", "N": "lbf", "J": "ft lbf", "W": "hp", "Pa": "psi"},
}
# Units that decide for a system, neutral ones, and those of each system that are shown if the scene writes them.
_AMERICAN = frozenset(
    (
        *("in", "inch", "ft", "yd", "mil", "thou", "mph", "hp"),
        *("lb", "lbs", "lbm", "oz", "slug"),
        *("lbf", "klbf", "ozf", "kip", "kips", "tonf", "psi", "ksi"),
    )
)
_NEUTRAL = frozenset(
    (
        *("rad", "mrad", "rev", "deg", "gon", "arcmin", "arcsec", "percent"),
        *("s", "us", "ms", "min", "h", "Hz", "kHz", "rps", "rpm", "RPM", "spm"),
    )
)
_OWN = {"SI": frozenset(), "mm": frozenset(["kgf", "kp", "gf", "PS", "atm"]), "US": _AMERICAN}
_ALIASES = {"inch": "in", "lbs": "lb", "lbm": "lb", "kips": "kip", "klbf": "kip"}
# Smaller numbers are written without a power of ten.
_WRITTEN_OUT = 1e7
# Error estimates below this share of the value are not shown.
TELLING = 1e-6
# Error estimates of a zero below this, in the unit shown, are rounding.
_NO_ERROR = 1e-8
_POWERS = str.maketrans("23456789", "²³⁴⁵⁶⁷⁸⁹")


class _Shown(NamedTuple):
    """The system, and the scene's own units in it by SI unit."""

    system: UnitSystem = "mm"
    own: Mapping[str, str] = MappingProxyType({})


_shown: ContextVar[_Shown] = ContextVar("units shown")
_every_error: ContextVar[bool] = ContextVar("whether every error estimate is shown", default=False)


def show_errors(every: bool) -> None:
    """Show every error estimate from now on, or only those that matter."""
    _every_error.set(every)


def show_units_of(data: Mapping[str, Any]) -> UnitSystem:
    """Show numbers in the units of a scene from now on: its key `units`, or the system of most of its texts.

    Parameters
    ----------
    data : mapping
        The scene's tables, not validated.
    """
    written = Counter(_written(data))
    system = data.get("units")
    if system not in get_args(UnitSystem):
        votes = Counter[bool]()
        for unit, count in written.items():
            votes[bool(_AMERICAN & units_in(unit).keys())] += count if units_in(unit).keys() - _NEUTRAL else 0
        system = "US" if votes[True] > votes[False] else "mm"
    own: dict[str, str] = {}
    for unit, _ in written.most_common():
        powers = units_in(unit)
        if _OWN[system] & powers.keys() and powers.keys() <= _OWN[system] | _NEUTRAL:
            own.setdefault(
                _si_unit(unit), " ".join(f"{_ALIASES.get(n, n)}{'' if p == 1 else p}" for n, p in powers.items())
            )
    own.pop("", None)
    _shown.set(_Shown(system, own))
    return system


def _written(data: object) -> Iterator[str]:
    """Units of all texts that are quantities; in a list, each unit once."""
    left = [data]
    while left:
        here = left.pop()
        if isinstance(here, Mapping):
            left += here.values()
        elif isinstance(here, list):
            yield from {unit for item in here if isinstance(item, str) for unit in _written(item)}
            left += [item for item in here if not isinstance(item, str)]
        elif isinstance(here, str) and (unit := unit_in(here)):
            with suppress(UnitError, ArithmeticError):
                dimension_of_unit(unit)
                yield unit


def _si_unit(unit: str) -> str:
    """The SI unit of a named dimension, "" if there is none."""
    powers = dimension_of_unit(unit)
    return next((d.unit for d in DIMENSIONS.values() if d.unit != "1" and dimension_of_unit(d.unit) == powers), "")


def units_shown() -> dict[str, Any]:
    """The units shown, for `show_units`, as JSON data."""
    system, own = _shown.get(_Shown())
    return {"system": system, "own": dict(own)}


def show_units(shown: Mapping[str, Any]) -> None:
    """Show numbers in the units from `units_shown` from now on."""
    _shown.set(_Shown(shown.get("system", "mm"), shown.get("own", {})))


def show_system(system: UnitSystem) -> None:
    """Show numbers in a system from now on, with the scene's own units if it is the one shown already."""
    if _shown.get(_Shown()).system != system:
        _shown.set(_Shown(system))


@functools.lru_cache(1024)
def _row(units: str, system: UnitSystem, own: tuple[tuple[str, str], ...]) -> tuple[tuple[str, float, float], ...]:
    """Units of an SI unit: name, size in SI units, and least number shown in it; the first is that of tables."""
    rows = _ROWS[system] | {si: {unit: 0.0} for si, unit in own}
    bases = _BASES[system] | {si: unit for si, unit in own if " " not in f"{si}{unit}"}
    words, found = units.split(), rows.get(units)
    if found is None:
        begins = [" ".join(words[:n]) for n in range(len(words) - 1, 0, -1)]
        begin = next((part for part in begins if part in rows and part != "rad"), "")
        rest = [_in_base(word, bases) for word in words[len(begin.split()) :]]
        found = {" ".join([*unit.split(), *rest]): least for unit, least in rows.get(begin, {"": 0.0}).items()}
    if bases.get("m") == "ft":
        found = {re.sub(r"\bin(?![a-z])", "ft", unit): least for unit, least in found.items()}
    return tuple((unit, in_any_unit(f"1 {unit}")[0], least) for unit, least in found.items())


def _in_base(word: str, bases: Mapping[str, str]) -> str:
    symbol = word.rstrip("-0123456789")
    power = word[len(symbol) :]
    return " ".join(f"{base}{power}" for base in bases.get(symbol, symbol).split())


def _choices(units: str) -> tuple[tuple[str, float, float], ...]:
    system, own = _shown.get(_Shown())
    return _row(units, system, tuple(own.items()))


def display_unit(units: str, values: np.ndarray) -> tuple[float, str]:
    """Factor from SI and label of the unit in which some numbers are shown.

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
    if units in ("", "1"):
        return 1.0, units or "1"
    finite = np.abs(np.asarray(values, float)[np.isfinite(values)])
    largest = float(finite.max()) if finite.size else 0.0
    choices = sorted(_choices(units), key=lambda choice: choice[1])
    name, size, _ = next((c for c in reversed(choices) if largest >= c[2] * c[1]), choices[0])
    return 1.0 / size, unit_label(name)


def table_unit(units: str) -> tuple[float, str]:
    """Size in SI units and name of the unit of a table's column; the name reads back: "lbf in", "in s-2".

    Parameters
    ----------
    units : str
        CF unit ("kg m2").
    """
    if units in ("", "1"):
        return 1.0, units
    name, size, _ = _choices(units)[0]
    return size, name


def unit_label(units: str) -> str:
    """A unit as a fraction: "W s rad-1" as "W·s/rad", "deg" as "°"; "" for plain numbers."""
    above, below = [], []
    for part in units.replace("deg", "°").split():
        symbol = part.rstrip("-0123456789")
        power = int(part[len(symbol) :] or 1)
        size = "" if abs(power) == 1 else str(abs(power)).translate(_POWERS)
        if symbol:
            (below if power < 0 else above).append(symbol + size)
    if not below:
        return "·".join(above)
    bar = "·".join(below)
    return f"{'·'.join(above) or '1'}/{f'({bar})' if len(below) > 1 else bar}"


def quantity_text(value: float, units: str, error: float | None = None, decides: bool = False) -> str:
    """A value with its error estimate in a practical unit.

    Parameters
    ----------
    value : float
        SI.
    units : str
        CF unit ("kg m2").
    error : float, optional
        SI.
    decides : bool
        As for `figure_text`.
    """
    if not math.isfinite(value):
        return "–"
    factor, label = display_unit(units, np.array([value]))
    unit = f" {label}" if label not in ("", "1") else ""
    return figure_text(value * factor + 0.0, None if error is None else error * factor, 5, decides) + unit


def figure_text(value: float, error: float | None, digits: int, decides: bool = False) -> str:
    """A value with its error estimate if that matters, rounded to significant digits.

    Parameters
    ----------
    value : float
    error : float or None
        Shown with one digit.
    digits : int
        Maximum number of significant digits.
    decides : bool
        Whether something depends on the error estimate, so that it is shown however small.
    """
    plain = f"{value:.{digits}g}"
    if abs(value) < _WRITTEN_OUT and "e+" in plain:
        plain = f"{float(plain):.0f}"
    if error is None or not math.isfinite(error):
        return plain
    asked = decides or _every_error.get()
    if not asked and error <= TELLING * abs(value):
        return plain
    if not asked and abs(value) <= error < _NO_ERROR:
        return "0"
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
