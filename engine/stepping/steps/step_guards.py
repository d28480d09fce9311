"""Guards: roots at which a step must end, kinks, extremes of the speed, and numbers that a root changes."""

import math

from engine.compiling.blocks import LANES, in_lanes
from engine.compiling.decorators import inlined, routine
from engine.stepping.steps.stage_rates import FOUND_TO
from engine.stepping.steps.step_edges import edge_ahead
from engine.stepping.steps.step_errors import ROUNDED
from engine.stepping.steps.step_lanes import EDGE, FIRST, OTHER, RISE, SIZE, SLOPE, SPEED, STEEPNESS, Room
from engine.stepping.walk_task import WalkTask

# Relative tolerance of the length of the step to a guard's root, and maximum number of trials.
ROOT, MOST_TRIALS = 4e-16, 60
# Replaces a guard of zero at the start of a step.
TINY = 1e-292
# Below this fraction of its final value a guard is too small for the secant; try this fraction of the step instead.
NEXT_TO_NOTHING, LEAP = 1e-3, 0.1
# A step that passes a kink is repeated up to the kink, unless that is within this fraction of the step from an end;
# maximum number of repetitions, which a jump instead of a kink would need without end.
NEXT_TO_END, MOST_AIMS = 2e-3, 6
# An extreme of the speed is found once the slope is below the fraction FLAT √tolerance of its terms: the speed misses
# the extreme by the square of that. To bracket it, a trial step overshoots by the fraction BEYOND of the bracket, the
# second by BEHIND of its own distance.
FLAT, BEYOND, BEHIND = 0.1, 1e-5, 0.2


@inlined
def next_root(lane: int, task: WalkTask, room: Room) -> float:
    """Length of the step to the first root within the bracket, by the secant; the longer end once the root is found.

    Extremes of the speed follow from the cubic through its values and slopes.
    """
    own, guards, count = room.lane, room.guards, FIRST + task.guards
    short, long = own.short[lane], own.long[lane]
    best = long
    if long - short > task.root * long and own.trials[lane] <= MOST_TRIALS:
        for g in range(count):
            near, far = guards[g, lane], guards[count + g, lane]
            if near > 0.0 and far <= 0.0 and not (g == RISE and is_reached(far, long - short, lane, room)):
                share = top_between(near, far, lane, room) if g == RISE else near / (near - far)
                # A guard that starts at its zero, or just after it, is too small for the secant.
                share = LEAP if g != RISE and short == 0.0 and share < NEXT_TO_NOTHING else share
                # Aim beyond the root rather than before it.
                root = short + (long - short) * share + 0.5 * task.root * long
                best = root if root < best else best
    return best


@inlined
def is_reached(comes: float, bracket: float, lane: int, room: Room) -> bool:
    """Whether a step to the longer end of an extreme's bracket, where the slope is `comes`, misses it negligibly.

    The speed falls from the extreme by less than that slope times the bracket.
    """
    negligible = max(FLAT * FLAT * room.lane.tolerance[lane], ROUNDED) * in_lanes(room.watched)[SPEED, lane]
    return -comes * bracket <= negligible


@inlined
def top_between(leaves: float, comes: float, lane: int, room: Room) -> float:
    """Fraction of the bracket at which the speed is extreme; `leaves` and `comes` are its slopes at the two ends.

    The slope at the start of the step is taken as positive.

    Source: Hermite's cubic, whose slope is a quadratic with one root between slopes of different signs.
    """
    own, watched = room.lane, in_lanes(room.watched)
    bracket = own.long[lane] - own.short[lane]
    a, b = leaves * bracket, comes * bracket
    c = math.copysign(1.0, watched[SLOPE, lane]) * (own.long_speed[lane] - own.short_speed[lane])
    linear, squared = 6.0 * c - 4.0 * a - 2.0 * b, 3.0 * (a + b) - 6.0 * c
    share = 2.0 * a / (math.sqrt(max(linear * linear - 4.0 * squared * a, 0.0)) - linear)
    # The second trial approaches from the other side.
    overshoot = BEYOND if own.trials[lane] != 2.0 else BEHIND * (share if own.side[lane] < 0.0 else share - 1.0)
    share += overshoot
    return share if 0.0 < share < 1.0 else 0.5


@inlined
def speed_slope(lane: int, end: int, task: WalkTask, room: Room) -> float:
    """Derivative of the speed at the start of a step, 0, or its end, 1; along the angle dω/dφ = ω/(2E) · I ω dω/dφ."""
    watched, energy = in_lanes(room.watched), room.begin if end == 0 else room.after
    slope, speed = watched[end * task.watched + SLOPE, lane], watched[end * task.watched + SPEED, lane]
    return slope if task.along_time else 0.5 * slope * speed / energy[0, lane]


@inlined
def guard(g: int, lane: int, end: int, task: WalkTask, room: Room) -> float:
    """Value of a guard of a lane at the start of a step, 0, or at its end, 1."""
    own, watched = room.lane, in_lanes(room.watched)
    states = room.begin if end == 0 else room.after
    row = end * task.watched
    if g == EDGE:
        return (edge_ahead(lane, room) - states[0, lane]) * own.facing[lane] if task.along_time else 1.0
    if g == OTHER:
        if task.along_time:
            return (own.other_goal[lane] - states[0, lane]) * own.facing[lane]
        return own.other_goal[lane] - states[task.states, lane]
    if g == RISE:
        slope, own_state = watched[SLOPE, lane], 1 if task.along_time else 0
        # In a motion in balance the slope's sign is rounding.
        off = FOUND_TO * abs(room.begin[own_state, lane])
        unsure = ROUNDED * watched[SIZE, lane] + steepness(lane, task, room) * off
        sense = math.copysign(1.0, slope) if abs(slope) > unsure else 0.0
        return sense * speed_slope(lane, end, task, room) if task.extremes else 1.0
    return watched[row + task.watched - task.guards + g - FIRST, lane]


@inlined
def is_crossed(g: int, lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a guard vanishes within a step; where guards change held numbers, a step may start at a guard's zero."""
    return passes_zero(guard(g, lane, 0, task, room), guard(g, lane, 1, task, room), task)


@inlined
def passes_zero(near: float, far: float, task: WalkTask) -> bool:
    """Whether a guard with these values at the ends of a step vanishes within it."""
    return ((near > 0.0) & (not far > 0.0)) | ((near == 0.0) & (far < 0.0) & (task.held.shape[0] > 0))


@routine
def fires(rises: bool, task: WalkTask, room: Room) -> None:
    """Set `fired` in lanes where a guard that is positive at the start of the step isn't positive at its end.

    If `rises`, extremes of the speed count too.
    """
    own, watched = room.lane, in_lanes(room.watched)
    for lane in range(LANES):
        crossed = is_crossed(OTHER, lane, task, room)
        own.fired[lane] = 1.0 if crossed or (task.along_time and is_crossed(EDGE, lane, task, room)) else 0.0
    # Rows without a choice between guards vectorise.
    for row in range(task.watched - task.guards, task.watched):
        for lane in range(LANES):
            crossed = passes_zero(watched[row, lane], watched[task.watched + row, lane], task)
            own.fired[lane] = 1.0 if crossed else own.fired[lane]
    for lane in range(LANES if rises else 0):
        leaves, comes = guard(RISE, lane, 0, task, room), guard(RISE, lane, 1, task, room)
        if task.implicit:
            # The sign of a steep machine's slope is that of an error within the tolerance.
            off = own.missed[lane] * own.tolerance[lane] * watched[task.watched + SPEED, lane]
            off *= 1.0 if task.along_time else 0.5 * own.work[lane] / room.after[0, lane]
            comes -= steepness(lane, task, room) * off
        if passes_zero(leaves, comes, task) and (own.trials[lane] > 0.0 or may_exceed(lane, task, room)):
            own.fired[lane] = 1.0


@inlined
def steepness(lane: int, task: WalkTask, room: Room) -> float:
    """Magnitude of the speed's own ∂f/∂y at the start of a step, the inverse of the length in which it settles."""
    return abs(in_lanes(room.watched)[task.slopes if task.solved > 0 else STEEPNESS, lane])


@inlined
def settles(lane: int, task: WalkTask, room: Room) -> float:
    """Change of the speed while it settles within an implicit step, unresolved by its stages; 0 if it doesn't."""
    steep = steepness(lane, task, room)
    within = task.implicit and steep * room.lane.length[lane] > 1.0
    return speed_slope(lane, 0, task, room) / steep if within else 0.0


@inlined
def hides_two(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether the speed may have two extremes in a step between slopes of one sign, beyond the extremes so far.

    Source: Hermite's cubic through its values and slopes, whose slope is a quadratic.
    """
    own, watched, length = room.lane, in_lanes(room.watched), room.lane.length[lane]
    if task.fixed or not task.extremes or own.fired[lane] + own.trials[lane] > 0.0:
        return False
    near, far = watched[SPEED, lane], watched[task.watched + SPEED, lane]
    a, b = speed_slope(lane, 0, task, room) * length, speed_slope(lane, 1, task, room) * length
    linear, squared = 6.0 * (far - near) - 4.0 * a - 2.0 * b, 3.0 * (a + b) - 6.0 * (far - near)
    under = linear * linear - 4.0 * squared * a
    if not (a * b > 0.0 and a * squared > 0.0 and under > 0.0 and 0.0 < -linear / (2.0 * squared) < 1.0):
        return False
    hides, off = False, ROUNDED * near
    for sign in range(-1, 2, 2):
        x = 0.5 * (sign * math.sqrt(under) - linear) / squared
        top = near + x * (a + x * (0.5 * linear + x * squared / 3.0))
        hides |= top > max(own.fastest[lane], far) + off or top < min(own.slowest[lane], far) - off
    return hides


@inlined
def hides_top(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a step with an extreme of the speed is too long to find it: the speed settles within."""
    own, rise = room.lane, abs(settles(lane, task, room))
    hides = task.extremes and own.fired[lane] > 0.0 and own.trials[lane] == 0.0
    return hides and rise > own.tolerance[lane] * in_lanes(room.watched)[SPEED, lane]


@inlined
def may_exceed(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether an extreme of the speed within the step may exceed the extremes so far or trigger a guard.

    It lies roughly within the triangle of the chord and the end tangents, and certainly within twice its height.
    """
    own, watched = room.lane, in_lanes(room.watched)
    near, far = watched[SPEED, lane], watched[task.watched + SPEED, lane]
    leaves, comes = speed_slope(lane, 0, task, room), speed_slope(lane, 1, task, room)
    # Intersection of the tangents.
    top = near + leaves * (far - near - comes * own.length[lane]) / (leaves - comes)
    end = max(near, far) if leaves > 0.0 else min(near, far)
    beyond = top - end if leaves > 0.0 else end - top
    # An intersection between the end speeds means that a steep motor bends the curve otherwise.
    if not beyond >= 0.0:
        return True
    for g in range(FIRST + task.endings, FIRST + task.guards):
        first, last = guard(g, lane, 0, task, room), guard(g, lane, 1, task, room)
        if first > 0.0 and not min(first, last) > 2.0 * beyond:
            return True
    return top + beyond > own.fastest[lane] if leaves > 0.0 else top - beyond < own.slowest[lane]


@inlined
def narrow(lane: int, task: WalkTask, room: Room) -> bool:
    """Narrow the bracket of a guard's root in a lane; true where the step ends at the root.

    Source: N. Anderson and Å. Björck, A new high order method of regula falsi type, BIT 13 (1973).
    """
    own, guards, count = room.lane, room.guards, FIRST + task.guards
    length, fired, watched = own.length[lane], own.fired[lane] > 0.0, in_lanes(room.watched)
    if own.trials[lane] == 0.0:
        own.short[lane], own.long[lane], own.side[lane] = 0.0, length, 0.0
        own.short_speed[lane] = watched[SPEED, lane]
        for g in range(count):
            near = guard(g, lane, 0, task, room)
            guards[g, lane] = TINY if near == 0.0 and task.held.shape[0] > 0 else near
    if fired and own.trials[lane] > 0.0 and (beyond_root(lane, task, room) or is_flat(lane, task, room)):
        return True
    side = 1.0 if fired else -1.0
    again = own.side[lane] == side
    for g in range(count):
        # Replace the value at this end; reduce the weight of the end that stays twice. Slopes keep theirs.
        here, same, other = guard(g, lane, 1, task, room), g + (count if fired else 0), g + (0 if fired else count)
        less = 1.0 - here / guards[same, lane]
        guards[other, lane] *= (less if less > 0.0 else 0.5) if again and g != RISE else 1.0
        guards[same, lane] = here if fired or guards[same, lane] > 0.0 else guards[same, lane]
    speed = watched[task.watched + SPEED, lane]
    if fired:
        own.long[lane], own.long_speed[lane] = length, speed
    else:
        own.short[lane], own.short_speed[lane] = length, speed
    own.side[lane] = side
    own.trials[lane] += 1.0
    return False


@inlined
def beyond_root(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a step that ends beyond the roots of guards ends at the first of them, by the secant."""
    own, guards = room.lane, room.guards
    length, off = own.length[lane], 0.0
    for g in range(FIRST + task.guards):
        near, far = guards[g, lane], guard(g, lane, 1, task, room)
        if near > 0.0 and not far > 0.0:
            share = far / (far - near)
            off = share if not share <= off else off
    return length >= own.long[lane] or off * (length - own.short[lane]) <= task.root * length


@inlined
def is_flat(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether only an extreme of the speed ends the step, and the speed is flat there to tolerance."""
    watched, end = in_lanes(room.watched), task.watched
    for g in range(FIRST + task.guards):
        if g != RISE and is_crossed(g, lane, task, room):
            return False
    own, near, far = room.lane, room.guards[RISE, lane], guard(RISE, lane, 1, task, room)
    if is_reached(far, own.length[lane] - own.short[lane], lane, room):
        return True
    flat = FLAT * math.sqrt(own.tolerance[lane])
    if abs(watched[end + SLOPE, lane]) > flat * (abs(watched[SLOPE, lane]) + watched[SIZE, lane]):
        return False
    # A top flatter than the parabola through both slopes would be missed by more than `missed_top` says.
    rise = math.copysign(1.0, watched[SLOPE, lane]) * (watched[end + SPEED, lane] - own.short_speed[lane])
    return 6.0 * rise / (own.length[lane] - own.short[lane]) - 2.0 * near - 4.0 * far >= 0.5 * (near - far)


@inlined
def missed_top(lane: int, task: WalkTask, room: Room) -> float:
    """Speed by which a step that ends at an extreme of the speed misses it: twice the height of the parabola there."""
    own, near = room.lane, room.guards[RISE, lane]
    far = guard(RISE, lane, 1, task, room)
    found = own.trials[lane] > 0.0 and near > 0.0 and far < 0.0
    return far * far * (own.length[lane] - own.short[lane]) / (near - far) if found else 0.0


@inlined
def aims_at_kink(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a step passes a kink of the rates; the next trial ends there, by the secant.

    The error estimate may be blind to a kink between two stages. Close to an end of the step it isn't, and the error is
    small.
    """
    own, watched = room.lane, in_lanes(room.watched)
    if not (own.missed[lane] < math.inf and own.trials[lane] == 0.0 and own.aims[lane] < MOST_AIMS):
        return False
    beside = min(NEXT_TO_END, own.tolerance[lane])
    first = math.inf
    for i in range(task.kinks.shape[0]):
        near, far = watched[task.kinks[i], lane], watched[task.watched + task.kinks[i], lane]
        share = near / (near - far) if near * far < 0.0 else math.inf
        first = share if beside < share < min(first, 1.0 - beside) else first
    # A step that is lost in the rounding of its angle never reaches the kink.
    turned = first * own.length[lane] * (abs(room.begin[1, lane]) if task.along_time else 1.0)
    first = first if turned > ROUNDED * abs(own.turned[lane]) else math.inf
    if first < 1.0:
        own.aim[lane] = first * own.length[lane]
        own.aims[lane] += 1.0
    return first < 1.0


@inlined
def switches(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a guard that doesn't end the walk ended a lane's step."""
    if room.lane.trials[lane] > 0.0:
        for g in range(FIRST + task.endings, FIRST + task.guards):
            if is_crossed(g, lane, task, room):
                return True
    return False


@inlined
def switch(lane: int, task: WalkTask, room: Room) -> None:
    """Set a lane's held numbers to their values after the guard that ended its step."""
    watched, numbers, begin = in_lanes(room.watched), in_lanes(room.numbers), room.begin
    first, count = task.first_place + task.places, task.held.shape[0]
    for i in range(count):
        row, value = task.held[i], watched[2 * task.watched - task.guards - count + i, lane]
        if row < first:
            numbers[row, lane] = value
        else:
            begin[row - first, lane] = value
