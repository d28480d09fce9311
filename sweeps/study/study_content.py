"""Content of a study: scene, variables, outputs."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from engine import AskError, ElementsAlone, Machine, Scene, TextExpression, described_dimension, scene_numbers
from sweeps.study.sampling import Design
from sweeps.study.study_text import Best, Optimise, ToleranceText
from sweeps.text.conditions import Condition

# A machine, or the elements of a scene without a mechanism, ready to be evaluated.
ReadyMachine = Machine | ElementsAlone


class AskedDerivative(NamedTuple):
    """A requested derivative of a summary with respect to a scene number or free parameter."""

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
            The text is invalid.
        """
        words = text.split()
        if len(words) != 3 or words[1] != "by":
            raise AskError(f"{text!r}: write a summary, 'by' and a number, such as 'excess_work by input.length'")
        return cls(words[0], words[2])


@dataclass(frozen=True, eq=False, repr=False)
class StudyContent:
    """A scene with its variables and outputs.

    Attributes
    ----------
    scene : Scene
    design : Design
        The variants: the product of the axes, the last fastest.
    derived : dict of str to TextExpression
        Numbers derived from varied ones, by path.
    require : tuple of Condition
        A variant that fails one is dropped.
    summaries, fields : tuple of str
        Requested outputs.
    positions : int
    field_precision : {"float64", "float32"}
    accuracy : float or None
        Relative tolerance of every summary.
    name, title, question, text : str
    scene_text : str
        TOML source of the scene; "" if it is part of the study's text.
    best : Best or None
    optimise : Optimise or None
        The search task.
    tolerances : dict of str to ToleranceText
        Manufacturing tolerances, by path.
    derivatives : tuple of AskedDerivative
        Derivatives of summaries by numbers of the scene or free parameters.
    free_units : dict of str to str
        CF unit (SI) of each parameter outside the scene.
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
        """Numbers of the unmodified scene (SI), by path."""
        return {path: number.value for path, number in scene_numbers(self.scene).items()}

    @property
    def paths(self) -> tuple[str, ...]:
        """Numbers of the scene that differ between variants."""
        return tuple(p for p in self.parameters if p in self.fixed)

    @property
    def parameters(self) -> tuple[str, ...]:
        """All varied and derived numbers, including free parameters."""
        return (*self.design.names, *self.derived)

    def unit(self, name: str) -> str:
        """CF unit (SI) of a parameter; "" if unknown."""
        number = scene_numbers(self.scene).get(name)
        return described_dimension(number.dimension).unit if number else self.free_units.get(name, "")


def number_units(scene: Scene) -> dict[str, str]:
    """CF unit (SI) of every number of a scene, by path."""
    return {path: described_dimension(number.dimension).unit for path, number in scene_numbers(scene).items()}
