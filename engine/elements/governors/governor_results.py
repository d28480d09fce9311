"""What is told of a governor and of its engine near equilibrium, with what rounding of all its numbers does to it.

Positions that were searched are kept where they are found and follow each number to first order, so that one rounding
of every number can be tried at the price of a few evaluations.
"""

import math

import numpy as np

from engine.compiling.blocks import lane_of
from engine.compiling.decorators import driver, routine
from engine.cycle.panels.lanes import Memory
from engine.cycle.roots import MOST_TURNS, newton_between
from engine.elements.governors.characteristic import (
    FROM,
    INNER,
    ISOCHRONOUS,
    LEAST_STABLE,
    MARKS,
    MOST_SAMPLES,
    OFF_FROM,
    OFF_LEAST_STABLE,
    OFF_TO,
    OUTER,
    TO,
    WEAKEST,
    stretches,
)
from engine.elements.governors.places import (
    BALL,
    CHANGE,
    DAMPING,
    FRICTION,
    GREATEST,
    INERTIA,
    LEAST,
    LOAD,
    NEW_LOAD,
    NUMBERS,
    RATIO,
    SELF_REGULATION,
    SLEEVE,
    SWITCH,
    Throttling,
    held_at,
    linkage_at,
    margin_at,
    throttle_at,
)
from engine.laws.governors.equilibrium import (
    controlling_force,
    equilibrium_speed,
    insensitivity_by_friction,
    moving_inertia,
    sleeve_equivalent,
    sleeve_stiffness,
    speed_with_friction,
    stability_margin,
)
from engine.laws.governors.stability import (
    critical_damping_of_sleeve,
    critical_inertia_of_engine,
    governed_polynomial,
    most_gain,
    normal_roots,
    oscillates,
    vyshnegradsky,
)
from engine.laws.rounding import EPS, NUDGE
from engine.verdicts import Verdict

_NONE, _FULL_AND_SHUT = int(Throttling.NONE), int(Throttling.FULL_AND_SHUT)
_OK, _OUTSIDE = int(Verdict.OK), int(Verdict.OUTSIDE_LIMITS)
_STALLS, _RUNS_AWAY = int(Verdict.STALLS), int(Verdict.RUNS_AWAY)
# Newton's method takes a handful of them, halving of the bracket one for each bit.
_ROUNDS = 100

# Rows of results, in the order of the names in `engine.elements.governors.governor_columns`.
(
    INNER_SPEED,
    OUTER_SPEED,
    INNER_FORCE,
    OUTER_FORCE,
    STABLE_FROM,
    STABLE_TO,
    LEAST_SPEED,
    GREATEST_SPEED,
    MEAN_SPEED,
    NON_UNIFORMITY,
    LEAST_STABILITY,
    LEAST_STABILITY_RADIUS,
    IS_ISOCHRONOUS,
    SLEEVE_LIFT,
    INSENSITIVITY,
    LEAST_WITH_FRICTION,
    GREATEST_WITH_FRICTION,
    SLEEVE_FORCE,
    EFFORT,
    POWER,
) = range(20)
STATICS = 20
(
    WORKING_LIFT,
    WORKING_SPEED,
    SPEED_CHANGE,
    VYSHNEGRADSKY_X,
    VYSHNEGRADSKY_Y,
    IS_STABLE,
    GAIN_MARGIN,
    CRITICAL_DAMPING,
    CRITICAL_INERTIA,
    DECAY,
    HUNTING_FREQUENCY,
    DOES_OSCILLATE,
) = range(STATICS, STATICS + 12)
WITH_ENGINE = STATICS + 12
# What `find_equilibria` keeps beside marks: positions in the middle of the lift and at both loads, the mean speed.
MIDDLE, BEFORE, AFTER, MEAN_KEPT = MARKS, MARKS + 1, MARKS + 2, MARKS + 3
KEPT = MARKS + 4
# Numbers that `find_equilibria` needs room for.
ROOM = MOST_SAMPLES + WITH_ENGINE + NUMBERS


@routine
def moved_to_radius(kind: int, p: Memory, x: float, radius: float) -> float:
    """Position near x at which the balls have a radius, to first order."""
    link = linkage_at(kind, p, x)
    return x - (link[0] - radius) / link[1]


@routine
def moved_to_lift(kind: int, p: Memory, x: float, height: float) -> float:
    """Position near x at which the sleeve has a height, to first order."""
    link = linkage_at(kind, p, x)
    return x - (link[5] - height) / link[6]


@routine
def middle_of_lift(kind: int, p: Memory, low: float, high: float) -> float:
    """Position halfway up the lift between two positions."""
    half = 0.5 * (linkage_at(kind, p, low)[5] + linkage_at(kind, p, high)[5])
    x = 0.5 * (low + high)
    for _ in range(MOST_TURNS):
        link = linkage_at(kind, p, x)
        x, low, high, settled = newton_between(x, link[5] - half, link[6], True, low, high)
        if settled:
            break
    return x


@routine
def equilibrium_at(
    kind: int, p: Memory, memory: Memory, x: float, zero: float
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """A governor in equilibrium at a position.

    Parameters
    ----------
    kind : int
    p : Memory (NUMBERS,)
    memory : Memory
    x, zero : float
        Position, and height of the sleeve at the inner stop [m].

    Returns
    -------
    tuple of 10 floats
        Radius, lift [m], controlling force [N], speed of the spindle [rad/s], force at the sleeve [N], stability
        margin, z', mass of the sleeve [kg], its stiffness at constant speed [N/m], inertia of the balls about the
        axis [kg·m²].
    """
    link = linkage_at(kind, p, x)
    r, r1, r2, h1, _, z, z1, _ = link
    slope, curvature, _ = held_at(kind, p, memory, x, link, zero)
    force, sleeve = controlling_force(slope, r1), sleeve_equivalent(slope, z1)
    margin = stability_margin(r, r1, r2, slope, curvature)
    return (
        r,
        z - zero,
        force,
        equilibrium_speed(force, p[BALL], r),
        sleeve,
        margin,
        z1,
        moving_inertia(p[BALL], p[SLEEVE], r1, h1, z1) / (z1 * z1),
        sleeve_stiffness(sleeve, margin, r, r1, z1),
        2.0 * p[BALL] * r * r,
    )


@routine
def moved_to_load(
    throttle: int,
    p: Memory,
    memory: Memory,
    offset: float,
    x: float,
    state: tuple,
    whole: float,
    mean_speed: float,
    load: float,
) -> float:
    """Position near x at which the engine carries a load, or its valve switches, to first order.

    Parameters
    ----------
    throttle : int
        `Throttling`.
    p : Memory (NUMBERS,)
    memory : Memory
    offset : float
        Where the throttle's table begins in it.
    x : float
        [m]
    state : tuple of 10 floats
        `equilibrium_at` it.
    whole, mean_speed, load : float
        Lift between the stops [m], mean speed of the spindle [rad/s], load [N·m].
    """
    _, lift, _, speed, force, _, lift_rate, _, stiffness, _ = state
    if throttle == _FULL_AND_SHUT:
        return x + (p[SWITCH] - lift) / lift_rate
    moment, fall = throttle_at(throttle, p, memory, offset, lift, whole)
    left = moment - p[SELF_REGULATION] * (speed - mean_speed) / p[RATIO] - load
    # At equilibrium a lift dz goes with a speed dω = ω c dz/(2 E).
    slope = fall + p[SELF_REGULATION] / p[RATIO] * speed * stiffness / (2.0 * force)
    return x + left / (slope * lift_rate) if slope > 0.0 else x


@routine
def working_position(
    kind: int,
    throttle: int,
    p: Memory,
    memory: Memory,
    offset: float,
    kept: Memory,
    whole: float,
    mean_speed: float,
    load: float,
) -> tuple[float, int]:
    """Position in the stable stretch at which the engine carries a load, and the verdict on it.

    Parameters
    ----------
    kind, throttle : int
        `Holding`, `Throttling`.
    p : Memory (NUMBERS,)
    memory : Memory
    offset : float
        Where the throttle's table begins in it.
    kept : Memory (KEPT,)
        Positions.
    whole, mean_speed, load : float
        Lift between the stops [m], mean speed of the spindle [rad/s], load [N·m].

    Returns
    -------
    position : float
        [m]; of a valve that is open or shut that of its switch.
    verdict : int
        OK; STALLS or RUNS_AWAY where the governor can't give as much or as little; OUTSIDE_LIMITS for a switch that
        the sleeve doesn't reach.
    """
    zero = linkage_at(kind, p, kept[INNER])[5]
    low, high = kept[FROM], kept[TO]
    switches = throttle == _FULL_AND_SHUT
    begin, end = equilibrium_at(kind, p, memory, low, zero), equilibrium_at(kind, p, memory, high, zero)
    if switches and not begin[1] < p[SWITCH] < end[1]:
        return math.nan, _OUTSIDE
    most = throttle_at(throttle, p, memory, offset, begin[1], whole)[0]
    least = throttle_at(throttle, p, memory, offset, end[1], whole)[0]
    regulation = p[SELF_REGULATION] / p[RATIO]
    if not load <= most - regulation * (begin[3] - mean_speed):
        return math.nan, _STALLS
    if not load >= least - regulation * (end[3] - mean_speed):
        return math.nan, _RUNS_AWAY
    x = 0.5 * (low + high)
    for _ in range(_ROUNDS):
        state = equilibrium_at(kind, p, memory, x, zero)
        moment = throttle_at(throttle, p, memory, offset, state[1], whole)[0]
        lower = state[1] <= p[SWITCH] if switches else moment - regulation * (state[3] - mean_speed) > load
        if lower:
            low = x
        else:
            high = x
        following = moved_to_load(throttle, p, memory, offset, x, state, whole, mean_speed, load)
        following = following if low < following < high else 0.5 * (low + high)
        done = abs(following - x) <= EPS * abs(x)
        x = following
        if done:
            break
    return x, _OK


@routine
def near_equilibrium(
    kind: int,
    throttle: int,
    p: Memory,
    memory: Memory,
    offset: float,
    kept: Memory,
    found: Memory,
) -> None:
    """Write all results of a variant whose positions are known, to first order in the change of its numbers.

    Parameters
    ----------
    kind, throttle : int
        `Holding`, `Throttling`.
    p : Memory (NUMBERS,)
    memory : Memory
    offset : float
        Where the throttle's table begins in it.
    kept : Memory (KEPT,)
        Positions.
    found : Memory (results,)
        To be written to.
    """
    low, high = moved_to_radius(kind, p, kept[INNER], p[LEAST]), moved_to_radius(kind, p, kept[OUTER], p[GREATEST])
    zero = linkage_at(kind, p, low)[5]
    inner, outer = equilibrium_at(kind, p, memory, low, zero), equilibrium_at(kind, p, memory, high, zero)
    begin = inner if kept[FROM] == kept[INNER] else equilibrium_at(kind, p, memory, kept[FROM], zero)
    end = outer if kept[TO] == kept[OUTER] else equilibrium_at(kind, p, memory, kept[TO], zero)
    whole, least, greatest = outer[1], begin[3], end[3]
    mean = 0.5 * (least + greatest)
    found[INNER_FORCE], found[INNER_SPEED] = inner[2], inner[3]
    found[OUTER_FORCE], found[OUTER_SPEED], found[SLEEVE_LIFT] = outer[2], outer[3], whole
    found[STABLE_FROM], found[STABLE_TO] = begin[0], end[0]
    found[LEAST_SPEED], found[GREATEST_SPEED] = least, greatest
    found[MEAN_SPEED], found[NON_UNIFORMITY] = mean, (greatest - least) / mean
    place = kept[LEAST_STABLE]
    shaky = inner if place == kept[INNER] else outer
    if kept[INNER] < place < kept[OUTER]:
        shaky = equilibrium_at(kind, p, memory, place, zero)
    found[LEAST_STABILITY], found[LEAST_STABILITY_RADIUS] = shaky[5], shaky[0]
    found[IS_ISOCHRONOUS] = kept[ISOCHRONOUS]
    place = kept[WEAKEST]
    weak = begin if place == kept[FROM] else end
    if kept[FROM] < place < kept[TO]:
        weak = equilibrium_at(kind, p, memory, place, zero)
    found[INSENSITIVITY] = insensitivity_by_friction(p[FRICTION], weak[4])
    found[LEAST_WITH_FRICTION] = speed_with_friction(least, -p[FRICTION], begin[4])
    found[GREATEST_WITH_FRICTION] = speed_with_friction(greatest, p[FRICTION], end[4])
    place = moved_to_lift(kind, p, kept[MIDDLE], zero + 0.5 * (begin[1] + end[1]))
    half = equilibrium_at(kind, p, memory, place, zero)
    found[SLEEVE_FORCE], found[EFFORT] = half[4], p[CHANGE] * half[4]
    found[POWER] = 2.0 * found[EFFORT] * found[EFFORT] / half[8]
    if throttle == _NONE:
        return
    state = equilibrium_at(kind, p, memory, kept[BEFORE], zero)
    place = moved_to_load(throttle, p, memory, offset, kept[BEFORE], state, whole, mean, p[LOAD])
    before = equilibrium_at(kind, p, memory, place, zero)
    state = equilibrium_at(kind, p, memory, kept[AFTER], zero)
    place = moved_to_load(throttle, p, memory, offset, kept[AFTER], state, whole, mean, p[NEW_LOAD])
    _, lift, _, speed, force, _, _, mass, stiffness, balls = equilibrium_at(kind, p, memory, place, zero)
    ratio, s, b = p[RATIO], p[SELF_REGULATION], p[DAMPING]
    found[WORKING_LIFT], found[WORKING_SPEED] = lift, speed / ratio
    found[SPEED_CHANGE] = (speed - before[3]) / ratio
    if throttle == _FULL_AND_SHUT:
        for k in range(VYSHNEGRADSKY_X, WITH_ENGINE):
            found[k] = math.nan
        found[IS_STABLE], found[DOES_OSCILLATE] = 0.0, 1.0
        return
    gain = throttle_at(throttle, p, memory, offset, lift, whole)[1]
    inertia, pull = p[INERTIA] + ratio * ratio * balls, 2.0 * force * ratio / speed
    a3, a2, a1, a0 = governed_polynomial(inertia, mass, b, stiffness, s, gain, pull)
    x, y, time = vyshnegradsky(a3, a2, a1, a0)
    real, middle, square = normal_roots(x, y)
    found[VYSHNEGRADSKY_X], found[VYSHNEGRADSKY_Y] = x, y
    found[IS_STABLE] = 1.0 if x * y > 1.0 else 0.0
    found[GAIN_MARGIN] = most_gain(inertia, mass, b, stiffness, s, pull) / gain
    found[CRITICAL_DAMPING] = critical_damping_of_sleeve(inertia, mass, stiffness, s, gain, pull)
    wheel = critical_inertia_of_engine(mass, b, stiffness, s, gain, pull)
    found[CRITICAL_INERTIA] = max(wheel - ratio * ratio * balls, 0.0)
    slowest = max(real, middle + math.sqrt(max(square, 0.0)))
    found[DECAY] = -slowest / time
    found[HUNTING_FREQUENCY] = math.sqrt(max(-square, 0.0)) / time
    found[DOES_OSCILLATE] = 1.0 if oscillates(x, y) else 0.0


@driver
def find_equilibria(
    kind: int,
    throttle: int,
    numbers: np.ndarray,
    memory: np.ndarray,
    offset: float,
    found: np.ndarray,
    sizes: np.ndarray,
    kept: np.ndarray,
    verdicts: np.ndarray,
    room: np.ndarray,
) -> None:
    """All results of a set of variants near equilibrium.

    Parameters
    ----------
    kind, throttle : int
        `Holding`, `Throttling`.
    numbers : ndarray (variants, NUMBERS)
    memory : ndarray
        Tables.
    offset : float
        Where the throttle's table begins in it.
    found, sizes : ndarray (variants, results)
        Of NaN, to be written to: results, and the magnitudes whose rounding they carry.
    kept : ndarray (variants, KEPT)
        Of NaN, to be written to: positions.
    verdicts : ndarray (variants,) of uint8
        To be written to.
    room : ndarray (ROOM,)
    """
    results, tables = found.shape[1], lane_of(memory)
    places, moved, p = lane_of(room), lane_of(room[MOST_SAMPLES:]), lane_of(room[MOST_SAMPLES + WITH_ENGINE :])
    for v in range(numbers.shape[0]):
        for i in range(NUMBERS):
            p[i] = numbers[v, i]
        marks, values, carried = lane_of(kept[v]), lane_of(found[v]), lane_of(sizes[v])
        verdict = stretches(kind, p, tables, marks, places)
        if verdict == _OK:
            marks[MIDDLE] = middle_of_lift(kind, p, marks[FROM], marks[TO])
            if throttle != _NONE:
                verdict = mark_loads(kind, throttle, p, tables, offset, marks)
        verdicts[v] = verdict
        if verdict != _OK:
            continue
        near_equilibrium(kind, throttle, p, tables, offset, marks, values)
        for k in range(results):
            carried[k] = abs(values[k])
        for i in range(NUMBERS):
            if p[i] != 0.0:
                p[i] *= 1.0 + NUDGE
                near_equilibrium(kind, throttle, p, tables, offset, marks, moved)
                p[i] = numbers[v, i]
                for k in range(results):
                    carried[k] += abs(moved[k] - values[k]) / NUDGE
        add_rounding(kind, throttle, p, tables, marks, values, carried)


@routine
def mark_loads(kind: int, throttle: int, p: Memory, memory: Memory, offset: float, kept: Memory) -> int:
    """Mark the positions at both loads; the verdict on them."""
    zero = linkage_at(kind, p, kept[INNER])[5]
    whole = linkage_at(kind, p, kept[OUTER])[5] - zero
    mean = 0.5 * (
        equilibrium_at(kind, p, memory, kept[FROM], zero)[3] + equilibrium_at(kind, p, memory, kept[TO], zero)[3]
    )
    kept[MEAN_KEPT] = mean
    kept[BEFORE], verdict = working_position(kind, throttle, p, memory, offset, kept, whole, mean, p[LOAD])
    if verdict == _OK:
        kept[AFTER], verdict = working_position(kind, throttle, p, memory, offset, kept, whole, mean, p[NEW_LOAD])
    return verdict


@routine
def add_rounding(
    kind: int, throttle: int, p: Memory, memory: Memory, kept: Memory, found: Memory, sizes: Memory
) -> None:
    """Add what differences lose, and what places that were searched are off."""
    zero = linkage_at(kind, p, kept[INNER])[5]
    sizes[NON_UNIFORMITY] += 2.0
    sizes[SLEEVE_LIFT] += 2.0 * abs(zero)
    margin = margin_at(kind, p, memory, kept[LEAST_STABLE], zero)
    sizes[LEAST_STABILITY] += margin[1] / EPS
    sizes[LEAST_STABILITY_RADIUS] += kept[OFF_LEAST_STABLE] / EPS
    sizes[STABLE_FROM] += kept[OFF_FROM] / EPS
    sizes[STABLE_TO] += kept[OFF_TO] / EPS
    if throttle != _NONE:
        sizes[SPEED_CHANGE] += 2.0 * found[WORKING_SPEED]
        sizes[WORKING_LIFT] += 2.0 * abs(zero)
