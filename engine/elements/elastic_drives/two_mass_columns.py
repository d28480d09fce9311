"""What is computed of a drive of two masses with backlash: its shaft's greatest moment, impacts, speeds at the end."""

import math
from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.running import prepare, spread
from engine.elements.compliances.reduction import in_series, part_keys, reduced_part
from engine.elements.compliances.stiffnesses import damping_of_absorption
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
from engine.elements.elastic_drives.elastic_shaft import ElasticShaft
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
    follow_motor_drives,
)
from engine.elements.elastic_drives.two_mass_element import (
    DriveDCMotor,
    DriveInductionMotor,
    DriveMotor,
    DriveTableMotor,
    TwoMassDrive,
)
from engine.elements.element_laws import ROUNDING, ElementResult, LawOfArrays, with_nudges
from engine.elements.element_numbers import Numbers
from engine.elements.oscillators.one_mass import free_motion
from engine.parts.motor_constants import kloss_constants, stall_moment

_Law = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]

# The least backlash [rad] whose products still are numbers of full precision.
SMALLEST = np.finfo(float).tiny / np.finfo(float).eps
# Under Kloss' formula vibrations are followed in up to 200 000 steps, or averaged: an error of so many roundings.
STEPS = 1e4
# Phases of a drive that a picture can show.
MOST_SHOWN = 2000
_RESULTS = (
    ElementResult("stiffness", "torsional stiffness of the shaft", "N m rad-1"),
    ElementResult("damping", "torsional damping of the shaft", "N m s rad-1"),
    ElementResult("natural_frequency", "natural frequency of the drive in touch", "rad s-1"),
    ElementResult("rigid_moment", "moment of the shaft at the begin, were it rigid and without backlash", "N m"),
    ElementResult("greatest_moment", "greatest magnitude of the shaft's moment", "N m"),
    ElementResult("greatest_moment_at", "when the shaft's moment is greatest", "s"),
    ElementResult("dynamic_factor", "greatest moment over that of a rigid shaft", "1"),
    ElementResult("closings", "how often the backlash closes", "1", exact=True),
    ElementResult("first_impact_at", "when the backlash closes first", "s", None, True),
    ElementResult("first_impact_speed", "relative speed at which the backlash closes first", "rad s-1", None, True),
    ElementResult("load_starts_at", "when the load starts to move", "s", None, True),
    ElementResult("motor_speed", "speed of the motor at the end", "rad s-1"),
    ElementResult("load_speed", "speed of the load at the end", "rad s-1"),
)


class DriveShaft(NamedTuple):
    """Stiffness [N·m/rad] and damping [N·m·s/rad] of a drive's shaft, and its natural frequency in touch [rad/s]."""

    stiffness: np.ndarray
    damping: np.ndarray
    frequency: np.ndarray


def drive_law(drive: TwoMassDrive) -> LawOfArrays:
    """The law of a drive of two masses: its numbers in an order of their own, and its results.

    Parameters
    ----------
    drive : TwoMassDrive
    """
    keys = tuple(drive_keys(drive))
    law = with_nudges(partial(_rows, drive, keys))
    return LawOfArrays(
        _in_many_steps(law) if isinstance(drive.motor, DriveInductionMotor) else law,
        lambda element, given: tuple(given(key) for key in keys),
        _RESULTS,
    )


def _in_many_steps(law: _Law) -> _Law:
    """A law whose results carry the rounding of many steps, or what averages leave out, which nudges don't show."""

    def both(numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        rows, sizes = law(numbers)
        return rows, sizes + STEPS / ROUNDING * np.abs(rows)

    return both


def drive_keys(drive: TwoMassDrive) -> Iterator[str]:
    """Keys of all numbers that a drive is given."""
    yield from ("motor_inertia", "load_inertia", "backlash", "load_moment", "time")
    yield from (key for key in ("motor_moment", "load_before", "speed") if getattr(drive, key) is not None)
    if drive.motor is not None:
        yield from (f"motor.{key}" for key in motor_keys(drive.motor))
    yield from shaft_keys(drive)


def motor_keys(motor: DriveMotor) -> Iterator[str]:
    """Keys of the numbers that a drive's motor is given."""
    yield from (key for key, value in motor if isinstance(value, float))


def shaft_keys(drive: ElasticShaft) -> Iterator[str]:
    """Keys of all numbers that the shaft of a drive is given."""
    yield from (key for key in ("stiffness", "damping", "damping_ratio") if getattr(drive, key) is not None)
    for name, part in (drive.parts or {}).items():
        yield from part_keys(part, f"parts.{name}")


def drive_shaft(drive: ElasticShaft, n: Numbers) -> DriveShaft:
    """The shaft of a drive, with all dampers as they are at its natural frequency.

    Parameters
    ----------
    drive : ElasticShaft
        How its shaft is given; its numbers are not used.
    n : mapping of str to ndarray (variants,)
        Its numbers by their keys, and the inertias at its ends, "motor_inertia" and "load_inertia".
    """
    absorption = np.zeros_like(n["motor_inertia"])
    if drive.parts is None:
        stiffness, damping = n["stiffness"], n.get("damping", absorption)
    else:
        whole = in_series({name: reduced_part(part, n, f"parts.{name}") for name, part in drive.parts.items()})
        stiffness, damping, absorption = whole.stiffness, whole.damping, whole.absorption
        damping = damping + n.get("damping", 0.0)
    frequency = np.sqrt(stiffness * (1.0 / n["motor_inertia"] + 1.0 / n["load_inertia"]))
    damping = damping + damping_of_absorption(absorption, stiffness, frequency)
    if drive.damping_ratio is not None:
        damping = damping + 2.0 * n["damping_ratio"] * stiffness / frequency
    return DriveShaft(stiffness, damping, frequency)


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


def _rows(drive: TwoMassDrive, keys: tuple[str, ...], table: np.ndarray) -> np.ndarray:
    n = dict(zip(keys, table, strict=True))
    if drive.motor is None:
        (found, _, shaft), motor = followed_drive(drive, n), n["motor_moment"]
    else:
        found, _, shaft = motor_driven(drive, n)
        motor = found[MOMENT_AT_BEGIN]
    load = n["load_moment"]
    rigid = rigid_moment(motor, load, n["motor_inertia"], n["load_inertia"])
    if drive.begin == "at rest":
        # A load that the motor can't move holds all of its moment.
        rigid = np.where(load >= motor, motor, rigid)
    return np.stack(
        [
            shaft.stiffness,
            shaft.damping,
            shaft.frequency,
            rigid,
            found[GREATEST],
            found[GREATEST_AT],
            found[GREATEST] / rigid,
            found[CLOSINGS],
            found[IMPACT_AT],
            found[IMPACT_SPEED],
            found[LOAD_AT],
            found[MOTOR_SPEED],
            found[LOAD_SPEED],
        ]
    )


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
    numbers = {}
    for key in drive_keys(drive):
        part: object = drive
        for name in key.split("."):
            part = part[name] if isinstance(part, Mapping) else getattr(part, name)
        numbers[key] = np.array([part], float)
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
