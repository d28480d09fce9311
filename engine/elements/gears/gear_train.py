"""Gear trains as machine elements: speeds and ratios, assembly, torques, losses, tooth forces, inertia."""

from functools import cached_property
from typing import ClassVar, Literal

from engine.elements.element import Answers, Element, ElementResult, Numbers
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.gears.train_results import results_of, train_answers


class GearTrainElement(GearTrain, Element):
    """A gear train as a machine element of a scene."""

    __doc__ = GearTrain.__doc__

    picture: ClassVar = "velocities"
    type: Literal["gear_train"]

    def results(self) -> tuple[ElementResult, ...]:
        """Results of its members, depending on the keys given."""
        return self.own_results

    @cached_property
    def own_results(self) -> tuple[ElementResult, ...]:
        """The same, computed once."""
        return results_of(self)

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates, and verdicts."""
        return train_answers(self, n)
