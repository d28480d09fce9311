"""Steps of a cycle that are stored, to be repeated in later cycles."""

from engine.compiling.decorators import inlined
from engine.stepping.steps.step_lanes import Room
from engine.stepping.walk_task import GOING, WalkTask

# A cycle that ends this close to the goal, as a fraction of the cycle, ends at it.
NEARLY = 1e-12


@inlined
def cycles_ahead(task: WalkTask) -> float:
    """Minimum number of cycles ahead of a lane that repeats one."""
    return (2.0 if task.extremes else 1.0) - NEARLY


@inlined
def may_repeat(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a lane is in a cycle that it may repeat, with enough cycles ahead."""
    own = room.lane
    in_stored = own.why[lane] == GOING and own.at[lane] >= own.halt[lane] and own.kept[lane] > 0.0
    return in_stored and own.halt[lane] + cycles_ahead(task) * task.cycle <= own.goal[lane]


@inlined
def remember(first: bool, lane: int, task: WalkTask, room: Room) -> None:
    """Store the state at the start of a lane's cycle, and that of the cycle before unless this is the `first`."""
    own, before, width = room.lane, room.before, task.width
    begin, carried_errors, one = room.begin, room.carried_errors, 2 * task.width + 1
    for i in range(one):
        now = own.at[lane] if i == 2 * width else begin[i, lane] if i < width else carried_errors[i - width, lane]
        before[i, lane] = now if first else before[one + i, lane]
        before[one + i, lane] = now


@inlined
def go_back(lane: int, task: WalkTask, room: Room) -> None:
    """Return a lane to the start of the previous cycle; its steps are new up to the end of the cycle it left."""
    own, before, width = room.lane, room.before, task.width
    begin, carried_errors = room.begin, room.carried_errors
    for i in range(width):
        begin[i, lane], carried_errors[i, lane] = before[i, lane], before[width + i, lane]
    own.at[lane], own.free[lane] = before[2 * width, lane], before[4 * width + 1, lane] + task.cycle
