"""State of each lane of a walk, the scratch memory of a block of lanes, and the input and output of a walk."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, Rows, in_lanes, scatter_row, scatter_rows
from engine.compiling.decorators import routine
from engine.cycle.panels.lanes import OFFSET, one, rows
from engine.stepping.walk_task import WalkTask

# Maximum number of stored steps per cycle; lanes that need more don't repeat theirs.
MOST_SLOTS = 160
# First rows of `watch`: speed; magnitude of the terms of the first state's rate; derivative of that rate with respect
# to the first state; a number with the sign of the speed's slope; from RESPONSES on, derivatives of the integrands
# with respect to the first state.
SPEED, SIZE, STEEPNESS, SLOPE, RESPONSES = range(5)
# Guards that aren't rows of `watch`: the edge ahead, the other goal, an extreme of the speed.
EDGE, OTHER, RISE, FIRST = range(4)


class Lane(NamedTuple):
    """Rows of a block, one number per lane.

    Inputs are the rows up to `pace`; outputs are those from `turned` to `steps`.

    Attributes
    ----------
    start, direction : row
        Crank angle at the start [rad], and the direction in which the angle turned is counted, +1 or −1.
    facing : row
        Direction of motion, +1 or −1.
    clock : row
        Time at the start [s].
    goal, other_goal : row
        Independent variable at the end; for a walk along time, the angle turned at the end, along the angle the time.
    tolerance, farthest : row
        Step tolerance, and largest angle of a step [rad].
    longest, floor : row
        For a walk along time, the longest step [s] and the speed below which the motion has faded [rad/s]; where speeds
        may be negative, the minimum scale of the errors of the states.
    turned, pace : row
        Angle turned, and length of the next trial step.
    at : row
        Independent variable, from the start.
    slowest, fastest, slow_off, fast_off : row
        Minimum and maximum speed at the ends of steps, and their error estimates.
    slope : row
        A number with the sign of the speed's slope at the end.
    why, steps : row
        Why the walk ended (`Why`), and its number of steps.
    scale, work, size : row
        Maximum work of the accepted steps; the same including the trial step; scale of a step's error.
    length, missed : row
        Length of the trial step, and its error estimate relative to the tolerance.
    edge, base : row
        Number of the edge behind, and the angle turned at which its cycle starts.
    low, high, begins, ends : row
        Limits of the angle turned and of the time at which a step evaluates its stages.
    behind, ahead : row
        Distances from the start and the end of a step along the angle to these limits, where it meets an edge [rad].
    short, long, trials, side : row
        Bracket of step lengths around a guard's root, number of trials, and side of the last one: −1 before the root,
        +1 beyond.
    short_speed, long_speed : row
        Speeds at the ends of the bracket.
    fired : row
        1 if a guard ends the step.
    halt : row
        Independent variable at the end of the cycle that is laid or repeated.
    taken, able : row
        1 if the step is accepted; 1 if a cycle is repeated.
    kept : row
        Number of stored steps of a cycle; −1: none.
    free : row
        Independent variable from which steps may be stored again.
    worst : row
        Maximum error estimate of the repeated steps relative to the tolerance.
    carried_error : row
        Error estimate of the first state at the start of the step.
    ended : row
        Number of the guard that ends the step; −1: none.
    top_off : row
        Speed by which a step that ends at an extreme of the speed misses it.
    settled : row
        Speed that may be reached within an implicit step with an extreme, unresolved; else NaN.
    aim, aims : row
        Length of the next trial step up to a kink, infinite if none; number of such trials since an accepted step.
    refused : row
        Error estimate, relative to the tolerance, of the last rejected step; infinite if none since an accepted step.
    alone : row
        1 if the step starts where all walks do: at their start, an edge, a switch or an instant.
    exact : row
        1 if the last accepted step was so exact that the next one may be longer by the largest factor.
    """

    start: Row
    direction: Row
    facing: Row
    clock: Row
    goal: Row
    other_goal: Row
    tolerance: Row
    farthest: Row
    longest: Row
    floor: Row
    turned: Row
    pace: Row
    at: Row
    slowest: Row
    fastest: Row
    slow_off: Row
    fast_off: Row
    slope: Row
    why: Row
    steps: Row
    scale: Row
    work: Row
    size: Row
    length: Row
    missed: Row
    edge: Row
    base: Row
    low: Row
    high: Row
    behind: Row
    ahead: Row
    begins: Row
    ends: Row
    short: Row
    long: Row
    trials: Row
    side: Row
    short_speed: Row
    long_speed: Row
    fired: Row
    halt: Row
    taken: Row
    able: Row
    kept: Row
    free: Row
    worst: Row
    carried_error: Row
    ended: Row
    top_off: Row
    settled: Row
    aim: Row
    aims: Row
    refused: Row
    alone: Row
    exact: Row


_FIRST_ROWS = Lane._fields[: Lane._fields.index("steps") + 1]
GIVEN, FIRST_FOUND = _FIRST_ROWS[: Lane._fields.index("pace") + 1], Lane._fields.index("turned")
FOUND = _FIRST_ROWS[FIRST_FOUND:]


class Room(NamedTuple):
    """Scratch arrays for one block, lanes last."""

    numbers: np.ndarray
    position: np.ndarray
    lane: one(Lane)
    edges: Rows
    instants: Rows
    rates: np.ndarray
    watched: np.ndarray
    begin: Rows
    after: Rows
    errors: Rows
    carried_errors: Rows
    ending: Rows
    secants: Rows
    equations: Rows
    before: Rows
    guards: Rows
    lengths: np.ndarray
    limits: Rows
    places: Rows


def new_room(task: WalkTask, numbers: int, edges: int, instants: int, repeats: bool) -> Room:
    """Scratch arrays for one block; `repeats` adds room for the stored steps of a cycle."""
    laid, unknown = MOST_SLOTS if repeats else 1, task.stages * task.solved
    return Room(
        rows(numbers),
        rows(3),
        rows(len(Lane._fields)),
        rows(2 * edges),
        rows(max(instants, 1)),
        # Tiles of one position.
        rows(task.width * max(len(task.nodes), task.stages + 1), 1, offset=OFFSET),
        rows(2 * task.watched, 1),
        rows(task.width),
        rows(task.width, offset=OFFSET),
        rows(task.width),
        rows(task.width),
        rows(task.width),
        rows(2),
        rows(unknown * (unknown + 1) + task.stages * task.states if task.implicit else 1),
        rows(2 * (2 * task.width + 1)),
        rows(2 * (FIRST + task.guards)),
        rows(laid),
        rows(2 * laid),
        rows(laid * (task.stages + 1) * max(task.places, 1)),
    )


class Printed(NamedTuple):
    """The printed functions of a system, and the memory of all tables."""

    places: Callable
    rates: Callable
    watch: Callable
    memory: np.ndarray


class WalkBatch(NamedTuple):
    """Inputs and results of a number of walks.

    Attributes
    ----------
    printed : Printed
    numbers : ndarray (numbers, variants)
        Held numbers are updated in place.
    edges : ndarray (2 × edges, variants)
        Angles turned at the edges of a cycle, including its start and end, and the margins at them [rad].
    instants : ndarray (instants, variants)
    given : ndarray (GIVEN, variants)
    states : ndarray (width, variants)
        States and integrals at the start, updated in place.
    carried_errors : ndarray (width, variants)
        Their error estimates, updated in place.
    ending : ndarray (width, variants)
        Their rates at the end.
    found : ndarray (FOUND, variants)
    recorded : ndarray (steps, 3 + (states + 1) × (1 + places), variants)
        Start, length and direction of each step; for each state and the first integral, its polynomial and its error
        estimate at the start.
    """

    printed: Printed
    numbers: np.ndarray
    edges: np.ndarray
    instants: np.ndarray
    given: np.ndarray
    states: np.ndarray
    carried_errors: np.ndarray
    ending: np.ndarray
    found: np.ndarray
    recorded: np.ndarray


@routine
def store_block(first: int, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Store the final states of a block of variants."""
    scatter_rows(room.begin, first, batch.states)
    scatter_rows(room.carried_errors, first, batch.carried_errors)
    scatter_rows(room.ending, first, batch.ending)
    for i in range(batch.found.shape[0]):
        scatter_row(room.lane[FIRST_FOUND + i], first, batch.found[i])
    if task.held.shape[0] > 0:
        scatter_rows(in_lanes(room.numbers), first, batch.numbers)
