"""A group of variants carried side by side in the energy form: what `engine.motion.steppers.energy_form` compiles.

This file is its own template. `MOTORS` and `LAWS` say for how many induction motors and for which power laws it is
compiled; copies of it with other values are kept as kernels are. Loops over motors or channels inside the loop over
lanes would keep the compiler from vectorising.
"""

import math
from collections.abc import Callable

import numpy as np
from numba import njit

from engine.compiling.jit import KERNEL_OPTIONS, scalar
from engine.equal_positions.rows import larger, smaller
from engine.laws.motor_characteristics import induction_motor
from engine.motion.steppers.energy_form import (
    ABOVE,
    ANGLE,
    BELOW,
    NEAR_REST,
    SHARE_PER_STEP,
    STIFF,
    STIFF_SHARE,
    TIME,
    TIMES_PER_RADIAN,
    Course,
    Drive,
    Limits,
    Tables,
)

# Number of induction motors; channel of each power law.
MOTORS = 0
LAWS = ()

LANES = 32
# Lanes that the processor takes at once, or a multiple of that: what is left over would go a scalar way.
TOGETHER = 8

# A group of lanes keeps its numbers in one flat array, its tables in another, each kind at a fixed place: the compiler
# then sees that no two overlap, and vectorises. Places in the array of numbers …
E, T, W, MOTOR, SQUARES, SLOW, FAST, PEAK, MOVING, GOES = (i * LANES for i in range(10))
E_AFTER, T_STEP, W_AFTER, MOTOR_STEP, SQUARES_STEP, PEAK_STEP, STIFFNESS = (i * LANES for i in range(10, 17))
W1, W2, W3, W4, STEPS, UNTIL, OVER, UNDER, LINE = (i * LANES for i in range(17, 26))
KLOSS = 27 * LANES
PER_KLOSS = 5 * LANES
# … and in the tables of one step: its length, 2/I in the middle and at the end, moments at three places.
H, MIDDLE, FAR, LOADS = (i * LANES for i in range(4))
PER_ORDER, PER_PLACE = 3 * LANES, LANES


COUNT, CHANNEL_OF = len(LAWS), np.array((*LAWS, -1))
POWERS = KLOSS + MOTORS * PER_KLOSS
ROOM = POWERS + COUNT * LANES
POWER_ROWS = LOADS + 3 * PER_ORDER
ITEMS = POWER_ROWS + COUNT * PER_ORDER


@scalar
def straight_motors(x: np.ndarray, i: int, w: float) -> float:
    """Moment of the motors with a straight characteristic of lane i at speed w."""
    return x[LINE + i] + w * x[LINE + LANES + i]


def with_induction_motor(others: Callable, place: int) -> Callable:
    """Moment of other motors and of one more, an induction motor whose constants begin at a place in the lanes.

    One function around another instead of a loop over the motors, which would keep lanes from being vectorised.
    """

    @scalar
    def of_motors(x: np.ndarray, i: int, w: float) -> float:
        at = place + i
        ratio = x[at + 4 * LANES]
        torque = induction_motor(x[at], x[at + LANES], x[at + 2 * LANES], x[at + 3 * LANES], ratio * w)
        return others(x, i, w) + ratio * torque

    return of_motors


of_motors = straight_motors
for motor in range(MOTORS):
    of_motors = with_induction_motor(of_motors, KLOSS + motor * PER_KLOSS)


@scalar
def pack(tables: Tables, first: int, width: int, packed: np.ndarray) -> None:
    """Gather the tables of a group of lanes, step by step: all loads together, and each channel by itself."""
    for k in range(tables.steps.shape[0]):
        for i in range(width):
            v = first + i
            packed[k, H + i] = tables.steps[k, v]
            packed[k, MIDDLE + i] = 2.0 / tables.inertia[2 * k + 1, v]
            packed[k, FAR + i] = 2.0 / tables.inertia[2 * k + 2, v]
        for place in range(3):
            j = 2 * k + place
            for order in range(3):
                at = LOADS + order * PER_ORDER + place * PER_PLACE
                for i in range(width):
                    packed[k, at + i] = tables.loads[0, order, j, first + i]
                for channel in range(1, tables.loads.shape[0]):
                    for i in range(width):
                        packed[k, at + i] += tables.loads[channel, order, j, first + i]
            for law in range(COUNT):
                at = POWER_ROWS + law * PER_ORDER + place * PER_PLACE
                for i in range(width):
                    packed[k, at + i] = tables.powers[law, j, first + i]


@scalar
def begin_lanes(
    tables: Tables, drive: Drive, energy: np.ndarray, limits: Limits, first: int, width: int, x: np.ndarray
) -> None:
    """Set a group of lanes to its first node."""
    x[:] = 0.0
    for i in range(width):
        v = first + i
        speed = math.sqrt(2.0 * energy[v] / tables.inertia[0, v])
        x[E + i], x[W + i], x[SLOW + i], x[FAST + i], x[MOVING + i] = energy[v], speed, speed, speed, 1.0
        x[STEPS + i], x[UNTIL + i] = limits.steps[v], limits.time[v]
        x[OVER + i], x[UNDER + i] = limits.above[v], limits.below[v]
        x[LINE + i], x[LINE + LANES + i] = drive.line[0, v], drive.line[1, v]
        for motor in range(MOTORS):
            for constant in range(5):
                x[KLOSS + motor * PER_KLOSS + constant * LANES + i] = drive.kloss[motor, constant, v]
        for law in range(COUNT):
            x[POWERS + law * LANES + i] = drive.exponents[law, v]


@scalar
def of_loads(x: np.ndarray, p: np.ndarray, place: int, i: int, w: float) -> float:
    """Moment of all loads at one of the step's three places."""
    at = LOADS + place * PER_PLACE + i
    moment = p[at] + w * (p[at + PER_ORDER] + w * p[at + 2 * PER_ORDER])
    for law in range(COUNT):
        moment += p[POWER_ROWS + law * PER_ORDER + place * PER_PLACE + i] * w ** x[POWERS + law * LANES + i]
    return moment


@scalar
def step(x: np.ndarray, p: np.ndarray, width: int) -> None:
    """One classical Runge–Kutta step of all lanes, not yet taken. Nothing is written before all is read."""
    for i in range(width):
        e, w1, h = x[E + i], x[W + i], p[H + i]
        motor1 = of_motors(x, i, w1)
        m1 = motor1 + of_loads(x, p, 0, i, w1)
        w2 = math.sqrt((e + 0.5 * h * m1) * p[MIDDLE + i])
        motor2 = of_motors(x, i, w2)
        m2 = motor2 + of_loads(x, p, 1, i, w2)
        w3 = math.sqrt((e + 0.5 * h * m2) * p[MIDDLE + i])
        motor3 = of_motors(x, i, w3)
        m3 = motor3 + of_loads(x, p, 1, i, w3)
        w4 = math.sqrt((e + h * m3) * p[FAR + i])
        motor4 = of_motors(x, i, w4)
        m4 = motor4 + of_loads(x, p, 2, i, w4)
        after = e + h / 6.0 * (m1 + 2.0 * (m2 + m3) + m4)
        far = p[FAR + i]
        sixth = h / 6.0
        x[E_AFTER + i] = after
        # Reciprocals of two speeds for one division.
        outer, inner = 1.0 / (w1 * w4), 2.0 / (w2 * w3)
        r1, r2, r3, r4 = outer * w4, inner * w3, inner * w2, outer * w1
        x[T_STEP + i] = sixth * (r1 + r2 + r3 + r4)
        squares = motor1 * motor1 * r1 + motor2 * motor2 * r2 + motor3 * motor3 * r3 + motor4 * motor4 * r4
        x[SQUARES_STEP + i] = sixth * squares
        x[W_AFTER + i] = math.sqrt(after * far)
        x[PEAK_STEP + i] = larger(abs(motor1), abs(motor4))
        # M differs between the second and the third stage by its dependence on E alone, and E there as the
        # first two stages do: the ratio says how near an explicit method is to being unstable.
        stiff = (abs(m3 - m2) - abs(m2 - m1)) * h > STIFF_SHARE * e
        careful = x[UNDER + i] >= 0.0
        slowing = careful & ((-m1 > TIMES_PER_RADIAN * e) | (-m1 * h > SHARE_PER_STEP * e))
        x[STIFFNESS + i] = 1.0 if stiff else 0.0
        x[GOES + i] = 0.0 if (stiff | slowing) else 1.0
        x[MOTOR_STEP + i] = sixth * (motor1 + 2.0 * (motor2 + motor3) + motor4)
        x[W1 + i], x[W2 + i], x[W3 + i], x[W4 + i] = w1, w2, w3, w4


@scalar
def gather(x: np.ndarray, tables: Tables, k: int, channel: int, first: int, width: int, work: np.ndarray) -> None:
    """Work of one channel over the step, with the speeds of its stages."""
    for i in range(width):
        v, w1, w2, w3, w4 = first + i, x[W1 + i], x[W2 + i], x[W3 + i], x[W4 + i]
        j, loads = 2 * k, tables.loads
        near = loads[channel, 0, j, v] + w1 * (loads[channel, 1, j, v] + w1 * loads[channel, 2, j, v])
        j += 1
        linear, square = loads[channel, 1, j, v], loads[channel, 2, j, v]
        middle = loads[channel, 0, j, v] + loads[channel, 0, j, v] + (w2 + w3) * linear
        middle += (w2 * w2 + w3 * w3) * square
        j += 1
        far = loads[channel, 0, j, v] + w4 * (loads[channel, 1, j, v] + w4 * loads[channel, 2, j, v])
        goes = x[GOES + i] > 0.0
        work[i] += tables.steps[k, v] / 6.0 * (near + 2.0 * middle + far) if goes else 0.0
    for law in range(COUNT):
        if CHANNEL_OF[law] == channel:
            for i in range(width):
                v, n = first + i, x[POWERS + law * LANES + i]
                row = tables.powers[law, :, v]
                middle = row[2 * k + 1] * (x[W2 + i] ** n + x[W3 + i] ** n)
                ends = row[2 * k] * x[W1 + i] ** n + row[2 * k + 2] * x[W4 + i] ** n
                work[i] += tables.steps[k, v] / 6.0 * (ends + 2.0 * middle) if x[GOES + i] > 0.0 else 0.0


@scalar
def take(x: np.ndarray, width: int, done: int) -> float:
    """Take the step in the lanes where it passes no end of the stretch; returns how many do."""
    going = 0.0
    for i in range(width):
        w, t = x[W_AFTER + i], x[T + i] + x[T_STEP + i]
        inside = (w > x[UNDER + i]) & (w < x[OVER + i]) & (t < x[UNTIL + i]) & (done < x[STEPS + i]) & (w > 0.0)
        x[GOES + i] = x[GOES + i] * x[MOVING + i] if inside else 0.0
        going += x[GOES + i]
    for i in range(width):
        goes, w, peak = x[GOES + i] > 0.0, x[W_AFTER + i], x[PEAK_STEP + i]
        x[E + i] = x[E_AFTER + i] if goes else x[E + i]
        x[T + i] += x[T_STEP + i] if goes else 0.0
        x[SQUARES + i] += x[SQUARES_STEP + i] if goes else 0.0
        x[W + i] = w if goes else x[W + i]
        x[SLOW + i] = smaller(x[SLOW + i], w) if goes else x[SLOW + i]
        x[FAST + i] = larger(x[FAST + i], w) if goes else x[FAST + i]
        x[PEAK + i] = larger(x[PEAK + i], peak) if goes else x[PEAK + i]
        x[MOTOR + i] += x[MOTOR_STEP + i] if goes else 0.0
    return going


@scalar
def why(x: np.ndarray, i: int, done: int) -> int:
    """Why lane i can't take the step."""
    w = x[W_AFTER + i]
    if done >= x[STEPS + i]:
        return ANGLE
    if w >= x[OVER + i]:
        return ABOVE
    if 0.0 < w <= x[UNDER + i]:
        return BELOW
    if x[T + i] + x[T_STEP + i] >= x[UNTIL + i]:
        return TIME
    return STIFF if x[STIFFNESS + i] > 0.0 else NEAR_REST


@scalar
def settle(x: np.ndarray, first: int, width: int, done: int, works: np.ndarray, course: Course) -> None:
    """Write down the lanes that stop here."""
    for i in range(width):
        if x[MOVING + i] > x[GOES + i]:
            v = first + i
            x[MOVING + i] = 0.0
            course.energy[v], course.time[v], course.made[v] = x[E + i], x[T + i], done
            course.stop[v] = why(x, i, done)
            course.slowest[v], course.fastest[v], course.peak[v] = x[SLOW + i], x[FAST + i], x[PEAK + i]
            course.squares[v], course.works[0, v] = x[SQUARES + i], x[MOTOR + i]
            for channel in range(works.shape[0]):
                course.works[channel + 1, v] = works[channel, i]


@scalar
def fill(x: np.ndarray, packed: np.ndarray, width: int, wide: int) -> None:
    """Fill up idle lanes with copies of the last: all lanes then take the same instructions, to the last bit."""
    for i in range(width, wide):
        for j in range(ROOM // LANES):
            x[j * LANES + i] = x[j * LANES + width - 1]
        for k in range(packed.shape[0]):
            for j in range(ITEMS // LANES):
                packed[k, j * LANES + i] = packed[k, j * LANES + width - 1]
        x[MOVING + i] = 0.0


@njit(**KERNEL_OPTIONS)
def carry(
    begin: int,
    end: int,
    tables: Tables,
    drive: Drive,
    energy: np.ndarray,
    limits: Limits,
    record: np.ndarray,
    course: Course,
) -> None:
    """Carry variants begin … end − 1 to the end of their stretch; see `energy_form`."""
    cycle, channels = tables.steps.shape[0], tables.loads.shape[0]
    x, packed, works = np.empty(ROOM), np.empty((cycle, ITEMS)), np.empty((channels, LANES))
    for first in range(begin, end, LANES):
        width = min(LANES, end - first)
        pack(tables, first, width, packed)
        begin_lanes(tables, drive, energy, limits, first, width, x)
        wide = -(-width // TOGETHER) * TOGETHER
        fill(x, packed, width, wide)
        works[:] = 0.0
        moving, done = float(width), 0
        while moving > 0.0:
            if done < record.shape[1]:
                for i in range(width):
                    record[0, done, first + i], record[1, done, first + i] = x[E + i], x[T + i]
            k = done % cycle
            step(x, packed[k], wide)
            going = take(x, wide, done)
            if channels > 1:
                for channel in range(channels):
                    gather(x, tables, k, channel, first, width, works[channel])
            if going < moving:
                settle(x, first, width, done, works, course)
            moving, done = going, done + 1
        if channels == 1:
            # What the motors didn't give.
            for i in range(width):
                course.works[1, first + i] = course.energy[first + i] - energy[first + i] - course.works[0, first + i]
