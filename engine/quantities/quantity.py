"""What a quantity tells of itself, and the units that depend on a machine's input."""

from typing import NamedTuple

from engine.scene.parts import CrankInput
from engine.scene.scene import Scene

# What a coefficient of speed fluctuation is: relative to the mean of both speeds, not to that over time.
OF_FLUCTUATION = "2 (ω_max − ω_min)/(ω_max + ω_min)"
STATISTICS = {
    "min": "least value of",
    "max": "greatest value of",
    "range": "range of",
    "peak": "greatest magnitude of",
    "mean": "mean of",
    "rms": "root mean square of",
    "min_at": "crank angle of the least value of",
    "max_at": "crank angle of the greatest value of",
}


class Quantity(NamedTuple):
    """A quantity one may ask: its name, meaning and unit (SI, spelt as CF does), and the textbook's symbol, if any."""

    name: str
    long_name: str
    units: str
    symbol: str = ""


class InputUnits(NamedTuple):
    """Units that depend on the input: of its coordinate q, of what is reduced, and of derivatives."""

    q: str
    inertia: str
    moment: str
    per_q: str

    @classmethod
    def of(cls, scene: Scene) -> "InputUnits":
        """Units for a scene's input: angle and moments for a crank, displacement and forces for a slider."""
        if isinstance(scene.input, CrankInput):
            return cls("rad", "kg m2", "N m", "rad-1")
        return cls("m", "kg", "N", "m-1")

    @property
    def speed(self) -> str:
        """Of the input's speed."""
        return f"{self.q} s-1"

    @property
    def acceleration(self) -> str:
        """Of the input's acceleration."""
        return f"{self.q} s-2"


def has_cycle(scene: Scene) -> bool:
    """Whether the input turns fully, so that there is a cycle to close."""
    return isinstance(scene.input, CrankInput) and scene.input.start is None
