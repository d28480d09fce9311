"""What has mass in a scene: bodies, the base that accelerates them, and the flywheel."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.parts.skeleton import (
    Acceleration,
    Area,
    AxesRef,
    Density,
    Faults,
    FramePoint,
    Inertia,
    Length,
    Mass,
    Name,
    Number,
    Part,
    Pressure,
    Refers,
    Speed,
    Time,
)
from engine.units.display import quantity_text

# Definition of the coefficient of speed fluctuation: relative to the mean of both speeds, not to the mean over time.
OF_FLUCTUATION = "2 (ω_max − ω_min)/(ω_max + ω_min)"


class Rod(Part):
    """Uniform thin rod along the link's x axis from the origin: J = mL²/12 about its middle; mass = ρAL."""

    type: Literal["rod"]
    length: Annotated[Length, Field(gt=0)]
    area: Annotated[Area, Field(gt=0)] | None = None


class Disc(Part):
    """Uniform disc: J = mR²/2; mass = ρπR²t."""

    type: Literal["disc"]
    diameter: Annotated[Length, Field(gt=0)]
    thickness: Annotated[Length, Field(gt=0)] | None = None


class Ring(Part):
    """Uniform ring: J = m(R² + r²)/2; mass = ρπ(R² − r²)t."""

    ascending: ClassVar = {("inner_diameter", "diameter"): "a ring lies between them"}

    type: Literal["ring"]
    diameter: Annotated[Length, Field(gt=0)]
    inner_diameter: Annotated[Length, Field(gt=0)]
    thickness: Annotated[Length, Field(gt=0)] | None = None


class Plate(Part):
    """Uniform rectangular plate: J = m(a² + b²)/12; mass = ρabt."""

    type: Literal["plate"]
    length: Annotated[Length, Field(gt=0)]
    width: Annotated[Length, Field(gt=0)]
    thickness: Annotated[Length, Field(gt=0)] | None = None


Shape = Annotated[Rod | Disc | Ring | Plate, Field(discriminator="type")]


STANDARD_GRAVITY = 9.80665


class Swinging(Part):
    """Small swings of a body under `gravity`, by default the earth's; `period` is a full swing, there and back."""

    period: Annotated[Time, Field(gt=0)]
    gravity: Annotated[Acceleration, Field(gt=0)] = STANDARD_GRAVITY


class CompoundPendulum(Swinging):
    """Swings about a knife edge at a `distance` h from the mass centre: J = mgh T²/4π² − mh²."""

    type: Literal["compound"]
    distance: Annotated[Length, Field(gt=0)]

    def _faults(self) -> Faults:
        least = math.tau * math.sqrt(self.distance / self.gravity)
        if self.period < least:
            yield (
                f"period = {self.period:g} s: no body swings faster than a point mass at distance = "
                f"{quantity_text(self.distance, 'm')}, in {least:.4g} s; give a longer period "
                f"(there and back) or a shorter distance"
            )


class BifilarSuspension(Swinging):
    """Torsional swings on two parallel wires, `spacing` d apart and `length` L long: J = mg d² T²/(16π² L)."""

    type: Literal["bifilar"]
    spacing: Annotated[Length, Field(gt=0)]
    length: Annotated[Length, Field(gt=0)]


class TrifilarSuspension(Swinging):
    """Torsional swings on three parallel wires on a circle of `radius` r, `length` L long: J = mg r² T²/(4π² L)."""

    type: Literal["trifilar"]
    radius: Annotated[Length, Field(gt=0)]
    length: Annotated[Length, Field(gt=0)]


Swing = Annotated[CompoundPendulum | BifilarSuspension | TrifilarSuspension, Field(discriminator="type")]


class Replacement(Part):
    """Point masses that replace a body, at named points of its link; "centre" is the body's mass centre.

    "static" conserves mass and mass centre: two points on a line through the centre, or any three. "dynamic" also
    conserves the moment of inertia: one point (its conjugate is computed); two points and the `mass` at the first (a
    third is computed); three points on a line through the centre; or four.
    """

    type: Literal["static", "dynamic"]
    at: tuple[Name, ...]
    mass: Mass | None = None

    def _faults(self) -> Faults:
        allowed = {"static": (2, 3), "dynamic": (1, 2, 3, 4)}[self.type]
        if len(self.at) not in allowed:
            listed = f"{', '.join(map(str, allowed[:-1]))} or {allowed[-1]}"
            yield f"at names {len(self.at)} points; a {self.type} replacement takes {listed}"
        if len(set(self.at)) < len(self.at):
            yield f"at names a point twice: {', '.join(self.at)}; name each once"
        by_mass = self.type == "dynamic" and len(self.at) == 2
        if by_mass and self.mass is None:
            yield f"two points need the mass at the first, {self.at[0]!r}: give mass; or name one point"
        if self.mass is not None and not by_mass:
            yield "mass belongs to a dynamic replacement at two points; omit it, the masses are computed"


class Body(Part):
    """A mass on a link: mass, mass centre in the link's axes and moment of inertia about it, or a shape.

    With a `shape` the inertia follows from it; the mass is given, or follows from `density` and the shape's thickness
    (a rod's area). The mass centre of a rod is its middle unless x, y are given. With `replace`, point masses replace
    the body in all calculations. Instead of `inertia`, `swing` gives the measured period of the body as a pendulum or
    on wires. The axis of a pendulum is perpendicular to the plane of motion. On wires, the body hangs with that
    perpendicular vertical and turns about a vertical axis through its mass centre.
    """

    needs: ClassVar = {"density": ("shape",)}

    link: Annotated[AxesRef, Refers("moving link")]
    mass: Annotated[Mass, Field(ge=0)] | None = None
    x: Length | None = None
    y: Length = 0.0
    inertia: Annotated[Inertia, Field(ge=0)] | None = None
    shape: Shape | None = None
    density: Annotated[Density, Field(gt=0)] | None = None
    swing: Swing | None = None
    replace: Replacement | None = None

    def _faults(self) -> Faults:
        if self.swing is not None and (self.inertia is not None or self.shape is not None):
            other = "inertia" if self.shape is None else "shape"
            yield f"inertia follows from the swing; give swing or {other}, one of the two"
        if self.shape is None:
            if self.mass is None:
                yield "give mass (with inertia), or a shape with density"
            return
        thickness = "area" if self.shape.type == "rod" else "thickness"
        if self.density is None and self.shape.gives(thickness):
            yield f"shape.{thickness} has no meaning where the mass is given; leave it out, or give density"
        if self.inertia is not None:
            yield "inertia follows from the shape; give one of the two"
        if (self.mass is None) == (self.density is None):
            yield "with a shape, give either mass or density"
        if self.density is not None and getattr(self.shape, thickness) is None:
            yield f"density needs shape.{thickness}; give it, or give mass instead of density"


class AcceleratedBase(Part):
    """Constant acceleration of the frame, as in a braking vehicle or a starting lift.

    The machine's motion is relative to the frame. In addition to its weight, each mass is loaded by −m a, which counts
    as "gravity" in all results.
    """

    acceleration_x: Acceleration = 0.0
    acceleration_y: Acceleration = 0.0


class Balance(Part):
    """Reference point of the shaking moment: `about` is a point of the frame."""

    about: FramePoint


class WheelForm(Part):
    """Design of the flywheel.

    Type "rim" is a rim of radial thickness `thickness_ratio` × diameter; "disc" a solid disc; "arms" a rim with `arms`
    straight arms of section `arm_area` and a hub; "mean rim" the textbook's rim, with all mass at half the
    `mean_diameter`, and a width of `width_ratio` × its thickness. The default `diameter` is the largest that the rim
    speed allows. `ratio` is the speed of the wheel's shaft over that of the input link. With the `strength` of the
    material, the bursting speed is reported.
    """

    goes_with: ClassVar = {
        "arms": ("type", ("arms",)),
        "thickness_ratio": ("type", ("rim", "arms")),
        "width_ratio": ("type", ("mean rim",)),
        "diameter": ("type", ("rim", "disc", "arms")),
        "mean_diameter": ("type", ("mean rim",)),
    }
    required_with: ClassVar = dict.fromkeys(("arm_area", "hub_diameter", "hub_width"), ("type", ("arms",)))

    type: Literal["rim", "disc", "arms", "mean rim"]
    material: Literal["cast iron", "steel"] = "cast iron"
    density: Annotated[Density, Field(gt=0)] | None = None
    rim_speed_limit: Annotated[Speed, Field(gt=0)] | None = None
    diameter: Annotated[Length, Field(gt=0)] | None = None
    mean_diameter: Annotated[Length, Field(gt=0)] | None = None
    thickness_ratio: Annotated[Number, Field(gt=0, lt=0.5)] = 0.1
    width_ratio: Annotated[Number, Field(gt=0)] = 2.0
    strength: Annotated[Pressure, Field(gt=0)] | None = None
    ratio: Annotated[Number, Field(gt=0)] = 1.0
    arms: Annotated[int, Field(ge=2)] = 6
    arm_area: Annotated[Area, Field(gt=0)] | None = None
    hub_diameter: Annotated[Length, Field(gt=0)] | None = None
    hub_width: Annotated[Length, Field(gt=0)] | None = None

    def _faults(self) -> Faults:
        if self.density is not None and self.rim_speed_limit is not None and self.gives("material"):
            yield "material: it has no effect with density and rim_speed_limit; remove it"


class Flywheel(Part):
    """The flywheel: its `inertia` on the input link, the required `speed_fluctuation`, and its design.

    `speed_fluctuation` is δ = (ω_max − ω_min)/ω_m, with ω_m = (ω_max + ω_min)/2 equal to `input.speed`.
    """

    inertia: Annotated[Inertia, Field(ge=0)] | None = None
    speed_fluctuation: Annotated[Number, Field(gt=0, lt=2)] | None = None
    wheel: WheelForm | None = None

    @property
    def has_size(self) -> bool:
        """Whether its inertia is given or follows from `speed_fluctuation`."""
        return self.inertia is not None or self.speed_fluctuation is not None
