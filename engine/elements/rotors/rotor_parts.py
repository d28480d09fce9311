"""Parts of a rotor: masses off its axis, correction planes."""

import math
from typing import Annotated, ClassVar

from pydantic import Field

from engine.elements.rotors.hole_pattern import ways_to_fill
from engine.parts.skeleton import Angle, Faults, Length, Mass, Number, Part, Positive


class OffAxis(Part):
    """A mass off the axis: its radius, and its angle on the rotor."""

    mass: Annotated[Mass, Field(gt=0)]
    radius: Annotated[Length, Field(ge=0)]
    angle: Angle = 0.0


class Unbalance(OffAxis):
    """A mass off the axis: its position along the axis, its radius, and its angle on the rotor."""

    position: Length


class CorrectionPlane(Part):
    """A plane in which mass is added at a radius, at any angle or as whole pieces in equally spaced holes.

    At most `used` holes get pieces, each at most `most`. The mass or radius has a relative error up to `mass_error`,
    the angle an error up to `angle_error`, both of either sign.
    """

    together: ClassVar = (("holes", "piece"),)

    position: Length
    radius: Positive
    holes: Annotated[Number, Field(ge=1)] | None = None
    piece: Annotated[Mass, Field(gt=0)] | None = None
    first_hole: Angle = 0.0
    most: Annotated[int, Field(ge=1, le=255)] = 4
    used: Annotated[int, Field(ge=1)] = 2
    mass_error: Annotated[Number, Field(ge=0)] = 0.0
    angle_error: Annotated[Angle, Field(ge=0, le=math.pi)] = 0.0

    def _faults(self) -> Faults:
        if self.holes is not None:
            if self.holes != int(self.holes):
                yield f"holes = {self.holes:g}: give a whole number"
            ways_to_fill(int(self.holes), self.most, self.used)
