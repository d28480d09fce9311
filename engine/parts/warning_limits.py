"""Limits of good practice that a scene may set, `[limits]`; the program warns beyond them."""

import math
from typing import Annotated

from pydantic import Field

from engine.parts.skeleton import Angle, Length, Number, Part


class WarningLimits(Part):
    """Limits beyond which the program warns; they change no result, and zero or very large limits never warn.

    `transmission_angle` is the minimum: 40° is usual, 30° suffices for slow machines. `clearance` is the maximum
    clearance volume over the swept volume. `slenderness` is the maximum of a rod in compression, its length over the
    radius of gyration of its section. `rim_width` is the minimum width of a flywheel's rim. `flywheel_ratio` is the
    maximum inertia of a flywheel over the mean reduced inertia of the machine. `friction` is the maximum coefficient
    of friction.
    """

    transmission_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] = math.radians(40)
    clearance: Annotated[Number, Field(gt=0)] = 0.5
    slenderness: Annotated[Number, Field(gt=0)] = 200.0
    rim_width: Annotated[Length, Field(ge=0)] = 1e-3
    flywheel_ratio: Annotated[Number, Field(gt=0)] = 100.0
    friction: Annotated[Number, Field(gt=0)] = 1.5
