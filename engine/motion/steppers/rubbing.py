"""Friction in the pairs of a machine in motion: the moment on the input that stands for it, in lanes.

It follows from the reactions, and these from ω² and ε; so ε is found with it, from I·ε + ½ω²·dI/dφ = M + M_f(ω², ε),
by secants. Against which motion friction acts is among the numbers: those of machines that move forward, or backwards.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import in_lanes
from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import Memory, rows

# ε is found to so much of what it is made of, far below what steps may miss, within so many evaluations.
SETTLED, MOST_ROUNDS = 1e-13, 20
# Rows to work in: ε without friction and as it is guessed; the guess before and what it left over; and what friction
# took of ε the last time.
FREE, HERE, BEFORE, LEFT_BEFORE, TAKEN = range(5)


class Rubbing(NamedTuple):
    """Where the moment of friction comes from.

    Attributes
    ----------
    memory : ndarray
        All tables of the printed functions.
    moving : ndarray (3,) of int
        Rows of the numbers that hold speed, its square, and acceleration; −1 where nothing depends on one.
    clocks : ndarray of int
        Rows that hold the time.
    curve : int
        Its curve; −1 where no pair rubs.
    channel : int
        Channel of work that it belongs to; −1 where all are one.
    """

    memory: np.ndarray
    moving: np.ndarray
    clocks: np.ndarray
    curve: int
    channel: int


class RubbingRoom(NamedTuple):
    """Memory for a block."""

    numbers: np.ndarray
    tile: np.ndarray
    rows: np.ndarray


def new_rubbing_room(parameters: int, curves: int) -> RubbingRoom:
    """Memory for functions of so many numbers and curves."""
    return RubbingRoom(rows(parameters), rows(curves, 1), rows(TAKEN + 1))


@routine
def begin_friction(room: RubbingRoom) -> None:
    """Forget what friction took of ε."""
    work = in_lanes(room.rows)
    for lane in range(LANES):
        work[TAKEN, lane] = 0.0


@routine
def add_friction(
    rub: Callable,
    rubbing: Rubbing,
    position: np.ndarray,
    way: Memory,
    time: Memory,
    share: float,
    length: Memory,
    inverse: Memory,
    slope: Memory,
    speed: Memory,
    moment: Memory,
    rubbed: Memory,
    room: RubbingRoom,
) -> None:
    """Add the moment of friction to a moment, at a place of a step.

    Parameters
    ----------
    rub : callable
        Fills the tile with the moment of friction, counter-clockwise positive.
    rubbing : Rubbing
    position : ndarray (3, LANES)
        Crank angle with cosine and sine.
    way, time, length : row
        +1 or −1; time at the begin of the step [s], and its length [s].
    share : float
        Of the step, to where the place is.
    inverse, slope, speed, moment : row
        2/I, dI/dφ, ω, and the moment of everything else, in the direction of motion.
    rubbed : row
        The moment of friction is written there.
    room : RubbingRoom
    """
    numbers, work = in_lanes(room.numbers), in_lanes(room.rows)
    filled = in_lanes(room.tile)
    for lane in range(LANES):
        omega = speed[lane]
        values = (abs(omega), omega * omega)
        for i in range(2):
            if rubbing.moving[i] >= 0:
                numbers[rubbing.moving[i], lane] = values[i]
        for i in range(rubbing.clocks.shape[0]):
            numbers[rubbing.clocks[i], lane] = time[lane] + share * length[lane]
        work[FREE, lane] = 0.5 * inverse[lane] * (moment[lane] - 0.5 * omega * omega * slope[lane])
        taken = work[TAKEN, lane]
        work[HERE, lane] = work[FREE, lane] + (taken if abs(taken) < np.inf else 0.0)
    for turn in range(MOST_ROUNDS):
        if rubbing.moving[2] >= 0:
            for lane in range(LANES):
                numbers[rubbing.moving[2], lane] = way[lane] * work[HERE, lane]
        rub(room.numbers, rubbing.memory, position[0:1], position[1:2], position[2:3], room.tile)
        pending = 0.0
        for lane in range(LANES):
            rubbed[lane] = way[lane] * filled[rubbing.curve, lane]
            free, here, before = work[FREE, lane], work[HERE, lane], work[BEFORE, lane]
            takes = 0.5 * inverse[lane] * rubbed[lane]
            left, left_before = free + takes - here, work[LEFT_BEFORE, lane]
            if abs(left) > SETTLED * (abs(free) + abs(takes)):
                pending += 1.0
                secant = here - left * (here - before) / (left - left_before)
                first = turn == 0 or not abs(secant) < np.inf
                work[BEFORE, lane], work[LEFT_BEFORE, lane] = here, left
                work[HERE, lane] = here + left if first else secant
        if pending == 0.0:
            break
    for lane in range(LANES):
        moment[lane] += rubbed[lane]
        work[TAKEN, lane] = work[HERE, lane] - work[FREE, lane]
