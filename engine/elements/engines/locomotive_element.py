"""A locomotive's driving axle as a machine element of a scene: its cylinders, wheels and balance weights."""

import math
from typing import Annotated, Literal

from pydantic import Field

from engine.parts.actions import Force
from engine.parts.skeleton import Angle, AngularSpeed, Length, Mass, Number, Part

Positive = Annotated[Length, Field(gt=0)]
# Two cylinders start from every position with cranks at a right angle; three and four have even ones.
USUAL_THROW_ANGLES = {1: 0.0, 2: math.pi / 2, 3: 2 * math.pi / 3, 4: math.pi / 2}


class LocomotiveElement(Part):
    """Horizontal cylinders, `cylinder_spacing` apart, on one axle, whose wheels carry balance weights in their planes.

    Every throw follows the one before, from left to right, by `throw_angle`; `crank_angle` is that of the first one
    from its cylinder's axis. `rotating_mass`, at the crankpin, and `reciprocating_mass` are those of a cylinder.
    Weights at `balance_radius` balance the shares `balanced_rotating` and `balanced_reciprocating` of them. Rods count
    as long: orders above the first are left out. `wheel_load` is what a wheel presses on its rail at rest.
    """

    type: Literal["locomotive"]
    cylinders: Literal[1, 2, 3, 4] = 2
    cylinder_spacing: Annotated[Length, Field(ge=0)]
    wheel_spacing: Positive
    throw_angle: Angle | None = None
    stroke: Positive
    rotating_mass: Annotated[Mass, Field(ge=0)] = 0.0
    reciprocating_mass: Annotated[Mass, Field(gt=0)]
    balanced_rotating: Number = 1.0
    balanced_reciprocating: Number = 2 / 3
    balance_radius: Positive
    speed: Annotated[AngularSpeed, Field(gt=0)]
    wheel_load: Annotated[Force, Field(gt=0)] | None = None
    crank_angle: Angle | None = None
