"""Members of a gear train: its wheels, the shafts they sit on, and their meshes."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.parts.actions import Moment
from engine.parts.skeleton import Angle, AngularSpeed, Density, Faults, Inertia, Length, Mass, Name, Number, Part

MOST_TEETH = 100_000


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
            yield "loaded: the shaft's moment is to follow from the others; leave out moment and held"
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
