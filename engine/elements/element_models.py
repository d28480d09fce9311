"""Machine elements of a scene: screws, belts, guides, rollers, cars, bodies, rotors, engines, governors, gears, cams.

An element stands beside the mechanism, if there is one: its load is its own, and the mechanism doesn't feel it.
"""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elements.bodies.body_elements import RotatingGuide, TetheredBody, TiltedBody, WoundFlywheel
from engine.elements.cams.cam_elements import CamElement
from engine.elements.compliances.elastic_parts import ComplianceElement
from engine.elements.elastic_drives.machine_drive_element import MachineDrive
from engine.elements.elastic_drives.two_mass_element import TwoMassDrive
from engine.elements.engines.engine_element import EngineElement
from engine.elements.engines.locomotive_element import LocomotiveElement
from engine.elements.gears.drive_elements import ChainDrive, FrictionDrive
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.governors.governor_elements import (
    HartnellGovernor,
    PorterGovernor,
    ProellGovernor,
    TableGovernor,
    WattGovernor,
)
from engine.elements.oscillators.oscillator_element import OscillatorElement
from engine.elements.rotors.rotor_element import RotorElement, StaticRotor
from engine.elements.torsional_trains.train_element import TorsionalTrain
from engine.parts.actions import Force, Moment
from engine.parts.skeleton import (
    STANDARD_GRAVITY,
    Acceleration,
    Angle,
    AngularSpeed,
    Length,
    Number,
    Part,
    Speed,
    Time,
    quantity,
)

LinearDensity = quantity("linear_density")
Positive = Annotated[Length, Field(gt=0)]
Load = Annotated[Force, Field(gt=0)]
Friction = Annotated[Number, Field(ge=0)]


class ScrewElement(Part):
    """A screw that raises and lowers a load, its thread named or of any `thread_angle` between the flanks.

    `collar_diameter` is the mean one of the thrust collar.
    """

    type: Literal["screw"]
    load: Load
    mean_diameter: Positive
    pitch: Positive
    starts: Annotated[int, Field(ge=1)] = 1
    thread: Literal["square", "trapezoidal", "metric"] | None = None
    thread_angle: Annotated[Angle, Field(ge=0, lt=math.pi)] | None = None
    friction: Friction
    collar_diameter: Annotated[Length, Field(ge=0)] = 0.0
    collar_friction: Friction = 0.0

    @model_validator(mode="after")
    def _one_thread(self) -> "ScrewElement":
        if (self.thread is None) == (self.thread_angle is None):
            raise ValueError("give thread ('square', 'trapezoidal' or 'metric') or thread_angle, one of the two")
        return self


class BeltElement(Part):
    """A belt on a pulley on the point of slipping: the moment that its `tension` carries, or the tension for a moment.

    `tension` is that of the tight strand; `groove_angle` lies between the faces of a V groove. A belt that runs has a
    `speed`, and with its `linear_density` a centrifugal tension.
    """

    type: Literal["belt"]
    diameter: Positive
    wrap: Annotated[Angle, Field(gt=0)]
    friction: Annotated[Number, Field(gt=0)]
    groove_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    tension: Load | None = None
    moment: Annotated[Moment, Field(gt=0)] | None = None
    speed: Annotated[Speed, Field(ge=0)] | None = None
    linear_density: Annotated[LinearDensity, Field(gt=0)] | None = None

    @model_validator(mode="after")
    def _one_load(self) -> "BeltElement":
        if (self.tension is None) == (self.moment is None):
            raise ValueError("give tension (of the tight strand) or moment, one of the two")
        if self.linear_density is not None and self.speed is None:
            raise ValueError("linear_density matters at a speed: give speed")
        return self


class WedgeElement(Part):
    """A wedge under a load that is guided at a right angle to the wedge's base.

    `friction` is that of the inclined face; the base has the same unless `base_friction` is given.
    """

    type: Literal["wedge"]
    load: Load
    angle: Annotated[Angle, Field(gt=0, lt=math.pi / 2)]
    friction: Friction
    base_friction: Friction | None = None
    guide_friction: Friction = 0.0


class InclineElement(Part):
    """A load on an inclined plane, pulled at `pull_angle` above the plane; at rest `static_friction` holds it."""

    type: Literal["incline"]
    load: Load
    angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)]
    friction: Friction
    static_friction: Friction | None = None
    pull_angle: Annotated[Angle, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0


class JournalElement(Part):
    """A journal in its bearing, touching on a line, or in a new or worn-in bush that embraces half of it."""

    type: Literal["journal"]
    load: Load
    diameter: Positive
    friction: Friction
    contact: Literal["line", "new", "worn in"] = "line"
    speed: AngularSpeed | None = None


class GuideElement(Part):
    """A slider on its guide, moved against a `resistance` along its middle by a force at an `overhang`.

    `load` presses it on the guide: flat, a V of `vee_angle` between its faces, or half-round, new or worn in.
    """

    type: Literal["guide"]
    form: Literal["flat", "vee", "half-round, new", "half-round, worn in"] = "flat"
    vee_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    length: Positive
    friction: Friction
    load: Force = 0.0
    resistance: Load
    overhang: Length = 0.0

    @model_validator(mode="after")
    def _vee_has_an_angle(self) -> "GuideElement":
        if (self.form == "vee") != (self.vee_angle is not None):
            raise ValueError("vee_angle goes with form = 'vee': give both, or neither")
        return self


class RollerElement(Part):
    """A loaded roller on a plane, pulled at its axle unless `pull_height` says where, or driving a second roller.

    `rolling_arm` is the arm k of rolling friction, `friction` that of sliding.
    """

    type: Literal["roller"]
    load: Load
    diameter: Positive
    rolling_arm: Annotated[Length, Field(ge=0)]
    friction: Friction
    pull_height: Positive | None = None
    mate_diameter: Positive | None = None


class CarElement(Part):
    """A car that brakes with the `brakes` of its front, rear or all wheels on the point of sliding, to rest.

    `rear_distance` is that of its centre of mass from the rear axle, `height` that from the road. It goes up a positive
    `slope`, down a negative one; the brakes begin to act after the `reaction_time`.
    """

    type: Literal["car"]
    brakes: Literal["front", "rear", "all"] = "all"
    speed: Annotated[Speed, Field(gt=0)]
    friction: Annotated[Number, Field(gt=0)]
    wheelbase: Positive
    rear_distance: Positive
    height: Positive
    slope: Annotated[Angle, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0
    reaction_time: Annotated[Time, Field(ge=0)] = 0.0
    gravity: Annotated[Acceleration, Field(gt=0)] = STANDARD_GRAVITY

    @model_validator(mode="after")
    def _centre_between_axles(self) -> "CarElement":
        if not self.rear_distance < self.wheelbase:
            raise ValueError("rear_distance must be less than wheelbase: the centre of mass lies between the axles")
        return self


MachineElement = Annotated[
    ScrewElement
    | BeltElement
    | WedgeElement
    | InclineElement
    | JournalElement
    | GuideElement
    | RollerElement
    | CarElement
    | TetheredBody
    | TiltedBody
    | RotatingGuide
    | WoundFlywheel
    | RotorElement
    | StaticRotor
    | EngineElement
    | LocomotiveElement
    | WattGovernor
    | PorterGovernor
    | ProellGovernor
    | HartnellGovernor
    | TableGovernor
    | OscillatorElement
    | ComplianceElement
    | TorsionalTrain
    | TwoMassDrive
    | MachineDrive
    | CamElement
    | GearTrain
    | FrictionDrive
    | ChainDrive,
    Field(discriminator="type"),
]
