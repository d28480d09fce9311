"""A machine at a position of each lane: inertia and loads, from the functions printed of it, in rows of a place.

A place has 2/I, loads over ω⁰, ω¹ and ω², power laws, where there are several channels of work the loads of each, and
dI/dφ in the direction of motion.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import in_lanes
from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import Memory
from engine.laws.elementary import direction_of
from engine.motion.moments.at_speed import (
    POLYNOMIAL,
    add_induction_motors,
    add_power,
    polynomial,
    straight_motors,
)
from engine.motion.moments.dynamics import Dynamics

# Rows of a place.
INVERSE, LOADS = range(2)


class Form(NamedTuple):
    """How many there are of what differs between machines: induction motors, power laws, channels of work.

    `width` is the number of rows of a place.
    """

    motors: int
    laws: int
    channels: int
    width: int


class Source(NamedTuple):
    """Where the rows of a place come from.

    Attributes
    ----------
    memory : ndarray
        All tables of the printed functions.
    target, also : ndarray (curves,) of int
        To which row of a place each curve is added, and to which other one; −1 to none.
    turned : ndarray (curves,) of bool
        Which curves are taken in the direction of motion.
    clocks : ndarray of int
        Rows of the numbers that hold the time.
    """

    memory: np.ndarray
    target: np.ndarray
    also: np.ndarray
    turned: np.ndarray
    clocks: np.ndarray


def form_of(dynamics: Dynamics, motors: int) -> Form:
    """How many there are of everything, with so many induction motors."""
    laws, channels = dynamics.channel_of_laws.size, len(dynamics.channels)
    width = LOADS + POLYNOMIAL + laws + (POLYNOMIAL * channels if channels > 1 else 0) + 1
    return Form(motors, laws, channels, width)


def source_of(dynamics: Dynamics, form: Form) -> Source:
    """Where the rows of a place come from, with the actions that are at work."""
    target, also = np.full((2, dynamics.target.size), -1)
    target[0], target[1] = INVERSE, form.width - 1
    after = LOADS + POLYNOMIAL + form.laws
    for i, channel, order in dynamics.polynomial:
        target[i + 2] = LOADS + order
        also[i + 2] = after + POLYNOMIAL * channel + order if form.channels > 1 else -1
    for k, (i, _, _) in enumerate(dynamics.laws):
        target[i + 2] = LOADS + POLYNOMIAL + k
    tabulation = dynamics.reduction.tabulation
    clocks = np.array([tabulation.functions.rows[node] for node in tabulation.given], np.int64)
    return Source(tabulation.functions.memory, target, also, np.arange(target.size) > 0, clocks)


@routine
def fill_place(
    fill: Callable,
    source: Source,
    numbers: np.ndarray,
    position: np.ndarray,
    tile: np.ndarray,
    direction: Memory,
    wheel: Memory,
    width: int,
    places: Memory,
    at: int,
) -> None:
    """Fill the rows of a place from row `at` on.

    Parameters
    ----------
    fill : callable
        Fills the tile at one position.
    source : Source
    numbers : ndarray (numbers, LANES)
    position : ndarray (3, LANES)
        Crank angle; its cosine and sine are put beside it.
    tile : ndarray (curves, 1, LANES)
    direction, wheel : row
        +1 or −1; inertia added to the machine's [kg·m²].
    width, places, at
        Where to.
    """
    own, filled = in_lanes(position), in_lanes(tile)
    for lane in range(LANES):
        own[1, lane], own[2, lane] = direction_of(own[0, lane])
    fill(numbers, source.memory, position[0:1], position[1:2], position[2:3], tile)
    for row in range(width):
        for lane in range(LANES):
            places[at + row, lane] = 0.0
    for curve in range(source.target.shape[0]):
        into, also = source.target[curve], source.also[curve]
        if into >= 0:
            if source.turned[curve]:
                for lane in range(LANES):
                    places[at + into, lane] += direction[lane] * filled[curve, lane]
            else:
                for lane in range(LANES):
                    places[at + into, lane] += filled[curve, lane]
        if also >= 0:
            for lane in range(LANES):
                places[at + also, lane] += direction[lane] * filled[curve, lane]
    for lane in range(LANES):
        places[at + INVERSE, lane] = 2.0 / (places[at + INVERSE, lane] + wheel[lane])


@routine
def add_share(wide: int, share: float, step: Memory, rates: Memory, energy: Memory) -> None:
    """Add to an energy what a moment does over a share of the step; all are rows, (LANES,)."""
    for lane in range(wide):
        energy[lane] += share * step[lane] * rates[lane]


@routine
def moments_at_speed(
    wide: int,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    at: int,
    speed: Memory,
    motors: Memory,
    moment: Memory,
) -> None:
    """Moment of the motors and moment of everything at a place whose rows begin at row `at`; all are rows, (LANES,)."""
    for lane in range(wide):
        motors[lane] = straight_motors(drive, lane, speed[lane])
    add_induction_motors(wide, drive, form.motors, speed, motors)
    for lane in range(wide):
        moment[lane] = motors[lane] + polynomial(places, at + LOADS, lane, speed[lane])
    for law in range(form.laws):
        add_power(wide, places[at + LOADS + POLYNOMIAL + law], exponents[law], speed, moment)
