"""Single bodies as machine elements of a scene."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.parts.actions import Force, Stiffness
from engine.parts.skeleton import Angle, AngularSpeed, Inertia, Length, Mass, Number, Part, Speed, quantity

Positive = Annotated[Length, Field(gt=0)]
Stress = quantity("pressure")
MOMENTS = ("inertia_x", "inertia_y", "inertia_z")
SEMI_AXES = ("semi_axis_x", "semi_axis_y", "semi_axis_z")


class TiltedBody(Part):
    """A body whose own axes are turned against the fixed ones.

    First by `yaw` about z, then by `pitch` about its y as it then lies, and by `roll` about its x. It has moments of
    inertia about its own axes through its centre of mass, with products such as ∫xy dm if these aren't principal ones,
    or it is an ellipsoid of given semi-axes. `x`, `y`, `z` are the fixed coordinates of the centre of mass. With a
    `speed` it turns about the fixed z axis.
    """

    type: Literal["tilted_body"]
    mass: Annotated[Mass, Field(gt=0)]
    inertia_x: Annotated[Inertia, Field(gt=0)] | None = None
    inertia_y: Annotated[Inertia, Field(gt=0)] | None = None
    inertia_z: Annotated[Inertia, Field(gt=0)] | None = None
    product_xy: Inertia = 0.0
    product_yz: Inertia = 0.0
    product_zx: Inertia = 0.0
    semi_axis_x: Positive | None = None
    semi_axis_y: Positive | None = None
    semi_axis_z: Positive | None = None
    yaw: Angle = 0.0
    pitch: Angle = 0.0
    roll: Angle = 0.0
    x: Length = 0.0
    y: Length = 0.0
    z: Length = 0.0
    speed: AngularSpeed | None = None

    @model_validator(mode="after")
    def _one_shape(self) -> "TiltedBody":
        moments, axes = ([getattr(self, key) is not None for key in keys] for keys in (MOMENTS, SEMI_AXES))
        if not (all(moments) and not any(axes)) and not (all(axes) and not any(moments)):
            raise ValueError(f"give {', '.join(MOMENTS)}, or {', '.join(SEMI_AXES)} of an ellipsoid: all three of one")
        if all(axes) and (self.product_xy or self.product_yz or self.product_zx):
            raise ValueError("products belong to given moments: an ellipsoid has none about its own axes")
        return self


class RotatingGuide(Part):
    """A body that slides outwards on a straight lever, which turns in a level plane with constant `speed`.

    At time 0 it is at `start_radius` from the axis, with `start_velocity` along the lever; at `length` it leaves it.
    """

    type: Literal["rotating_guide"]
    mass: Annotated[Mass, Field(gt=0)]
    speed: Annotated[AngularSpeed, Field(gt=0)]
    start_radius: Positive
    start_velocity: Annotated[Speed, Field(ge=0)] = 0.0
    length: Positive
    friction: Annotated[Number, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _has_a_way(self) -> "RotatingGuide":
        if not self.start_radius < self.length:
            raise ValueError(
                f"length = {self.length:g} m is not above start_radius = {self.start_radius:g} m: the body slides out"
            )
        return self


class WoundFlywheel(Part):
    """A flywheel of tape or wire, wound with the tension `winding_stress` on a ring of the same material.

    The ring reaches from `bore` to `winding_diameter`, the winding from there to `diameter`. What it withstands is its
    `strength`.
    """

    type: Literal["wound_flywheel"]
    bore: Positive
    winding_diameter: Positive
    diameter: Positive
    width: Positive
    density: Annotated[quantity("density"), Field(gt=0)]
    poisson_ratio: Annotated[Number, Field(ge=0, lt=0.5)] = 0.3
    winding_stress: Annotated[Stress, Field(ge=0)]
    speed: Annotated[AngularSpeed, Field(gt=0)]
    strength: Annotated[Stress, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _from_inside_out(self) -> "WoundFlywheel":
        if not self.bore < self.winding_diameter < self.diameter:
            raise ValueError(
                f"bore = {self.bore:g} m, winding_diameter = {self.winding_diameter:g} m, diameter = "
                f"{self.diameter:g} m: give them ascending, the winding lies outside the ring"
            )
        if self.strength is not None and not self.winding_stress < self.strength:
            raise ValueError("winding_stress must be below strength: the tape would tear while it is wound")
        return self


class TetheredBody(Part):
    """A body on an elastic tie about a fixed point, set off by an impulse across it or spun up slowly.

    `length` is that of the tie without force, `strength` the force at which it bursts, `speed` that of the body. A thin
    rim of radius R and section A is one with the length R, the stiffness 2πEA/R and 2π times its section's strength.
    """

    type: Literal["tethered_body"]
    mass: Annotated[Mass, Field(gt=0)]
    length: Positive
    stiffness: Annotated[Stiffness, Field(gt=0)]
    strength: Annotated[Force, Field(gt=0)]
    speed: Annotated[Speed, Field(gt=0)]
