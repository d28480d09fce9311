"""The engine that a governor controls, and its throttle."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.laws.tables import Table, make_table
from engine.parts.skeleton import ActionRef, Faults, Inertia, Length, Moment, Number, Part, Positive, quantity
from engine.units.display import quantity_text


class _Throttle(Part):
    """Engine torque between `full` and `closed`."""

    ascending: ClassVar = {("closed", "full"): "a governor closes the throttle as it lifts the sleeve"}

    full: Moment
    closed: Moment = 0.0


class LinearThrottle(_Throttle):
    """Engine torque that falls linearly with the lift: `full` at the inner stop, `closed` at the outer one."""

    type: Literal["linear"]


class TableThrottle(Part):
    """Engine torque by a table over the lift of the sleeve; it must not rise with the lift."""

    type: Literal["table"]
    over_lift: list[Length]
    moment: list[Moment]
    interpolation: Literal["linear", "pchip"]

    def _faults(self) -> Faults:
        make_table(self.over_lift, self.moment, self.interpolation, names=("over_lift", "moment"))
        rises = next((i for i in range(1, len(self.moment)) if self.moment[i] > self.moment[i - 1]), None)
        if rises is not None:
            yield (
                f"moment rises in row {rises + 1}, from "
                f"{quantity_text(self.moment[rises - 1], 'N m')} to {quantity_text(self.moment[rises], 'N m')}: a "
                "governor closes the throttle as it lifts the sleeve; sort the rows so that the moment falls"
            )

    @property
    def table(self) -> Table:
        """Table of the torque."""
        return make_table(self.over_lift, self.moment, self.interpolation)


class FullAndShutThrottle(_Throttle):
    """On-off valve: torque `full` below the lift `switch`, `closed` above it.

    Its engine never runs steadily. A change of load begins with the valve open and the governor in equilibrium, its
    balls at 99 % of their travel from the inner stop to the switch.
    """

    type: Literal["full and shut"]
    switch: Positive


Throttle = Annotated[LinearThrottle | TableThrottle | FullAndShutThrottle, Field(discriminator="type")]


class GovernedEngine(Part):
    """The engine whose speed a governor controls.

    `ratio` is the speed of the governor's spindle over the engine's. The throttle gives the torque at the mean speed of
    the governor; `self_regulation` is the decrease of the torque, or the increase of the load, per rad/s above that
    speed. The engine runs at `load` until the load changes to `new_load`; the motion is simulated for `duration`, and
    is settled once the speed stays within the fraction `settling_band` of the new steady speed.

    With `machine` the engine is the scene's own mechanism: `inertia` is added to the cycle averages of its reduced
    inertia and its flywheel's. Over time the mechanism moves with its actual reduced inertia and its own actions: those
    that are `throttled` follow the throttle, all others are unchanged. `load` is the mean of all resistances, including
    the mechanism's own.
    """

    needs: ClassVar = {"duration": ("new_load",), "settling_band": ("duration",)}

    machine: bool = False
    throttled: tuple[ActionRef, ...] = ()
    inertia: Annotated[Inertia, Field(ge=0)] = 0.0
    ratio: Annotated[Number, Field(gt=0)] = 1.0
    throttle: Throttle
    self_regulation: Annotated[quantity("torsional_damping"), Field(ge=0)] = 0.0
    load: Moment
    new_load: Moment | None = None
    duration: Annotated[quantity("time"), Field(gt=0)] | None = None
    settling_band: Annotated[Number, Field(gt=0)] = 0.01

    def _faults(self) -> Faults:
        if not (self.machine or self.inertia > 0):
            yield "inertia is missing: give that of the engine, or machine = true for the scene's own"
        if self.throttled and not self.machine:
            yield "throttled names actions of the scene's mechanism: give machine = true, or leave it out"
        if self.throttled and self.duration is None:
            yield "throttled needs a simulated change of load: give duration, or leave it out"
