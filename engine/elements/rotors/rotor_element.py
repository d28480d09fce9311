"""A rotor as a machine element of a scene: its unbalances, its bearings, the planes in which it is to be balanced."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elements.rotors.hole_pattern import PatternError, ways_to_fill
from engine.parts.skeleton import Angle, AngularSpeed, Length, Mass, Name, Number, Part, Speed

Positive = Annotated[Length, Field(gt=0)]


class OffAxis(Part):
    """A mass off the axis: how far, at which angle of the rotor."""

    mass: Annotated[Mass, Field(gt=0)]
    radius: Annotated[Length, Field(ge=0)]
    angle: Angle = 0.0


class Unbalance(OffAxis):
    """A mass off the axis: where it is along the axis, how far off it, at which angle of the rotor."""

    position: Length


class StaticRotor(Part):
    """A flat rotor, such as a wheel or a disc: all masses off its axis count as in one plane.

    One mass at `correction_radius` balances them. On knife edges, with the rotor's `mass` and the arm of rolling
    friction, `rolling_arm`, it is found as well as friction lets it.
    """

    type: Literal["static_rotor"]
    unbalances: Annotated[dict[Name, OffAxis], Field(min_length=1)]
    correction_radius: Positive
    mass: Annotated[Mass, Field(gt=0)] | None = None
    rolling_arm: Annotated[Length, Field(gt=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _rolls_with_its_mass(self) -> "StaticRotor":
        if self.rolling_arm is not None and self.mass is None:
            raise ValueError("rolling_arm needs the rotor's mass, which presses it on the knife edges: give mass")
        return self


class CorrectionPlane(Part):
    """A plane in which mass is added at a radius, anywhere or as whole pieces in equally spaced holes.

    At most `used` of the holes get pieces, `most` at the greatest. The mass or radius may be off by `mass_error`, a
    share of it, the angle by `angle_error`, either way.
    """

    position: Length
    radius: Positive
    holes: Annotated[Number, Field(ge=1)] | None = None
    piece: Annotated[Mass, Field(gt=0)] | None = None
    first_hole: Angle = 0.0
    most: Annotated[int, Field(ge=1, le=255)] = 4
    used: Annotated[int, Field(ge=1)] = 2
    mass_error: Annotated[Number, Field(ge=0)] = 0.0
    angle_error: Annotated[Angle, Field(ge=0, le=math.pi)] = 0.0

    @model_validator(mode="after")
    def _holes_get_pieces(self) -> "CorrectionPlane":
        if (self.holes is None) != (self.piece is None):
            raise ValueError("holes and piece (the mass of one) belong together: give both, or neither")
        if self.holes is not None:
            if self.holes != int(self.holes):
                raise ValueError(f"holes = {self.holes:g}: give a whole number")
            try:
                ways_to_fill(int(self.holes), self.most, self.used)
            except PatternError as error:
                raise ValueError(str(error)) from None
        return self


class RotorElement(Part):
    """A rigid rotor in two bearings, with masses off its axis and planes for correction.

    `centre` is the position of the centre of mass along the axis, as are the bearings' and planes'. `grade` is the
    balance quality G as the product of specific unbalance and speed, "6.3 mm/s" for G 6.3. `rolling_arm` is that of
    rolling friction on knife edges.
    """

    type: Literal["rotor"]
    mass: Annotated[Mass, Field(gt=0)]
    speed: Annotated[AngularSpeed, Field(gt=0)]
    centre: Length
    first_bearing: Length
    second_bearing: Length
    grade: Annotated[Speed, Field(gt=0)] = 0.0063
    unbalances: Annotated[dict[Name, Unbalance], Field(min_length=1)]
    planes: Annotated[dict[Name, CorrectionPlane], Field(min_length=1)]
    rolling_arm: Annotated[Length, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _places_differ(self) -> "RotorElement":
        if self.first_bearing == self.second_bearing:
            raise ValueError("first_bearing and second_bearing are in one place; a rotor needs two apart")
        positions = [plane.position for plane in self.planes.values()]
        if len(positions) > 1 and len(set(positions)) == 1:
            raise ValueError(f"planes {', '.join(self.planes)} are in one place; move one, or leave all but one out")
        return self
