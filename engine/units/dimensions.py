"""The dimensions of a machine's numbers: the SI unit of each, and how it is written in texts.

The plane angle counts as a separate dimension, so "N m" and "N m/rad" are different units, and 1/s is
not a speed of rotation.
"""

import operator
import re
from collections.abc import Mapping
from fractions import Fraction
from types import MappingProxyType
from typing import NamedTuple


class Dimension(NamedTuple):
    """How one dimension is written.

    Attributes
    ----------
    unit : str
        SI unit as UDUNITS and the CF conventions spell it, such as ``"rad s-1"``.
    example : str
        A text that `to_si` accepts for this dimension, such as ``"1450 rpm"``.
    """

    unit: str
    example: str


class Powers(NamedTuple):
    """Powers of the base units in a quantity; quantities multiply and divide, so do their powers."""

    mass: int | Fraction = 0
    length: int | Fraction = 0
    time: int | Fraction = 0
    angle: int | Fraction = 0

    @property
    def plain(self) -> "Powers":
        """The powers without that of the angle."""
        return self._replace(angle=0)

    @property
    def spelled(self) -> str:
        """The SI unit as the CF conventions spell it, "kg m2"; they have none for fractions, such as "m1/2"."""
        powers = zip(("kg", "m", "s", "rad"), self, strict=True)
        return " ".join(symbol if power == 1 else f"{symbol}{power}" for symbol, power in powers if power)

    def __bool__(self) -> bool:
        return any(self)

    def __mul__(self, other: "Powers") -> "Powers":
        return Powers(*map(operator.add, self, other))

    def __truediv__(self, other: "Powers") -> "Powers":
        return Powers(*map(operator.sub, self, other))

    def __pow__(self, exponent: int | Fraction) -> "Powers":
        return Powers(*[exponent * power for power in self])


DIMENSIONS: Mapping[str, Dimension] = MappingProxyType(
    {
        "number": Dimension("1", "0.3"),
        "length": Dimension("m", "80 mm"),
        "area": Dimension("m2", "12 cm2"),
        "volume": Dimension("m3", "450 cm3"),
        "angle": Dimension("rad", "30 deg"),
        "time": Dimension("s", "20 ms"),
        "mass": Dimension("kg", "1.2 kg"),
        "inertia": Dimension("kg m2", "0.5 kg m2"),
        "density": Dimension("kg m-3", "7850 kg/m3"),
        "area_density": Dimension("kg m-2", "15.7 kg/m2"),
        "linear_density": Dimension("kg m-1", "2.5 kg/m"),
        "speed": Dimension("m s-1", "2.5 m/s"),
        "acceleration": Dimension("m s-2", "9.81 m/s2"),
        "angular_speed": Dimension("rad s-1", "1450 rpm"),
        "angular_acceleration": Dimension("rad s-2", "20 rad/s2"),
        "force": Dimension("N", "12 kN"),
        "moment": Dimension("N m", "7 N m"),
        "pressure": Dimension("Pa", "6 bar"),
        "power": Dimension("W", "1.5 kW"),
        "energy": Dimension("J", "2 kJ"),
        "stiffness": Dimension("N m-1", "8 N/mm"),
        "torsional_stiffness": Dimension("N m rad-1", "500 N m/rad"),
        "damping": Dimension("N s m-1", "40 N s/m"),
        "torsional_damping": Dimension("N m s rad-1", "0.2 N m s/rad"),
        "quadratic_drag": Dimension("N s2 m-2", "0.8 N s2/m2"),
        "torsional_quadratic_drag": Dimension("N m s2 rad-2", "0.003 N m s2/rad2"),
    }
)


_SI_UNIT = re.compile(r"(?:kg|m|s|rad)(?:-?[1-9])?(?: (?:kg|m|s|rad)(?:-?[1-9])?)*")


def described(dimension: str) -> Dimension:
    """How a dimension is written: a key of `DIMENSIONS`, or, for one without a name, its SI unit, "kg m-2 s-2".

    Raises
    ------
    KeyError
        It is neither.
    """
    if dimension not in DIMENSIONS and _SI_UNIT.fullmatch(dimension):
        return Dimension(dimension, f"1 {_with_bars(dimension)}")
    if dimension not in DIMENSIONS:
        raise KeyError(f"unknown dimension {dimension!r}; known are {', '.join(DIMENSIONS)}")
    return DIMENSIONS[dimension]


def common_units(dimension: str) -> tuple[str, ...]:
    """Units usual in texts: that of the dimension's example, and the SI unit if different.

    Parameters
    ----------
    dimension : str
        As for `described`, except "number".

    Returns
    -------
    tuple of str
        For instance ("mm", "m").
    """
    described_so = described(dimension)
    return tuple(dict.fromkeys([described_so.example.partition(" ")[2], _with_bars(described_so.unit)]))


def _with_bars(unit: str) -> str:
    """Spell an SI unit with bars: "N s2 m-2" as "N s2/m2"."""
    return re.sub(r" ([a-z]+)-(?:1\b)?", r"/\1", unit)


def in_words(dimension: str, *, article: bool = False) -> str:
    """A dimension in messages: "angular speed", with its article "an angular speed"."""
    words = dimension.replace("_", " ") if dimension in DIMENSIONS else f"quantity in {dimension}"
    return f"{'an' if words[0] in 'aeio' else 'a'} {words}" if article else words


def with_example(dimension: str) -> str:
    """A dimension with an example: "a length such as '80 mm'"."""
    return f"{in_words(dimension, article=True)} such as '{described(dimension).example}'"
