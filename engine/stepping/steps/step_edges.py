"""Positions at which a step must end: edges of the torques, and requested instants."""

import math

from engine.compiling.decorators import inlined
from engine.stepping.steps.step_errors import ROUNDED
from engine.stepping.steps.step_lanes import Room
from engine.stepping.walk_task import WalkTask

# An interval is divided into equal steps only if there are at most this many; rounding adds no step.
MOST_PARTS, NEARLY_ALL = 1e6, 1.0 - 1e-9

# Edges: angles at which something jumps or bends


@inlined
def look_ahead(lane: int, count: int, room: Room) -> None:
    """Limits of the angles at which a lane's step evaluates: its edges, less their margins."""
    own, edges = room.lane, room.edges
    k = int(own.edge[lane])
    low, high = edges[k, lane] + edges[count + k, lane], edges[k + 1, lane] - edges[count + k + 1, lane]
    middle = 0.5 * (edges[k, lane] + edges[k + 1, lane])
    own.low[lane] = own.base[lane] + (low if low < middle else middle)
    own.high[lane] = own.base[lane] + (high if high > middle else middle)


@inlined
def edge_ahead(lane: int, room: Room) -> float:
    """Angle turned at the edge ahead of a lane."""
    own = room.lane
    return own.base[lane] + room.edges[int(own.edge[lane]) + (1 if own.facing[lane] > 0.0 else 0), lane]


@inlined
def equal_part(most: float, lane: int, task: WalkTask, room: Room) -> float:
    """Length of the equal steps, at most `most`, between the edges on either side of a lane.

    A comparison walk of half as many steps differs between any two edges if their number is even.
    """
    k, number = int(room.lane.edge[lane]), 2.0 if task.longer == 1.0 else 1.0
    between = room.edges[k + 1, lane] - room.edges[k, lane]
    if not between < MOST_PARTS * most:
        return most
    return between / (number * math.ceil(between / (number * most) * NEARLY_ALL))


@inlined
def pass_edge(lane: int, count: int, task: WalkTask, room: Room) -> bool:
    """Move a lane past the edge ahead; false where the range ends there."""
    own, edges = room.lane, room.edges
    facing, k = (1 if own.facing[lane] > 0.0 else -1), int(own.edge[lane])
    for _ in range(count + 1):
        k += facing
        if k < 0 or k + 1 >= count:
            if not task.cycle < math.inf:
                return False
            own.base[lane] += facing * task.cycle
            k = 0 if facing > 0 else count - 2
        # Edges that are nearly equal may be the same angle after some turns.
        if own.base[lane] + edges[k + 1, lane] > own.base[lane] + edges[k, lane]:
            break
    own.edge[lane] = float(k)
    return True


@inlined
def find_edge(lane: int, count: int, task: WalkTask, room: Room) -> None:
    """Find the edges on either side of a lane; at an edge, take the interval ahead."""
    own, edges = room.lane, room.edges
    cycle, facing = task.cycle, own.facing[lane]
    near = facing * ROUNDED * (abs(own.turned[lane]) + (cycle if cycle < math.inf else 0.0))
    own.base[lane] = math.floor((own.turned[lane] + near) / cycle) * cycle if cycle < math.inf else 0.0
    within, k = own.turned[lane] - own.base[lane] + near, 0
    while k + 2 < count and edges[k + 1, lane] < within:
        k += 1
    own.edge[lane] = float(k)


@inlined
def next_instant(lane: int, count: int, room: Room) -> float:
    """Next instant at which a function of time jumps or bends; set the time limits of the step."""
    own, instants = room.lane, room.instants
    now = own.clock[lane] + own.at[lane]
    now += ROUNDED * abs(now)
    before, after = -math.inf, math.inf
    for i in range(count):
        x = instants[i, lane]
        if x > now:
            after = x if x < after else after
        elif x <= now:
            before = x if x > before else before
    own.begins[lane], own.ends[lane] = before, after
    return after


@inlined
def ends_at_instant(lane: int, room: Room) -> bool:
    """Whether a lane's step ended at an instant at which a function of time jumps or bends."""
    own = room.lane
    now = own.clock[lane] + own.at[lane]
    return own.ends[lane] - now <= ROUNDED * abs(now)
