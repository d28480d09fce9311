"""Error estimate of a step, the length of the next one, and the propagation of earlier errors."""

import math

from engine.compiling.blocks import LANES, in_lanes
from engine.compiling.decorators import inlined, routine
from engine.laws.elementary import exponential
from engine.laws.rounding import EPS
from engine.stepping.steps.stage_rates import FOUND_TO
from engine.stepping.steps.step_lanes import RESPONSES, SIZE, SLOPE, STEEPNESS, Room
from engine.stepping.walk_task import LOST, STEEP, WalkTask

SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# An implicit method pays where |h ∂f/∂y| limits explicit steps to less than this fraction of the longest step.
WORTH_SOLVING = 0.05
# The real eigenvalue of the matrix of Radau's method with five stages is 0.159; 1/4 of it filters error estimates.
OWN_SHARE = 0.25 * 0.159
# Errors below this fraction of a state are rounding; so is a distance to an edge.
ROUNDED = 4.0 * EPS
# A step error below NOISE is rounding (of torques in balance, say) if a shorter step leaves at least the fraction FALLS
# of it. It then counts as the fraction FORGIVEN of the tolerance, so that steps grow again.
NOISE, FALLS, FORGIVEN = 1e-11, 0.5, 0.05
# Number of states with the speeds of two sides, states 1 and 3. Below this fraction of the other's speed, a side is
# practically at rest: its errors are judged as at that speed.
SIDES, NEARLY_AT_REST = 4, 1e-9
# A step along time is rejected if it turns by more than this multiple of the largest permitted angle.
TOO_FAR = 2.0
# Steps below this fraction of the distance covered fail; at the start along time, of LEAST_TIME [s].
SHORTEST, LEAST_TIME = 1e-13, 1e-7


@routine
def judge_steps(task: WalkTask, room: Room) -> None:
    """Error estimate of the step relative to the tolerance.

    Along the angle, the scales are the maximum work of a step and the time of a cycle; along time, those of the system,
    or the angle turned in the step, and the speed or its change.
    """
    own, k, begin = room.lane, in_lanes(room.rates), room.begin
    after, errors, width = room.after, room.errors, task.width
    cycle = task.cycle if task.cycle < math.inf else math.tau
    watched, count = in_lanes(room.watched), task.watched
    rounded = max(ROUNDED, 4.0 * FOUND_TO if task.implicit else 0.0)
    for lane in range(LANES):
        own.missed[lane] = 0.0
    judged = task.states if task.along_time else task.states + 1
    for lane in range(LANES if task.implicit and not task.along_time else 0):
        # A steep motor damps an implicit step's error. Source: E. Hairer and G. Wanner, Solving Ordinary
        # Differential Equations II, section IV.8.
        fades = -own.length[lane] * watched[count + STEEPNESS, lane]
        errors[0, lane] /= 1.0 + (OWN_SHARE * fades if fades > 0.0 else 0.0)
    for q in range(0 if task.fixed else judged):
        if not task.along_time and q == 0:
            for lane in range(LANES):
                size = (
                    watched[SIZE, lane]
                    if watched[SIZE, lane] > watched[count + SIZE, lane]
                    else watched[count + SIZE, lane]
                )
                size *= own.length[lane]
                # A rejected step says nothing about the work of accepted ones.
                own.work[lane] = size if size > own.scale[lane] else own.scale[lane]
                own.size[lane] = own.work[lane]
        elif not task.along_time:
            for lane in range(LANES):
                # Scale of the time: one cycle at this speed.
                own.size[lane] = cycle * k[q, lane]
        elif task.scales >= 0:
            for lane in range(LANES):
                own.size[lane] = watched[task.scales + q, lane]
        else:
            for lane in range(LANES):
                own.size[lane] = abs(begin[q, lane]) if q % 2 == 1 or task.signed else 0.0
                own.size[lane] = (
                    own.size[lane] if own.size[lane] > own.floor[lane] or not task.signed else own.floor[lane]
                )
            for lane in range(LANES if task.states == SIDES and not task.signed else 0):
                # The torques that start a side from balance are as small as their rounding.
                slow = NEARLY_AT_REST * abs(begin[SIDES - (q | 1), lane])
                slow *= 1.0 if q % 2 == 1 else own.length[lane]
                own.size[lane] = slow if slow > own.size[lane] else own.size[lane]
            for s in range(task.stages):
                for lane in range(LANES):
                    made = abs(own.length[lane] * k[s * width + q, lane])
                    own.size[lane] = made if made > own.size[lane] else own.size[lane]
        for lane in range(LANES):
            off = abs(errors[q, lane]) / (own.tolerance[lane] * own.size[lane] + rounded * abs(begin[q, lane]))
            # A state at rest has no error, and no scale either.
            off = off if errors[q, lane] != 0.0 else 0.0
            own.missed[lane] = off if off > own.missed[lane] or off != off else own.missed[lane]
    for q in range(width):
        for lane in range(LANES):
            own.missed[lane] = own.missed[lane] if abs(after[q, lane]) < math.inf else math.inf
    for lane in range(LANES if task.along_time else 0):
        # Beyond this angle the error estimate is blind.
        far = abs(after[0, lane] - begin[0, lane]) > TOO_FAR * own.farthest[lane]
        own.missed[lane] = math.inf if far else own.missed[lane]
    for q in range(1, task.states if task.along_time and not task.signed else 0, 2):
        for lane in range(LANES):
            # A side that starts from rest can't return to rest within a step.
            back = begin[q, lane] <= 0.0 and after[q, lane] <= 0.0 and k[q, lane] != 0.0
            own.missed[lane] = math.inf if back else own.missed[lane]
    for lane in range(LANES):
        steep, end = abs(own.length[lane] * watched[STEEPNESS, lane]) > task.steepest, watched[count + SLOPE, lane]
        sound = own.missed[lane] == own.missed[lane] and end == end
        sound = sound and not (steep and not (task.fixed or task.implicit))
        own.missed[lane] = own.missed[lane] if sound else math.inf


@inlined
def is_rounding(lane: int, room: Room) -> bool:
    """Whether a step's error is rounding: below NOISE, and at least FALLS times that of the step rejected before."""
    own = room.lane
    before, own.refused[lane] = own.refused[lane], own.missed[lane]
    rounding = own.missed[lane] * own.tolerance[lane] <= NOISE and own.missed[lane] >= FALLS * before
    if rounding:
        own.missed[lane] = FORGIVEN
    return rounding


@inlined
def is_short(length: float, lane: int, task: WalkTask, room: Room) -> bool:
    """Whether an implicit step pays: a step turns by little; without a limit of the angle, the last one was exact."""
    own = room.lane
    turns = length * abs(room.begin[1, lane]) if task.along_time else length
    return turns < WORTH_SOLVING * own.farthest[lane] if own.farthest[lane] < math.inf else own.exact[lane] > 0.0


@inlined
def shorten(lane: int, task: WalkTask, room: Room) -> None:
    """Choose a shorter step in a lane with too large an error; the lane is lost below the minimum length."""
    own, watched = room.lane, in_lanes(room.watched)
    length, share = own.length[lane], SHRINK
    if own.missed[lane] < math.inf:
        share = SAFETY / math.sqrt(math.sqrt(math.sqrt(own.missed[lane])))
        share = share if share > SHRINK else SHRINK
    fades = 0.0 if task.implicit else abs(length * watched[STEEPNESS, lane])
    steepest = task.steepest
    if fades > steepest:
        share = max(SHRINK, SAFETY * steepest / fades)
    own.pace[lane], own.trials[lane] = length * share, 0.0
    least = SHORTEST * (abs(own.at[lane]) + (LEAST_TIME if task.along_time else own.farthest[lane]))
    worth_solving = fades > steepest and task.solved > 0 and is_short(length * share, lane, task, room)
    if worth_solving or not length * share > least:
        own.why[lane] = STEEP if fades > steepest and task.solved > 0 else LOST


@inlined
def energy_beside(lane: int, task: WalkTask, room: Room) -> float:
    """Change of ½Iω² at constant speed from an edge that ends a step to the angle at which its inertia is evaluated.

    ½ω²·dI/dφ is the rate of the energy over the angle less I ω dω/dφ.
    """
    rate = in_lanes(room.rates)[(task.stages - 1) * task.width, lane]
    return room.lane.ahead[lane] * abs(rate - in_lanes(room.watched)[task.watched + SLOPE, lane])


@routine
def carry_errors(task: WalkTask, room: Room) -> None:
    """Propagate the error estimates of the energy and the integrals over the step, and add those of the step.

    An error of the energy grows or fades as neighbouring motions diverge or converge, by exp ∫∂M/∂E dφ; those of the
    integrals follow by their derivatives. Every step adds rounding, and at an edge the change of the rates up to where
    they are evaluated. All are magnitudes, so none cancel. Source: E. Hairer, S. P. Nørsett and G. Wanner, Solving
    Ordinary Differential Equations I, section I.14.
    """
    own, watched, k = room.lane, in_lanes(room.watched), in_lanes(room.rates)
    carried_errors, errors, begin, end = (
        room.carried_errors,
        room.errors,
        room.begin,
        task.watched,
    )
    width, last = task.width, (task.stages - 1) * task.width
    for q in range(width):
        for lane in range(LANES):
            behind = own.behind[lane] * abs(k[width + q, lane] - k[q, lane])
            ahead = own.ahead[lane] * abs(k[last + q, lane] - k[last - width + q, lane])
            errors[q, lane] = abs(errors[q, lane]) + behind + ahead
    most, rounded = (-3.0, 4.0 * FOUND_TO) if task.implicit else (-1.0, 0.25 * EPS)
    for lane in range(LANES):
        # A steep motor holds the speed that follows from the energy and the inertia at this angle next to the edge.
        fades = abs(own.length[lane] * watched[end + STEEPNESS, lane])
        errors[0, lane] += energy_beside(lane, task, room) * (fades if fades < 1.0 else 1.0)
        grows = 0.5 * own.length[lane] * (watched[STEEPNESS, lane] + watched[end + STEEPNESS, lane])
        # A step damps an error no more than its method does.
        grows = grows if grows > most else most
        own.carried_error[lane] = carried_errors[0, lane]
        step = errors[0, lane] + rounded * begin[0, lane]
        after = own.carried_error[lane] * exponential(grows) + step
        carried_errors[0, lane] = after if own.taken[lane] > 0.0 else carried_errors[0, lane]
    for q in range(1, task.width):
        row = RESPONSES + q - 1
        for lane in range(LANES):
            follows = (
                abs(watched[row, lane]) * own.carried_error[lane]
                + abs(watched[end + row, lane]) * carried_errors[0, lane]
            )
            more = carried_errors[q, lane] + 0.5 * own.length[lane] * follows + errors[q, lane]
            carried_errors[q, lane] = more if own.taken[lane] > 0.0 else carried_errors[q, lane]
