"""Watt's governor."""

from typing import Annotated, Literal

from pydantic import Field

from engine.elements.governors.governor import ArmGovernor
from engine.parts.skeleton import Length


class WattGovernor(ArmGovernor):
    """Watt's governor: balls on the upper arms.

    The balls are at `ball_arm` from the pivots; by default at the joints with the lower arms.
    """

    type: Literal["watt_governor"]
    ball_arm: Annotated[Length, Field(gt=0)] | None = None

    @property
    def ball_arm_key(self) -> str:
        """Key of the distance of the balls from the upper pivots."""
        return "upper_arm" if self.ball_arm is None else "ball_arm"
