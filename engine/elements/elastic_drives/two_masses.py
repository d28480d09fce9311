"""Motion of two masses on a shaft with backlash, as a system: its rates, guards, and what is held between them.

The moment T of the shaft follows from its twist e = φ₁ − φ₂ as in `shaft_touch`; it doesn't change its sign while in
touch. Without backlash there is nothing to lose touch in. The load resists with M_c against its motion; at rest it
sticks while |T| ≤ M_c:

    I₁ ω₁′ = M(ω₁) − T,   I₂ ω₂′ = T ∓ M_c.

Touch and the way of the load are held. Steps end where either changes, and at the extremes of T, of the play and of ω₂:
within a step all of them are monotonic, so that no short touch and no short stop is passed over.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links and clearances).
"""

import math
from collections.abc import Mapping
from functools import cache
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen
from engine.elements.elastic_drives.elastic_shaft import DriveShaft
from engine.elements.elastic_drives.shaft_touch import touch_left, touch_turns, touching_moment
from engine.graph.nodes import Given, Graph, Node, Stage
from engine.laws.motor_characteristics import bend_of, induction_motor
from engine.laws.rounding import EPS
from engine.laws.senses import past
from engine.parts.motor_constants import MotorCurve
from engine.stepping.system import Guard, PrintedSystem, System, Walks
from engine.stepping.walk import Why

# The first step, in radians of the vibration.
FIRST = 0.1
# A drive is followed through no more of its vibration than this, which a single one takes some seconds for.
MOST_RADIANS = 6e4
# How often a walk is carried on at most.
MOST_WALKS = 200
# Numbers beyond this are garbage.
MOST_SIZE = 1e100
# Beyond all angles [rad].
_FAR = 1e300
# Peaks that are the same but for rounding differ by less than this share.
_HIGHER = 1.0 + 1e-11

# Numbers as in `DriveNumbers`; twist, both speeds, the motor's moment, time; what is held, as in `HeldOfDrive`, in two
# parts; all of that with the load's speed.
Drive = tuple[float, float, float, float, float, float]
Motion = tuple[float, float, float, float, float]
Phase = tuple[float, float, float, float]
Seen = tuple[float, float, float, float, float, float]
Behind = tuple[float, float, float, float, float, float, float, float, float, float, float]


class HeldOfDrive(NamedTuple):
    """What a drive holds between two guards, nodes or arrays (variants,): the phase, and what was seen so far.

    Attributes
    ----------
    touch : Given or ndarray
        1 where the shaft touches forwards, −1 backwards, 0 nowhere.
    moves : Given or ndarray
        The way the load moves, 1 or −1; 0 where it sticks.
    growing, gains : Given or ndarray
        1 or −1: whether the shaft's moment, or out of touch the twist, and the load's speed grow.
    greatest, greatest_at : Given or ndarray
        Greatest magnitude of the shaft's moment and when [N·m], [s].
    closings, impact_at, impact_speed : Given or ndarray
        How often the backlash closed, when first [s] and how fast [rad/s]; −1 where it never did.
    load_at : Given or ndarray
        When the load started [s]; −1 where it never did.
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
        """Natural frequency in touch [rad/s]."""
        return np.sqrt(self.stiffness * (self.mobility + self.load_mobility))


@scalar
def sign(x: float) -> float:
    """The sign of a number, 0 of 0."""
    return chosen(x > 0.0, 1.0, chosen(x < 0.0, -1.0, 0.0))


@scalar
def drive_rates(drive: Drive, touch: float, moves: float, motion: Motion) -> tuple[float, float, float]:
    """Moment of the shaft [N·m], accelerations of motor and load [rad/s²]."""
    twist, speed, load_speed, driving, _ = motion
    moment = touching_moment(drive[2:5], touch, twist, speed - load_speed)
    return moment, drive[0] * (driving - moment), chosen(moves == 0.0, 0.0, drive[1] * (moment - moves * drive[5]))


@scalar
def ways_of_drive(drive: Drive, touch: float, moves: float, motion: Motion) -> tuple[float, float]:
    """What has the sign by which the shaft's moment, or out of touch the twist, grows; so of the load's speed."""
    moment, rise, load_rise = drive_rates(drive, touch, moves, motion)
    slip, apart = motion[1] - motion[2], rise - load_rise
    change = touch_turns(drive[2:5], touch, slip, apart)
    return chosen(change == 0.0, apart, change), moment - moves * drive[5]


@scalar
def guards_of_drive(drive: Drive, phase: Phase, motion: Motion) -> tuple[float, float, float, float]:
    """What is positive until touch changes, until the load's way does, and until either of `ways_of_drive` turns."""
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
def behind_guard(drive: Drive, phase: Phase, motion: Motion, seen: Seen) -> Behind:
    """What is held behind a guard, as in `HeldOfDrive`, and the load's speed there."""
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
    pulls = chosen(starts > 0.0, sign(moment), chosen(abs(moment) > drive[5], sign(moment), 0.0))
    moves = chosen(stops > 0.0, pulls, chosen(moves == 0.0, pulls, moves))
    # A damper is hit with full speed.
    reached = chosen(abs(before) > abs(moment), abs(before), abs(moment))
    higher = reached > greatest * _HIGHER
    greatest_at = chosen(higher, now, greatest_at)
    greatest = chosen(higher, reached, greatest)
    moving = chosen(load_at < 0.0, touch * moves, 0.0)
    load_at = chosen(moving == 0.0, load_at, now)
    change, gain = ways_of_drive(drive, touch, moves, motion)
    seen_so_far = greatest, greatest_at, closings + closes, impact_at, impact_speed, load_at
    return touch, moves, sign(change), sign(gain), *seen_so_far, load_speed


class MotorNodes(NamedTuple):
    """A motor's characteristic as nodes: level, slope, bends and the side held of each, Kloss' constants."""

    level: Given
    slope: Given
    bends: tuple[tuple[Given, Given, Given], ...]
    kloss: tuple[Given, ...]

    def moment(self, speed: Node) -> Node:
        """Moment at a speed [N·m]."""
        graph = speed.graph
        bent = (bend * graph.apply(bend_of, speed - knot) for bend, knot, _ in self.bends)
        moment = sum(bent, self.level + self.slope * speed)
        return moment + graph.apply(induction_motor, *self.kloss, speed) if self.kloss else moment


class TwoMasses(PrintedSystem):
    """The system of a drive, its functions printed.

    Parameters
    ----------
    bends : int
        How often its motor's characteristic bends.
    kloss : bool
        Whether Kloss' formula is part of it.
    """

    def __init__(self, bends: int, kloss: bool) -> None:
        graph = Graph()

        def given(label: str) -> Given:
            return graph.given(label, Stage.STATE)

        # The twist counts as a speed, so that all states are of one size.
        labels = "twist by natural frequency", "speed of the motor", "speed of the load"
        swung, speed, load_speed = states = tuple(map(given, labels))
        self.frequency, self.radian = given("natural frequency"), given("time of a radian")
        twist = swung * self.radian
        clock = given("time of a state")
        self.drive = DriveNumbers(*map(given, DriveNumbers._fields))
        self.held = HeldOfDrive(*map(given, HeldOfDrive._fields))
        each = (tuple(given(f"{part} of bend {i}") for part in ("change", "speed", "side")) for i in range(bends))
        constants = tuple(given(f"constant {i} of Kloss") for i in range(4 if kloss else 0))
        self.motor = MotorNodes(given("level"), given("slope"), tuple(each), constants)
        motion = twist, speed, load_speed, self.motor.moment(speed), clock
        drive, phase, seen = tuple(self.drive), self.held[:4], self.held[4:]
        _, *rises = graph.apply(drive_rates, drive, *phase[:2], motion)
        names = ("touch", "load", "moment turns", "load turns")
        guards = [
            Guard(name, value, False)
            for name, value in zip(names, graph.apply(guards_of_drive, drive, phase, motion), strict=True)
        ]
        behind = graph.apply(behind_guard, drive, phase, motion, seen)
        held = dict(zip((*self.held, load_speed), behind, strict=True))
        for i, (_, knot, side) in enumerate(self.motor.bends):
            guards.append(Guard(f"bend {i}", side * (speed - knot), False))
            held[side] = graph.apply(past, guards[-1].value, side, -side)
        rates, zero = (self.frequency * (speed - load_speed), *rises), graph.zero
        system = System(
            "time", states, {}, rates, {}, speed, zero, zero, rises[0], (), (), tuple(guards), clock, held, True
        )
        super().__init__(system, graph, zero, graph.one)


two_masses = cache(TwoMasses)


def shaft_moment(shaft: DriveShaft, backlash: float, twist: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """Moment of a shaft by its twist and the rate of that [N·m]; damping doesn't pull where there is a backlash."""
    forwards, pull = shaft.stiffness * twist, shaft.damping * slip
    if backlash == 0.0:
        return forwards + pull
    behind = shaft.stiffness * (twist + backlash)
    pressed = np.where(twist > 0.0, np.maximum(forwards + pull, 0.0), 0.0)
    return pressed + np.where(twist < -backlash, np.minimum(behind + pull, 0.0), 0.0)


class FollowedDrives(NamedTuple):
    """Drives at the end of their time, arrays (variants,).

    Attributes
    ----------
    held : HeldOfDrive
    speed, load_speed : ndarray
        Of motor and load at the end [rad/s].
    too_stiff : ndarray of bool
        Which vibrate too often within their time to be followed.
    steps, recorded : ndarray
        How many steps were made; these, as in `engine.stepping.walk.WalkBatch`, as many as there is room for.
    """

    held: HeldOfDrive
    speed: np.ndarray
    load_speed: np.ndarray
    too_stiff: np.ndarray
    steps: np.ndarray
    recorded: np.ndarray


class Beginning(NamedTuple):
    """How drives begin, (variants,): at rest with all of the backlash open, or where they run with another load.

    Attributes
    ----------
    runs : bool
    speed, load_before : ndarray
        [rad/s], [N·m].
    time : ndarray
        For how long they are followed [s].
    """

    runs: bool
    speed: np.ndarray
    load_before: np.ndarray
    time: np.ndarray


def follow_drives(
    drive: DriveNumbers, motor: MotorCurve, begin: Beginning, tolerance: float, recorded: int = 0
) -> FollowedDrives:
    """Follow drives for their time.

    Parameters
    ----------
    drive : DriveNumbers
        Arrays.
    motor : MotorCurve
    begin : Beginning
    tolerance : float
        What a step may miss.
    recorded : int
        How many steps to record at most.
    """
    made, zero, time = two_masses(len(motor.bends), motor.kloss is not None), np.zeros_like(begin.time), begin.time
    speed, driving = zero + begin.speed, motor.moment(begin.speed) + zero
    # What is lost in the rounding of the motor's moment resists nothing.
    drive = drive._replace(load=np.where(driving + drive.load > driving, drive.load, 0.0))
    mobility, load_mobility, stiffness, _, backlash, load = drive
    # Within the backlash whatever is rounded.
    twist, touch = -backlash * (1.0 - 4.0 * EPS), np.where(backlash > 0.0, 0.0, 1.0)
    if begin.runs:
        # Until now both masses were accelerated alike.
        shared = driving * mobility + begin.load_before * load_mobility
        pressed = shared / (mobility + load_mobility) / stiffness
        touch = np.where((pressed > 0.0) | (backlash == 0.0), 1.0, -1.0)
        twist = np.where(touch < 0.0, pressed - backlash, pressed)
    moves = np.where((speed > 0.0) | (load == 0.0), 1.0, 0.0)
    at_begin = (touch, moves, (twist, speed, speed, driving, zero))
    moment = drive_rates(tuple(drive), *at_begin)[0]
    signs = (np.sign(way) for way in ways_of_drive(tuple(drive), *at_begin))
    starts = np.where((speed > 0.0) | ((moves != 0.0) & (touch != 0.0)), 0.0, -1.0)
    held = HeldOfDrive(touch, moves, *signs, np.abs(moment), zero, zero, zero - 1.0, zero - 1.0, starts)
    frequency = drive.frequency
    # A damper far stronger than a critical one is as fast as a stiff shaft.
    too_stiff = time * np.fmax(frequency, 0.1 * drive.damping * (mobility + load_mobility)) > MOST_RADIANS
    size = np.abs(np.array([*drive, twist, driving, speed, time, frequency])).max(axis=0)
    follows = ~too_stiff & (size < MOST_SIZE) & (frequency > 1.0 / MOST_SIZE) & (mobility > 0.0) & (load_mobility > 0.0)
    numbers = dict(zip((*made.drive, *made.held), (*drive, *held), strict=True))
    numbers |= {made.motor.level: motor.level, made.motor.slope: motor.slope}
    numbers |= {made.frequency: frequency, made.radian: 1.0 / frequency}
    numbers |= dict(zip(made.motor.kloss, motor.kloss or (), strict=True))
    for (bend, knot, side), (change, at) in zip(made.motor.bends, motor.bends, strict=True):
        numbers |= {bend: change, knot: at, side: np.where(speed >= at, 1.0, -1.0)}
    lanes = {"tolerance": tolerance, "clock": zero, "goal": np.where(follows, time, 0.0)}
    lanes |= {"pace": np.minimum(FIRST / frequency, time), "floor": (np.abs(driving) + load) / stiffness * frequency}
    walks = _walk(made, numbers, np.array([frequency * twist, speed, speed]), lanes, recorded)
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
    recorded: int,
) -> Walks:
    """Walk to the end of the time, however many steps that takes."""
    count = states.shape[1]
    numbers = made.limited(np.zeros((len(made.functions.rows), count)), numbers)
    edges, nothing = np.zeros((4, count)), np.zeros((0, count))
    edges[:2] = [[-_FAR], [_FAR]]
    given = {"start": 0.0, "direction": 1.0, "facing": 1.0, "other_goal": np.inf}
    given |= {"farthest": np.inf, "turned": states[0]} | lanes
    task = made.task(np.inf)
    walks = made.run(task, numbers, edges, nothing, given, states, recorded=recorded)
    for _ in range(0 if recorded else MOST_WALKS):
        full = np.flatnonzero(walks.why == Why.FULL)
        if not full.size:
            break
        some, gone = {name: np.broadcast_to(row, count)[full] for name, row in given.items()}, walks.at[full]
        some |= {"clock": some["clock"] + gone, "goal": some["goal"] - gone, "pace": walks.pace[full]}
        further = made.run(task, walks.numbers[:, full], edges[:, full], nothing[:, full], some, walks.states[:, full])
        further.at[:] += gone
        for whole, part in zip(walks, further, strict=True):
            whole[..., full] = part
    return walks
