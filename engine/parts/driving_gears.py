"""Racks, pinions and non-circular wheels that drive a mechanism, as a scene describes them."""

import math
from typing import Annotated, Literal

import numpy as np
from pydantic import Field, model_validator

from engine.parts.skeleton import Angle, GuideRef, Length, LinkRef, Name, NonZero, Number, Part, PointRef

# Lobes of a wheel, and harmonics of a law: more would be teeth.
MOST_LOBES, MOST_HARMONICS = 8, 12


class ToothedBar(Part):
    """What a rack that is driven and a pinion that is driven have in common.

    `pivot` is the pinion's axis: a point of what carries the rack's guide, or of a slider on that guide. With a
    positive `radius` of the pinion's pitch circle the rack moves along the guide's direction as the pinion turns
    counter-clockwise, and lies to the right of the axis; with a negative one it is the other way round. `efficiency`
    is that of the mesh, the pinion's axis held, whichever drives.
    """

    pivot: PointRef
    radius: Annotated[Length, NonZero("a pinion with the radius 0 moves no rack: give the radius of its pitch circle")]
    pressure_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] = 0.0
    efficiency: Annotated[Number, Field(gt=0, le=1)] | None = None


class Rack(ToothedBar):
    """A link that slides on a `guide`, driven by a `pinion`: the crank, a shaft with a pivot, or another pinion.

    Its origin lies on the guide, `start` beyond the pinion's axis where the pinion's angle against what carries the
    guide is zero; its x axis lies along the guide.
    """

    pinion: LinkRef
    guide: GuideRef
    start: Length = 0.0


class Pinion(ToothedBar):
    """A link that turns about its `pivot`, driven by a `rack`, which is any slider on a guide.

    Without a rack that moves, it rolls on one that lies along the `guide` on which its axis slides. Its angle against
    what carries the guide is `phase` where the rack's origin, or the guide's point, is beside the axis.
    """

    rack: LinkRef | None = None
    guide: GuideRef | None = None
    phase: Angle = 0.0

    @model_validator(mode="after")
    def _has_one_rack(self) -> "Pinion":
        if (self.rack is None) == (self.guide is None):
            raise ValueError("give either rack, the slider that drives it, or guide, along which a fixed rack lies")
        return self


class EllipticalLaw(Part):
    """Ellipses that turn about their foci; with lobes, their like of higher order.

    The driven wheel turns fastest where the law begins. With equal numbers of lobes `eccentricity` is the ellipse's.
    """

    type: Literal["elliptical"]
    eccentricity: Annotated[Number, Field(ge=0, lt=1)]


class RateHarmonic(Part):
    """A harmonic of the driven wheel's speed over a lobe of the driver: coefficients as shares of the mean."""

    order: Annotated[int, Field(ge=1, le=MOST_HARMONICS)]
    cosine: Number = 0.0
    sine: Number = 0.0


class HarmonicLaw(Part):
    """The driven wheel's speed is 1 + Σ c cos kθ + s sin kθ of its mean, θ the driver's angle times its lobes."""

    type: Literal["harmonic"]
    harmonics: Annotated[dict[Name, RateHarmonic], Field(min_length=1)]

    @model_validator(mode="after")
    def _goes_on(self) -> "HarmonicLaw":
        # Thirty steps to a period of the highest harmonic.
        angles = np.linspace(0.0, 2.0 * math.pi, 30 * MOST_HARMONICS + 1)
        terms = [
            h.cosine * np.cos(h.order * angles) + h.sine * np.sin(h.order * angles) for h in self.harmonics.values()
        ]
        speeds = 1.0 + sum(terms)
        if speeds.min() <= 0.0:
            place = math.degrees(angles[speeds.argmin()])
            raise ValueError(
                f"harmonics: the driven wheel would stand or turn back {place:.0f}° after the law's beginning, where "
                f"its speed is {speeds.min():.3g} of the mean; wheels in mesh can't do that: make coefficients smaller"
            )
        return self


class NoncircularWheel(Part):
    """A link that turns about a `pivot` of the frame, in mesh with a wheel on the crank, a shaft or another such wheel.

    They turn against each other, `driver_lobes` turns of it to `lobes` of the driver's on average; within a lobe of
    the driver the `law` says how unevenly. `begin` is the driver's angle at which the law begins, and `phase` this
    wheel's angle there. With the `pressure_angle` of the teeth, forces between them are part of reactions.
    `efficiency` is that of the mesh, whichever wheel drives.
    """

    geared_to: LinkRef
    pivot: PointRef
    law: Annotated[EllipticalLaw | HarmonicLaw, Field(discriminator="type")]
    lobes: Annotated[int, Field(ge=1, le=MOST_LOBES)] = 1
    driver_lobes: Annotated[int, Field(ge=1, le=MOST_LOBES)] = 1
    begin: Angle = 0.0
    phase: Angle = 0.0
    pressure_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] | None = None
    efficiency: Annotated[Number, Field(gt=0, le=1)] | None = None
