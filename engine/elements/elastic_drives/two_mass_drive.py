"""A drive of two masses on an elastic shaft with backlash: greatest moment, impacts, speeds at the end."""

import math
from typing import Annotated, ClassVar, Literal, NamedTuple

import numba
import numpy as np
from numba import types
from pydantic import Field, model_validator

from engine.compiling.running import prepare, spread
from engine.elements.elastic_drives.backlash_phases import (
    CLOSINGS,
    FOUND,
    GREATEST,
    GREATEST_AT,
    IMPACT_AT,
    IMPACT_SPEED,
    LOAD_AT,
    LOAD_SPEED,
    MOTOR_SPEED,
    PHASE,
    follow_drives,
)
from engine.elements.elastic_drives.drive_motors import DriveDCMotor, DriveInductionMotor, DriveMotor, DriveTableMotor
from engine.elements.elastic_drives.elastic_shaft import DriveShaft, ElasticShaft, drive_shaft
from engine.elements.elastic_drives.motor_phases import (
    GAP,
    LOAD_RATE,
    MOMENT_AT_BEGIN,
    MOTOR_FOUND,
    MOTOR_MOMENT,
    MOTOR_RATE,
    MOTOR_ROOM,
    ORDER,
    SHAFT_MOMENT,
    SHOWN,
    TOO_STIFF,
    follow_motor_drives,
)
from engine.elements.element import Answers, Columns, Element, ElementResult, Numbers, nudged
from engine.elements.oscillators.one_mass import free_motion
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.laws.rounding import EPS
from engine.parts.actions import Moment, Time
from engine.parts.motor_constants import kloss_constants, stall_moment
from engine.parts.skeleton import Angle, AngularSpeed, Inertia
from engine.words.verdicts import Verdict

# The least backlash [rad] whose products still are numbers of full precision.
SMALLEST = np.finfo(float).tiny / np.finfo(float).eps
# Under a motor vibrations are followed in up to 200 000 steps: an error of so many roundings.
STEPS = 1e4
# Instants of curves.
_INSTANTS = 8004
# Phases of a drive that a picture can show.
MOST_SHOWN = 2000


class TwoMassDrive(ElasticShaft, Element):
    """A motor drives a load through a shaft with backlash; all is reduced to one shaft.

    `backlash` is the whole angle through which one end turns freely against the other. The load resists with
    `load_moment`, as dry friction does: at rest it holds up to that moment. The motor drives with the constant
    `motor_moment`, or as a `motor` whose moment depends on its speed. `begin` "at rest", it closes the whole backlash
    first; "running", the drive runs with `load_before` at `speed` until at time 0 the load jumps to `load_moment`. What
    happens is computed up to `time`.
    """

    picture: ClassVar = "transient"
    RESULTS: ClassVar = (
        ElementResult("stiffness", "torsional stiffness of the shaft", "N m rad-1"),
        ElementResult("damping", "torsional damping of the shaft", "N m s rad-1"),
        ElementResult("natural_frequency", "natural frequency of the drive in touch", "rad s-1"),
        ElementResult("rigid_moment", "initial torque of the shaft if it were rigid and without backlash", "N m"),
        ElementResult("greatest_moment", "peak shaft torque", "N m"),
        ElementResult("greatest_moment_at", "time of the peak shaft torque", "s"),
        ElementResult("dynamic_factor", "peak torque over that of a rigid shaft", "1"),
        ElementResult("closings", "how often the backlash closes", "1", exact=True),
        ElementResult("first_impact_at", "when the backlash closes first", "s", None, True),
        ElementResult("first_impact_speed", "relative speed at which the backlash closes first", "rad s-1", None, True),
        ElementResult("load_starts_at", "when the load starts to move", "s", None, True),
        ElementResult("motor_speed", "speed of the motor at the end", "rad s-1"),
        ElementResult("load_speed", "speed of the load at the end", "rad s-1"),
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

    @model_validator(mode="after")
    def _begins_in_one_way(self) -> "TwoMassDrive":
        if (self.begin == "running") != (self.speed is not None) or (self.speed is None) != (self.load_before is None):
            raise ValueError("speed and load_before go with begin = 'running': give both, or neither")
        return self

    @model_validator(mode="after")
    def _driven_in_one_way(self) -> "TwoMassDrive":
        if (self.motor_moment is None) == (self.motor is None):
            raise ValueError("give motor_moment (constant) or motor (its moment by its speed), one of the two")
        return self

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by their names."""
        if self.motor is None:
            (found, _, shaft), motor = followed_drive(self, n), n["motor_moment"]
            too_stiff = np.zeros_like(motor)
        else:
            found, _, shaft = motor_driven(self, n)
            motor, too_stiff = found[MOMENT_AT_BEGIN], found[TOO_STIFF]
        load = n["load_moment"]
        rigid = rigid_moment(motor, load, n["motor_inertia"], n["load_inertia"])
        if self.begin == "at rest":
            # A load that the motor can't move holds all of its moment.
            rigid = np.where(load >= motor, motor, rigid)
        return {
            "stiffness": shaft.stiffness,
            "damping": shaft.damping,
            "natural_frequency": shaft.frequency,
            "rigid_moment": rigid,
            "greatest_moment": found[GREATEST],
            "greatest_moment_at": found[GREATEST_AT],
            "dynamic_factor": found[GREATEST] / rigid,
            "closings": found[CLOSINGS],
            "first_impact_at": found[IMPACT_AT],
            "first_impact_speed": found[IMPACT_SPEED],
            "load_starts_at": found[LOAD_AT],
            "motor_speed": found[MOTOR_SPEED],
            "load_speed": found[LOAD_SPEED],
            "too_stiff": too_stiff,
        }

    def evaluate(self, n: Numbers) -> Answers:
        """Results with their errors; under a motor with those of many steps, which nudges don't show."""
        found, errors = nudged(self.values, n)
        if self.motor is not None:
            errors = {name: error + STEPS * EPS * np.abs(found[name]) for name, error in errors.items()}
            # A speed rounds as that of the vibration does, however small it is in the end.
            swing = found["greatest_moment"] / found["stiffness"] * found["natural_frequency"]
            for name in ("motor_speed", "load_speed"):
                errors[name] = errors[name] + STEPS * EPS * swing
        too_stiff = np.where(found["too_stiff"] > 0.0, Verdict.SHAFT_RIGID, Verdict.OK)
        return Answers(found, errors, too_stiff.astype(np.uint8))

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """Moment of the shaft, speeds of motor and load, and play over time."""
        history, x = drive_history(self, _INSTANTS), PanelAxis("time", "s")
        peak = np.abs(history.moment).argmax()
        moments = Curve("of the shaft", history.moment), Curve("of the motor", history.motor_moment, True)
        marks = Mark("", history.time[peak], history.moment[peak]), Mark("of the load", None, self.load_moment)
        speeds = Curve("motor", history.motor_speed), Curve("load", history.load_speed)
        play = Mark("", None, 0.0), Mark("backlash", None, -self.backlash)
        return (
            Panel(x, PanelAxis("moment", "N m"), history.time, moments, marks),
            Panel(x, PanelAxis("speed", "rad s-1"), history.time, speeds),
            Panel(x, PanelAxis("motor ahead of load", "rad"), history.time, (Curve("", history.gap),), play),
        )


def rigid_moment(motor: np.ndarray, load: np.ndarray, first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Moment of a rigid shaft between a motor of the first inertia and a load of the second that turn [N·m].

    (M I₂ + M_c I₁)/(I₁ + I₂), M being the motor's moment and M_c the load's.
    """
    return (motor * second + load * first) / (first + second)


def followed_drive(drive: TwoMassDrive, n: Numbers, shown: int = 0) -> tuple[np.ndarray, np.ndarray, DriveShaft]:
    """Follow drives through their phases.

    Parameters
    ----------
    drive : TwoMassDrive
        How it is given and how it begins; its numbers are not used.
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys, such as "motor_moment".
    shown : int
        How many phases to return.

    Returns
    -------
    found : ndarray (FOUND, variants)
    phases : ndarray (variants, shown, PHASE)
        Both as for `follow_drives`.
    shaft : DriveShaft
    """
    shaft = drive_shaft(drive, n)
    none = np.zeros_like(shaft.stiffness)
    inertias = n["motor_inertia"], n["load_inertia"]
    # One so small that its products vanish is none.
    backlash = np.where(n["backlash"] < SMALLEST, 0.0, n["backlash"])
    if drive.begin == "running":
        twist = rigid_moment(n["motor_moment"], n["load_before"], *inertias) / shaft.stiffness
        speed, touch = n["speed"], none + 1.0
    else:
        # The whole backlash is open; without any, the shaft is in touch.
        twist, speed, touch = -backlash, none, np.where(backlash > 0.0, 0.0, 1.0)
    moments = backlash, n["motor_moment"], n["load_moment"], n["time"]
    rows = (*inertias, shaft.stiffness, shaft.damping, *moments, twist, speed, touch)
    given = np.array([np.broadcast_to(row, none.shape) for row in rows])
    found, phases = np.empty((FOUND, none.size)), np.empty((none.size, shown, PHASE))
    prepare(follow_drives, [types.intp, types.intp, *(numba.typeof(a) for a in (given, found, phases))])
    spread(follow_drives, none.size, lambda: (given, found, phases))
    return found, phases, shaft


def motor_curves(motor: DriveMotor, n: Numbers, count: int) -> tuple[np.ndarray, np.ndarray]:
    """Characteristics of a drive's motor as compiled code takes them.

    Parameters
    ----------
    motor : DriveMotor
    n : mapping of str to ndarray (count,)
        Its numbers by their keys, such as "motor.stall_moment".
    count : int

    Returns
    -------
    lines : ndarray (count, rows, 2)
        Rows of speed and moment; none for Kloss' formula.
    kloss : ndarray (count, 4)
        Its constants; (count, 0) for lines.
    """
    lines, kloss = np.empty((count, 0, 2)), np.empty((count, 0))
    match motor:
        case DriveDCMotor():
            lines = np.zeros((count, 2, 2))
            lines[:, 0, 1] = stall_moment(motor, "motor", n)
            lines[:, 1, 0] = n["motor.no_load_speed"]
        case DriveInductionMotor():
            constants = kloss_constants(motor, "motor", n)
            kloss = np.stack([np.broadcast_to(value, count) for value in constants], axis=1)
        case DriveTableMotor():
            table = np.stack([motor.speed, motor.moment], axis=1)
            lines = np.repeat(table[None], count, axis=0)
            lines[:, :, 1] *= n["motor.scale"][:, None]
    return lines, kloss


def motor_driven(drive: TwoMassDrive, n: Numbers, instants: int = 0) -> tuple[np.ndarray, np.ndarray, DriveShaft]:
    """Follow drives under their motors.

    Parameters
    ----------
    drive : TwoMassDrive
        One with a `motor`; its numbers are not used.
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys, such as "motor.stall_moment".
    instants : int
        At how many instants, equally spaced, to return what they do.

    Returns
    -------
    found : ndarray (MOTOR_FOUND, variants)
    shown : ndarray (variants, instants, SHOWN)
        Both as for `follow_motor_drives`.
    shaft : DriveShaft
    """
    shaft = drive_shaft(drive, n)
    none = np.zeros_like(shaft.stiffness)
    backlash = np.where(n["backlash"] < SMALLEST, 0.0, n["backlash"])
    running = none + (drive.begin == "running")
    starts = running, n.get("speed", none), n.get("load_before", none)
    inertias, elastic = (n["motor_inertia"], n["load_inertia"]), (shaft.stiffness, shaft.damping, backlash)
    rows = (*inertias, *elastic, n["load_moment"], n["time"], *starts)
    given = np.stack([np.broadcast_to(row, none.shape) for row in rows], axis=1)
    lines, kloss = motor_curves(drive.motor, n, none.size)
    found, shown = np.empty((none.size, MOTOR_FOUND)), np.full((none.size, instants, SHOWN), np.nan)
    tables = given, lines, kloss, found, shown
    room = np.empty((MOTOR_ROOM, ORDER + 1))
    prepare(follow_motor_drives, [types.intp, types.intp, *(numba.typeof(a) for a in (*tables, room))])
    spread(follow_motor_drives, none.size, lambda: (*tables, np.empty_like(room)))
    return found.T, shown, shaft


class DriveHistory(NamedTuple):
    """A drive over time.

    Attributes
    ----------
    time : ndarray (instants,)
        [s].
    moment : ndarray (instants,)
        Of the shaft [N·m].
    motor_speed, load_speed : ndarray (instants,)
        [rad/s].
    gap : ndarray (instants,)
        e = φ₁ − φ₂, 0 where the shaft touches forwards [rad].
    motor_moment : ndarray (instants,)
        [N·m].
    """

    time: np.ndarray
    moment: np.ndarray
    motor_speed: np.ndarray
    load_speed: np.ndarray
    gap: np.ndarray
    motor_moment: np.ndarray


def drive_history(drive: TwoMassDrive, instants: int) -> DriveHistory:
    """What a drive does, at equally spaced instants.

    Parameters
    ----------
    drive : TwoMassDrive
    instants : int
    """
    numbers = drive.own_numbers()
    if drive.motor is not None:
        _, (shown,), _ = motor_driven(drive, numbers, instants)
        time = np.linspace(0.0, drive.time, instants)
        rates = shown[:, MOTOR_RATE], shown[:, LOAD_RATE]
        return DriveHistory(time, shown[:, SHAFT_MOMENT], *rates, shown[:, GAP], shown[:, MOTOR_MOMENT])
    _, phases, shaft = followed_drive(drive, numbers, MOST_SHOWN)
    phases = phases[0][~np.isnan(phases[0, :, 0])]
    time = np.linspace(0.0, drive.time, instants)
    k, b = float(shaft.stiffness[0]), float(shaft.damping[0])
    rows = np.searchsorted(phases[:, 0], time, side="right") - 1
    moment, motor, load, gap = np.empty((4, instants))
    for row, (begins, touch, moves, e, v, speed) in enumerate(phases):
        here = rows == row
        t = time[here] - begins
        if touch == 0:
            push = drive.motor_moment / drive.motor_inertia + moves * drive.load_moment / drive.load_inertia
            gap[here], rate = e + (v + 0.5 * push * t) * t, v + push * t
            moment[here] = 0.0
            load[here] = speed - moves * drive.load_moment / drive.load_inertia * t
        else:
            behind = drive.backlash if touch < 0 else 0.0
            mobility = 1.0 / drive.motor_inertia + (1.0 / drive.load_inertia if moves else 0.0)
            push = drive.motor_moment / drive.motor_inertia + moves * drive.load_moment / drive.load_inertia
            frequency = np.full(t.shape, math.sqrt(k * mobility))
            twist = push / (k * mobility)
            deviation, rate = free_motion(frequency, 0.5 * b * mobility / frequency, e + behind - twist, v, t)
            gap[here], moment[here] = twist + deviation - behind, k * (twist + deviation) + b * rate
            total = drive.motor_inertia + drive.load_inertia
            momentum = drive.motor_inertia * (v + speed) + drive.load_inertia * speed
            momentum = momentum + (drive.motor_moment - moves * drive.load_moment) * t
            load[here] = (momentum - drive.motor_inertia * rate) / total if moves else 0.0
        motor[here] = load[here] + rate
    return DriveHistory(time, moment, motor, load, gap, np.full(instants, drive.motor_moment))
