"""Followers of a cam, their contact, and the limits that the cam must satisfy."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.parts.actions import Force
from engine.parts.motion_programs import TouchesCam
from engine.parts.skeleton import Angle, Faults, Inertia, Length, Mass, Moment, Number, Part, Positive, quantity

NotNegative = Annotated[Length, Field(ge=0)]
Stiffness = Annotated[quantity("stiffness"), Field(ge=0)]
TorsionalStiffness = Annotated[quantity("torsional_stiffness"), Field(ge=0)]


# Keys of forces, which require the follower's mass or inertia.
_FORCES = ("preload", "stiffness", "load")


class TranslatingFollower(TouchesCam):
    """A translating follower; a positive `offset` of its line of motion from the cam's axis lowers α on the rise.

    Under a flat face, the offset only moves the contact along the face.

    `load` presses it onto the cam at all times and includes its weight. Friction in the guide requires `guide_length`
    and `overhang`, by which the follower projects from the guide at its lowest position.
    """

    together: ClassVar = (("friction", "guide_length", "overhang"),)
    needs: ClassVar = dict.fromkeys((*_FORCES, "friction"), ("mass",))

    type: Literal["translating"]
    contact: Literal["roller", "flat", "knife edge"]
    roller_radius: Positive | None = None
    offset: Length = 0.0
    mass: Annotated[Mass, Field(ge=0)] | None = None
    preload: Force = 0.0
    stiffness: Stiffness = 0.0
    load: Force = 0.0
    friction: Annotated[Number, Field(ge=0)] | None = None
    guide_length: Positive | None = None
    overhang: NotNegative | None = None

    def _faults(self) -> Faults:
        if self.friction is not None and self.contact == "flat":
            yield "friction in the guide is computed for a roller or knife edge only: leave it out"

    @property
    def moved(self) -> float | None:
        """Mass [kg]; None without dynamics."""
        return self.mass


class OscillatingFollower(TouchesCam):
    """A follower that swings about a pivot at `pivot_distance` from the cam's axis, with a roller or edge on its `arm`.

    A flat face passes through the pivot. Moving away from the cam, the follower turns against the cam's rotation,
    or with it for `opens` = "with". `load` and `preload` are moments about the pivot that press it onto the cam.
    """

    needs: ClassVar = dict.fromkeys(_FORCES, ("inertia",))
    required_with: ClassVar = {"arm": ("contact", ("roller", "knife edge"))}

    type: Literal["oscillating"]
    contact: Literal["roller", "flat", "knife edge"]
    roller_radius: Positive | None = None
    pivot_distance: Positive
    arm: Positive | None = None
    opens: Literal["against", "with"] = "against"
    inertia: Annotated[Inertia, Field(ge=0)] | None = None
    preload: Moment = 0.0
    stiffness: TorsionalStiffness = 0.0
    load: Moment = 0.0

    @property
    def moved(self) -> float | None:
        """Moment of inertia about the pivot [kg·m²]; None without dynamics."""
        return self.inertia


class LineContact(Part):
    """Line contact of a given `width`, for the Hertzian pressure; cam and follower have the same material."""

    width: Positive
    elastic_modulus: Annotated[quantity("pressure"), Field(gt=0)] = 206e9
    poisson: Annotated[Number, Field(ge=0, le=0.5)] = 0.3


class CamLimits(Part):
    """Limits for the minimum base circle: maximum pressure angle, minimum convex radius of the profile."""

    pressure_angle: Annotated[Angle, Field(gt=0, lt=math.pi / 2)] | None = None
    convex_radius: NotNegative | None = None

    def _faults(self) -> Faults:
        if self.pressure_angle is None and self.convex_radius is None:
            yield "give pressure_angle or convex_radius, or both"
