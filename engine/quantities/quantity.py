"""Name, meaning and unit of a quantity, and the units that depend on a machine's input."""

from typing import NamedTuple

from engine.elements.element import Rank
from engine.parts.skeleton import CrankInput
from engine.scene.scene import Scene

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


class Quantity(NamedTuple):
    """A quantity: name, meaning, unit (SI, CF spelling), symbol if any, and rank."""

    name: str
    long_name: str
    units: str
    symbol: str = ""
    rank: Rank = Rank.FURTHER


class InputUnits(NamedTuple):
    """Units that depend on the input: of its coordinate q, of reduced inertia and moment, and of 1/q.

    `symbols` are those of its coordinate, of its speed, and of reduced moments.
    """

    q: str
    inertia: str
    moment: str
    per_q: str
    symbols: tuple[str, str, str]

    @classmethod
    def of(cls, scene: Scene) -> "InputUnits":
        """Units for a scene's input: angle and moments for a crank, displacement and forces for a slider."""
        if isinstance(scene.input, CrankInput):
            return cls("rad", "kg m2", "N m", "rad-1", ("φ", "ω", "M"))
        return cls("m", "kg", "N", "m-1", ("q", "v", "F"))

    @property
    def speed(self) -> str:
        """Unit of the input speed."""
        return f"{self.q} s-1"

    @property
    def acceleration(self) -> str:
        """Unit of the input acceleration."""
        return f"{self.q} s-2"


def has_cycle(scene: Scene) -> bool:
    """Whether the input turns fully, so that the machine has a closed cycle."""
    return scene.input is not None and scene.input.turns_fully


def drive_words(scene: Scene) -> str:
    """Name of the drive torque or force for constant input speed."""
    return f"drive {'torque' if isinstance(scene.input, CrankInput) else 'force'} for constant speed"


def called(kind: str, name: str) -> str:
    """A part by kind and name, "motor M1", or by name only if that contains the kind, "main_motor"."""
    return name if kind in name else f"{kind} {name}"


def ordinal(number: int | str) -> str:
    """Ordinal number in figures: "1st", "2nd", "11th", "0.5th"."""
    text = str(number)
    ending = {"1": "st", "2": "nd", "3": "rd"}.get(text[-1], "th")
    return f"{text}{'th' if text[-2:] in ('11', '12', '13') or '.' in text else ending}"
