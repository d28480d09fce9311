"""Higher pairs of a scene: shafts with gears, racks, pinions, non-circular wheels and cams; followers are links."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.parts.motion_programs import CamProgram, TouchesCam
from engine.parts.skeleton import (
    Angle,
    Faults,
    FrameGuide,
    FramePoint,
    GuideRef,
    Inertia,
    Length,
    LinkRef,
    Mode,
    Name,
    NonZero,
    Number,
    Part,
    PointRef,
    Positive,
    Refers,
)

# Lobes of a wheel and harmonics of a law; more would be teeth.
MOST_LOBES, MOST_HARMONICS = 8, 12
_GEARED = NonZero("a shaft with the ratio 0 never turns: give the ratio of its speed to that of its link")


class Shaft(Part):
    """A shaft geared to a turning link; its speed is `ratio` times that link's (negative: reversed).

    With a `pivot` the shaft is a link that can carry points and bodies. Without a `carrier` the pivot is a point of the
    frame, and the driver is hinged to the frame too. With a `carrier` it is a point of the carrier; the driver's wheel
    is on another joint or point of the carrier, or fixed to the frame about the carrier's pivot. `ratio` is that of the
    speeds relative to the carrier (negative: external teeth). `phase` is the shaft's angle at crank angle 0; with an
    unevenly turning driver, its angle relative to the carrier where driver and carrier are parallel. Unless the ratio
    is whole, such a driver must swing by less than half a turn to either side of the angle `around` relative to the
    carrier. With the `pressure_angle` of the teeth, reactions include the tooth forces. `efficiency` is that of the
    mesh with the carrier fixed, whichever wheel drives.
    """

    needs: ClassVar = {"phase": ("pivot",), "around": ("pivot",)}

    geared_to: LinkRef
    ratio: Annotated[Number, _GEARED]
    carrier: LinkRef | None = None
    pressure_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] | None = None
    efficiency: Annotated[Number, Field(gt=0, le=1)] | None = None
    inertia: Annotated[Inertia, Field(ge=0)] = 0.0
    pivot: PointRef | None = None
    phase: Angle = 0.0
    around: Angle = 0.0


class ToothedBar(Part):
    """Common keys of driven racks and driven pinions.

    `pivot` is the pinion's axis: a point of the link that carries the rack's guide, or of a slider on that guide. For a
    positive pitch circle `radius` of the pinion, the rack is to the right of the axis and moves along the guide's
    direction as the pinion turns counter-clockwise; a negative radius reverses both. `efficiency` is that of the mesh
    with the pinion's axis fixed, whichever part drives.
    """

    pivot: PointRef
    radius: Annotated[Length, NonZero("a pinion with the radius 0 moves no rack: give the radius of its pitch circle")]
    pressure_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] = 0.0
    efficiency: Annotated[Number, Field(gt=0, le=1)] | None = None


class Rack(ToothedBar):
    """A link that slides on a `guide`, driven by a `pinion`: the crank, a pivoted shaft, or another pinion.

    Its origin is on the guide, its x axis along it. `start` is the distance of the origin beyond the pinion's axis
    where the pinion's angle relative to the guide's carrier is zero.
    """

    pinion: LinkRef
    guide: GuideRef
    start: Length = 0.0


class Pinion(ToothedBar):
    """A link that turns about its `pivot`, driven by a `rack`, which may be any slider on a guide.

    Without a moving rack, the pinion rolls on a fixed one along the `guide` on which its axis slides. `phase` is its
    angle relative to the guide's carrier where the rack's origin, or the guide's point, is level with the axis.
    """

    one_of: ClassVar = (("rack", "guide"),)

    rack: LinkRef | None = None
    guide: GuideRef | None = None
    phase: Angle = 0.0


class EllipticalLaw(Part):
    """Ellipses that turn about their foci; with lobes, ellipses of higher order.

    The driven wheel turns fastest where the law starts. `eccentricity` is that of the ellipse if both wheels have the
    same number of lobes.
    """

    type: Literal["elliptical"]
    eccentricity: Annotated[Number, Field(ge=0, lt=1)]


class RateHarmonic(Part):
    """A harmonic of the driven wheel's speed over a lobe of the driver; coefficients relative to the mean speed."""

    order: Annotated[int, Field(ge=1, le=MOST_HARMONICS)]
    cosine: Number = 0.0
    sine: Number = 0.0


class HarmonicLaw(Part):
    """Speed of the driven wheel: 1 + Σ (c cos kθ + s sin kθ) times its mean, with θ the driver's angle × its lobes."""

    type: Literal["harmonic"]
    harmonics: Annotated[dict[Name, RateHarmonic], Field(min_length=1)]

    def _faults(self) -> Faults:
        # 30 points per period of the highest harmonic.
        angles = np.linspace(0.0, math.tau, 30 * MOST_HARMONICS + 1)
        terms = [
            h.cosine * np.cos(h.order * angles) + h.sine * np.sin(h.order * angles) for h in self.harmonics.values()
        ]
        speeds = 1.0 + sum(terms)
        if speeds.min() <= 0.0:
            place = math.degrees(angles[speeds.argmin()])
            yield (
                f"harmonics: the driven wheel would stop or reverse {place:.0f}° after the start of the law, where "
                f"its speed is {speeds.min():.3g} of the mean; wheels in mesh can't do that: make coefficients smaller"
            )


class NoncircularWheel(Part):
    """A link that turns about a `pivot` of the frame, in mesh with a wheel on the crank, a shaft or another such wheel.

    The wheels turn in opposite directions, on average `driver_lobes` turns of this wheel to `lobes` turns of the
    driver. The `law` gives the variation of the ratio within a lobe of the driver. `begin` is the driver's angle at
    which the law starts. `phase` is this wheel's angle there. With the `pressure_angle` of the teeth, reactions include
    the tooth forces. `efficiency` is that of the mesh, whichever wheel drives.
    """

    geared_to: LinkRef
    pivot: FramePoint
    law: Annotated[EllipticalLaw | HarmonicLaw, Field(discriminator="type")]
    lobes: Annotated[int, Field(ge=1, le=MOST_LOBES)] = 1
    driver_lobes: Annotated[int, Field(ge=1, le=MOST_LOBES)] = 1
    begin: Angle = 0.0
    phase: Angle = 0.0
    pressure_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] | None = None
    efficiency: Annotated[Number, Field(gt=0, le=1)] | None = None


class SlidingFollower(TouchesCam):
    """A link that slides on a guide of the frame; it moves away from the cam in the guide's direction.

    Its origin is the centre of the roller or the knife edge; with a flat face, which is perpendicular to the guide, it
    is the face's point on the guide. The guide may be offset from the cam's axis.
    """

    type: Literal["translating"]
    link: Name
    guide: FrameGuide
    contact: Literal["roller", "flat", "knife edge"]
    roller_radius: Positive | None = None


class SwingingFollower(TouchesCam):
    """A link that turns about a point of the frame, its x axis from there to the roller or edge, or along the face.

    `arm` is the distance of the roller or edge from the pivot; a flat face passes through the pivot. `mode` +1: seen
    from the pivot towards the cam's axis, the arm lies to the left.
    """

    required_with: ClassVar = {"arm": ("contact", ("roller", "knife edge"))}

    type: Literal["oscillating"]
    link: Name
    pivot: FramePoint
    contact: Literal["roller", "flat", "knife edge"]
    roller_radius: Positive | None = None
    arm: Positive | None = None
    mode: Mode = 1


class DrivingCam(CamProgram):
    """A cam on the crank, or on a pivoted shaft geared to it; its follower is a link of the mechanism.

    The first section starts at the crank angle `begin`; sections follow as the crank angle increases, in whichever
    direction the cam turns. `base_radius` is the minimum radius of the cam's surface, at zero displacement. `closure`
    "spring" relies on a spring or other loads to press the follower on the cam, which otherwise lifts off; "form" is a
    groove that drives the follower in both directions.
    """

    on: Annotated[LinkRef, Refers("cam shaft")]
    begin: Angle = 0.0
    base_radius: Positive
    follower: Annotated[SlidingFollower | SwingingFollower, Field(discriminator="type")]
    closure: Literal["spring", "form"] = "spring"

    def _faults(self) -> Faults:
        yield from self._faults_of_jumps()
