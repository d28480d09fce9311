"""What a change of load does: the motion of a governor and its engine, compiled, one variant after another.

The motion is cut where it isn't smooth: where friction stops the sleeve or lets it go, at the stops, which take all of
its velocity, where a valve switches. Between cuts it is followed by the method of Dormand and Prince of order five with
its embedded error; with the sleeve held, the speed has a closed form. Every extreme of the speed ends a step, so that
within a step the speed rises or falls. Error figures come from a second run with a hundred times the tolerance, and
with every second position of the curves where the engine is a mechanism.

Source of the method: J. R. Dormand and P. J. Prince, A family of embedded Runge–Kutta formulae, J. Comput. Appl. Math.
6 (1980); E. Hairer, S. P. Nørsett and G. Wanner, Solving Ordinary Differential Equations I, table II.5.2.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import lane_of
from engine.compiling.decorators import driver, inlined, routine
from engine.cycle.panels.lanes import Memory
from engine.elements.governors.places import (
    AFTER,
    BALL,
    BAND,
    BEFORE,
    CLOSED,
    CYCLE_LENGTH,
    CYCLE_POSITIONS,
    DAMPING,
    DURATION,
    FRICTION,
    FULL,
    INERTIA,
    INNER,
    LOAD,
    MEAN_KEPT,
    MIDDLE,
    NEW_LOAD,
    NUMBERS,
    OUTER,
    RATIO,
    SELF_REGULATION,
    SLEEVE,
    SWITCH,
    Throttling,
    equilibrium_at,
    held_at,
    linkage_at,
    throttle_at,
)
from engine.laws.governors.equilibrium import moving_inertia
from engine.laws.governors.motion import (
    engine_acceleration,
    governor_acceleration,
    moving_inertia_rate,
    speed_after,
    time_to_speed,
)
from engine.words.verdicts import Verdict

State = tuple[float, float, float, float]


class Governed(NamedTuple):
    """An engine with its governor.

    Attributes
    ----------
    kind, throttle : int
        `Holding`, `Throttling`.
    p : Memory (NUMBERS,)
        With curves of a mechanism behind, where the engine is one.
    memory : Memory
    offset : float
        Where the throttle's table begins in it.
    """

    kind: int
    throttle: int
    p: Memory
    memory: Memory
    offset: float


class Followed(NamedTuple):
    """What is written of a set of variants, and what it begins from.

    Attributes
    ----------
    answers, coarse : ndarray (variants, ANSWERS)
        Of NaN, to be written to, with the tolerances FINE and COARSE.
    kept : ndarray (variants, 6)
        INNER to MEAN_KEPT.
    verdicts : ndarray (variants,) of uint8
        Those without a complaint are followed.
    """

    answers: np.ndarray
    coarse: np.ndarray
    kept: np.ndarray
    verdicts: np.ndarray


_OK, _STALLS, _NO_END = int(Verdict.OK), int(Verdict.STALLS), int(Verdict.NO_END)
_NOT_FINITE = int(Verdict.NOT_FINITE)
_FULL_AND_SHUT = int(Throttling.FULL_AND_SHUT)

# Weights of stages 2 to 7 by those before; the last are those of the step itself.
_A = (
    (1 / 5,),
    (3 / 40, 9 / 40),
    (44 / 45, -56 / 15, 32 / 9),
    (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
    (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
    (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
)
_A2, _A3, _A4, _A5, _A6, _A7 = _A
# Weights of order five less those of order four.
_E = (71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40)

FINE, COARSE = 1e-8, 1e-6
# Of a share of the speed so great errors are judged: governors work within a few hundredths.
_SPEED_SCALE = 0.01
MOST_STEPS = 100_000
# The last part of a run, in which the swing is measured.
LAST_PART = 0.75
_ROUNDS = 60
# To so small a share of a step an event is located, and an extreme, which is flat.
_LOCATED, _EXTREME_LOCATED = 1e-12, 1e-6

# A state is a tuple of position [m], its rate [m/s], the speed of the engine [rad/s] and its angle [rad].
# What stays the same in a step: height of the sleeve at the inner stop, lift between the stops, mean speed of the
# spindle, load, sense of the sleeve's motion (0 without friction), whether a valve is open, whether the sleeve rests,
# length of the mechanism's cycle (0 without one), which of the positions of its curves are used: each, or every second.
ZERO, WHOLE, MEAN, NOW, SENSE, OPEN, RESTS, CYCLE, STRIDE = range(9)
# What is watched.
REVERSAL, AT_INNER, AT_OUTER, SWITCHES, EXTREME, LEAVES_BAND, RISES, FALLS = range(8)
# Answers of a run.
HIGHEST, LOWEST, OVERSHOOT, SETTLING_TIME, HUNTING, INNER_HITS, OUTER_HITS = range(7)
ANSWERS = 7
# Numbers that `follow_changes` needs room for.
MOTION_ROOM = 19


@routine
def cycle_at(p: Memory, held: Memory, angle: float) -> tuple[float, float, float, float]:
    """Curves of the engine's mechanism at a crank angle, by cubics through four neighbours.

    Parameters
    ----------
    p : Memory (NUMBERS + CURVES · CYCLE_POSITIONS,)
    held : Memory (9,)
    angle : float
        [rad]

    Returns
    -------
    tuple of 4 floats
        Reduced inertia beside its mean [kg·m²], its derivative by the angle, the driving moment over its mean, and what
        else acts, without its mean [N·m]; 0, 0, 1, 0 of an engine without a mechanism.
    """
    if held[CYCLE] == 0.0:
        return 0.0, 0.0, 1.0, 0.0
    stride = int(held[STRIDE])
    count = CYCLE_POSITIONS // stride
    place = angle / held[CYCLE]
    place = (place - math.floor(place)) * count
    first = int(place)
    t = place - first
    first = first % count
    before = (first + count - 1) % count * stride
    here, after, beyond = first * stride, (first + 1) % count * stride, (first + 2) % count * stride
    a, b = -t * (t - 1.0) * (t - 2.0) / 6.0, (t * t - 1.0) * (t - 2.0) / 2.0
    c, d = -t * (t + 1.0) * (t - 2.0) / 2.0, t * (t * t - 1.0) / 6.0
    k, n = NUMBERS, CYCLE_POSITIONS
    return (
        a * p[k + before] + b * p[k + here] + c * p[k + after] + d * p[k + beyond],
        a * p[k + n + before] + b * p[k + n + here] + c * p[k + n + after] + d * p[k + n + beyond],
        a * p[k + 2 * n + before] + b * p[k + 2 * n + here] + c * p[k + 2 * n + after] + d * p[k + 2 * n + beyond],
        a * p[k + 3 * n + before] + b * p[k + 3 * n + here] + c * p[k + 3 * n + after] + d * p[k + 3 * n + beyond],
    )


@inlined
def moment_at(engine: Governed, held: Memory, lift: float, speed: float, driving: float) -> float:
    """M_d − M_c at a lift and a speed of the engine [N·m], with M_d over its mean at the crank's angle."""
    p = engine.p
    if engine.throttle == _FULL_AND_SHUT:
        given = p[FULL] if held[OPEN] > 0.0 else p[CLOSED]
    else:
        given = throttle_at(engine.throttle, p, engine.memory, engine.offset, lift, held[WHOLE])[0]
    return given * driving - p[SELF_REGULATION] * (speed - held[MEAN] / p[RATIO]) - held[NOW]


@routine
def rates_at(engine: Governed, held: Memory, y: State) -> State:
    """Rates of a state.

    Parameters
    ----------
    engine : Governed
    held : Memory (9,)
        What stays the same.
    y : tuple of 4 floats
    """
    x, velocity, speed, angle = y
    p = engine.p
    link = linkage_at(engine.kind, p, x)
    r, r1, r2, h1, h2, z, z1, z2 = link
    square = p[RATIO] * p[RATIO]
    whirl_rate = 4.0 * p[BALL] * r * r1
    change, slope, driving, other = cycle_at(p, held, angle)
    moment = moment_at(engine, held, z - held[ZERO], speed, driving)
    moment += other - 0.5 * slope * speed * speed
    whole = p[INERTIA] + change + square * 2.0 * p[BALL] * r * r
    turning = engine_acceleration(moment, whole, square * whirl_rate, velocity, speed)
    if held[RESTS] > 0.0:
        return 0.0, 0.0, turning, speed
    held_by, _, _ = held_at(engine.kind, p, engine.memory, x, link, held[ZERO])
    hindered = z1 * (p[DAMPING] * z1 * velocity + p[FRICTION] * held[SENSE])
    pull = 0.5 * square * speed * speed * whirl_rate - held_by - hindered
    inertia = moving_inertia(p[BALL], p[SLEEVE], r1, h1, z1)
    inertia_rate = moving_inertia_rate(p[BALL], p[SLEEVE], r1, r2, h1, h2, z1, z2)
    return velocity, governor_acceleration(pull, inertia, inertia_rate, velocity), turning, speed


@inlined
def plus(y: State, share: float, rates: State) -> State:
    """A state, and a share of rates added to it."""
    return y[0] + share * rates[0], y[1] + share * rates[1], y[2] + share * rates[2], y[3] + share * rates[3]


@routine
def governor_step(
    engine: Governed, held: Memory, scales: Memory, y: State, h: float
) -> tuple[State, float, float, float]:
    """A step of Dormand's and Prince's method.

    Parameters
    ----------
    engine, held
        As for `rates_at`.
    scales : Memory (3,)
        What errors are measured by.
    y : tuple of 4 floats
    h : float
        [s]

    Returns
    -------
    end : tuple of 3 floats
        State after it.
    error : float
        In units of the scales.
    first, last : float
        Rate of the speed before and after.
    """
    k1 = rates_at(engine, held, y)
    k2 = rates_at(engine, held, plus(y, h * _A2[0], k1))
    at = plus(plus(y, h * _A3[0], k1), h * _A3[1], k2)
    k3 = rates_at(engine, held, at)
    at = plus(plus(plus(y, h * _A4[0], k1), h * _A4[1], k2), h * _A4[2], k3)
    k4 = rates_at(engine, held, at)
    at = plus(plus(plus(plus(y, h * _A5[0], k1), h * _A5[1], k2), h * _A5[2], k3), h * _A5[3], k4)
    k5 = rates_at(engine, held, at)
    at = plus(plus(plus(y, h * _A6[0], k1), h * _A6[1], k2), h * _A6[2], k3)
    k6 = rates_at(engine, held, plus(plus(at, h * _A6[3], k4), h * _A6[4], k5))
    end = plus(plus(plus(y, h * _A7[0], k1), h * _A7[2], k3), h * _A7[3], k4)
    end = plus(plus(end, h * _A7[4], k5), h * _A7[5], k6)
    k7 = rates_at(engine, held, end)
    off = plus(plus(plus((0.0, 0.0, 0.0, 0.0), h * _E[0], k1), h * _E[2], k3), h * _E[3], k4)
    off = plus(plus(plus(off, h * _E[4], k5), h * _E[5], k6), h * _E[6], k7)
    error = 0.0
    for i in range(3):
        # A NaN must not count as a small error.
        error = max(error, abs(off[i]) / scales[i]) if off[i] == off[i] else math.inf
    return end, error, k1[2], k7[2]


@routine
def watched(what: int, kind: int, p: Memory, held: Memory, limits: Memory, y: State, rate: float) -> float:
    """What is above 0 at the begin of a step and below where an event has come about.

    Parameters
    ----------
    what : int
        REVERSAL of the sleeve against its sense; AT_INNER, AT_OUTER; SWITCHES, of a valve; EXTREME of the speed;
        LEAVES_BAND, of the speed; RISES or FALLS, of a resting sleeve.
    kind : int
    p, held : Memory
    limits : Memory (7,)
        Positions of the stops, sign of the speed's rate at the begin, middle and half width of the band, speeds at
        which a resting sleeve rises and falls.
    y : tuple of 4 floats
    rate : float
        Of the speed.
    """
    if what == REVERSAL:
        return held[SENSE] * y[1]
    if what == AT_INNER:
        return y[0] - limits[0]
    if what == AT_OUTER:
        return limits[1] - y[0]
    if what == EXTREME:
        return rate * limits[2]
    if what == LEAVES_BAND:
        return abs(y[2] - limits[3]) - limits[4]
    if what == RISES:
        return limits[5] - y[2]
    if what == FALLS:
        return y[2] - limits[6]
    above = linkage_at(kind, p, y[0])[5] - held[ZERO] - p[SWITCH]
    return -above if held[OPEN] > 0.0 else above


@routine
def locate(what: int, engine: Governed, held: Memory, scales: Memory, limits: Memory, y: State, h: float) -> float:
    """Length of the step at whose end an event has just come about, by regula falsi (Illinois).

    Parameters
    ----------
    what : int
        Of `watched`.
    engine, held, scales
        As for `governor_step`.
    limits : Memory (7,)
        As for `watched`.
    y : tuple of 4 floats
        State before.
    h : float
        Step within which it comes about [s].

    Returns
    -------
    float
        [s]; 0 where the event is there from the begin.
    """
    end, _, first, last = governor_step(engine, held, scales, y, h)
    a, at_a = 0.0, watched(what, engine.kind, engine.p, held, limits, y, first)
    b, at_b = h, watched(what, engine.kind, engine.p, held, limits, end, last)
    while at_a <= 0.0:
        # It begins on the very edge: on from where it is well off it.
        shorter = 0.5 * b
        if shorter < 1e-12 * h:
            return 0.0
        end, _, _, last = governor_step(engine, held, scales, y, shorter)
        value = watched(what, engine.kind, engine.p, held, limits, end, last)
        if value > 0.0:
            a, at_a = shorter, value
        else:
            b, at_b = shorter, value
    side, near = 0, h * (_EXTREME_LOCATED if what == EXTREME else _LOCATED)
    for _ in range(_ROUNDS):
        if b - a <= near or at_b == 0.0:
            break
        # Half of what is near enough beside an end: then the other side of the event is soon near, too.
        c = min(max(b - at_b * (b - a) / (at_b - at_a), a + 0.5 * near), b - 0.5 * near)
        end, _, _, last = governor_step(engine, held, scales, y, c)
        value = watched(what, engine.kind, engine.p, held, limits, end, last)
        if value > 0.0:
            a, at_a = c, value
            at_b = 0.5 * at_b if side > 0 else at_b
            side = 1
        else:
            b, at_b = c, value
            at_a = 0.5 * at_a if side < 0 else at_a
            side = -1
    return b


@inlined
def thresholds(kind: int, p: Memory, memory: Memory, held: Memory, x: float) -> tuple[float, float, float, float]:
    """Speeds of the engine at which a resting sleeve falls and rises, its lift, the engine's inertia with the balls.

    Parameters
    ----------
    kind : int
    p, memory, held : Memory
    x : float
        Position [m].

    Returns
    -------
    tuple of 4 floats
        [rad/s], [rad/s], [m], [kg·m²]
    """
    link = linkage_at(kind, p, x)
    slope, _, _ = held_at(kind, p, memory, x, link, held[ZERO])
    friction = p[FRICTION] * link[6]
    square = p[RATIO] * p[RATIO]
    pull = square * 2.0 * p[BALL] * link[0] * link[1]
    falls, rises = math.sqrt(max(slope - friction, 0.0) / pull), math.sqrt(max(slope + friction, 0.0) / pull)
    whole = p[INERTIA] + square * 2.0 * p[BALL] * link[0] * link[0]
    return falls, rises, link[5] - held[ZERO], whole


@inlined
def note(t: float, lift: float, speed: float, history: np.ndarray, count: int) -> int:
    """Keep an instant in the history, if there is room; how many are kept."""
    if count < history.shape[0]:
        history[count, 0], history[count, 1], history[count, 2] = t, lift, speed
        return count + 1
    return count


@routine
def follow_change(
    engine: Governed,
    kept: Memory,
    tolerance: float,
    most_step: float,
    cycle: float,
    answers: Memory,
    history: np.ndarray,
    room: tuple[Memory, Memory, Memory],
) -> tuple[int, int]:
    """Follow an engine and its governor from a change of load on.

    Parameters
    ----------
    engine : Governed
    kept : Memory (6,)
        Positions, from `find_equilibria`.
    tolerance : float
        Of a step's error: of lift and velocity as shares of their ranges, of speed as a share of its hundredth part.
    most_step : float
        [s]
    cycle : float
        Length of the cycle of the engine's mechanism [rad]; 0 without one.
    answers : Memory (ANSWERS,)
        To be written to: highest and lowest speed [rad/s]; greatest departure beyond the new steady speed, as a share;
        time from which on the speed stays in the band [s], NaN where it doesn't; half of its swing in the last part, as
        a share; how often the sleeve runs on its stops.
    history : ndarray (instants, 3)
        To be written to: time [s], lift [m], speed [rad/s].
    room : tuple of 3 Memory
        For nine, three and seven numbers.

    Returns
    -------
    verdict : int
        OK; STALLS where the engine stops; NO_END after MOST_STEPS steps; NOT_FINITE.
    instants : int
        How many are written.
    """
    kind, throttle, p, memory, _ = engine
    low, high, duration = kept[INNER], kept[OUTER], p[DURATION]
    held, scales, limits = room
    held[ZERO] = linkage_at(kind, p, low)[5]
    held[WHOLE] = linkage_at(kind, p, high)[5] - held[ZERO]
    held[NOW], held[SENSE], held[OPEN], held[RESTS] = p[NEW_LOAD], 0.0, 1.0, 0.0
    held[CYCLE], held[STRIDE] = cycle, 1.0 if tolerance < COARSE else 2.0
    begin, goal = (
        equilibrium_at(kind, p, memory, kept[BEFORE], held[ZERO]),
        equilibrium_at(kind, p, memory, kept[AFTER], held[ZERO]),
    )
    half = equilibrium_at(kind, p, memory, kept[MIDDLE], held[ZERO])
    held[MEAN] = kept[MEAN_KEPT]
    steady = goal[3] / p[RATIO]
    direction = goal[3] - begin[3]
    direction = p[LOAD] - p[NEW_LOAD] if direction == 0.0 else direction
    scales[0] = high - low
    scales[1] = (high - low) * math.sqrt(half[4] / (half[7] * held[WHOLE]))
    scales[2] = _SPEED_SCALE * steady
    band = p[BAND] * steady
    limits[0], limits[1], limits[2], limits[3], limits[4] = low, high, 1.0, steady, band
    x, velocity, speed, angle = kept[BEFORE], 0.0, begin[3] / p[RATIO], 0.0
    if throttle == _FULL_AND_SHUT:
        # Just below the switch: on it the valve would be neither open nor shut.
        x -= 1e-9 * (high - low)
    highest = lowest = speed
    top, bottom = -math.inf, math.inf
    settled = 0.0 if abs(speed - steady) <= band else math.nan
    inner_hits = outer_hits = 0.0
    t, h, resting, fresh, pause = 0.0, 1e-4 * duration, p[FRICTION] > 0.0, True, 0.0
    count = note(t, begin[1], speed, history, 0)
    steps = 0
    while t < duration:
        steps += 1
        if steps > MOST_STEPS:
            return _NO_END, count
        mark = LAST_PART * duration if t < LAST_PART * duration else duration
        before = speed
        if resting:
            falls, rises, lift, inertia = thresholds(kind, p, memory, held, x)
            moment = moment_at(engine, held, lift, before, 1.0)
            may_rise, may_fall = x < high, x > low
            up = may_rise and (before > rises or (before == rises and moment > 0.0 and cycle == 0.0))
            down = may_fall and (before < falls or (before == falls and moment < 0.0 and cycle == 0.0))
            limits[5], limits[6] = rises if may_rise else math.inf, falls if may_fall else -math.inf
            if pause == 0.0 and (up or down):
                resting, fresh = False, True
                held[SENSE] = 0.0 if p[FRICTION] == 0.0 else (1.0 if up else -1.0)
                continue
        held[RESTS] = 1.0 if resting else 0.0
        if resting and cycle == 0.0:
            target, wait = math.nan, math.inf
            if pause > 0.0:
                wait = pause
            elif moment > 0.0 and may_rise:
                target, wait = rises, time_to_speed(before, rises, moment, p[SELF_REGULATION], inertia)
            elif moment < 0.0 and may_fall:
                target, wait = falls, time_to_speed(before, falls, moment, p[SELF_REGULATION], inertia)
            pause = 0.0
            arrives = t + wait <= mark
            length = wait if arrives else mark - t
            speed = speed_after(before, length, moment, p[SELF_REGULATION], inertia)
            if arrives and target == target:
                speed = target
            if not abs(speed - steady) <= band:
                settled = math.nan
            elif not abs(before - steady) <= band:
                edge = steady + math.copysign(band, before - steady)
                settled = t + time_to_speed(before, edge, moment, p[SELF_REGULATION], inertia)
            t = mark if not arrives else t + length
        else:
            y = (x, velocity, before, angle)
            h = min(h, most_step)
            if pause > 0.0:
                h = min(h, pause)
            trial = min(h, mark - t)
            end, error, first, last = governor_step(engine, held, scales, y, trial)
            error /= tolerance
            if not error <= 1.0:
                h = trial * max(0.2, 0.9 * error**-0.2)
                if not h > 1e-14 * duration:
                    return _NOT_FINITE, count
                continue
            if fresh:
                limits[2], fresh = math.copysign(1.0, first if first != 0.0 else last), False
            event, length = -1, trial
            for what in range(FALLS + 1):
                if (what == REVERSAL and held[SENSE] == 0.0) or (what == SWITCHES and throttle != _FULL_AND_SHUT):
                    continue
                # Of a resting sleeve whether it moves, of a moving one where; of both the extremes of the speed.
                if what == LEAVES_BAND or (what != EXTREME and resting != (what >= RISES)):
                    continue
                if resting and what >= RISES and pause > 0.0:
                    continue
                if watched(what, kind, p, held, limits, end, last) < 0.0:
                    at = locate(what, engine, held, scales, limits, y, trial)
                    if event < 0 or at < length:
                        event, length = what, at
            if length == 0.0 and event <= AT_OUTER:
                # Forces are in balance but for rounding: it doesn't move yet.
                resting, pause, velocity, fresh = True, trial, 0.0, True
                continue
            pause = 0.0
            if event >= 0:
                end, _, _, _ = governor_step(engine, held, scales, y, length)
            else:
                h = trial * min(5.0, 0.9 * max(error, 1e-10) ** -0.2)
            x, velocity, speed, angle = end
            if not abs(speed - steady) <= band:
                settled = math.nan
            elif not abs(before - steady) <= band:
                settled = t + locate(LEAVES_BAND, engine, held, scales, limits, y, length)
            t = mark if event < 0 and trial == mark - t else t + length
            if event == EXTREME:
                limits[2] = -limits[2]
            elif event == SWITCHES:
                held[OPEN], fresh = 1.0 - held[OPEN], True
            elif event in (RISES, FALLS):
                resting, fresh, velocity = False, True, 0.0
                held[SENSE] = 0.0 if p[FRICTION] == 0.0 else (1.0 if event == RISES else -1.0)
            elif event == REVERSAL:
                resting, velocity, fresh = True, 0.0, True
            elif event >= 0:
                inner_hits += 1.0 if event == AT_INNER else 0.0
                outer_hits += 1.0 if event == AT_OUTER else 0.0
                resting, x, velocity, fresh = True, low if event == AT_INNER else high, 0.0, True
        if not speed > 0.0:
            return (_STALLS if speed <= 0.0 else _NOT_FINITE), count
        highest, lowest = max(highest, speed), min(lowest, speed)
        if t >= LAST_PART * duration:
            top, bottom = max(top, speed), min(bottom, speed)
        if history.shape[0] > 0:
            count = note(t, linkage_at(kind, p, x)[5] - held[ZERO], speed, history, count)
    beyond = highest - steady if direction > 0.0 else steady - lowest
    answers[HIGHEST], answers[LOWEST] = highest, lowest
    answers[OVERSHOOT] = max(beyond, 0.0) / steady
    answers[SETTLING_TIME] = settled
    answers[HUNTING] = 0.5 * (top - bottom) / steady
    answers[INNER_HITS], answers[OUTER_HITS] = inner_hits, outer_hits
    return _OK, count


@driver
def follow_changes(
    kind: int,
    throttle: int,
    numbers: np.ndarray,
    memory: np.ndarray,
    offset: float,
    found: Followed,
    room: np.ndarray,
) -> None:
    """What a change of load does in a set of variants, by two runs each.

    Parameters
    ----------
    kind, throttle : int
        `Holding`, `Throttling`.
    numbers : ndarray (variants, NUMBERS)
        With curves of mechanisms behind, where engines are such.
    memory : ndarray
    offset : float
        Where the throttle's table begins in it.
    found : Followed
    room : ndarray (MOTION_ROOM,)
    """
    verdicts, answers = found.verdicts, found.answers
    nothing, tables, parts = answers[:0], lane_of(memory), (lane_of(room), lane_of(room[9:]), lane_of(room[12:]))
    for v in range(numbers.shape[0]):
        engine, marks = Governed(kind, throttle, lane_of(numbers[v]), tables, offset), lane_of(found.kept[v])
        cycle = numbers[v, CYCLE_LENGTH] if numbers.shape[1] > NUMBERS else 0.0
        if verdicts[v] == _OK:
            verdicts[v], _ = follow_change(engine, marks, FINE, math.inf, cycle, lane_of(answers[v]), nothing, parts)
        if verdicts[v] == _OK:
            verdicts[v], _ = follow_change(
                engine, marks, COARSE, math.inf, cycle, lane_of(found.coarse[v]), nothing, parts
            )


@driver
def follow_one(
    kind: int,
    throttle: int,
    p: np.ndarray,
    memory: np.ndarray,
    offset: float,
    kept: np.ndarray,
    history: np.ndarray,
    room: np.ndarray,
) -> None:
    """Write the history of a change of load, an instant after the other; what isn't written stays as it is.

    Parameters
    ----------
    kind, throttle, p, memory, offset, kept, history
        As for `follow_change`.
    room : ndarray (MOTION_ROOM + ANSWERS,)
    """
    parts = (lane_of(room), lane_of(room[9:]), lane_of(room[12:]))
    most_step = 2.0 * p[DURATION] / history.shape[0]
    answers, cycle = lane_of(room[MOTION_ROOM:]), p[CYCLE_LENGTH] if p.size > NUMBERS else 0.0
    engine = Governed(kind, throttle, lane_of(p), lane_of(memory), offset)
    follow_change(engine, lane_of(kept), FINE, most_step, cycle, answers, history, parts)
