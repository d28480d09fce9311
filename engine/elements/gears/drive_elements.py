"""Friction wheels and chain drives as machine elements of a scene."""

import math
from typing import Annotated, Literal

from pydantic import Field

from engine.parts.actions import Force, Moment
from engine.parts.skeleton import Angle, AngularSpeed, Length, Number, Part, quantity


class FrictionDrive(Part):
    """Two wheels pressed together, the second inside out if `internal`; with a `groove_angle` between V-shaped faces.

    `moment` resists on the driven wheel. `creep` is the share of the rim's speed that the driven one lags behind.
    `safety` is how many times the force is to press that just suffices; `press_force` that which does.
    """

    type: Literal["friction_drive"]
    driving_diameter: Annotated[Length, Field(gt=0)]
    driven_diameter: Annotated[Length, Field(gt=0)]
    internal: bool = False
    groove_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    friction: Annotated[Number, Field(gt=0)]
    creep: Annotated[Number, Field(ge=0, lt=1)] = 0.0
    safety: Annotated[Number, Field(ge=1)] = 1.5
    speed: AngularSpeed
    moment: Annotated[Moment, Field(ge=0)]
    press_force: Annotated[Force, Field(gt=0)] | None = None


class ChainDrive(Part):
    """A chain of a `pitch` over two sprockets; `moment` resists on the driven one.

    With the `distance` of the axes that is wanted, links and the distance that an even number of them makes follow;
    with the `linear_density` of the chain its centrifugal tension.
    """

    type: Literal["chain_drive"]
    pitch: Annotated[Length, Field(gt=0)]
    driving_teeth: Annotated[Number, Field(ge=3)]
    driven_teeth: Annotated[Number, Field(ge=3)]
    speed: AngularSpeed
    moment: Annotated[Moment, Field(ge=0)]
    distance: Annotated[Length, Field(gt=0)] | None = None
    linear_density: Annotated[quantity("linear_density"), Field(gt=0)] | None = None
