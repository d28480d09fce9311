"""Quantities with units in texts: "80 mm", "1450 rpm", "12 kN" become SI numbers.

A text is one number and one unit, read by a strict grammar: it is neither evaluated nor guessed. Each unit is defined
by earlier ones, down to metre, kilogram, second and radian.

Evenly spaced numbers are given by the first, the last and their count: "40 mm to 80 mm, 5".
"""

from __future__ import annotations

import datetime
import difflib
import functools
import math
import numbers
import re
from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from decimal import Context, Decimal, localcontext

import numpy as np

from engine.units.dimensions import DIMENSIONS, Powers, common_units, described, in_words, with_example
from engine.words.user_error import UserError

# Whole numbers up to this are numbers of float64.
COUNTED = 2**53


class UnitError(UserError, ValueError):
    """A quantity that cannot be read, or whose unit does not fit; the message says how to correct it."""


_TWO_PI = "6.283185307179586476925286766559005768394"

# Each line defines a unit; the names that follow it are its decimal multiples by their prefixes, or other spellings.
# gal is the US gallon, 231 in³.
# hp is the mechanical horsepower, 550 ft lbf/s; PS the metric one, 75 kgf m/s. The pound is 0.45359237 kg, standard
# gravity 9.80665 m/s², tonf the short ton-force, 2000 lbf. spm is strokes per minute, one a revolution. Ambiguous
# units are omitted: nm and kn (N m and kN in small letters), ton (three of them), cal (several), P,
# c and d.
_DEFINITIONS = f"""
m um mm cm dm km = [length]
in inch = 0.0254 m
mil thou = 2.54e-5 m
ft = 0.3048 m
yd = 0.9144 m
l ml = 1e-3 m**3
L mL = 1e-3 m**3
cc = 1e-6 m**3
gal = 3.785411784e-3 m**3
rad mrad = [angle]
rev = {_TWO_PI} rad
deg = {_TWO_PI} / 360 rad
gon = {_TWO_PI} / 400 rad
arcmin = {_TWO_PI} / 21600 rad
arcsec = {_TWO_PI} / 1296000 rad
s us ms sec = [time]
min = 60 s
h = 3600 s
Hz kHz = 1 / s
rps = {_TWO_PI} rad / s
rpm RPM spm = {_TWO_PI} / 60 rad / s
gpm = gal / 60 / s
cfm = 0.028316846592 / 60 m**3 / s
kg = [mass]
g mg = 1e-3 kg
t = 1e3 kg
lb lbs lbm = 0.45359237 kg
oz = 0.028349523125 kg
slug = 4.4482216152605 / 0.3048 kg
N mN kN MN daN = kg m / s**2
lbf = 4.4482216152605 N
ozf = 0.27801385095378125 N
kip kips klbf = 4448.2216152605 N
tonf = 8896.443230521 N
gf kgf = 9.80665e-3 N
kp = 9.80665 N
Nmm = 1e-3 N m
Nm kNm MNm = N m
Pa hPa kPa MPa GPa = N / m**2
bar mbar = 1e5 Pa
atm = 101325 Pa
psi = 4.4482216152605 / 0.00064516 Pa
ksi = 4448.2216152605 / 0.00064516 Pa
J kJ MJ mJ = N m
Wh kWh = 3600 J
W kW MW mW = J / s
hp = 745.69987158227022 W
PS = 735.49875 W
mph = 0.44704 m / s
percent = 0.01
""".strip().splitlines()
_PREFIXES = {"u": -6, "m": -3, "c": -2, "d": -1, "": 0, "da": 1, "h": 2, "k": 3, "M": 6, "G": 9}

UNIT_NAMES = tuple(name for line in _DEFINITIONS for name in line.partition(" = ")[0].split())

# Every legitimate quantity is far shorter; the bound keeps hostile texts cheap.
_LONGEST = 100
# Decimal arithmetic keeps "9 mm" at 0.009, where binary 9 * 1e-3 gives 0.009000000000000001; 40 digits leave
# the one rounding to float64 as the only error.
_DIGITS = 40

_NUMBER = r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?"
_QUANTITY = re.compile(rf"({_NUMBER})\s*(.*)", re.DOTALL)
_FRACTION = re.compile(rf"({_NUMBER})\s*/\s*([0-9]+\.?[0-9]*)")
# "1 1/4 in" and "1/3 hp", as parts in inches and motors are listed.
_MIXED = re.compile(r"([+-]?)(?:([0-9]+)(?:\s+|-))?([0-9]+)/(2|3|4|8|16|32|64)\s*([^\s0-9./].*)?", re.DOTALL)
_FACTOR = re.compile(r"([A-Za-z]+)(?:(?:\^|\*\*)?(-?[1-9]))?")
_TOKEN = re.compile(rf"\s*({_FACTOR.pattern}(?![0-9A-Za-z^])|[*/()]|1(?=\s*/))\s*")
# Characters of numbers in columns.
_OF_NUMBERS = frozenset("0123456789+-.eE \t")
# Units of mass that people write for forces, and words between hyphens.
_AS_FORCES = {"lb": "lbf", "lbs": "lbf", "oz": "ozf"}
_HYPHEN = re.compile(r"(?<=[A-Za-z0-9])-(?=[A-Za-z])")
_FOOT_POUND = re.compile(r"\b(?:(ft|in)-lbs?|lbs?-(ft|in))(?![\w^*²³-])")
_REVOLUTIONS = re.compile(r"\b[rU] ?/ ?(?=min\b|s\b)")
_TON = (
    "{!r} is ambiguous: the short ton is 2000 lb, the long ton 2240 lb, the metric ton 1000 kg, '1 t'; of force they "
    "are 2000 lbf ('1 tonf'), 2240 lbf and 9.80665 kN"
)
_GAUGE = {"psig": "14.696 psi", "barg": "1.01325 bar"}
_SPELLINGS = str.maketrans(
    {"·": "*", "⋅": "*", "×": "*", "µ": "u", "μ": "u", "°": "deg", "%": "percent"}
    | dict(zip("⁻¹²³⁴⁵⁶⁷⁸⁹", "-123456789", strict=True))
)


def to_si(value: str | float | int, dimension: str) -> float:
    """Convert a quantity to SI.

    Parameters
    ----------
    value : str, float or int
        A number is taken as SI already. A text is a number and a unit: ``"80 mm"``, ``"1 1/4 in"``, ``"0.5 kg*m^2"``,
        ``"40 N s/m"``, ``"40 N/(m/s)"``. For ``"number"`` a text is a plain number, a fraction ``"1/30"`` or
        a percentage ``"2 %"``. As a speed of rotation, ``1/min`` means revolutions per minute.
    dimension : str
        A key of `DIMENSIONS`, or an SI unit without a name in it.

    Returns
    -------
    float
        The value in SI, finite and correctly rounded.

    Raises
    ------
    UnitError
        If the value is neither number nor text, is not finite, cannot be read, or its unit does not fit.
    KeyError
        If `dimension` is neither.
    """
    described(dimension)
    if isinstance(value, str):
        return _read_text(value, dimension)
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        raise UnitError(f"expected {with_example(dimension)}, got {shown(value)}")
    return _in_range(value, shown(value), in_words(dimension))


def in_text(value: str | float | int, dimension: str) -> float:
    """Convert a value read from a text file to SI; a bare number is refused unless it needs no unit.

    Parameters
    ----------
    value : str, float or int
        As in `to_si`, but a number is accepted only for the dimension ``"number"`` or if it is exactly 0.
    dimension : str
        As in `to_si`.

    Returns
    -------
    float
        The value in SI.

    Raises
    ------
    UnitError
        As `to_si`, and for a bare number; the message proposes texts with a unit.
    KeyError
        As `to_si`.
    """
    number = to_si(value, dimension)
    if not isinstance(value, str) and number != 0 and dimension != "number":
        raise _no_unit(str(value), dimension)
    return number


def text_pattern(dimension: str) -> str:
    """Regular expression for editors, matched by every text that `in_text` accepts.

    It finds misspelt numbers and units, not units of another dimension. Python, ECMAScript and Rust read it alike.

    Parameters
    ----------
    dimension : str
        As in `to_si`.
    """
    sign = "[+\N{MINUS SIGN}-]?"
    number = _NUMBER.replace("[+-]?", sign, 1)
    mixed = rf"{sign}(?:[0-9]+(?:\s+|-))?[0-9]+/[0-9]+"
    names = "|".join([*(name.replace("u", "[uµμ]") for name in UNIT_NAMES), "r", "°", "%"])
    between = "[-0-9\\s*/()^·⋅×⁻¹²³⁴⁵⁶⁷⁸⁹]"
    unit = rf"{between}*(?:{names})(?:{between}+(?:{names}))*{between}*"
    alone = rf"{number}(?:\s*/\s*[0-9.]+)?|{mixed}" if dimension == "number" else rf"{sign}[0.]+(?:[eE][+-]?[0-9]+)?"
    return rf"^\s*(?:(?:{number}|{mixed}){unit}|{alone})\s*$"


def column_in_text(cells: Sequence[str] | np.ndarray, unit: str, dimension: str) -> list[float]:
    """Convert a column of numbers that have one unit to SI.

    Parameters
    ----------
    cells : sequence of str, or ndarray
        Numbers without units; of texts each is rounded correctly, like "80 mm" by `in_text`.
    unit : str
        Their common unit, "" for none.
    dimension : str
        As in `to_si`.

    Returns
    -------
    list of float
        In SI.

    Raises
    ------
    UnitError
        As `in_text`, for the first cell that is wrong.
    KeyError
        As `to_si`.
    """
    if not unit and dimension != "number":
        return [in_text(cell if isinstance(cell, str) else float(cell), dimension) for cell in cells]
    expected = with_example(dimension)
    factor = _factor(unit, dimension) if unit else Decimal(1)
    if isinstance(cells, np.ndarray):
        found = (cells * float(factor)).tolist()
        texts = [repr(cell) for cell in cells.tolist()] if not all(map(math.isfinite, found)) else []
    else:
        with localcontext(Context(prec=_DIGITS)):
            # Other texts that Decimal reads, such as "nan" or "1_000", contain other characters.
            if set("".join(cells)) <= _OF_NUMBERS:
                with suppress(ArithmeticError, OverflowError):
                    found = [float(Decimal(cell) * factor) for cell in cells]
                    if all(map(math.isfinite, found)):
                        return found
        found, texts = [], list(cells)
    for cell in texts:
        _number_and_unit(_stripped(cell, expected), expected)
        found.append(in_text(f"{cell.strip()} {unit}".strip(), dimension))
    return found


def _read_text(text: str, dimension: str) -> float:
    stripped = _stripped(text, with_example(dimension))
    with localcontext(Context(prec=_DIGITS)):
        try:
            return _in_range(_evaluate(stripped, dimension), f"{text!r}", in_words(dimension))
        except ArithmeticError:
            raise UnitError(f"{text!r} is not a finite {in_words(dimension)}") from None


def shown(value: object) -> str:
    """A value for a message, in the spelling of scenes."""
    if isinstance(value, bool | np.bool_):
        return str(value).lower()
    return shortened(str(value) if isinstance(value, datetime.date | datetime.time) else repr(value))


def shortened(text: str, most: int = 60) -> str:
    """A text for a message, without what exceeds `most` characters."""
    return text if len(text) <= most else f"{text[: most - 3]}..."


def _stripped(text: str, expected: str) -> str:
    if len(text) > _LONGEST:
        raise UnitError(f"expected {expected}, got a text of {len(text)} characters: {shortened(text, 23)!r}")
    return text.strip().replace("\N{MINUS SIGN}", "-")


def _evaluate(text: str, dimension: str) -> Decimal:
    if dimension == "number" and (fraction := _FRACTION.fullmatch(text)):
        return Decimal(fraction[1]) / Decimal(fraction[2])
    number, unit = _number_and_unit(text, with_example(dimension))
    if unit:
        return number * _factor(unit, dimension)
    if number != 0 and dimension != "number":
        raise _no_unit(text, dimension)
    return number


def _number_and_unit(text: str, expected: str) -> tuple[Decimal, str]:
    if (mixed := _MIXED.fullmatch(text)) is not None:
        sign, whole, above, below, unit = mixed.groups("")
        return (Decimal(whole or 0) + Decimal(above) / Decimal(below)) * Decimal(f"{sign}1"), unit
    quantity = _QUANTITY.fullmatch(text)
    if quantity is None:
        raise UnitError(f"expected {expected}, got {text!r}, which does not begin with a number")
    unit = quantity[2]
    if unit.startswith(","):
        raise UnitError(comma_advice(text))
    if re.match(r":\s*[0-9]", unit):
        raise UnitError(f"{text!r}: write a ratio as a fraction, as in '1/10'")
    if re.match(r"[0-9.](?!\s*/)", unit):
        raise UnitError(f"{text!r}: write the number in one piece, without gaps, as in '1000'")
    return Decimal(quantity[1]), unit


def comma_advice(text: str) -> str:
    """What to write instead of a number with commas: "120,000 lbf" may be 120000 or 120.000, "1,5 mm" is 1.5 mm.

    Parameters
    ----------
    text : str
        A number that contains a comma, with or without a unit.
    """
    number = re.match(r"[+-]?[0-9.,]*", text)[0].rstrip(",.")
    whole, point = number.replace(",", ""), number.replace(",", ".")
    if re.fullmatch(r"[+-]?[1-9][0-9]{0,2},[0-9]{3}", number):
        return f"{text!r} is ambiguous: {whole} or {point}? Write it without the comma"
    if re.fullmatch(r"[+-]?[1-9][0-9]{0,2}(,[0-9]{3})+(\.[0-9]*)?", number):
        return f"{text!r}: write the number without commas, {whole}"
    written = text.replace(number, point, 1) if point.count(".") == 1 else "1.5"
    return f"{text!r}: use a decimal point, not a comma, as in {written!r}"


def _in_range(value: numbers.Real | Decimal, shown: str, words: str) -> float:
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number) or (number == 0 and value != 0):
        raise UnitError(f"{shown} is not a finite {words}: give 0, or a magnitude from 1e-308 to 1e308 in SI units")
    return number


def _factor(unit: str, dimension: str) -> Decimal:
    """Value of 1 `unit` in the SI unit of `dimension`."""
    expected = with_example(dimension)
    powers = _read_unit(unit, expected)
    if dimension == "angular_speed" and powers == {"min": -1}:
        powers = {"rpm": 1}
    factor, kind = _factor_and_kind(powers)
    wanted = dimension_of_unit(described(dimension).unit)
    if kind == wanted:
        return factor
    # "lb in" of torque, "lb/in" of a spring: nobody means a mass there.
    if powers.keys() & _AS_FORCES.keys():
        force, kind_of_force = _factor_and_kind({_AS_FORCES.get(name, name): p for name, p in powers.items()})
        if kind_of_force == wanted:
            return force
    if wanted.angle and kind == wanted.plain:
        units = " or ".join(common_units(dimension))
        raise UnitError(f"{unit!r} is ambiguous for {in_words(dimension, article=True)}: write {units}")
    raise UnitError(f"expected {expected}, got {unit!r}")


def _factor_and_kind(powers: Mapping[str, int]) -> tuple[Decimal, Powers]:
    """Return the SI value of a product of units and its powers of the base units."""
    return _product((_units()[name], power) for name, power in powers.items())


def _product(factors: Iterable[tuple[tuple[Decimal, Powers], int]]) -> tuple[Decimal, Powers]:
    """Product of powers of units."""
    value, kind = Decimal(1), Powers()
    for (factor, own), power in factors:
        value *= factor**power
        kind *= own**power
    return value, kind


@functools.cache
def _units() -> dict[str, tuple[Decimal, Powers]]:
    """The SI value of each unit and its powers of the base units."""
    known: dict[str, tuple[Decimal, Powers]] = {}
    with localcontext(Context(prec=_DIGITS)):
        for line in _DEFINITIONS:
            names, _, text = line.partition(" = ")
            if text.startswith("["):
                value, kind = Decimal(1), Powers(**{text.strip("[]"): 1})
            else:
                # A number or a unit after each stroke is divided by, all others are multiplied.
                words = text.replace("/ ", "/").split()
                parts = [(word.lstrip("/").partition("**"), -1 if word.startswith("/") else 1) for word in words]
                value, kind = _product(
                    (known.get(base) or (Decimal(base), Powers()), sign * int(power or 1))
                    for (base, _, power), sign in parts
                )
            first, *others = names.split()
            known[first] = value, kind
            for name in others:
                # Another spelling has no prefix.
                known[name] = value.scaleb(_PREFIXES.get(name.removesuffix(first), 0)), kind
    return known


def _read_unit(unit: str, expected: str) -> dict[str, int]:
    """Read "N m/rad" as {"N": 1, "m": 1, "rad": -1}."""
    # A hyphen multiplies, and the pounds of "ft-lb" are of force.
    rest, tokens = _REVOLUTIONS.sub("rev/", _FOOT_POUND.sub(r"\1\2 lbf", unit)), deque()
    rest = _HYPHEN.sub(" ", rest).translate(_SPELLINGS)
    while rest:
        token = _TOKEN.match(rest)
        if token is None:
            raise _unreadable(unit, expected)
        tokens.append(token[1])
        rest = rest[token.end() :]
    powers = _read_product(tokens, unit, expected)
    if tokens or ("percent" in powers and powers != {"percent": 1}):
        raise _unreadable(unit, expected)
    return powers


def _read_product(tokens: deque[str], unit: str, expected: str) -> dict[str, int]:
    """Consume tokens up to a closing bracket or the end; return the power of each unit name."""
    powers: dict[str, int] = {}
    divided = False
    if tokens and tokens[0] == "1":
        tokens.popleft()
    while tokens and tokens[0] != ")":
        divides = tokens[0] == "/"
        if divided and not divides:
            # UDUNITS would read "N/m s" as (N/m)*s, a hand-written formula often means N/(m s).
            raise UnitError(f"{unit!r} is ambiguous after the '/': use brackets, as in 'N/(m s)'")
        divided = divides
        if divides or tokens[0] == "*":
            tokens.popleft()
        for name, power in _read_factor(tokens, unit, expected).items():
            powers[name] = powers.get(name, 0) + (-power if divides else power)
    if not powers:
        raise _unreadable(unit, expected)
    return powers


def _read_factor(tokens: deque[str], unit: str, expected: str) -> dict[str, int]:
    token = tokens.popleft() if tokens else ""
    if token == "(":
        powers = _read_product(tokens, unit, expected)
        if not tokens:
            raise _unreadable(unit, expected)
        tokens.popleft()
        return powers
    factor = _FACTOR.fullmatch(token)
    if factor is None:
        raise _unreadable(unit, expected)
    name, power = factor.groups()
    if name in ("ton", "tons"):
        raise UnitError(_TON.format(name))
    if name in _GAUGE:
        raise UnitError(f"{name!r} is a gauge pressure; pressures are absolute: add {_GAUGE[name]}")
    if name not in UNIT_NAMES:
        raise UnitError(f"unknown unit {name!r}{_did_you_mean(name)} (expected {expected})")
    return {name: int(power or 1)}


def _did_you_mean(name: str) -> str:
    folded = [known.lower() for known in UNIT_NAMES]
    # Of "mN" and "MN" for "mn" neither is likelier, so every spelling of a match is shown.
    close = [name.lower()] if name.lower() in folded else difflib.get_close_matches(name.lower(), folded, n=2)
    names = [repr(known) for match in dict.fromkeys(close) for known in UNIT_NAMES if known.lower() == match]
    return f": did you mean {' or '.join(names)}?" if names else ""


def _unreadable(unit: str, expected: str) -> UnitError:
    return UnitError(f"cannot read the unit {unit!r}; expected {expected}")


def _no_unit(number: str, dimension: str) -> UnitError:
    common, *si = common_units(dimension)
    other = f', or "{number} {si[0]}" if the SI unit is meant' if si else ""
    return UnitError(f'{number} has no unit: write "{number} {common}"{other}')


def units_in(unit: str) -> dict[str, int]:
    """The units of a compound and their powers: "lb-in" as {"in": 1, "lbf": 1}.

    Raises
    ------
    UnitError
        The unit is not known.
    """
    return _read_unit(unit, "a unit such as 'N m'")


@functools.cache
def dimension_of_unit(unit: str) -> Powers:
    """Dimension of a unit in the spelling of texts or of the CF conventions: "N m", "kg m2 rad-1", "1" for none.

    Raises
    ------
    UnitError
        The unit is unknown.
    """
    return _factor_and_kind({} if unit == "1" else units_in(unit))[1]


def recognised(value: float | str) -> tuple[float, str]:
    """SI value and dimension of a quantity in any unit, as for `to_si`; the simplest of several dimensions that fit.

    Raises
    ------
    UnitError
        The text is not a number with a known unit.
    """
    for dimension in ("number", *DIMENSIONS):
        try:
            return in_text(value, dimension), dimension
        except UnitError:
            continue
    if not isinstance(value, str):
        raise UnitError(f"{value!r} is not a quantity with a known unit, such as '80 mm'")
    try:
        number, powers = in_any_unit(value)
    except UnitError as error:
        raise UnitError(f"{value!r} is not a quantity with a known unit: {error}") from None
    return number, powers.spelled


def in_any_unit(text: str) -> tuple[float, Powers]:
    """SI value of a quantity in any unit, and its dimension.

    Parameters
    ----------
    text : str
        As for `to_si`; `1/min` is a speed of rotation.

    Returns
    -------
    value : float
    powers : Powers

    Raises
    ------
    UnitError
        The text is not a number with a known unit.
    """
    expected = "a quantity such as '80 mm'"
    stripped = _stripped(text, expected)
    with localcontext(Context(prec=_DIGITS)):
        try:
            if (fraction := _FRACTION.fullmatch(stripped)) is not None:
                number, kind = Decimal(fraction[1]) / Decimal(fraction[2]), Powers()
            else:
                number, unit = _number_and_unit(stripped, expected)
                powers = _read_unit(unit, expected) if unit else {}
                factor, kind = _factor_and_kind({"rpm": 1} if powers == {"min": -1} else powers)
                number *= factor
            return _in_range(number, f"{text!r}", "quantity"), kind
        except ArithmeticError:
            raise UnitError(f"{text!r} is not a finite quantity") from None


def unit_in(text: str) -> str:
    """The unit of a quantity's text as it is written; "" where there is none."""
    text = text.strip()
    found = _MIXED.fullmatch(text) or _QUANTITY.fullmatch(text)
    return (found[found.re.groups] or "") if found else ""


def any_quantity(text: str) -> float:
    """SI value of a quantity in any unit, in an expression."""
    return in_any_unit(text)[0]


# Numbers in even steps

# More than any count has; Python refuses to convert more than some thousands.
_MOST_DIGITS = 100


def first_last_count(text: str) -> tuple[str, str, int] | None:
    """The first number, the last and how many there are in a text such as "40 mm to 80 mm, 5"; None if it isn't one."""
    ends, _, count = text.rpartition(",")
    # Blanks are stripped afterwards: patterns for runs of them take time that grows with the square of their length.
    first, *others = re.split(r"\sto\s", ends, maxsplit=1)
    last, count = "".join(others).strip(), count.strip()
    if not (first.strip() and last and count.isdecimal() and len(count) <= _MOST_DIGITS):
        return None
    return first.strip(), last, int(count)


def even_steps(first: float, last: float, count: int, indices: np.ndarray) -> np.ndarray:
    """Some of `count` numbers in even steps from one number to another, both hit exactly.

    Ends that are short as decimal numbers have numbers between them that are rounded once, as if each were written
    down: from 0.04 to 0.08 in five there is 0.06, where sums of steps give 0.060000000000000005.

    Parameters
    ----------
    first, last : float
    count : int
    indices : ndarray
        Whole numbers from 0 to `count` − 1.
    """
    whole = _in_whole_numbers(first, last, count)
    if whole is not None:
        begin, rise, denominator = whole
        return (begin + rise * indices) / denominator
    step = (last - first) / max(count - 1, 1)
    return np.where(indices == count - 1, last, first + indices * step)


def _in_whole_numbers(first: float, last: float, count: int) -> tuple[int, int, int] | None:
    """Numerator of the first number, its rise, and the common denominator; None if any exceeds `COUNTED`."""
    steps = max(count - 1, 1)
    ends = [Decimal(repr(end)) for end in (float(first), float(last))]
    places = max(0, *(-end.as_tuple().exponent for end in ends))
    denominator = steps * 10**places
    if denominator > COUNTED or max(map(abs, ends)) * denominator > COUNTED:
        return None
    begin, end = (int(end * 10**places) for end in ends)
    return begin * steps, (end - begin if count > 1 else 0), denominator
