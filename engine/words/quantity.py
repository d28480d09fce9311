"""Description of a result: name, meaning, unit, and its importance to the engineer."""

from enum import IntEnum
from functools import partial
from typing import NamedTuple

# Prefix to the meaning of a field.
STATISTICS = {
    "min": "minimum",
    "max": "maximum",
    "range": "range of",
    "amplitude": "amplitude (half the range) of",
    "peak": "peak",
    "mean": "mean",
    "rms": "rms",
    "min_at": "crank angle of the minimum",
    "max_at": "crank angle of the maximum",
}


class Rank(IntEnum):
    """Importance of a result to the engineer: a main result, a further one, or a check of the others."""

    ANSWER = 0
    FURTHER = 1
    CHECK = 2


class Quantity(NamedTuple):
    """Description of a result of a machine, a regime or an element.

    Attributes
    ----------
    name, long_name, units : str
        Name, meaning, SI unit in CF spelling.
    may_be_undefined : bool
        Whether NaN is a valid result, not a failure.
    exact : bool
        Whether it has no error estimate, such as yes or no.
    symbol : str
        Textbook symbol.
    rank : Rank
    """

    name: str
    long_name: str
    units: str
    may_be_undefined: bool = False
    exact: bool = False
    symbol: str = ""
    rank: Rank = Rank.FURTHER


main_result, check_result = (partial(Quantity, rank=rank) for rank in (Rank.ANSWER, Rank.CHECK))


def called(kind: str, name: str) -> str:
    """A part by kind and name, "motor M1", or by name only if that contains the kind, "main_motor"."""
    return name if kind in name else f"{kind} {name}"


def ordinal(number: int | str) -> str:
    """Ordinal number in figures: "1st", "2nd", "11th", "0.5th"."""
    text = str(number)
    ending = {"1": "st", "2": "nd", "3": "rd"}.get(text[-1], "th")
    return f"{text}{'th' if text[-2:] in ('11', '12', '13') or '.' in text else ending}"
