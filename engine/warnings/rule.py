"""A rule of good practice: a number of a machine, its limit, and the warning where the limit is exceeded."""

from collections.abc import Callable, Iterator, Mapping
from typing import Literal, NamedTuple

import numpy as np

from engine.cycle.measured import Measured, measured
from engine.parts.requirements import WarningLimits
from engine.scene.scene import Numbers, Scene
from engine.units.display import quantity_text

Judge = Callable[..., tuple[object, object]]


class Rule(NamedTuple):
    """A possible warning on one part of a scene.

    Attributes
    ----------
    at : str
        Path of the part.
    sense : {"above", "below"}
        Whether to warn above or below the limit.
    units : str
        SI unit of number and limit as CF spells it; "%" for shares shown as percentages.
    sentence : str
        Words with {value} and {limit}.
    judge : callable
        Number and limit, from the numbers of the scene and the quantities read.
    reads : tuple of str
        Names of summaries.
    """

    at: str
    sense: Literal["above", "below"]
    units: str
    sentence: str
    judge: Judge
    reads: tuple[str, ...] = ()

    def broken(self, numbers: Numbers, known: Mapping[str, Measured]) -> Measured:
        """1 where the limit is exceeded by more than the error estimates, else 0; ± 1 where they leave it undecided.

        Parameters
        ----------
        numbers : Numbers
            The scene's, for some variants.
        known : mapping of str to Measured (variants,)
            Summaries by name.
        """
        value, limit = self._compared(numbers, known)
        beyond = value - limit if self.sense == "above" else limit - value
        # Differences are rounded, but numbers as given are exact.
        error = value.error + limit.error
        with np.errstate(invalid="ignore"):
            return Measured(np.where(beyond.value > error, 1.0, 0.0), np.where(np.abs(beyond.value) < error, 1.0, 0.0))

    def words(self, numbers: Numbers, known: Mapping[str, Measured]) -> str:
        """The warning on the first variant, with its number and the limit; parameters as for `broken`."""
        value, limit = (_text(float(found.value.flat[0]), self.units) for found in self._compared(numbers, known))
        return f"{self.at}: {self.sentence.format(value=value, limit=limit)}"

    def _compared(self, numbers: Numbers, known: Mapping[str, Measured]) -> tuple[Measured, Measured]:
        with np.errstate(all="ignore"):
            value, limit = self.judge(numbers, *(known[name] for name in self.reads))
        return measured(value), measured(limit)


class WarningKind(NamedTuple):
    """A kind of warning: its name, its meaning, and the rules that it has for the parts of a scene."""

    name: str
    long_name: str
    rules: Callable[[Scene], Iterator[Rule]]


def limit_of(scene: Scene, key: str, numbers: Numbers) -> object:
    """A limit of the scene, which may vary, or the usual one."""
    return getattr(WarningLimits(), key) if scene.limits is None else numbers[f"limits.{key}"]


def _text(value: float, units: str) -> str:
    return f"{100.0 * value:.4g} %" if units == "%" else quantity_text(value, units)
