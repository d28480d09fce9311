"""A system at given states: its rates and watched values, from the functions with which a walk steps."""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, in_lanes, scatter_row
from engine.compiling.decorators import driver
from engine.stepping.steps.stage_rates import look, rate, set_position
from engine.stepping.steps.step_lanes import Printed, Room
from engine.stepping.walk_task import WalkTask


class GivenStates(NamedTuple):
    """States of a number of points, and the requested results.

    Attributes
    ----------
    printed : Printed
    numbers : ndarray (numbers, variants)
    variants : ndarray (points,) of int
        Variant of each point.
    places, clock : ndarray (points,)
        Position of the input [rad] and time [s].
    states : ndarray (states, points)
    wanted : ndarray (results,) of int
        Rows of the rates, followed by those of `watch`.
    found : ndarray (results, points)
    """

    printed: Printed
    numbers: np.ndarray
    variants: np.ndarray
    places: np.ndarray
    clock: np.ndarray
    states: np.ndarray
    wanted: np.ndarray
    found: np.ndarray


@driver
def evaluate_states(begin: int, end: int, batch: GivenStates, task: WalkTask, room: Room) -> None:
    """Evaluate a system at the states of the blocks begin … end − 1 of points."""
    own, printed, numbers = room.lane, batch.printed, in_lanes(room.numbers)
    points, first_state = batch.places.shape[0], task.first_place + task.places
    rated, watched, rates_asked = in_lanes(room.rates), in_lanes(room.watched), task.solves >= 0
    for i in range(batch.wanted.shape[0]):
        rates_asked |= batch.wanted[i] < task.width
    for b in range(begin, end):
        first = b * LANES
        for lane in range(LANES):
            point = min(first + lane, points - 1)
            variant = batch.variants[point]
            for i in range(batch.numbers.shape[0]):
                numbers[i, lane] = batch.numbers[i, variant]
            for i in range(task.states):
                numbers[first_state + i, lane] = batch.states[i, point]
            own.start[lane], own.direction[lane], own.clock[lane] = batch.places[point], 0.0, batch.clock[point]
            own.at[lane], own.length[lane] = 0.0, 1.0
            own.low[lane], own.high[lane], own.begins[lane], own.ends[lane] = -math.inf, math.inf, -math.inf, math.inf
        set_position(0.0, 0, -1, printed, task, room)
        if rates_asked:
            rate(0, printed, task, room)
        look(0, printed, task, room)
        for i in range(batch.wanted.shape[0]):
            row = batch.wanted[i]
            if row < task.width:
                scatter_row(rated[row], first, batch.found[i])
            else:
                scatter_row(watched[row - task.width], first, batch.found[i])
