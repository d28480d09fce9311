"""Porter's governor."""

from typing import Annotated, Literal

from pydantic import Field

from engine.elements.governors.governor import ArmGovernor
from engine.parts.skeleton import Mass


class PorterGovernor(ArmGovernor):
    """Porter's governor: balls at the joints of the arms, and a central load on the sleeve."""

    type: Literal["porter_governor"]
    sleeve_mass: Annotated[Mass, Field(gt=0)]
