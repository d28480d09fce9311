"""Motion of two masses on a shaft with backlash, as a system: rates, guards, and quantities held between the guards.

The shaft torque T follows from the twist e = φ₁ − φ₂ as in `shaft_touch`; it doesn't change its sign in contact.
Without backlash, contact is never lost. The load resists with M_c against its motion; at rest it sticks while
|T| ≤ M_c:

    I₁ ω₁′ = M(ω₁) − T,   I₂ ω₂′ = T ∓ M_c.

The contact and the load's direction of motion are held. Steps end where either changes, and at the extremes of T, of
the play and of ω₂. Within a step all of these are monotonic, so that no short contact or stop is missed.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links and clearances).
"""

import math
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import Law, scalar
from engine.compiling.instructions import chosen
from engine.elements.elastic_drives.shaft_touch import touch_left, touch_turns, touching_moment
from engine.graph.nodes import Given, Graph, Stage
from engine.laws.rounding import EPS
from engine.laws.senses import past, sense
from engine.parts.motors import MotorCurve
from engine.stepping.records import put
from engine.stepping.system import PrintedSystem, Start, System, Walks
from engine.stepping.walk_task import Why, tolerance_of_walk

# Tolerance of a step.
TOLERANCE = 1e-12
# First step, in radians of the vibration.
FIRST = 0.1
# Longest motion, in radians of the vibration; a single drive takes some seconds for it.
MOST_RADIANS = 6e4
# Maximum number of continuations of a walk.
MOST_WALKS = 200
# Larger numbers are meaningless.
MOST_SIZE = 1e100
# Ties of peaks within rounding go to the earlier one.
_HIGHER = 1.0 + 1e-11

# Numbers as in `DriveNumbers`; twist, both speeds, motor torque, time; the two parts of `HeldOfDrive`; all of
# `HeldOfDrive` with the load's speed.
Drive = tuple[float, float, float, float, float, float]
Motion = tuple[float, float, float, float, float]
Phase = tuple[float, float, float, float]
Seen = tuple[float, float, float, float, float, float]
Behind = tuple[float, float, float, float, float, float, float, float, float, float, float]


class HeldOfDrive(NamedTuple):
    """Quantities held between two guards, nodes or arrays (variants,): the phase, and the results so far.

    Attributes
    ----------
    touch : Given or ndarray
        Contact of the shaft: 1 forward, −1 backward, 0 none.
    moves : Given or ndarray
        Direction of the load's motion, 1 or −1; 0 if it sticks.
    growing, gains : Given or ndarray
        1 or −1: whether the shaft torque (the twist, if out of contact) and the load's speed grow.
    greatest, greatest_at : Given or ndarray
        Peak magnitude of the shaft torque [N·m] and its time [s].
    closings, impact_at, impact_speed : Given or ndarray
        How often the backlash closed; time [s] and relative speed [rad/s] of the first impact, −1 if none.
    load_at : Given or ndarray
        When the load started [s]; −1 if never.
    """

    touch: Given | np.ndarray
    moves: Given | np.ndarray
    growing: Given | np.ndarray
    gains: Given | np.ndarray
    greatest: Given | np.ndarray
    greatest_at: Given | np.ndarray
    closings: Given | np.ndarray
    impact_at: Given | np.ndarray
    impact_speed: Given | np.ndarray
    load_at: Given | np.ndarray


class DriveNumbers(NamedTuple):
    """Numbers of a drive, nodes or arrays (variants,); mobilities are reciprocals of inertias [1/(kg·m²)]."""

    mobility: Given | np.ndarray
    load_mobility: Given | np.ndarray
    stiffness: Given | np.ndarray
    damping: Given | np.ndarray
    backlash: Given | np.ndarray
    load: Given | np.ndarray

    @property
    def frequency(self) -> np.ndarray:
        """Natural frequency in contact [rad/s]."""
        return np.sqrt(self.stiffness * (self.mobility + self.load_mobility))


@scalar
def drive_rates(drive: Drive, touch: float, moves: float, motion: Motion) -> tuple[float, float, float]:
    """Shaft torque [N·m], accelerations of motor and load [rad/s²]."""
    twist, speed, load_speed, driving, _ = motion
    moment = touching_moment(drive[2:5], touch, twist, speed - load_speed)
    return moment, drive[0] * (driving - moment), chosen(moves == 0.0, 0.0, drive[1] * (moment - moves * drive[5]))


@scalar
def rate_signs(drive: Drive, touch: float, moves: float, motion: Motion) -> tuple[float, float]:
    """Numbers with the signs of the rates of the shaft torque (twist, if out of contact) and of the load's speed."""
    moment, rise, load_rise = drive_rates(drive, touch, moves, motion)
    slip, apart = motion[1] - motion[2], rise - load_rise
    change = touch_turns(drive[2:5], touch, slip, apart)
    return chosen(change == 0.0, apart, change), moment - moves * drive[5]


@scalar
def guards_of_drive(drive: Drive, phase: Phase, motion: Motion) -> tuple[float, float, float, float]:
    """Guards of the contact, the load's direction, and both signs of `rate_signs`; positive until these change."""
    (touch, moves, growing, gains), shaft, load = phase, drive[2:5], drive[5]
    twist, speed, load_speed, _, _ = motion
    moment, rise, load_rise = drive_rates(drive, touch, moves, motion)
    slip = speed - load_speed
    touches = chosen(shaft[2] > 0.0, touch_left(shaft, touch, twist, slip), math.inf)
    holds = chosen(load > 0.0, chosen(moves == 0.0, load - abs(moment), moves * load_speed), math.inf)
    change = touch_turns(shaft, touch, slip, rise - load_rise)
    gained = chosen(moves * load == 0.0, math.inf, gains * (moment - moves * load))
    return touches, holds, growing * change, gained


@scalar
def after_guard(drive: Drive, phase: Phase, motion: Motion, seen: Seen) -> Behind:
    """Held quantities after a guard, as in `HeldOfDrive`, and the load's speed."""
    touch, moves, _, _ = phase
    twist, speed, load_speed, driving, now = motion
    greatest, greatest_at, closings, impact_at, impact_speed, load_at = seen
    touches, holds, _, _ = guards_of_drive(drive, phase, motion)
    before, _, _ = drive_rates(drive, touch, moves, motion)
    closes = chosen(touches > 0.0, 0.0, chosen(touch == 0.0, 1.0, 0.0))
    side = chosen(twist > -0.5 * drive[4], 1.0, -1.0)
    touch = chosen(touches > 0.0, touch, closes * side)
    first = closes * chosen(closings == 0.0, 1.0, 0.0)
    impact_at = chosen(first > 0.0, now, impact_at)
    impact_speed = chosen(first > 0.0, abs(speed - load_speed), impact_speed)
    stops = chosen(holds > 0.0, 0.0, abs(moves))
    starts = chosen(holds > 0.0, 0.0, 1.0 - stops)
    load_speed = chosen(stops > 0.0, 0.0, load_speed)
    motion = twist, speed, load_speed, driving, now
    moment, _, _ = drive_rates(drive, touch, moves, motion)
    pulls = chosen(starts > 0.0, sense(moment), chosen(abs(moment) > drive[5], sense(moment), 0.0))
    moves = chosen(stops > 0.0, pulls, chosen(moves == 0.0, pulls, moves))
    # At an impact the damper acts with the full relative speed.
    reached = chosen(abs(before) > abs(moment), abs(before), abs(moment))
    higher = reached > greatest * _HIGHER
    greatest_at = chosen(higher, now, greatest_at)
    greatest = chosen(higher, reached, greatest)
    moving = chosen(load_at < 0.0, touch * moves, 0.0)
    load_at = chosen(moving == 0.0, load_at, now)
    change, gain = rate_signs(drive, touch, moves, motion)
    seen_so_far = greatest, greatest_at, closings + closes, impact_at, impact_speed, load_at
    return touch, moves, sense(change), sense(gain), *seen_so_far, load_speed


class TwoMasses(PrintedSystem):
    """System of a drive with its printed functions.

    Parameters
    ----------
    laws : tuple of Law
        Laws of the motor.
    bends : int
        Number of bends of the motor's characteristic.
    """

    def __init__(self, laws: tuple[Law, ...], bends: int) -> None:
        graph = Graph()

        def given(label: str) -> Given:
            return graph.given(label, Stage.STATE)

        # The twist is scaled to a speed, so that all states have similar magnitudes.
        labels = "twist by natural frequency", "speed of the motor", "speed of the load"
        swung, speed, load_speed = states = tuple(map(given, labels))
        self.frequency, self.radian = given("natural frequency"), given("time of a radian")
        twist = swung * self.radian
        clock = given("time of a state")
        self.drive = DriveNumbers(*map(given, DriveNumbers._fields))
        self.held = HeldOfDrive(*map(given, HeldOfDrive._fields))
        self.motor = MotorCurve.of_nodes(laws, lambda label, law, index: given(label))
        # The speed of each bend, and the side on which the motor is.
        self.bends = tuple((given(f"bend {i}"), given(f"side of bend {i}")) for i in range(bends))
        motion = twist, speed, load_speed, self.motor.moment(speed), clock
        drive, phase, seen = tuple(self.drive), self.held[:4], self.held[4:]
        _, *rises = graph.apply(drive_rates, drive, *phase[:2], motion)
        switches = [*graph.apply(guards_of_drive, drive, phase, motion)]
        behind = graph.apply(after_guard, drive, phase, motion, seen)
        held = dict(zip((*self.held, load_speed), behind, strict=True))
        for knot, side in self.bends:
            switches.append(side * (speed - knot))
            held[side] = graph.apply(past, switches[-1], side, -side)
        system = System(
            "time",
            states=states,
            rates=(self.frequency * (speed - load_speed), *rises),
            speed=speed,
            slope=rises[0],
            clock=clock,
            switches=tuple(switches),
            held=held,
            signed=True,
        )
        super().__init__(system, graph, graph.zero, graph.one)


two_masses = cache(TwoMasses)


class FollowedDrives(NamedTuple):
    """Drives at the end of their duration, arrays (variants,).

    Attributes
    ----------
    held : HeldOfDrive
    speed, load_speed : ndarray
        Final speeds of motor and load [rad/s].
    too_stiff : ndarray of bool
        Drives not computed because they vibrate too often within their duration.
    steps, recorded : ndarray
        Number of steps, and the recorded ones, as in `WalkBatch`.
    """

    held: HeldOfDrive
    speed: np.ndarray
    load_speed: np.ndarray
    too_stiff: np.ndarray
    steps: np.ndarray
    recorded: np.ndarray


class Beginning(NamedTuple):
    """Initial state of drives, (variants,): at rest with the whole backlash open, or running with another load.

    Attributes
    ----------
    runs : bool
    speed, load_before : ndarray
        [rad/s], [N·m].
    time : ndarray
        Duration [s].
    """

    runs: bool
    speed: np.ndarray
    load_before: np.ndarray
    time: np.ndarray


def follow_drives(
    drive: DriveNumbers, motor: MotorCurve, begin: Beginning, longer: float, recorded: int = 0
) -> FollowedDrives:
    """Compute drives for their duration.

    Parameters
    ----------
    drive : DriveNumbers
        Arrays.
    motor : MotorCurve
    begin : Beginning
    longer : float
        One of `WALKS`.
    recorded : int
        Maximum number of steps to record.
    """
    made, zero, time = two_masses(motor.laws, len(motor.bends)), np.zeros_like(begin.time), begin.time
    speed, driving = zero + begin.speed, motor.moment(begin.speed) + zero
    # A load below the rounding of the motor torque counts as zero.
    drive = drive._replace(load=np.where(driving + drive.load > driving, drive.load, 0.0))
    mobility, load_mobility, stiffness, _, backlash, load = drive
    # Stay within the backlash despite rounding.
    twist, touch = -backlash * (1.0 - 4.0 * EPS), np.where(backlash > 0.0, 0.0, 1.0)
    if begin.runs:
        # Up to now both masses had the same acceleration.
        shared = driving * mobility + begin.load_before * load_mobility
        pressed = shared / (mobility + load_mobility) / stiffness
        touch = np.where((pressed > 0.0) | (backlash == 0.0), 1.0, -1.0)
        twist = np.where(touch < 0.0, pressed - backlash, pressed)
    moves = np.where((speed > 0.0) | (load == 0.0), 1.0, 0.0)
    at_begin = (touch, moves, (twist, speed, speed, driving, zero))
    moment = drive_rates(tuple(drive), *at_begin)[0]
    signs = (np.sign(rate) for rate in rate_signs(tuple(drive), *at_begin))
    starts = np.where((speed > 0.0) | ((moves != 0.0) & (touch != 0.0)), 0.0, -1.0)
    held = HeldOfDrive(touch, moves, *signs, np.abs(moment), zero, zero, zero - 1.0, zero - 1.0, starts)
    frequency = drive.frequency
    # A damper far above critical is as fast as a stiff shaft.
    too_stiff = time * np.fmax(frequency, 0.1 * drive.damping * (mobility + load_mobility)) > MOST_RADIANS
    size = np.abs(np.array([*drive, twist, driving, speed, time, frequency])).max(axis=0)
    follows = ~too_stiff & (size < MOST_SIZE) & (frequency > 1.0 / MOST_SIZE) & (mobility > 0.0) & (load_mobility > 0.0)
    numbers = dict(zip((*made.drive, *made.held), (*drive, *held), strict=True))
    numbers |= {made.frequency: frequency, made.radian: 1.0 / frequency}
    for nodes, constants in zip(made.motor.constants, motor.constants, strict=True):
        numbers |= dict(zip(nodes, constants, strict=True))
    for (knot, side), at in zip(made.bends, motor.bends, strict=True):
        numbers |= {knot: at, side: np.where(speed >= at, 1.0, -1.0)}
    lanes = {"tolerance": tolerance_of_walk(TOLERANCE, longer), "clock": zero, "goal": np.where(follows, time, 0.0)}
    lanes |= {"pace": np.minimum(FIRST / frequency, time), "floor": (np.abs(driving) + load) / stiffness * frequency}
    walks = _walk(made, numbers, np.array([frequency * twist, speed, speed]), lanes, longer, recorded)
    swung, speed, load_speed = walks.states
    held = HeldOfDrive(*(walks.numbers[made.functions.rows[node]] for node in made.held))
    ending = (swung / frequency, speed, load_speed, zero, time)
    last = np.abs(drive_rates(tuple(drive), held.touch, held.moves, ending)[0])
    higher = last > held.greatest * _HIGHER
    greatest, at = np.where(higher, last, held.greatest), np.where(higher, time, held.greatest_at)
    held = held._replace(greatest=greatest, greatest_at=at)
    for name in ("impact_at", "impact_speed", "load_at"):
        held = held._replace(**{name: np.where(getattr(held, name) < 0.0, np.nan, getattr(held, name))})
    lost = np.where((walks.why == Why.GOAL) & follows, 0.0, np.nan)
    held = HeldOfDrive(*(row + lost for row in held))
    return FollowedDrives(held, speed + lost, load_speed + lost, too_stiff, walks.steps, walks.recorded)


def _walk(
    made: TwoMasses,
    numbers: Mapping[Given, np.ndarray],
    states: np.ndarray,
    lanes: Mapping[str, np.ndarray],
    longer: float,
    recorded: int,
) -> Walks:
    """Walk to the end of the duration, in several walks if one has too many steps."""
    count = states.shape[1]
    numbers = made.limited(np.zeros((len(made.functions.rows), count)), numbers)
    given, task = {"turned": states[0]} | lanes, made.task(np.inf, longer=longer)
    walks = made.run(task, Start(numbers, given, states, recorded=recorded))
    for _ in range(0 if recorded else MOST_WALKS):
        full = np.flatnonzero(walks.why == Why.FULL)
        if not full.size:
            break
        own, gone = {name: np.broadcast_to(row, count)[full] for name, row in given.items()}, walks.at[full]
        own |= {"clock": own["clock"] + gone, "goal": own["goal"] - gone, "pace": walks.pace[full]}
        further = made.run(task, Start(walks.numbers[:, full], own, walks.states[:, full]))
        further.at[:] += gone
        put(walks, full, further)
    return walks
