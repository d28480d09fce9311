"""A drive of two masses on an elastic shaft with backlash: peak torque, impacts, final speeds."""

from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from engine.elements.elastic_drives.elastic_shaft import ElasticShaft, drive_shaft
from engine.elements.elastic_drives.shaft_touch import touching_moment
from engine.elements.elastic_drives.two_masses import Beginning, DriveNumbers, FollowedDrives, follow_drives
from engine.elements.element import ROUNDING, Answers, Columns, Element, Numbers, named_in_order, nudged
from engine.elements.panels import SPEED, TIME, Curve, Mark, Panel, PanelAxis
from engine.laws.motor_characteristics import straight_motor
from engine.laws.rounding import EPS, LEAST_NORMAL
from engine.parts.motors import DCCharacteristic, InductionCharacteristic, MotorCurve, TableCharacteristic
from engine.parts.skeleton import Angle, AngularSpeed, Inertia, Moment, Time
from engine.stepping.recorded import made_steps, weights_at
from engine.stepping.walk_task import WALKS, range_of_walks
from engine.words.quantity import main_result
from engine.words.verdicts import Verdict

# The smallest backlash [rad] whose products keep full precision.
SMALLEST = LEAST_NORMAL / EPS
# Number of steps over which rounding accumulates.
STEPS = 1e4
# Instants of curves, and maximum number of steps recorded for a plot.
_INSTANTS, MOST_SHOWN = 8004, 20_000


class DriveDCMotor(DCCharacteristic):
    """A DC motor with a linear characteristic; power and rated speed may replace the stall torque."""

    type: Literal["dc"]


class DriveInductionMotor(InductionCharacteristic):
    """An induction motor, by Kloss' formula or from its nameplate."""

    type: Literal["induction"]


class DriveTableMotor(TableCharacteristic):
    """A motor defined by a table of its torque over its speed, with linear interpolation and extrapolation.

    All torques are multiplied by `scale`.
    """

    type: Literal["table"]


DriveMotor = Annotated[DriveDCMotor | DriveInductionMotor | DriveTableMotor, Field(discriminator="type")]


class TwoMassDrive(ElasticShaft, Element):
    """A motor drives a load through a shaft with backlash; all quantities are reduced to one shaft.

    `backlash` is the whole angle through which one end turns freely relative to the other. The load resists with
    `load_moment` like dry friction: at rest it holds up to that torque. The motor drives with the constant
    `motor_moment`, or as a `motor` whose torque depends on its speed. With `begin` "at rest", the whole backlash has to
    close first; with "running", the drive runs at `speed` against `load_before` until at time 0 the load jumps to
    `load_moment`. The motion is computed up to `time`.
    """

    one_of: ClassVar = (("motor_moment", "motor"),)
    required_with: ClassVar = dict.fromkeys(("speed", "load_before"), ("begin", ("running",)))
    picture: ClassVar = "transient"
    results: ClassVar = (
        main_result("stiffness", "torsional stiffness of the shaft", "N m rad-1"),
        main_result("damping", "torsional damping of the shaft", "N m s rad-1"),
        main_result("natural_frequency", "natural frequency of the drive in contact", "rad s-1"),
        main_result("rigid_moment", "initial torque of the shaft if it were rigid and without backlash", "N m"),
        main_result("greatest_moment", "peak shaft torque", "N m"),
        main_result("greatest_moment_at", "time of the peak shaft torque", "s"),
        main_result("dynamic_factor", "peak torque over that of a rigid shaft", "1"),
        main_result("closings", "how often the backlash closes", "1", exact=True),
        main_result("first_impact_at", "time at which the backlash first closes", "s", True),
        main_result("first_impact_speed", "relative speed when the backlash first closes", "rad s-1", True),
        main_result("load_starts_at", "time at which the load starts to move", "s", True),
        main_result("motor_speed", "speed of the motor at the end", "rad s-1"),
        main_result("load_speed", "speed of the load at the end", "rad s-1"),
    )

    type: Literal["two_mass_drive"]
    begin: Literal["at rest", "running"] = "at rest"
    motor_inertia: Annotated[Inertia, Field(gt=0)]
    load_inertia: Annotated[Inertia, Field(gt=0)]
    backlash: Annotated[Angle, Field(ge=0)] = 0.0
    motor_moment: Annotated[Moment, Field(gt=0)] | None = None
    motor: DriveMotor | None = None
    load_moment: Annotated[Moment, Field(ge=0)] = 0.0
    load_before: Annotated[Moment, Field(ge=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    time: Annotated[Time, Field(gt=0)]

    def values(self, n: Numbers, longer: float) -> tuple[Columns, FollowedDrives]:
        """Results of a set of variants by name, and their drives, by one of the `WALKS`."""
        followed, rigid = self.follow(n, longer), self.of_shaft(n)["rigid_moment"]
        held = followed.held
        peak, impacts = (held.greatest, held.greatest_at, held.greatest / rigid), held[6:]
        return named_in_order(self.results[4:], (*peak, *impacts, followed.speed, followed.load_speed)), followed

    def of_shaft(self, n: Numbers) -> Columns:
        """Results that don't depend on the motion, by name."""
        shaft, load = drive_shaft(self, n), n["load_moment"]
        motor = self.curve(n).moment(n["speed"] if self.begin == "running" else 0.0)
        rigid = rigid_moment(motor, load, n["motor_inertia"], n["load_inertia"])
        if self.begin == "at rest":
            # If the motor can't move the load, the load holds all of its torque.
            rigid = np.where(load >= motor, motor, rigid)
        return named_in_order(self.results[:4], (*shaft, rigid))

    def curve(self, n: Numbers) -> MotorCurve:
        """Characteristic of the motor."""
        if self.motor is None:
            return MotorCurve((straight_motor,), ((n["motor_moment"], 0.0),), np.inf)
        return self.motor.curve("motor", n)

    def follow(self, n: Numbers, longer: float, recorded: int = 0) -> FollowedDrives:
        """Compute drives for their duration by one of the `WALKS`, and record up to `recorded` steps."""
        shaft, zero = drive_shaft(self, n), np.zeros_like(n["motor_inertia"])
        # A backlash whose products underflow counts as zero.
        backlash = np.where(n["backlash"] < SMALLEST, 0.0, n["backlash"])
        mobilities = 1.0 / n["motor_inertia"], 1.0 / n["load_inertia"]
        drive = DriveNumbers(*mobilities, shaft.stiffness, shaft.damping + zero, backlash, n["load_moment"] + zero)
        runs = self.begin == "running", n.get("speed", zero), n.get("load_before", zero)
        return follow_drives(drive, self.curve(n), Beginning(*runs, n["time"] + zero), longer, recorded)

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates from longer steps with perturbed numbers."""
        found, errors = nudged(self.of_shaft, n)
        found_by = []
        for longer, nudge in zip(WALKS, (0.0, ROUNDING * EPS, -ROUNDING * EPS), strict=True):
            # Perturb up and down in turn.
            others = {name: row * (1.0 + (-1.0) ** i * nudge) for i, (name, row) in enumerate(n.items())}
            found_by.append(self.values(others, longer))
        fine, followed = found_by[0]
        # A speed rounds like that of the vibration, however small it is at the end.
        swing = fine["greatest_moment"] / found["stiffness"] * found["natural_frequency"]
        for name, row in fine.items():
            size = np.abs(row) + (swing if name.endswith("speed") else 0.0)
            errors[name] = range_of_walks([values[name] for values, _ in found_by]) + STEPS * EPS * size
        too_stiff = np.where(followed.too_stiff, Verdict.SHAFT_RIGID, Verdict.OK)
        return Answers(found | fine, errors, too_stiff.astype(np.uint8))

    def panels(self) -> tuple[Panel, ...]:
        """Plots of shaft torque, speeds of motor and load, and play over time."""
        history, x = drive_history(self, _INSTANTS), TIME
        peak = np.abs(history.moment).argmax()
        moments = Curve("of the shaft", history.moment), Curve("of the motor", history.motor_moment, True)
        marks = Mark("", history.time[peak], history.moment[peak]), Mark("of the load", None, self.load_moment)
        speeds = Curve("motor", history.motor_speed), Curve("load", history.load_speed)
        play = Mark("", None, 0.0), Mark("backlash", None, -self.backlash)
        over = Panel(x, PanelAxis("torque", "N m", "M"), history.time, moments, marks)
        gap = Panel(x, PanelAxis("motor ahead of load", "rad", "Δφ"), history.time, (Curve("", history.gap),), play)
        return over, Panel(x, SPEED, history.time, speeds), gap


def rigid_moment(motor: np.ndarray, load: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Torque of a rigid shaft between a motor with the first inertia and a load with the second, both turning [N·m].

    (M I₂ + M_c I₁)/(I₁ + I₂), with the motor's torque M and the load's M_c.
    """
    return (motor * second + load * first) / (first + second)


class DriveHistory(NamedTuple):
    """A drive over time.

    Attributes
    ----------
    time : ndarray (instants,)
        [s].
    moment : ndarray (instants,)
        Shaft torque [N·m].
    motor_speed, load_speed : ndarray (instants,)
        [rad/s].
    gap : ndarray (instants,)
        e = φ₁ − φ₂, 0 at first forward contact [rad].
    motor_moment : ndarray (instants,)
        Motor torque [N·m].
    """

    time: np.ndarray
    moment: np.ndarray
    motor_speed: np.ndarray
    load_speed: np.ndarray
    gap: np.ndarray
    motor_moment: np.ndarray


def drive_history(drive: TwoMassDrive, instants: int) -> DriveHistory:
    """Motion of a drive, at equally spaced instants.

    Parameters
    ----------
    drive : TwoMassDrive
    instants : int
    """
    n = drive.own_numbers()
    followed = drive.follow(n, 1.0, MOST_SHOWN)
    _, begin, length, samples, _ = made_steps(followed.recorded, followed.steps)
    time = np.linspace(0.0, drive.time, instants)
    own = np.searchsorted(begin, time, side="right") - 1
    weights = weights_at(np.clip((time - begin[own]) / length[own], 0.0, 1.0))
    shaft = drive_shaft(drive, n)
    swung, speed, load_speed = ((weights * samples[state][:, own]).sum(axis=0) for state in range(3))
    gap = swung / shaft.frequency
    contact = np.where(gap > 0.0, 1.0, np.where(gap < -drive.backlash, -1.0, 0.0))
    touch = contact if drive.backlash else np.ones(instants)
    moment = touching_moment((shaft.stiffness, shaft.damping, drive.backlash), touch, gap, speed - load_speed)
    # A backlash transmits no pull of the damper.
    moment = np.where(touch * moment < 0.0, 0.0, moment) if drive.backlash else moment
    return DriveHistory(time, moment, speed, load_speed, gap, drive.curve(n).moment(speed) + np.zeros(instants))
