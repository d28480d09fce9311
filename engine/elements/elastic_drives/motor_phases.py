"""Motion of two masses on a shaft with backlash under a motor whose moment depends on its speed.

The equations and phases are those of `backlash_phases`, with M(ω₁) in place of a constant moment: straight lines
between the rows of a table (a DC motor has two), or Kloss' formula. Within a phase the motion is followed in steps of
Taylor series of high order: all that occurs is sums, products and one quotient, so that every coefficient follows from
those before. The time is counted in 1/ω_n of the drive in touch. A step is as long as its last terms allow, by which it
is exact but for rounding; what ends a phase is sought on the polynomials themselves, between their turning points.
Every vibration is followed: a drive that vibrates too often within its time has no results (`MOST_RADIANS`).

Sources: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links and clearances); E. Hairer,
S. P. Nørsett and G. Wanner, Solving Ordinary Differential Equations I, section I.8 (Taylor series).
"""

import math

import numpy as np

from engine.compiling.decorators import driver, inlined, routine
from engine.cycle.roots import MOST_TURNS, newton_between
from engine.elements.elastic_drives.backlash_phases import (
    CLOSINGS,
    GREATEST,
    GREATEST_AT,
    IMPACT_AT,
    IMPACT_SPEED,
    LOAD_AT,
    LOAD_SPEED,
    MOTOR_SPEED,
)

# What a drive is given; in this order in the table.
MOTOR_INERTIA, LOAD_INERTIA, STIFFNESS, DAMPING, BACKLASH, LOAD, TIME, RUNNING, SPEED, LOAD_BEFORE = range(10)
MOTOR_GIVEN = 10
# What is found beyond that of `backlash_phases`: the motor's moment at the begin, and 1 where the drive is too stiff.
MOMENT_AT_BEGIN, TOO_STIFF = 8, 9
MOTOR_FOUND = 10
# Constants of Kloss' formula: breakdown moment and slip, rotor ratio, synchronous speed.
BREAKDOWN_MOMENT, BREAKDOWN_SLIP, ROTOR_RATIO, SYNCHRONOUS_SPEED = range(4)
# What is shown at an instant.
SHAFT_MOMENT, MOTOR_RATE, LOAD_RATE, GAP, MOTOR_MOMENT = range(5)
SHOWN = 5

ORDER = 20
# Series of a step: gap, its rate, speed of the load, of the motor, moments of shaft and motor; slip, Kloss' divisor,
# and what is known so far of the slip's square and of the divisor times the moment.
_E, _V, _LOAD, _MOTOR, _SHAFT, _DRIVING, _SLIP, _DIVISOR, _SQUARE, _PRODUCT, _WATCHED = range(11)
MOTOR_ROOM = 11
# The last terms of a step's series, over what they add to.
_LAST_TERMS = 1e-16
# Steps in touch, in 1/ω_n, and parts of a step between which signs are compared.
_LONGEST, _PARTS = 1.5, 6
# A drive is followed through no more of its vibration than this, nor in more steps.
MOST_RADIANS, MOST_STEPS = 2e5, 200_000
# Shares of what is watched that count as rounding.
_ROUNDED = 1e-12
_HIGHER = 1.0 + 1e-11
# What ends a phase; a closing of the backlash is 4 or, backwards, -4.
_GOES_ON, _PARTS_WITH, _LOAD_TURNS, _NEXT_LINE, _CLOSES = range(5)


@inlined
def _at(c: np.ndarray, t: float) -> tuple[float, float]:
    """Value and derivative of a series."""
    value, rate = c[ORDER], 0.0
    for j in range(ORDER - 1, -1, -1):
        rate = rate * t + value
        value = value * t + c[j]
    return value, rate


@inlined
def _rate_at(c: np.ndarray, t: float) -> tuple[float, float]:
    """First and second derivative of a series."""
    rate, bend = ORDER * c[ORDER], 0.0
    for j in range(ORDER - 1, 0, -1):
        bend = bend * t + rate
        rate = rate * t + j * c[j]
    return rate, bend


@routine
def _root(c: np.ndarray, a: float, b: float) -> float:
    """Where a series that has different signs at a and b vanishes."""
    rises, t = _at(c, b)[0] > 0.0, 0.5 * (a + b)
    for _ in range(MOST_TURNS):
        value, rate = _at(c, t)
        t, a, b, settled = newton_between(t, value, rate, rises, a, b)
        if settled:
            break
    return t


@routine
def _turn(c: np.ndarray, a: float, b: float) -> float:
    """Where a series turns whose derivative has different signs at a and b."""
    rises, t = _rate_at(c, b)[0] > 0.0, 0.5 * (a + b)
    for _ in range(MOST_TURNS):
        rate, bend = _rate_at(c, t)
        t, a, b, settled = newton_between(t, rate, bend, rises, a, b)
        if settled:
            break
    return t


@inlined
def _excursion(c: np.ndarray, h: float) -> float:
    """By how much a series within a step can't be farther than from its first term."""
    total = 0.0
    for j in range(ORDER, 0, -1):
        total = (total + abs(c[j])) * h
    return total


@routine
def _falls_below(c: np.ndarray, h: float, nothing: float) -> float:
    """When a series falls below 0 within a step, by more than nothing; never where it doesn't."""
    if c[0] > _excursion(c, h):
        return math.inf
    before, (g, rate) = 0.0, _at(c, 0.0)
    for part in range(1, _PARTS + 1):
        t = h * part / _PARTS
        value, slope = _at(c, t)
        lowest = t
        if value < -nothing and rate > 0.0 > slope:
            # It falls from where it turns on, and may have been above 0 there alone.
            before = _turn(c, before, t)
            g = _at(c, before)[0]
        elif value >= -nothing and rate < 0.0 < slope:
            lowest = _turn(c, before, t)
        if g >= -nothing and _at(c, lowest)[0] < -nothing:
            return _root(c, before, lowest) if g > 0.0 else before
        before, g, rate = t, value, slope
    return math.inf


@inlined
def _add_products(total: np.ndarray, series: np.ndarray, factor: float, own: int, begin: int, end: int) -> None:
    """To the coefficients of a product, what a factor's coefficient `own` makes with the others `begin` … `end` − 1."""
    for i in range(begin, min(end, ORDER + 1 - own)):
        total[own + i] += factor * series[i]


@routine
def _expand(
    s: np.ndarray,
    own: np.ndarray,
    kloss: np.ndarray,
    level: float,
    slope: float,
    unit: float,
    touch: int,
    moves: int,
) -> None:
    """Series of a step from the state in their first coefficients; on a line M = level + slope ω₁, or by Kloss."""
    first, second, k, b = own[MOTOR_INERTIA], own[LOAD_INERTIA], own[STIFFNESS], own[DAMPING]
    behind = own[BACKLASH] if touch < 0 else 0.0
    breakdown, damping = 0.0, 0.0
    if kloss.size > 0:
        breakdown, synchronous = kloss[BREAKDOWN_SLIP], kloss[SYNCHRONOUS_SPEED]
        damping = kloss[ROTOR_RATIO] * breakdown
        factor = kloss[BREAKDOWN_MOMENT] * (2.0 + damping) * breakdown
        for j in range(ORDER + 1):
            s[_SQUARE, j], s[_PRODUCT, j] = 0.0, 0.0
    for j in range(ORDER + 1):
        constant = 1.0 if j == 0 else 0.0
        s[_MOTOR, j] = s[_LOAD, j] + s[_V, j]
        s[_SHAFT, j] = k * (s[_E, j] + constant * behind) + b * s[_V, j] if touch != 0 else 0.0
        if kloss.size > 0:
            s[_SLIP, j] = constant - s[_MOTOR, j] / synchronous
            _add_products(s[_SQUARE], s[_SLIP], 2.0 * s[_SLIP, j], j, 0, j)
            if 2 * j <= ORDER:
                s[_SQUARE, 2 * j] += s[_SLIP, j] * s[_SLIP, j]
            s[_DIVISOR, j] = s[_SQUARE, j] + damping * breakdown * s[_SLIP, j] + constant * breakdown * breakdown
            if j > 0:
                _add_products(s[_PRODUCT], s[_DRIVING], s[_DIVISOR, j], j, 0, j)
            s[_DRIVING, j] = (factor * s[_SLIP, j] - s[_PRODUCT, j]) / s[_DIVISOR, 0]
            _add_products(s[_PRODUCT], s[_DIVISOR], s[_DRIVING, j], j, 1, j + 1)
            if s[_SLIP, 0] < 0.0 and s[_DIVISOR, 0] <= 0.0:
                # Beyond the poles of the formula it has no meaning.
                s[_DRIVING, j] = math.nan
        else:
            s[_DRIVING, j] = slope * s[_MOTOR, j] + constant * level
        if j < ORDER:
            share = unit / (j + 1)
            load = (s[_SHAFT, j] - constant * moves * own[LOAD]) / second if moves != 0 else 0.0
            s[_E, j + 1] = share * s[_V, j]
            s[_V, j + 1] = share * ((s[_DRIVING, j] - s[_SHAFT, j]) / first - load)
            s[_LOAD, j + 1] = share * load


@routine
def _watch(s: np.ndarray, sign: float, constant: float, by_gap: float, by_rate: float, row: int) -> None:
    """What is watched: a constant, and a series or, in the gap, shares of it and of its rate."""
    for j in range(ORDER + 1):
        value = by_gap * s[_E, j] + by_rate * s[_V, j] if row == _E else s[row, j]
        s[_WATCHED, j] = sign * value
    s[_WATCHED, 0] += constant


@inlined
def _length(v: np.ndarray, most: float) -> float:
    """How long a step may be for the last terms of the relative speed's series."""
    size, h = _LAST_TERMS * (abs(v[0]) + abs(v[1])), most
    for j in range(ORDER - 2, ORDER + 1):
        # Most steps are as long as may be: roots are dear.
        if abs(v[j]) * h**j > size:
            h = (size / abs(v[j])) ** (1.0 / j)
    return h


@driver
def follow_motor_drives(
    begin: int,
    end: int,
    given: np.ndarray,
    lines: np.ndarray,
    kloss: np.ndarray,
    found: np.ndarray,
    shown: np.ndarray,
    s: np.ndarray,
) -> None:
    """Follow drives `begin` … `end` − 1 under their motors.

    Parameters
    ----------
    begin, end : int
    given : ndarray (drives, MOTOR_GIVEN)
        Inertias, stiffness, damping, backlash, moment of the load, time; 1 for a drive that runs, at which speed, and
        the load's moment until then.
    lines : ndarray (drives, rows, 2)
        Speeds and moments between which characteristics are straight; the outermost lines go on.
    kloss : ndarray (drives, 4 or 0)
        Constants of Kloss' formula; none where lines are meant.
    found : ndarray (drives, MOTOR_FOUND)
        As for `backlash_phases.follow_drives`, NaN where the drive vibrates too often to be followed; then the motor's
        moment at the begin, and 1 where it does.
    shown : ndarray (drives, instants, SHOWN)
        To be filled at equally spaced instants, the last of them at the end.
    s : ndarray (MOTOR_ROOM, ORDER + 1)
        Memory.
    """
    for i in range(begin, end):
        own, curve = given[i], kloss[i]
        first, second, k, b = own[MOTOR_INERTIA], own[LOAD_INERTIA], own[STIFFNESS], own[DAMPING]
        backlash, load, horizon = own[BACKLASH], own[LOAD], own[TIME]
        unit = 1.0 / math.sqrt(k * (1.0 / first + 1.0 / second))
        now, steps, instant = 0.0, 0, 0
        e, v, speed = -backlash, 0.0, own[SPEED] if own[RUNNING] > 0.0 else 0.0
        touch = 0 if backlash > 0.0 else 1
        moves = 1 if speed > 0.0 or load == 0.0 else 0
        row = 0
        while row + 2 < lines.shape[1] and speed >= lines[i, row + 1, 0]:
            row += 1
        at_begin = math.nan
        greatest, greatest_at, closings = 0.0, 0.0, 0
        impact_at, impact_speed = math.nan, math.nan
        load_at = 0.0 if speed > 0.0 or (moves != 0 and touch != 0) else math.nan
        fresh = True
        most_steps = MOST_STEPS if horizon <= MOST_RADIANS * unit else 1
        while now < horizon and steps < most_steps:
            steps += 1
            level, slope = 0.0, 0.0
            if curve.size == 0:
                slope = (lines[i, row + 1, 1] - lines[i, row, 1]) / (lines[i, row + 1, 0] - lines[i, row, 0])
                level = lines[i, row, 1] - slope * lines[i, row, 0]
            s[_E, 0], s[_V, 0], s[_LOAD, 0] = e, v, speed
            if steps == 1:
                _expand(s, own, curve, level, slope, unit, 0, moves)
                at_begin = s[_DRIVING, 0]
                if own[RUNNING] > 0.0:
                    # Until now both masses were accelerated alike.
                    twist = (at_begin * second + own[LOAD_BEFORE] * first) / (first + second) / k
                    touch = 1 if twist > 0.0 or backlash == 0.0 else -1
                    e = twist - backlash if touch < 0 else twist
                    s[_E, 0] = e
            _expand(s, own, curve, level, slope, unit, touch, moves)
            left = (horizon - now) / unit
            h = _length(s[_V], min(left, _LONGEST) if touch != 0 else left)
            if not h > 0.0:
                break
            what, took = _GOES_ON, h
            if curve.size == 0 and lines.shape[1] > 2:
                small = _ROUNDED * (lines[i, lines.shape[1] - 1, 0] - lines[i, 0, 0])
                for upwards in range(2):
                    other = row + upwards
                    if 0 < other < lines.shape[1] - 1:
                        sign = -1.0 if upwards == 1 else 1.0
                        _watch(s, sign, -sign * lines[i, other, 0], 0.0, 0.0, _MOTOR)
                        at = _falls_below(s[_WATCHED], took, small)
                        if at < took:
                            what, took, towards = _NEXT_LINE, at, 2 * upwards - 1
            if touch == 0:
                for side in range(-1, 2, 2):
                    constant = 0.0 if side > 0 else backlash
                    _watch(s, -side, constant, 1.0, 0.0, _E)
                    at = _falls_below(s[_WATCHED], took, _ROUNDED * (backlash + unit * abs(v)))
                    if at < took:
                        what, took = side * _CLOSES, at
                    if b > 0.0:
                        # Bent beyond its end and let go of, the shaft may be caught up with.
                        _watch(s, -side, k * constant, k, b, _E)
                        size = k * (backlash + unit * abs(v))
                        at = _falls_below(s[_WATCHED], took, _ROUNDED * size)
                        if at < took:
                            gap = _at(s[_E], at)[0]
                            if side * gap > constant:
                                what, took = side * _CLOSES, at
            else:
                size = abs(s[_SHAFT, 0]) + abs(s[_SHAFT, 1])
                if backlash > 0.0:
                    _watch(s, touch, 0.0, 0.0, 0.0, _SHAFT)
                    at = _falls_below(s[_WATCHED], took, _ROUNDED * size)
                    if at < took:
                        what, took = _PARTS_WITH, at
                if moves == 0:
                    for side in range(-1, 2, 2):
                        _watch(s, -side, load, 0.0, 0.0, _SHAFT)
                        at = _falls_below(s[_WATCHED], took, _ROUNDED * load)
                        if at < took:
                            what, took, towards = _LOAD_TURNS, at, side
            if moves != 0 and load > 0.0:
                _watch(s, moves, 0.0, 0.0, 0.0, _LOAD)
                at = _falls_below(s[_WATCHED], took, _ROUNDED * unit * load / second)
                if at < took:
                    what, took = _LOAD_TURNS, at
            if touch != 0:
                if fresh and abs(s[_SHAFT, 0]) > greatest:
                    # A damper is hit with full speed.
                    greatest, greatest_at = abs(s[_SHAFT, 0]), now
                before, rate = 0.0, s[_SHAFT, 1]
                may_be = abs(s[_SHAFT, 0]) + _excursion(s[_SHAFT], took) > greatest
                for part in range(1, (_PARTS if may_be else 0) + 1):
                    t = took * part / _PARTS
                    value, slope = _at(s[_SHAFT], t)
                    if rate * slope < 0.0:
                        t_turn = _turn(s[_SHAFT], before, t)
                        reached = abs(_at(s[_SHAFT], t_turn)[0])
                        # Of peaks that are the same but for rounding, the first.
                        if reached > greatest * _HIGHER:
                            greatest, greatest_at = reached, now + unit * t_turn
                    if abs(value) > greatest * _HIGHER:
                        greatest, greatest_at = abs(value), now + unit * t
                    before, rate = t, slope
            fresh = False
            last = what == _GOES_ON and took == left
            until = horizon if last else now + unit * took
            while instant < shown.shape[1]:
                time = horizon * instant / max(shown.shape[1] - 1, 1)
                if time >= until and not last:
                    break
                t = min((time - now) / unit, took)
                shown[i, instant, SHAFT_MOMENT] = _at(s[_SHAFT], t)[0]
                shown[i, instant, MOTOR_RATE], shown[i, instant, LOAD_RATE] = _at(s[_MOTOR], t)[0], _at(s[_LOAD], t)[0]
                shown[i, instant, GAP], shown[i, instant, MOTOR_MOMENT] = _at(s[_E], t)[0], _at(s[_DRIVING], t)[0]
                instant += 1
            e, v, speed = _at(s[_E], took)[0], _at(s[_V], took)[0], _at(s[_LOAD], took)[0]
            carried = _at(s[_SHAFT], took)[0]
            now = until
            if what == _NEXT_LINE:
                row += towards
            elif what == _PARTS_WITH:
                touch = 0
            elif what == _CLOSES or what == -_CLOSES:
                touch, fresh = 1 if what > 0 else -1, True
                closings += 1
                if closings == 1:
                    impact_at, impact_speed = now, abs(v)
                carried = k * (e + (backlash if touch < 0 else 0.0)) + b * v
                if moves == 0 and abs(carried) > load:
                    moves = touch
                if moves != 0 and math.isnan(load_at):
                    load_at = now
            elif what == _LOAD_TURNS:
                if moves == 0:
                    moves = towards
                    if math.isnan(load_at):
                        load_at = now
                else:
                    # The motor keeps its own speed.
                    v, speed = v + speed, 0.0
                    moves = 0 if abs(carried) <= load else (1 if carried > 0.0 else -1)
        if now < horizon:
            for j in range(MOMENT_AT_BEGIN):
                found[i, j] = math.nan
        else:
            found[i, GREATEST], found[i, GREATEST_AT], found[i, CLOSINGS] = greatest, greatest_at, closings
            found[i, IMPACT_AT], found[i, IMPACT_SPEED], found[i, LOAD_AT] = impact_at, impact_speed, load_at
            found[i, MOTOR_SPEED], found[i, LOAD_SPEED] = speed + v, speed
        found[i, MOMENT_AT_BEGIN] = at_begin
        found[i, TOO_STIFF] = 1.0 if now < horizon and steps == most_steps else 0.0
