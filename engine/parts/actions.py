"""Actions on a machine: forces on points, moments on links, springs, motors and brakes.

Conventions
-----------
A force acts at a point along `angle`, measured from the x axis of the frame, or of the link named in `turns_with`; a
positive value acts in that direction. A moment acts on a link, positive counter-clockwise. `acts` limits an action to
the part of the cycle in which its point moves "along" or "against" its direction. `role` classifies its work:
"driving", "useful" (the resistance that the machine exists to overcome) or "harmful" (losses).
"""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field, field_validator

from engine import laws
from engine.parts.formulas.by_formula import ByFormula, FormulaText
from engine.parts.motors import AnyMotor
from engine.parts.skeleton import (
    FRAME,
    Acceleration,
    Angle,
    AngularSpeed,
    Area,
    Density,
    Faults,
    Length,
    LinkRef,
    Mass,
    Moment,
    Name,
    Number,
    Part,
    PointRef,
    Refers,
    SliderRef,
    Time,
    quantity,
)

Force = quantity("force")
Speed = quantity("speed")
Stiffness = quantity("stiffness")
Damping = quantity("damping")
QuadraticDrag = quantity("quadratic_drag")
TorsionalStiffness = quantity("torsional_stiffness")
TorsionalDamping = quantity("torsional_damping")
TorsionalQuadraticDrag = quantity("torsional_quadratic_drag")

Role = Literal["driving", "useful", "harmful"]
Interpolation = Literal["linear", "pchip", "spline"]


class OnPoint(Part):
    """A force at a point, along a fixed direction of the frame or of a link.

    `on` is the loaded point. `angle` is the direction of a positive force, measured from the x axis of the frame.
    `turns_with` names a link whose x axis replaces the frame's. `acts` limits the force to motion of its point "along"
    or "against" its direction. `role` classifies its work: "driving", "useful" or "harmful" (losses).
    """

    on: PointRef
    angle: Angle
    turns_with: LinkRef = FRAME
    acts: Literal["always", "along", "against"] = "always"
    role: Role = "useful"


class ResistingOnPoint(OnPoint):
    """A force that opposes the velocity of a point, or, with `angle`, its component in that direction."""

    angle: Angle | None = None
    role: Role = "harmful"

    def _faults(self) -> Faults:
        if self.angle is None and (self.acts != "always" or self.turns_with != FRAME):
            yield "acts and turns_with refer to a direction: give angle"


class OnLink(Part):
    """A moment on a link or shaft.

    `on` is the loaded link or shaft. `acts` limits the moment to rotation "along" (counter-clockwise) or "against" its
    positive direction. `role` classifies its work: "driving", "useful" or "harmful" (losses).
    """

    on: Annotated[LinkRef, Refers("turning link")]
    acts: Literal["always", "along", "against"] = "always"
    role: Role = "useful"


class ResistingOnLink(OnLink):
    """A moment that opposes the rotation of a link or shaft."""

    role: Role = "harmful"


class Tabled(Part):
    """A characteristic given by a table over the crank angle, a slider's stroke, or time.

    Exactly one of `over_angle`, `over_stroke`, `over_time` holds the abscissae. Over a stroke, `slider` names the
    slider. `measured_from` is the zero of the stroke: the guide's point, or the low or high end of the stroke (distance
    from that end, positive inwards). Over the angle the table repeats with the cycle. `interpolation` joins the rows by
    straight lines, a monotone cubic ("pchip") or a cubic spline. `outside` its rows a table holds its end values or is
    zero. `scale` multiplies all values.
    """

    one_of: ClassVar = (("over_angle", "over_stroke", "over_time"),)

    over_angle: list[Angle] | None = None
    over_stroke: list[Length] | None = None
    over_time: list[Time] | None = None
    slider: SliderRef | None = None
    measured_from: Literal["guide", "low end", "high end"] = "guide"
    interpolation: Interpolation
    outside: Literal["hold", "zero"] = "hold"
    scale: Number = 1.0

    @property
    def abscissae(self) -> list[float]:
        """The abscissae, of whichever kind."""
        return next(t for t in (self.over_angle, self.over_stroke, self.over_time) if t is not None)

    @property
    def ordinate(self) -> str:
        """Key of the forces or moments of the table."""
        return "force" if hasattr(self, "force") else "moment"

    @property
    def ordinates(self) -> list[float]:
        """The forces or moments of the table."""
        return getattr(self, self.ordinate)

    def _faults(self) -> Faults:
        given = self.gives("over_angle", "over_stroke", "over_time")
        if (given == ["over_stroke"]) != (self.slider is not None):
            yield "over_stroke and slider belong together: name the slider whose stroke is meant"
        if given != ["over_stroke"] and self.gives("measured_from"):
            yield f"measured_from has no meaning with {given[0]}, only with over_stroke; leave it out"
        rows, names = (self.abscissae, self.ordinates), (given[0], self.ordinate)
        laws.tables.make_table(*rows, self.interpolation, outside=self.outside, names=names)


class ConstantForce(OnPoint):
    """A constant force."""

    type: Literal["constant"]
    force: Force


class TableForce(OnPoint, Tabled):
    """A force given by a table."""

    type: Literal["table"]
    force: list[Force]


class ForceAgainstMotion(ResistingOnPoint):
    """A resistance of constant magnitude against the motion."""

    type: Literal["against_motion"]
    force: Annotated[Force, Field(ge=0)]


class LinearDragForce(ResistingOnPoint):
    """Viscous resistance −c v, with the `coefficient` c."""

    type: Literal["linear_drag"]
    coefficient: Annotated[Damping, Field(ge=0)]


class QuadraticDragForce(ResistingOnPoint):
    """Aerodynamic or hydraulic resistance −c v|v|, with the `coefficient` c."""

    type: Literal["quadratic_drag"]
    coefficient: Annotated[QuadraticDrag, Field(ge=0)]


class PowerDragForce(ResistingOnPoint):
    """A resistance proportional to a power of the speed: `force` at `at_speed`, times (v/at_speed)^`exponent`."""

    type: Literal["power_drag"]
    force: Annotated[Force, Field(ge=0)]
    at_speed: Annotated[Speed, Field(gt=0)]
    exponent: Annotated[Number, Field(ge=0)]


class FormulaForce(ResistingOnPoint, ByFormula):
    """A force given by a formula, positive along `angle`, or, without an angle, along the motion of the point.

    The formula may use its own `numbers`, the crank angle `phi`, the velocity `v` of the point along the force, the
    crank's angular velocity `omega`, the time `t`, the motion of the machine, such as `ram.slide`, and numbers of the
    scene by their paths; see `engine.scene.load_formulas`.
    """

    type: Literal["formula"]
    force: FormulaText
    role: Role = "useful"


class ConstantMoment(OnLink):
    """A constant moment."""

    type: Literal["constant"]
    moment: Moment


class TableMoment(OnLink, Tabled):
    """A moment given by a table."""

    type: Literal["table"]
    moment: list[Moment]


class FormulaMoment(OnLink, ByFormula):
    """A moment given by a formula, as for forces; `omega` is the angular velocity of the loaded link."""

    type: Literal["formula"]
    moment: FormulaText


class MomentAgainstMotion(ResistingOnLink):
    """A resisting moment of constant magnitude against the rotation."""

    type: Literal["against_motion"]
    moment: Annotated[Moment, Field(ge=0)]


class LinearDragMoment(ResistingOnLink):
    """Viscous resistance −c ω, with the `coefficient` c."""

    type: Literal["linear_drag"]
    coefficient: Annotated[TorsionalDamping, Field(ge=0)]


class QuadraticDragMoment(ResistingOnLink):
    """Fan or hydraulic resistance −c ω|ω|, with the `coefficient` c."""

    type: Literal["quadratic_drag"]
    coefficient: Annotated[TorsionalQuadraticDrag, Field(ge=0)]


class PowerDragMoment(ResistingOnLink):
    """A resistance proportional to a power of the speed: `moment` at `at_speed`, times (ω/at_speed)^`exponent`."""

    type: Literal["power_drag"]
    moment: Annotated[Moment, Field(ge=0)]
    at_speed: Annotated[AngularSpeed, Field(gt=0)]
    exponent: Annotated[Number, Field(ge=0)]


class Brake(Part):
    """A brake on a link or shaft; it acts against the rotation, in regimes only, unless a regime lists it as `off`."""

    on: Annotated[LinkRef, Refers("turning link")]

    @property
    def role(self) -> str:
        """Work of a brake: heat."""
        return "braking"


class BlockBrake(Brake):
    """Blocks pressed on a drum, M = n f N R; `force` acts on each of the `blocks`.

    `embrace` is the angle of contact of a long block, which brakes slightly better than a short one.
    """

    type: Literal["block_brake"]
    force: Annotated[Force, Field(ge=0)]
    friction: Annotated[Number, Field(ge=0)]
    radius: Annotated[Length, Field(gt=0)]
    blocks: Annotated[int, Field(ge=1)] = 1
    embrace: Annotated[Angle, Field(ge=0, le=math.pi)] = 0.0


class DiscBrake(Brake):
    """A disc or plates between linings, M = n f P r_m; n friction `faces`; `linings` worn in (uniform wear) or new."""

    ascending: ClassVar = {("inner_radius", "outer_radius"): "the linings lie between them"}

    type: Literal["disc_brake"]
    force: Annotated[Force, Field(ge=0)]
    friction: Annotated[Number, Field(ge=0)]
    inner_radius: Annotated[Length, Field(ge=0)]
    outer_radius: Annotated[Length, Field(gt=0)]
    faces: Annotated[int, Field(ge=1)] = 2
    linings: Literal["worn in", "new"] = "worn in"


class BandBrake(Brake):
    """A band around a drum (Euler); `force` acts on a lever of length `lever_arm`, which pulls the ends of the band.

    `slack_arm` and `tight_arm` are the arms of the band's slack and tight end about the lever's fulcrum: one of them 0
    for a simple band, opposite signs for a differential band. `wrap` is the angle of contact. A band lined with
    `blocks`, each with the angle of contact `block_angle`, has these instead of `wrap`; its `radius` is that of the
    band.
    """

    together: ClassVar = (("blocks", "block_angle"),)

    type: Literal["band_brake"]
    force: Annotated[Force, Field(ge=0)]
    friction: Annotated[Number, Field(ge=0)]
    radius: Annotated[Length, Field(gt=0)]
    wrap: Annotated[Angle, Field(gt=0)] | None = None
    blocks: Annotated[int, Field(ge=1)] | None = None
    block_angle: Annotated[Angle, Field(gt=0, lt=math.pi)] | None = None
    lever_arm: Annotated[Length, Field(gt=0)]
    slack_arm: Length = 0.0
    tight_arm: Length = 0.0

    def _faults(self) -> Faults:
        if self.slack_arm == 0.0 and self.tight_arm == 0.0:
            yield "give slack_arm or tight_arm: the lever must pull an end of the band"
        if not self.slack_arm + self.tight_arm > 0.0:
            yield (
                "slack_arm + tight_arm must be above 0, or the lever slackens the band: change a sign, or make the arm "
                "of the end that the lever tightens the longer one"
            )
        if (self.wrap is None) == (self.blocks is None):
            yield "give wrap, or blocks with block_angle for a band lined with blocks"


class TorsionSpring(Part):
    """A torsion spring between a link and the frame: −k (θ − θ₀), θ in (−π, π].

    `stiffness` is k. `free_angle` is θ₀.
    """

    type: Literal["torsion_spring"]
    on: Annotated[LinkRef, Refers("turning link"), Refers("link with an angle")]
    stiffness: TorsionalStiffness
    free_angle: Angle = 0.0


class Carried(Part):
    """Masses moved along a straight path by a drum or wheel on the crank or a shaft, at its rim speed.

    `forwards` is the rotation that moves the masses forwards, which is up for a hoist and for a positive slope.
    `gravity` defaults to the scene's, or to 9.80665 m/s² if the scene has none.
    """

    masses: ClassVar[tuple[str, ...]] = ("mass",)
    radius: ClassVar[str] = "drum_radius"
    on: Annotated[LinkRef, Refers("crank or shaft")]
    forwards: Literal["counter-clockwise", "clockwise"] = "counter-clockwise"
    gravity: Annotated[Acceleration, Field(gt=0)] | None = None
    role: Role = "useful"


class HoistMoment(Carried):
    """A load on the rope of a drum: its weight m g r, and its mass as the inertia m r².

    `efficiency` is that of the transmission between load and drum: lifting takes m g r/η, lowering gives back m g r η.
    Losses count as harmful work, whatever the `role` of the load.
    """

    type: Literal["hoist"]
    mass: Annotated[Mass, Field(ge=0)]
    drum_radius: Annotated[Length, Field(gt=0)]
    efficiency: Annotated[Number, Field(gt=0, le=1)] = 1.0


class VehicleMoment(Carried):
    """A vehicle on its driven wheels: rolling resistance f m g cos α, slope m g sin α, drag ½ ρ c A v², inertia m r².

    `rolling` is the coefficient f. `slope` is the angle α, positive if the path rises forwards. `drag_area` is c A of
    the body. `air_density` is ρ.
    """

    radius: ClassVar[str] = "wheel_radius"
    needs: ClassVar = {"forwards": ("slope",), "air_density": ("drag_area",)}
    type: Literal["vehicle"]
    mass: Annotated[Mass, Field(ge=0)]
    wheel_radius: Annotated[Length, Field(gt=0)]
    rolling: Annotated[Number, Field(ge=0)] = 0.0
    slope: Annotated[Angle, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0
    drag_area: Annotated[Area, Field(ge=0)] = 0.0
    air_density: Annotated[Density, Field(ge=0)] = 1.204


class ConveyorMoment(Carried):
    """A belt conveyor on its drum: friction C f (m_b + m_l) g cos δ, lift m_l g sin δ, inertia (m_b + m_l) r².

    `load_mass` is m_l, the mass on the belt. `belt_mass` is m_b, the belt and the rotating mass of its idlers.
    `friction` is the coefficient f. `length_coefficient` is C, the allowance for the ends of a short conveyor.
    `incline` is the angle δ.
    """

    masses: ClassVar[tuple[str, ...]] = ("load_mass", "belt_mass")
    needs: ClassVar = {"forwards": ("incline",), "length_coefficient": ("friction",)}
    type: Literal["conveyor"]
    load_mass: Annotated[Mass, Field(ge=0)]
    belt_mass: Annotated[Mass, Field(ge=0)] = 0.0
    drum_radius: Annotated[Length, Field(gt=0)]
    friction: Annotated[Number, Field(ge=0)] = 0.0
    length_coefficient: Annotated[Number, Field(ge=1)] = 1.0
    incline: Annotated[Angle, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0


_ForceDrag = LinearDragForce | QuadraticDragForce | PowerDragForce
ForceAction = Annotated[
    ConstantForce | TableForce | FormulaForce | ForceAgainstMotion | _ForceDrag, Field(discriminator="type")
]
_GivenMoment = ConstantMoment | TableMoment | FormulaMoment | MomentAgainstMotion
_MomentDrag = LinearDragMoment | QuadraticDragMoment | PowerDragMoment
_AnyBrake = BlockBrake | DiscBrake | BandBrake
_CarriedMoment = HoistMoment | VehicleMoment | ConveyorMoment
MomentAction = Annotated[
    _GivenMoment | _MomentDrag | _AnyBrake | TorsionSpring | _CarriedMoment | AnyMotor, Field(discriminator="type")
]


class Spring(Part):
    """A spring with an optional damper between two points: it pulls with k (L − l) + c dL/dt.

    `between` names the two points. `stiffness` is k. `free_length` is l. `damping` is c.
    """

    needs: ClassVar = {"free_length": ("stiffness",)}

    between: tuple[PointRef, PointRef]
    stiffness: Stiffness = 0.0
    free_length: Annotated[Length, Field(ge=0)] = 0.0
    damping: Annotated[Damping, Field(ge=0)] = 0.0

    @field_validator("between")
    @classmethod
    def _has_two_ends(cls, between: tuple[Name, Name]) -> tuple[Name, Name]:
        if between[0] == between[1]:
            raise ValueError(f"both ends are {between[0]!r}: name two points")
        return between
