"""What a study says: a scene, what varies in it, what is asked of it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from engine import AskError, Scene, TextExpression, described_dimension, scene_numbers
from sweeps.study.sampling import Design
from sweeps.study.study_text import Best, Optimise, ToleranceText
from sweeps.text.conditions import Condition


class AskedDerivative(NamedTuple):
    """A derivative that is asked for: of a summary, by a number of the scene or a free parameter."""

    of: str
    by: str

    @property
    def name(self) -> str:
        """Name of its column."""
        return f"{self.of}.by.{self.by}"

    @classmethod
    def read(cls, text: str) -> "AskedDerivative":
        """A text such as "excess_work by input.length".

        Raises
        ------
        AskError
            It isn't one.
        """
        words = text.split()
        if len(words) != 3 or words[1] != "by":
            raise AskError(f"{text!r}: write a summary, 'by' and a number, such as 'excess_work by input.length'")
        return cls(words[0], words[2])


@dataclass(frozen=True, eq=False, repr=False)
class StudyContent:
    """A scene with what varies in it and what is asked of it.

    Attributes
    ----------
    scene : Scene
    design : Design
        The variants: the product of the axes, the last fastest.
    derived : dict of str to Expression
        Numbers tied to the varied ones, by path.
    require : tuple of Condition
        A variant that fails one is dropped.
    summaries, fields : tuple of str
        What is asked.
    positions : int
    field_precision : {"float64", "float32"}
    accuracy : float or None
        Allowed error of every summary, as a share of its magnitude.
    name, title, question, text : str
    scene_text : str
        What the scene was read from, as TOML; "" where it is a part of the study's text.
    best : Best or None
    optimise : Optimise or None
        What a search looks for.
    tolerances : dict of str to ToleranceText
        How far numbers of the machine as built may be off, by path.
    derivatives : tuple of AskedDerivative
        Derivatives of summaries by numbers of the scene or free parameters.
    free_units : dict of str to str
        SI unit of each parameter that is no number of the scene, as CF spells it.
    """

    scene: Scene
    design: Design = field(default_factory=lambda: Design(()))
    derived: Mapping[str, TextExpression] = field(default_factory=dict)
    require: tuple[Condition, ...] = ()
    summaries: tuple[str, ...] = ()
    fields: tuple[str, ...] = ()
    positions: int = 720
    field_precision: str = "float64"
    accuracy: float | None = None
    name: str = "study"
    title: str = ""
    question: str = ""
    text: str = ""
    scene_text: str = ""
    best: Best | None = None
    optimise: Optimise | None = None
    tolerances: Mapping[str, ToleranceText] = field(default_factory=dict)
    derivatives: tuple[AskedDerivative, ...] = ()
    free_units: Mapping[str, str] = field(default_factory=dict)

    @cached_property
    def fixed(self) -> dict[str, float]:
        """Numbers of the scene as it is (SI), by path."""
        return {path: number.value for path, number in scene_numbers(self.scene).items()}

    @property
    def paths(self) -> tuple[str, ...]:
        """Numbers of the scene that differ between variants."""
        return tuple(p for p in self.parameters if p in self.fixed)

    @property
    def parameters(self) -> tuple[str, ...]:
        """All varied and derived numbers, free parameters too."""
        return (*self.design.names, *self.derived)

    def unit(self, name: str) -> str:
        """SI unit of a parameter as CF spells it; "" where that isn't known."""
        number = scene_numbers(self.scene).get(name)
        return described_dimension(number.dimension).unit if number else self.free_units.get(name, "")
