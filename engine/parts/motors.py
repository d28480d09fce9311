"""Motors: their models, and their torque over speed as a sum of laws with each motor's constants."""

from collections.abc import Callable, Mapping
from itertools import pairwise
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from engine import laws
from engine.compiling.decorators import Law
from engine.graph.nodes import Node
from engine.parts.skeleton import AngularSpeed, Faults, LinkRef, Moment, Number, Part, Power, Refers

Value = float | np.ndarray | Node
Numbers = Mapping[str, float | np.ndarray]


class MotorCurve(NamedTuple):
    """Torque of a motor over its speed, with its constants as numbers of variants or as nodes.

    Attributes
    ----------
    laws : tuple of Law
        Their sum is the torque.
    constants : tuple of tuple
        Arguments of each law before the speed.
    no_load_speed : float or ndarray
        Speed above which the motor does not drive; infinite for a motor by any table [rad/s].
    bends : tuple
        Speeds at which the slope jumps [rad/s].
    breakdowns : tuple
        Distances of peaks, as motor and as generator, from the no-load speed [rad/s].
    """

    laws: tuple[Law, ...]
    constants: tuple[tuple[Value, ...], ...]
    no_load_speed: Value
    bends: tuple[Value, ...] = ()
    breakdowns: tuple[Value, ...] = ()

    def moment(self, speed: Value) -> Value:
        """Torque at a speed [N·m]."""

        def at_speed(law: Law, constants: tuple[Value, ...]) -> Value:
            return speed.graph.apply(law, *constants, speed) if isinstance(speed, Node) else law(*constants, speed)

        return sum(map(at_speed, self.laws, self.constants))

    @classmethod
    def of_nodes(cls, kinds: tuple[Law, ...], node: Callable[[str, int, int], Node]) -> "MotorCurve":
        """A curve with nodes as constants, each made from its label, its law's index and its own index in the law."""
        codes = [law.py_func.__code__ for law in kinds]
        names = [code.co_varnames[: code.co_argcount - 1] for code in codes]
        constants = (tuple(node(f"{name} {i}", i, j) for j, name in enumerate(own)) for i, own in enumerate(names))
        return cls(kinds, tuple(constants), np.inf)

    @property
    def peaks(self) -> list[Value]:
        """Speeds between which the torque has no extreme [rad/s]."""
        return [*self.bends, *(self.no_load_speed + way * apart for apart in self.breakdowns for way in (-1.0, 1.0))]


class DCCharacteristic(Part):
    """The straight characteristic of a DC motor, M = `stall_moment` (1 − ω/`no_load_speed`)."""

    ascending: ClassVar = {("rated_speed", "no_load_speed"): "a motor slows down under load"}

    no_load_speed: Annotated[AngularSpeed, Field(gt=0)]
    stall_moment: Annotated[Moment, Field(gt=0)] | None = None
    power: Annotated[Power, Field(gt=0)] | None = None
    rated_speed: Annotated[AngularSpeed, Field(gt=0)] | None = None

    def _faults(self) -> Faults:
        nameplate = (self.power, self.rated_speed)
        if (self.stall_moment is None) == (None in nameplate) or (None in nameplate and any(nameplate)):
            yield "give either stall_moment, or power and rated_speed (nameplate)"

    def curve(self, at: str, n: Numbers) -> MotorCurve:
        """Torque over the motor's own speed."""
        no_load = n[f"{at}.no_load_speed"]
        if self.stall_moment is not None:
            stall = n[f"{at}.stall_moment"]
        else:
            rated = n[f"{at}.power"], n[f"{at}.rated_speed"]
            stall = laws.motor_characteristics.dc_motor_from_nameplate(*rated, no_load)
        return MotorCurve((laws.motor_characteristics.straight_motor,), ((stall, -stall / no_load),), no_load)


class Motor(Part):
    """A motor on the crank or a shaft geared to it; its torque depends on its speed only."""

    on: Annotated[LinkRef, Refers("driven shaft")]


class DCMotor(Motor, DCCharacteristic):
    """A DC motor, M = stall_moment (1 − ω/no_load_speed), on the crank or a shaft geared to it.

    The nameplate's `power` and `rated_speed` may replace `stall_moment`.
    """

    type: Literal["dc_motor"]


class InductionCharacteristic(Part):
    """The characteristic of an induction motor, by Kloss' formula or from its nameplate.

    Kloss' formula takes `synchronous_speed`, `breakdown_moment` (the maximum torque) and `breakdown_slip` (the slip at
    that torque). The nameplate gives `synchronous_speed`, `power`, `rated_speed`, `breakdown_ratio` (breakdown torque
    over rated torque) and, if known, `starting_ratio` (starting torque over rated torque).
    """

    synchronous_speed: Annotated[AngularSpeed, Field(gt=0)]
    breakdown_moment: Annotated[Moment, Field(gt=0)] | None = None
    breakdown_slip: Annotated[Number, Field(gt=0)] | None = None
    power: Annotated[Power, Field(gt=0)] | None = None
    rated_speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    breakdown_ratio: Annotated[Number, Field(gt=1)] | None = None
    starting_ratio: Annotated[Number, Field(gt=0)] | None = None

    def _faults(self) -> Faults:
        kloss = (self.breakdown_moment, self.breakdown_slip)
        nameplate = (self.power, self.rated_speed, self.breakdown_ratio)
        if None not in kloss and all(v is None for v in (*nameplate, self.starting_ratio)):
            return
        if None not in nameplate and all(v is None for v in kloss):
            trouble = laws.motor_characteristics.nameplate_trouble(
                self.power, self.rated_speed, self.synchronous_speed, self.breakdown_ratio, self.starting_ratio
            )
            if trouble:
                yield trouble
            return
        yield (
            "give either breakdown_moment and breakdown_slip (Kloss), or power, rated_speed and "
            "breakdown_ratio, with starting_ratio if known (nameplate)"
        )

    def curve(self, at: str, n: Numbers) -> MotorCurve:
        """Torque over the motor's own speed."""
        synchronous = n[f"{at}.synchronous_speed"]
        if self.breakdown_moment is not None:
            moment, slip, ratio = n[f"{at}.breakdown_moment"], n[f"{at}.breakdown_slip"], 0.0
        else:
            keys = ["power", "rated_speed", "synchronous_speed", "breakdown_ratio"]
            keys += ["starting_ratio"] if self.starting_ratio is not None else []
            moment, slip, ratio = laws.motor_characteristics.kloss_from_nameplate(*(n[f"{at}.{key}"] for key in keys))
        law, constants = laws.motor_characteristics.induction_motor, (moment, slip, ratio, synchronous)
        return MotorCurve((law,), (constants,), synchronous, breakdowns=(slip * synchronous,))


class InductionMotor(Motor, InductionCharacteristic):
    """An induction motor by Kloss' formula or from its nameplate, on the crank or a shaft geared to it."""

    type: Literal["induction_motor"]


class TableCharacteristic(Part):
    """A motor's torque given by a table over its speed, with linear interpolation.

    The first and last segments are extrapolated. All torques are multiplied by `scale`.
    """

    speed: list[AngularSpeed]
    moment: list[Moment]
    scale: Annotated[Number, Field(gt=0)] = 1.0

    def _faults(self) -> Faults:
        laws.tables.make_table(self.speed, self.moment, "linear", outside="hold", names=("speed", "moment"))
        if any(after <= before for before, after in pairwise(self.speed)):
            yield "speed: every row must lie above the one before; a motor's torque doesn't jump"

    def curve(self, at: str, n: Numbers) -> MotorCurve:
        """Torque over the motor's own speed."""
        scale, speed, moment = n[f"{at}.scale"], np.array(self.speed), np.array(self.moment)
        widths = np.diff(speed)
        slopes, bends = np.diff(moment) / widths, tuple(speed[1:-1])
        # The first segment counts from its upper end, the others from their lower ones.
        levels, lows = (scale * moment[1], *(0.0 for _ in bends)), (-np.inf, *(0.0 for _ in bends))
        highs = *(0.0, *widths[1:])[: len(bends)], np.inf
        constants = tuple(
            zip(levels, (scale * slope for slope in slopes), (speed[1], *bends), lows, highs, strict=True)
        )
        return MotorCurve((laws.motor_characteristics.ramp_motor,) * len(slopes), constants, np.inf, bends)


class TableMotor(Motor, TableCharacteristic):
    """A motor on the crank or a shaft geared to it, with its torque given by a table over its speed.

    Interpolation is linear. The first and last segments are extrapolated; above some speed the torque must vanish. All
    torques are multiplied by `scale`.
    """

    type: Literal["table_motor"]

    def _faults(self) -> Faults:
        before, last = self.moment[-2:]
        if before < last or before == last > 0.0:
            yield (
                "moment: the last rows must fall, as a motor stops driving at its no-load speed; for a torque that "
                "doesn't depend on the speed use type = 'constant' with role = 'driving'"
            )
        if not max(self.moment) > 0.0:
            yield "moment: no row is above 0: a motor drives at some speed; give one"

    def curve(self, at: str, n: Numbers) -> MotorCurve:
        """Torque over the motor's own speed."""
        return super().curve(at, n)._replace(no_load_speed=self.no_load_speed)

    @property
    def no_load_speed(self) -> float:
        """The highest speed at which the torque vanishes [rad/s]."""
        rows = list(zip(self.speed, self.moment, strict=True))
        drives = max(i for i, moment in enumerate(self.moment) if moment > 0.0)
        (low, driving), (high, beyond) = rows[min(drives, len(rows) - 2) :][:2]
        return low + (high - low) * driving / (driving - beyond)


AnyMotor = DCMotor | InductionMotor | TableMotor
