"""Governors as machine elements of a scene: arms or levers, masses, springs, stops, and the engine they govern.

A governor has two balls. Their radii say where the stops are; lifts of the sleeve are counted from the inner stop.
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elements.rotors.bearings import STANDARD_GRAVITY
from engine.laws.tables import TableError, make_table
from engine.parts.skeleton import Acceleration, Inertia, Length, Mass, Name, Number, Part, quantity

Positive = Annotated[Length, Field(gt=0)]
Force = quantity("force")
Moment = quantity("moment")
NotNegative = Annotated[Force, Field(ge=0)]


class LinearThrottle(Part):
    """A moment that falls in proportion to the lift: `full` at the inner stop, `closed` at the outer one."""

    type: Literal["linear"]
    full: Moment
    closed: Moment = 0.0

    @model_validator(mode="after")
    def _closes(self) -> "LinearThrottle":
        return _closing(self)


class TableThrottle(Part):
    """A moment by a table over the lift of the sleeve; it must not rise with the lift."""

    type: Literal["table"]
    over_lift: list[Length]
    moment: list[Moment]
    interpolation: Literal["linear", "pchip"]

    @model_validator(mode="after")
    def _falls(self) -> "TableThrottle":
        _sound(self.over_lift, self.moment, self.interpolation, ("over_lift", "moment"))
        rises = next((i for i in range(1, len(self.moment)) if self.moment[i] > self.moment[i - 1]), None)
        if rises is not None:
            raise ValueError(
                f"moment rises in row {rises + 1}, from {self.moment[rises - 1]:g} to {self.moment[rises]:g} N m: a "
                "governor closes the throttle as it lifts the sleeve; sort the rows so that the moment falls"
            )
        return self


class FullAndShutThrottle(Part):
    """A valve that is either open or shut: `full` below the lift `switch`, `closed` above it."""

    type: Literal["full and shut"]
    full: Moment
    closed: Moment = 0.0
    switch: Positive

    @model_validator(mode="after")
    def _closes(self) -> "FullAndShutThrottle":
        return _closing(self)


Throttle = Annotated[LinearThrottle | TableThrottle | FullAndShutThrottle, Field(discriminator="type")]


def _closing(throttle: "LinearThrottle | FullAndShutThrottle") -> "LinearThrottle | FullAndShutThrottle":
    if not throttle.full > throttle.closed:
        raise ValueError(
            f"full = {throttle.full:g} N m is not above closed = {throttle.closed:g} N m: a governor closes the "
            "throttle as it lifts the sleeve"
        )
    return throttle


def _sound(x: list[float], y: list[float], interpolation: str, names: tuple[str, str]) -> None:
    """Refuse rows that make no table, in words of the scene."""
    try:
        make_table(x, y, interpolation, names=names)
    except TableError as error:
        raise ValueError(str(error)) from None


class GovernedEngine(Part):
    """The engine that a governor holds at its speed.

    `ratio` is the speed of the governor's spindle over the engine's. The throttle gives the moment at the mean speed of
    the governor; with `self_regulation` it falls, or the load rises, by so much for each rad/s above that. The engine
    runs at `load` until it changes to `new_load`; the run is followed for `duration`, and counts as settled where its
    speed stays within the share `settling_band` of the new one.

    With `machine` the engine is the scene's own mechanism: the mean over its cycle of its reduced inertia, and that of
    its flywheel, are added to `inertia`. Over time it then turns with its true reduced inertia, and under its own
    actions: those that are `throttled` as the throttle says, all others as they are. `load` is the mean of all that
    resists, also of the mechanism's own.
    """

    machine: bool = False
    throttled: tuple[Name, ...] = ()
    inertia: Annotated[Inertia, Field(ge=0)] = 0.0
    ratio: Annotated[Number, Field(gt=0)] = 1.0
    throttle: Throttle
    self_regulation: Annotated[quantity("torsional_damping"), Field(ge=0)] = 0.0
    load: Moment
    new_load: Moment | None = None
    duration: Annotated[quantity("time"), Field(gt=0)] | None = None
    settling_band: Annotated[Number, Field(gt=0)] = 0.01

    @model_validator(mode="after")
    def _has_inertia(self) -> "GovernedEngine":
        if not (self.machine or self.inertia > 0):
            raise ValueError("inertia is missing: give that of the engine, or machine = true for the scene's own")
        if self.throttled and not self.machine:
            raise ValueError("throttled names actions of the scene's mechanism: give machine = true, or leave it out")
        return self

    @model_validator(mode="after")
    def _load_changes(self) -> "GovernedEngine":
        if self.duration is not None and self.new_load is None:
            raise ValueError("duration belongs to a change of load: give new_load, or leave duration out")
        return self


class Governor(Part):
    """What all governors have: two balls, a sleeve with friction, damping and a spring, stops, and perhaps an engine.

    `sleeve_mass` is that of the sleeve with its central load. The spring on the sleeve has the force `preload` at the
    inner stop. `speed_change` is the share of the speed for which effort and power are told.
    """

    ball_mass: Annotated[Mass, Field(gt=0)]
    sleeve_mass: Annotated[Mass, Field(ge=0)] = 0.0
    least_radius: Positive
    greatest_radius: Positive
    friction: NotNegative = 0.0
    damping: Annotated[quantity("damping"), Field(ge=0)] = 0.0
    speed_change: Annotated[Number, Field(gt=0)] = 0.01
    engine: GovernedEngine | None = None

    @model_validator(mode="after")
    def _has_a_range(self) -> "Governor":
        if not self.least_radius < self.greatest_radius:
            raise ValueError(
                f"greatest_radius = {self.greatest_radius:g} m is not above least_radius = {self.least_radius:g} m: "
                "give the radii of the balls at the inner and the outer stop"
            )
        return self


class LoadedGovernor(Governor):
    """A governor that is held by weights and a spring."""

    stiffness: Annotated[quantity("stiffness"), Field(ge=0)] = 0.0
    preload: Force = 0.0
    gravity: Annotated[Acceleration, Field(ge=0)] = STANDARD_GRAVITY


class ArmGovernor(LoadedGovernor):
    """A governor with upper arms on the spindle and lower arms on the sleeve.

    `upper_pivot` and `lower_pivot` are the distances of their pivots from the axis, on the side of the ball; negative
    where arms cross the axis.
    """

    upper_arm: Positive
    lower_arm: Positive
    upper_pivot: Length = 0.0
    lower_pivot: Length = 0.0


class WattGovernor(ArmGovernor):
    """Watt's governor: balls on the upper arms.

    They are at `ball_arm` from the pivots; at the joints with the lower arms where that isn't given.
    """

    type: Literal["watt_governor"]
    ball_arm: Positive | None = None


class PorterGovernor(ArmGovernor):
    """Porter's governor: balls at the joints of the arms, and a central load on the sleeve."""

    type: Literal["porter_governor"]
    sleeve_mass: Annotated[Mass, Field(gt=0)]


class ProellGovernor(ArmGovernor):
    """Proell's governor: balls on extensions of the lower arms.

    The extensions are parallel to the axis when the balls are at `parallel_radius`.
    """

    type: Literal["proell_governor"]
    extension: Positive
    parallel_radius: Length


class HartnellGovernor(LoadedGovernor):
    """Hartnell's governor: balls on the upright arms of bell cranks, which lift the sleeve against a spring.

    `pivot_radius` is that of the cranks' pivots; there the ball arms are parallel to the axis.
    """

    type: Literal["hartnell_governor"]
    ball_arm: Positive
    sleeve_arm: Positive
    pivot_radius: Positive
    stiffness: Annotated[quantity("stiffness"), Field(gt=0)]


class TableGovernor(Governor):
    """A governor by a table of its controlling force, found by experiment: the force on each ball, without friction.

    The rows stand over the radius of the balls, or over the lift, which is `lift_ratio` times the radius gained.
    """

    type: Literal["table_governor"]
    over_radius: list[Length] | None = None
    over_lift: list[Length] | None = None
    controlling_force: list[Force]
    interpolation: Literal["linear", "pchip", "spline"]
    lift_ratio: Annotated[Number, Field(gt=0)]

    @model_validator(mode="after")
    def _table_spans_the_range(self) -> "TableGovernor":
        if (self.over_radius is None) == (self.over_lift is None):
            raise ValueError("give over_radius or over_lift, one of the two")
        key = "over_lift" if self.over_radius is None else "over_radius"
        rows = getattr(self, key)
        _sound(rows, self.controlling_force, self.interpolation, (key, "controlling_force"))
        lift = (self.greatest_radius - self.least_radius) * self.lift_ratio
        needed = (0.0, lift) if self.over_radius is None else (self.least_radius, self.greatest_radius)
        if not (rows[0] <= needed[0] and needed[1] <= rows[-1] * (1 + 1e-12)):
            raise ValueError(
                f"{key} spans {rows[0]:g} to {rows[-1]:g} m, the stops lie at {needed[0]:g} and {needed[1]:g} m: give "
                "rows up to both stops, or move these"
            )
        return self


AnyGovernor = WattGovernor | PorterGovernor | ProellGovernor | HartnellGovernor | TableGovernor


def governs_machine(element: Part) -> bool:
    """Whether an element is a governor whose engine is the scene's mechanism."""
    return isinstance(element, Governor) and element.engine is not None and element.engine.machine
