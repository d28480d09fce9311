"""Gear trains as machine elements: speeds and ratios, whether they fit, moments, losses, tooth forces, inertia."""

from typing import ClassVar, Literal

from engine.elements.element import Answers, Element, ElementResult, Numbers
from engine.elements.gears.gear_columns import gear_train_results, train_answers
from engine.elements.gears.gear_elements import GearTrain


class GearTrainElement(GearTrain, Element):
    """A gear train as a machine element of a scene."""

    __doc__ = GearTrain.__doc__

    picture: ClassVar = "velocities"
    type: Literal["gear_train"]

    def results(self) -> tuple[ElementResult, ...]:
        """Those of its members, by what it is given."""
        return tuple(gear_train_results(self))

    def evaluate(self, n: Numbers) -> Answers:
        """Results with what they may be off by, and verdicts."""
        return train_answers(self, n)
