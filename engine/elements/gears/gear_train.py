"""Gear trains as machine elements: speeds and ratios, assembly, torques, losses, tooth forces, inertia."""

import math
from functools import cached_property
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.element import Answers, Element, NamedRows, Numbers
from engine.elements.gears.gear_structure import GearStructure, gear_structure
from engine.elements.gears.train_results import named_results, train_answers
from engine.parts.skeleton import (
    FRAME,
    Angle,
    AngularSpeed,
    Density,
    Faults,
    Inertia,
    Length,
    Mass,
    Moment,
    Name,
    Number,
    Part,
)

MOST_TEETH = 100_000
# With more meshes, the possible patterns of power flow are too many to try.
MOST_MESHES = 12


class GearWheel(Part):
    """A toothed wheel on a shaft, or on the `frame`; with a `width`, its mass is that of a disc of its pitch diameter.

    `profile_shift` is the outward shift of the tooth profile in modules, also for a ring.
    """

    shaft: Name
    teeth: Annotated[Number, Field(gt=0, le=MOST_TEETH)]
    profile_shift: Annotated[Number, Field(ge=-2, le=2)] = 0.0
    width: Annotated[Length, Field(gt=0)] | None = None
    bore: Annotated[Length, Field(ge=0)] = 0.0
    density: Annotated[Density, Field(gt=0)] = 7850.0


class GearShaft(Part):
    """A shaft in the frame or, for a planet, in its `carrier`, which is also a shaft.

    `planets` is the number of equally spaced planet sets of a carrier; the train describes one set. Shafts of the same
    `axis` are coaxial, as are a carrier and the central wheels of its planets. A driven shaft has a `speed`, a stopped
    shaft is `held`. `moment` is the external torque on the shaft, counter-clockwise. The torques of held shafts, of
    driven shafts without a moment, and of `loaded` shafts follow from equilibrium; all other shafts have none. `mass`
    and `inertia`, about its own axis, include everything on the shaft except wheels with a width; for a planet they are
    those of each.
    """

    carrier: Name | None = None
    planets: Annotated[Number, Field(ge=1, le=MOST_TEETH)] | None = None
    axis: Name | None = None
    speed: AngularSpeed | None = None
    held: bool = False
    moment: Moment | None = None
    loaded: bool = False
    mass: Annotated[Mass, Field(ge=0)] | None = None
    inertia: Annotated[Inertia, Field(ge=0)] | None = None

    def _faults(self) -> Faults:
        if self.held and (self.speed is not None or self.moment is not None):
            yield "held: a shaft that is stopped has no speed, and its moment follows; leave those out"
        if self.loaded and (self.held or self.moment is not None):
            yield "loaded: the shaft's moment follows from the others; leave out moment and held"
        if self.loaded and self.speed is not None:
            yield "loaded: the moment of a driven shaft without one follows anyway; leave loaded out"

    @property
    def moment_follows(self) -> bool:
        """Whether the shaft's torque follows from equilibrium."""
        return self.held or self.loaded or (self.speed is not None and self.moment is None)


class GearMesh(Part):
    """Two wheels in mesh; if it is `internal`, the second is the ring with internal teeth.

    `module` is the normal module; default: the train's. The loss is given by the `efficiency` of the mesh with its
    carrier at rest, or by the mean coefficient of `friction` of its teeth; by default there is no loss.
    """

    at_most_one_of: ClassVar = (("efficiency", "friction"),)

    between: tuple[Name, Name]
    type: Literal["external", "internal"] = "external"
    module: Annotated[Length, Field(gt=0)] | None = None
    pressure_angle: Annotated[Angle, Field(gt=0, lt=math.pi / 4)] = math.radians(20)
    helix_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 3)] = 0.0
    efficiency: Annotated[Number, Field(gt=0, le=1)] | None = None
    friction: Annotated[Number, Field(ge=0, lt=1)] | None = None

    def _faults(self) -> Faults:
        if self.between[0] == self.between[1]:
            yield f"between: a wheel doesn't mesh with itself; name two, not {self.between[0]!r} twice"


class GearTrain(Element):
    """Wheels on shafts, in mesh: a fixed train, a planetary train or a differential, of any number of stages."""

    picture: ClassVar = "velocities"

    type: Literal["gear_train"]
    module: Annotated[Length, Field(gt=0)] | None = None
    wheels: Annotated[dict[Name, GearWheel], Field(min_length=2)]
    shafts: Annotated[dict[Name, GearShaft], Field(min_length=1)]
    meshes: Annotated[dict[Name, GearMesh], Field(min_length=1, max_length=MOST_MESHES)]

    def _faults(self) -> Faults:
        names = [*self.wheels, *self.shafts, *self.meshes]
        twice = sorted({name for name in names if names.count(name) > 1})
        if twice:
            yield f"{twice[0]} names two things; wheels, shafts and meshes need distinct names"
        if FRAME in names:
            yield f"{FRAME}: this name is reserved for the frame, which needs no table; choose another"
        yield from self._faults_of_modules(self.structure)
        yield from self._faults_of_roles(self.structure)

    def _faults_of_modules(self, structure: GearStructure) -> Faults:
        given = [mesh.module is not None or self.module is not None for mesh in self.meshes.values()]
        if any(given) and not all(given):
            missing = list(self.meshes)[given.index(False)]
            yield f"meshes.{missing}.module: is missing; give it, or module once for the whole train"
        for name, wheel in self.wheels.items():
            lost = wheel.gives("bore", "density")
            if wheel.width is None and lost:
                yield f"wheels.{name}.{lost[0]} gives the mass of a wheel with a width; give width, or remove it"
        rings = {mesh.between[1] for mesh in self.meshes.values() if mesh.type == "internal"}
        for name, wheel in self.wheels.items():
            if wheel.width is not None and name in rings:
                yield f"wheels.{name}.width: a ring is not a disc; give its shaft the inertia instead"
            if wheel.width is not None and not self.has_modules:
                yield f"wheels.{name}.width needs a module: without it the wheel has no diameter"
        for name, shaft in self.shafts.items():
            if shaft.mass is not None and shaft.carrier is None:
                yield f"shafts.{name}.mass counts for planets only, which orbit; leave it out"
        # A planet with mass must orbit on a circle of known radius.
        wide = {wheel.shaft for wheel in self.wheels.values() if wheel.width is not None}
        for name in structure.planets:
            if self.shafts[name].mass is None and name not in wide:
                continue
            carrier = self.shafts[name].carrier
            if name not in structure.pin_meshes or self.shafts[carrier].carrier is not None:
                yield (
                    f"shafts.{name}: this planet has mass, but its circle isn't known: its carrier has to turn in the "
                    "frame, and one of its meshes has to be with a central wheel"
                )
            if not self.has_modules:
                yield f"shafts.{name}.mass needs a module: without it the planet's circle has no radius"

    def _faults_of_roles(self, structure: GearStructure) -> Faults:
        if len(structure.driven) != structure.mobility:
            yield (
                f"{structure.words}, so this many shafts need a speed, or others must be held; "
                f"{_those_with(structure.driven, 'a speed')}"
            )
        if not structure.speeds_follow:
            yield (
                f"the speeds of {', '.join((*structure.driven, *structure.held))} aren't independent: meshes tie them "
                "to each other; give speed or held to other shafts"
            )
        if not self.has_loads:
            loaded = [name for name, shaft in self.shafts.items() if shaft.loaded]
            if loaded:
                yield f"shafts.{loaded[0]}.loaded: no shaft has a moment that it could follow from; give one"
            return
        follow = tuple(name for name in structure.unknown_moments if name not in structure.held)
        if len(follow) != structure.mobility:
            yield (
                f"W = {structure.mobility}: this many torques follow from the others, those of driven shafts without a "
                f"moment and of loaded ones; {_those_with(follow, 'such a role')}"
            )
        if not structure.moments_follow:
            yield (
                f"the moments of {', '.join(structure.unknown_moments)} don't follow from those given: a moment acts "
                "on an unsupported shaft; let other shafts be loaded"
            )

    @cached_property
    def structure(self) -> GearStructure:
        """How wheels, shafts and meshes are connected.

        Raises
        ------
        TrainRefused
            They do not form a train.
        """
        return gear_structure(self.wheels, self.shafts, self.meshes)

    @property
    def has_modules(self) -> bool:
        """Whether the dimensions of the wheels are known."""
        return all(mesh.module is not None or self.module is not None for mesh in self.meshes.values())

    @property
    def has_loads(self) -> bool:
        """Whether any external torque is given."""
        return any(shaft.moment is not None for shaft in self.shafts.values())

    @property
    def has_inertia(self) -> bool:
        """Whether any part has mass or inertia."""
        heavy = any(shaft.mass is not None or shaft.inertia is not None for shaft in self.shafts.values())
        return heavy or any(wheel.width is not None for wheel in self.wheels.values())

    def named(self, n: Numbers) -> NamedRows:
        """Results of its members."""
        return named_results(self, n)

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates, and verdicts."""
        return train_answers(self, n)


def _those_with(names: tuple[str, ...], role: str) -> str:
    return f"those with {role} are {len(names)}: {', '.join(names)}" if names else f"no shaft has {role}"
