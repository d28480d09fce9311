"""Cams in a mechanism, on the crank or a shaft geared to it; their followers are links of the mechanism."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.parts.motion_programs import CamProgram, TouchesCam
from engine.parts.skeleton import Angle, Faults, FrameGuide, FramePoint, LinkRef, Mode, Name, Positive, Refers


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
