"""Cylinders of a scene: gas or liquid that acts on a piston."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.parts.actions import Role
from engine.parts.skeleton import Angle, Length, Number, Part, Pressure, SliderRef


class Cylinder(Part):
    """Gas or liquid behind a piston, which is a slider, with the `bore` of the cylinder.

    `head` is the end of the stroke with the cylinder head; with "high" the head is beyond the high end of the slide
    coordinate, and pressure pushes the piston towards the low end. `ambient` is the pressure on the other side of the
    piston. `clearance` is the clearance volume over the swept volume.
    """

    piston: SliderRef
    bore: Annotated[Length, Field(gt=0)]
    head: Literal["high", "low"] = "high"
    ambient: Pressure = 101_325.0


class Compressor(Cylinder):
    """A reciprocating compressor: polytropic compression and expansion between the pressures `suction` and `discharge`.

    `n_compression` and `n_expansion` are the polytropic exponents.
    """

    ascending: ClassVar = {("suction", "discharge"): "a compressor raises the pressure"}

    type: Literal["compressor"]
    clearance: Annotated[Number, Field(gt=0)]
    suction: Annotated[Pressure, Field(gt=0)]
    discharge: Annotated[Pressure, Field(gt=0)]
    n_compression: Annotated[Number, Field(gt=0)] = 1.3
    n_expansion: Annotated[Number, Field(gt=0)] = 1.3
    role: Role = "useful"


class Pump(Cylinder):
    """A piston pump: suction pressure as the piston moves away from the head, discharge pressure towards it."""

    type: Literal["pump"]
    suction: Annotated[Pressure, Field(ge=0)]
    discharge: Annotated[Pressure, Field(ge=0)]
    role: Role = "useful"


class EngineCylinder(Cylinder):
    """The cylinder of an engine: polytropic expansion from `peak`, and compression from `intake`.

    `exhaust` is the pressure during the exhaust. `n_compression` and `n_expansion` are the polytropic exponents.
    """

    clearance: Annotated[Number, Field(gt=0)]
    intake: Annotated[Pressure, Field(gt=0)]
    exhaust: Annotated[Pressure, Field(gt=0)]
    peak: Annotated[Pressure, Field(gt=0)]
    n_compression: Annotated[Number, Field(gt=0)] = 1.32
    n_expansion: Annotated[Number, Field(gt=0)] = 1.28
    role: Role = "driving"


class FourStroke(EngineCylinder):
    """A four-stroke engine: expansion, exhaust, intake, compression.

    The power stroke starts at the first head-end dead centre after φ = `firing_angle`. The cycle takes 2 revolutions.
    """

    type: Literal["four_stroke"]
    firing_angle: Angle = 0.0


class TwoStroke(EngineCylinder):
    """A two-stroke engine: expansion until the ports open at the fraction `port` of the stroke."""

    type: Literal["two_stroke"]
    port: Annotated[Number, Field(gt=0, le=1)]


CylinderAction = Annotated[Compressor | Pump | FourStroke | TwoStroke, Field(discriminator="type")]
