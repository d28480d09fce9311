"""Motion of two masses on a shaft with backlash, exactly, phase after phase.

With e = φ₁ − φ₂, counted from where the shaft is just in touch forwards, its moment is T = k e + b ė for e > 0, 0 in
the backlash −Δ < e < 0, and T = k (e + Δ) + b ė behind it; damping may not pull, so T doesn't change its sign while in
touch. Without backlash there is nothing to lose touch in. The load resists with M_c against its motion; at rest it
sticks while |T| ≤ M_c. So the motion consists of phases, in touch or not, load sticking or moving, and in each of them
it is a damped vibration of e about a constant twist, or a parabola:

    I₁ ω₁′ = M − T,   I₂ ω₂′ = T ∓ M_c.

A phase ends where T or ω₂ vanishes, where T overcomes M_c, or where the backlash closes. T is monotonic between its
stationary points, which are known, and ω₂ between these and where T = ±M_c; on such a stretch each of them vanishes
once at the most, so that no event is missed.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links and clearances).
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import driver, inlined, routine
from engine.cycle.roots import MOST_TURNS, newton_between
from engine.elements.oscillators.damped_vibration import damped_vibration, next_turn

# What a drive is given, and what is found; in this order in the tables.
MOTOR_INERTIA, LOAD_INERTIA, STIFFNESS, DAMPING, BACKLASH, MOMENT, LOAD, TIME, TWIST, SPEED, TOUCH = range(11)
GIVEN = 11
GREATEST, GREATEST_AT, CLOSINGS, IMPACT_AT, IMPACT_SPEED, LOAD_AT, MOTOR_SPEED, LOAD_SPEED = range(8)
FOUND = 8
# Columns of a recorded phase: when it begins, which touch (1, 0, -1), which way the load moves (0: sticks), and state.
BEGINS, TOUCHES, MOVES, GAP, RATE, LOAD_RATE = range(6)
PHASE = 6

MOST_EVENTS = 20_000
# A stretch shorter than this share of a radian of the vibration is none.
_SHORT = 1e-9
_NEVER = math.inf
_HIGHER = 1.0 + 1e-11


@inlined
def _crossing(a: float, b: float, c: float) -> float:
    """When c + b t + ½ a t² next goes from below 0 to above it; never where it doesn't."""
    inside = b * b - 2.0 * a * c
    if inside < 0.0:
        return _NEVER
    root = math.sqrt(inside)
    if b > 0.0:
        found = -2.0 * c / (b + root)
    elif a > 0.0:
        found = (root - b) / a
    else:
        return _NEVER
    return found if found > 0.0 else _NEVER


@routine
def _closing(k: float, b: float, e: float, v: float, a: float) -> float:
    """When a gap that has e, v and a for its excess closes: e > 0 and k e + b ė > 0 from then on."""
    closes = _crossing(a, v, e)
    if e <= 0.0:
        return closes
    # In touch, but the damper would pull: either it stops to before they part, or they meet anew.
    parts = _crossing(-a, -v, -e)
    stops = _crossing(k * a, k * v + b * a, k * e + b * v)
    return stops if stops < parts else closes


class _Vibration(NamedTuple):
    """A vibration about a constant twist: frequency and decay [rad/s], deviation and its rate at first [rad, rad/s]."""

    w: float
    beta: float
    u: float
    v: float


@inlined
def _deviation_at(vibration: _Vibration, time: float) -> tuple[float, float]:
    return damped_vibration(vibration.w, vibration.beta, vibration.u, vibration.v, time)


@inlined
def _moment_at(time: float, vibration: _Vibration, k: float, b: float, twist: float) -> float:
    deviation, rate = _deviation_at(vibration, time)
    return k * (twist + deviation) + b * rate


@routine
def _when_moment(
    level: float, begin: float, end: float, vibration: _Vibration, k: float, b: float, twist: float
) -> float:
    """When T is at a level, on a stretch on which it passes it once: Newton's method between bounds."""
    low, high = begin, end
    rises = _moment_at(end, vibration, k, b, twist) > _moment_at(begin, vibration, k, b, twist)
    time = 0.5 * (begin + end)
    for _ in range(MOST_TURNS):
        deviation, rate = _deviation_at(vibration, time)
        over = k * (twist + deviation) + b * rate - level
        w, beta = vibration.w, vibration.beta
        slope = k * rate - b * (2.0 * beta * rate + w * w * deviation)
        time, low, high, settled = newton_between(time, over, slope, rises, low, high)
        if settled:
            break
    return time


@inlined
def _speed_at(time: float, momentum: float, push: float, first: float, both: float, vibration: _Vibration) -> float:
    """Speed of the moving load in touch, from the momentum of both masses."""
    _, rate = _deviation_at(vibration, time)
    return (momentum + push * time - first * rate) / both


@routine
def _when_stops(
    begin: float, end: float, momentum: float, push: float, first: float, both: float, vibration: _Vibration
) -> float:
    """When the load stops, on a stretch on which its speed passes 0 once: Newton's method between bounds."""
    low, high = begin, end
    rises = _speed_at(end, momentum, push, first, both, vibration) > 0.0
    time = 0.5 * (begin + end)
    for _ in range(MOST_TURNS):
        deviation, rate = _deviation_at(vibration, time)
        speed = (momentum + push * time - first * rate) / both
        w, beta = vibration.w, vibration.beta
        slope = (push + first * (2.0 * beta * rate + w * w * deviation)) / both
        time, low, high, settled = newton_between(time, speed, slope, rises, low, high)
        if settled:
            break
    return time


@driver
def follow_drives(begin: int, end: int, given: np.ndarray, found: np.ndarray, phases: np.ndarray) -> None:
    """Follow drives `begin` … `end` − 1 through their phases.

    Parameters
    ----------
    begin, end : int
    given : ndarray (GIVEN, drives)
        Inertias, stiffness, damping, backlash, moments of motor and load, time; twist, speed of both masses, and touch
        (1 or 0) at the start.
    found : ndarray (FOUND, drives)
        Greatest magnitude of the shaft's moment and when; how often the backlash closed, when first and how fast; when
        the load started to move; speeds at the end. NaN where there are more phases than can be followed.
    phases : ndarray (drives, most, PHASE)
        To be filled with every drive's phases, as far as there is room; NaN behind the last.
    """
    for i in range(begin, end):
        first, second, k, b = given[MOTOR_INERTIA, i], given[LOAD_INERTIA, i], given[STIFFNESS, i], given[DAMPING, i]
        backlash, moment, load, horizon = given[BACKLASH, i], given[MOMENT, i], given[LOAD, i], given[TIME, i]
        # What is lost in the rounding of the motor's moment resists nothing.
        load = load if moment + load > moment else 0.0
        touch, e, v, speed = int(given[TOUCH, i]), given[TWIST, i], 0.0, given[SPEED, i]
        # A load that doesn't resist never sticks.
        moves = 1 if speed > 0.0 or load == 0.0 else 0
        now, events, recorded = 0.0, 0, 0
        greatest, greatest_at, closings = 0.0, 0.0, 0
        impact_at, impact_speed = math.nan, math.nan
        load_at = 0.0 if speed > 0.0 or (moves != 0 and touch != 0) else math.nan
        while now < horizon and events < MOST_EVENTS:
            events += 1
            if recorded < phases.shape[1]:
                phases[i, recorded, 0], phases[i, recorded, 1], phases[i, recorded, 2] = now, touch, moves
                phases[i, recorded, 3], phases[i, recorded, 4], phases[i, recorded, 5] = e, v, speed
                recorded += 1
            left = horizon - now
            # What happens next: 0 the end, 1 out of touch, 2 load starts or stops, 3 touches forwards, -3 backwards.
            what, took = 0, left
            if touch == 0:
                a = moment / first + moves * load / second
                forwards = _closing(k, b, e, v, a)
                backwards = _closing(k, b, -backlash - e, -v, -a)
                stops = abs(speed) * second / load if moves != 0 and load > 0.0 else _NEVER
                if forwards < took:
                    what, took = 3, forwards
                if backwards < took:
                    what, took = -3, backwards
                if stops < took:
                    what, took = 2, stops
                e, v = e + (v + 0.5 * a * took) * took, v + a * took
                speed -= moves * load / second * took
                if what == 3 or what == -3:
                    touch = 1 if what == 3 else -1
                    closings += 1
                    if closings == 1:
                        impact_at, impact_speed = now + took, abs(v)
                    if moves != 0 and math.isnan(load_at):
                        load_at = now + took
                elif what == 2:
                    # Without touch nothing moves it on.
                    speed, moves = 0.0, 0
            else:
                behind = backlash if touch < 0 else 0.0
                mobility = 1.0 / first + (1.0 / second if moves != 0 else 0.0)
                push = moment / first + moves * load / second
                w, beta, twist = math.sqrt(k * mobility), 0.5 * b * mobility, push / (k * mobility)
                u = e + behind - twist
                vibration = _Vibration(w, beta, u, v)
                momentum, both = first * (v + speed) + second * speed, first + second
                gain = moment - moves * load
                bound = touch if backlash > 0.0 else 0
                # T less its constant part vibrates as e does: its own turning points bound the stretches.
                value, rate = k * u + b * v, k * v - b * (2.0 * beta * v + w * w * u)
                turn = next_turn(w, beta, value, rate)
                half = math.pi / math.sqrt((w - beta) * (w + beta)) if w > beta else _NEVER
                start, at_start, towards = 0.0, k * twist + value, 1
                # A damper is hit with full speed.
                if abs(at_start) > greatest:
                    greatest, greatest_at = abs(at_start), now
                while True:
                    stop = min(turn, left)
                    at_stop = _moment_at(stop, vibration, k, b, twist)
                    what, took = 0, stop
                    if bound != 0 and bound * at_stop < 0.0:
                        what = 1
                        took = _when_moment(0.0, start, stop, vibration, k, b, twist)
                    if moves == 0 and abs(at_stop) > load:
                        level = load if at_stop > 0.0 else -load
                        passed = start
                        if abs(at_start) <= load:
                            passed = _when_moment(level, start, stop, vibration, k, b, twist)
                        if what == 0 or passed < took:
                            what, took, towards = 2, passed, 1 if at_stop > 0.0 else -1
                    if moves != 0 and load > 0.0:
                        # Where T passes what the load resists with, the load's speed turns.
                        split = stop
                        resists = moves * load
                        if (at_start - resists) * (at_stop - resists) < 0.0:
                            split = _when_moment(resists, start, stop, vibration, k, b, twist)
                            if (split - start) * w < _SHORT:
                                split = stop
                        piece = start
                        for part in range(2):
                            until = split if part == 0 else stop
                            ends = moves * _speed_at(until, momentum, gain, first, both, vibration)
                            if until > piece and ends < 0.0:
                                stopped = _when_stops(piece, until, momentum, gain, first, both, vibration)
                                if what == 0 or stopped < took:
                                    what, took = 2, stopped
                                break
                            piece = until
                    reached = abs(_moment_at(took, vibration, k, b, twist))
                    # Of peaks that are the same but for rounding, the first.
                    if reached > greatest * _HIGHER:
                        greatest, greatest_at = reached, now + took
                    if what != 0 or took >= left:
                        break
                    start, at_start = stop, at_stop
                    turn = turn + half
                deviation, rate = _deviation_at(vibration, took)
                if moves != 0:
                    speed = (momentum + gain * took - first * rate) / both
                e, v = twist + deviation - behind, rate
                if what == 1:
                    touch = 0
                elif what == 2:
                    carried = k * (e + behind) + b * v
                    if moves == 0:
                        moves = towards
                        if math.isnan(load_at):
                            load_at = now + took
                    else:
                        speed = 0.0
                        moves = 0 if abs(carried) <= load else (1 if carried > 0.0 else -1)
            now += took
        for row in range(recorded, phases.shape[1]):
            for column in range(PHASE):
                phases[i, row, column] = math.nan
        if now < horizon:
            for row in range(FOUND):
                found[row, i] = math.nan
        else:
            found[GREATEST, i], found[GREATEST_AT, i], found[CLOSINGS, i] = greatest, greatest_at, closings
            found[IMPACT_AT, i], found[IMPACT_SPEED, i], found[LOAD_AT, i] = impact_at, impact_speed, load_at
            found[MOTOR_SPEED, i], found[LOAD_SPEED, i] = speed + v, speed
