"""An engine as a machine element of a scene: its layout by name, its cranks, masses and counterweights."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.balancing.engine_layout import Pattern, boxer, in_line, radial, v, w
from engine.parts import Angle, AngularSpeed, Length, Mass, Number, Part

Positive = Annotated[Length, Field(gt=0)]
MassOrNone = Annotated[Mass, Field(ge=0)]


class EngineElement(Part):
    """An engine of equal cylinders, whose rods all turn on the crankpins.

    `bank_angle` lies between neighbouring banks of a V or W. `throws` are the angles of the throws, of one cylinder or
    of the pair, or row across, that works on it; usual ones where not given. By `pin_offset` a split crankpin of a V
    leads for the second bank. `spacing` is that of the throws, `rod_distance` that of the rods on one throw: without
    `spacing` there are no couples. `rod_centre` is the distance of the rod's centre of mass from the crankpin,
    `throw_mass` is reckoned at the crankpin. Counterweights balance the shares `balanced_rotating` and
    `balanced_reciprocating` of the masses at each throw.
    """

    type: Literal["engine"]
    layout: Literal["in-line", "V", "W", "boxer", "radial"]
    cylinders: Annotated[int, Field(ge=1, le=100)]
    throws: tuple[Angle, ...] | None = None
    bank_angle: Annotated[Angle, Field(ge=0, le=math.pi)] | None = None
    pin_offset: Angle | None = None
    spacing: Annotated[Length, Field(ge=0)] | None = None
    rod_distance: Length = 0.0
    stroke: Positive
    rod: Positive
    piston_mass: Annotated[Mass, Field(gt=0)]
    rod_mass: MassOrNone = 0.0
    rod_centre: Length = 0.0
    throw_mass: MassOrNone = 0.0
    balanced_rotating: Number = 1.0
    balanced_reciprocating: Number = 0.0
    speed: Annotated[AngularSpeed, Field(gt=0)]

    @model_validator(mode="after")
    def _keys_fit_the_layout(self) -> "EngineElement":
        if (self.layout in ("V", "W")) != (self.bank_angle is not None):
            raise ValueError(f"bank_angle goes with layout = 'V' or 'W'; the layout is {self.layout!r}")
        if self.pin_offset is not None and self.layout != "V":
            raise ValueError(f"pin_offset goes with layout = 'V'; the layout is {self.layout!r}")
        if self.throws is not None and self.layout == "radial":
            raise ValueError("throws: a radial engine has one throw; leave throws out")
        if self.rod <= self.stroke / 2:
            raise ValueError(f"rod = {self.rod:g} m: it must be longer than half the stroke, {self.stroke / 2:g} m")
        self.pattern()
        return self

    def pattern(self) -> Pattern:
        """The cylinders, with sizes still open.

        Raises
        ------
        LayoutError
            This layout doesn't have so many cylinders or throws.
        """
        if self.layout == "radial":
            return radial(self.cylinders)
        return {"in-line": in_line, "V": v, "W": _w, "boxer": boxer}[self.layout](self.cylinders, self.throws)


def _w(cylinders: int, throws: tuple[float, ...] | None) -> Pattern:
    return w(cylinders, throws=throws)
