"""Long stretches of a stiff drive in touch under Kloss' formula, in which nothing ends its phase: in few steps.

The drive turns as a whole, slowly, and its shaft vibrates about the twist that this takes, fast. With the inertias I₁,
I₂ and their sum I, a = I₂/I, the speed P of both taken together, twist y and relative speed v = ẏ, the motor turns with
P + a v, and

    I Ṗ = M(P + a v) − M_c,   μ v̇ = τ − k y − b v,   τ = a M + (1 − a) M_c,   μ = a I₁.

The slow motion has y and v that follow P alone, v = (τ̇ − b v̇ − …)/k. About it the shaft vibrates with the rates of the
characteristic's tangent S = M′, which change slowly as P does: amplitudes e^(−½∫p dt), phases ∫√(q − ¼p² − ½ṗ) dt. An
amplitude A of the motor's speed adds ¼ M″ A² to its mean moment and ⅛ M‴ A² to S, and M″ makes a vibration of twice the
frequency. What is left out is of the fourth order in A, and in the ratio of the slow rates to the vibration's
frequency; where that isn't lost in rounding there is no such stretch. A load that sticks is one of infinite inertia.

What bounds these motions is known as for straight characteristics (`calm_stretches`): P is monotonic, as every solution
of ẋ = f(x) is, and so is the slow moment, up to the breakdown moment and beyond it.

Sources: N. N. Bogoliubov and Y. A. Mitropolsky, Asymptotic Methods in the Theory of Non-linear Oscillations (averaging,
slowly varying parameters); E. Hairer, S. P. Nørsett and G. Wanner, Solving Ordinary Differential Equations I, section
II.5 (the steps of order eight).
"""

import math

import numpy as np

from engine.compiling.decorators import inlined, routine
from engine.elements.elastic_drives.calm_stretches import HALVINGS, LEAST_TURNS, NOTHING
from engine.laws.runge_kutta import ERRORS, MATRIX, SHARE_OF_COARSE, STAGES

# Squares of slow rates over the vibration's frequency, whose squares in turn are rounding.
_SLOW = 1e-7
# Square of the greatest amplitude, over the distance of breakdown from synchronous speed: its own square is rounding.
_SMALL = 2.5e-7
# Error of a step, over the synchronous speed, and of logarithms of amplitudes.
_EXACT, _EXACT_GROWTH = 2e-16, 1e-9
_HIGHER = 1.0 + 1e-11
_SEPARATIONS = 4
_FINE, _COARSE = ERRORS[0].copy(), ERRORS[1].copy()


@inlined
def _characteristic(
    breakdown_moment: float, breakdown_slip: float, rotor_ratio: float, synchronous: float, speed: float
) -> tuple[float, float, float, float]:
    """Kloss' moment and its first three derivatives by the speed; NaN at and beyond the poles of the formula."""
    slip, damping = 1.0 - speed / synchronous, rotor_ratio * breakdown_slip
    divisor = slip * slip + damping * breakdown_slip * slip + breakdown_slip * breakdown_slip
    if slip < 0.0 and divisor <= 0.0:
        return math.nan, math.nan, math.nan, math.nan
    factor = breakdown_moment * (2.0 + damping) * breakdown_slip
    moment, bent = factor * slip / divisor, 2.0 * slip + damping * breakdown_slip
    by_slip = (factor - moment * bent) / divisor
    bend = -2.0 * (moment + by_slip * bent) / divisor
    third = -3.0 * (2.0 * by_slip + bent * bend) / divisor
    return moment, -by_slip / synchronous, bend / synchronous**2, -third / synchronous**3


@routine
def _slow_motion(
    speed: float,
    square: float,
    first: float,
    share: float,
    mobility: float,
    k: float,
    b: float,
    load: float,
    kloss: np.ndarray,
) -> tuple[float, float, float, float, float, float, float, float]:
    """Where the drive turns as a whole with a speed, under vibrations of the motor's speed of a squared amplitude.

    Returns its acceleration, the shaft's twist and relative speed, slope and bend of the characteristic, and of the
    vibration p, q and the square of its frequency, q − ¼p² − ½ṗ.
    """
    curve = kloss[0], kloss[1], kloss[2], kloss[3]
    moment, slope, bend, third = _characteristic(*curve, speed)
    rate, rate_of_rate = 0.0, 0.0
    if mobility > 0.0:
        gain = mobility * (moment - load)
        rate_of_rate = share / k * gain * (bend * gain + slope * slope * mobility)
        rate = share * slope * gain / k - b / k * rate_of_rate
        moment, slope, bend, third = _characteristic(*curve, speed + share * rate)
    moment += 0.25 * bend * square
    held = share * moment + (1.0 - share) * load
    twist = (held - b * rate - share * first * rate_of_rate) / k
    # Reciprocal inertia of the load.
    other = (1.0 - share) / (share * first)
    grows = slope * mobility
    # What drives or damps a vibration of this amplitude.
    p = (b - slope - 0.125 * third * square) / first + b * other + grows
    q = k * (1.0 / first + other) - slope * b * other / first + grows * p
    gain = mobility * (moment - load)
    square_frequency = q - 0.25 * p * p - 0.5 * bend * gain * (mobility - 1.0 / first)
    return gain, twist, rate, slope, bend, p, q, max(square_frequency, 0.0)


@routine
def _step(
    speed: float,
    size: float,
    time: float,
    first: float,
    share: float,
    mobility: float,
    k: float,
    b: float,
    load: float,
    kloss: np.ndarray,
    room: np.ndarray,
) -> tuple[float, float, float, bool]:
    """One step: speed, logarithm of the amplitude's growth, phase, and whether it is exact but for rounding."""
    for stage in range(STAGES):
        at, grown = 0.0, 0.0
        for j in range(stage):
            at += MATRIX[stage, j] * room[0, j]
            grown += MATRIX[stage, j] * room[1, j]
        square = size * size * math.exp(2.0 * time * grown)
        rates = _slow_motion(speed + time * at, square, first, share, mobility, k, b, load, kloss)
        room[0, stage], room[1, stage], room[2, stage] = rates[0], -0.5 * rates[5], math.sqrt(rates[7])
    gained, grown, turned = 0.0, 0.0, 0.0
    fine, coarse, fine_growth = 0.0, 0.0, 0.0
    for j in range(STAGES):
        weight = MATRIX[STAGES, j]
        gained, grown, turned = gained + weight * room[0, j], grown + weight * room[1, j], turned + weight * room[2, j]
        fine, coarse = fine + _FINE[j] * room[0, j], coarse + SHARE_OF_COARSE * _COARSE[j] * room[0, j]
        fine_growth += _FINE[j] * room[1, j]
    error = time * fine * fine / math.hypot(fine, coarse) if fine != 0.0 else 0.0
    exact = error <= _EXACT * abs(kloss[3]) and abs(time * fine_growth) <= _EXACT_GROWTH
    return speed + time * gained, time * grown, time * turned, exact


@inlined
def _doubled(
    bend: float, first: float, share: float, mobility: float, frequency: float, y: float, w: float
) -> tuple[float, float, float]:
    """What vibrates with twice the frequency, as the characteristic bends: twist, its rate, and speed of both."""
    push = bend * share * share
    twist = -push * ((w / frequency) ** 2 - y * y) / (12.0 * first)
    return twist, push * w * y / (3.0 * first), 0.25 * push * mobility * w * y


@inlined
def _one_way(a: float, b: float, c: float) -> bool:
    """Whether three rates have one sign."""
    return (a >= 0.0 and b >= 0.0 and c >= 0.0) or (a <= 0.0 and b <= 0.0 and c <= 0.0)


@routine
def averaged_stretch(
    twist: float,
    v: float,
    speed: float,
    first: float,
    second: float,
    k: float,
    b: float,
    kloss: np.ndarray,
    load: float,
    moves: int,
    held: int,
    greatest: float,
    followed: float,
    most: float,
    room: np.ndarray,
) -> tuple[float, float, float, float]:
    """A time in which nothing ends the phase of a drive in touch, and what it has come to then.

    Parameters
    ----------
    twist, v, speed, first, second, k, b, load, moves, held, greatest, followed, most
        As for `calm_stretches.calm_stretch`.
    kloss : ndarray (4,)
        Breakdown moment and slip, rotor ratio, synchronous speed.
    room : ndarray (3 or more, STAGES or more)
        Memory.

    Returns
    -------
    time, twist, v, speed : float
        Time 0 where it isn't worth it.
    """
    share, mobility = second / (first + second), 1.0 / (first + second)
    if moves == 0:
        share, mobility = 1.0, 0.0
    resists = moves * load
    both = first, share, mobility, k, b, resists
    total = speed + (1.0 - share) * v
    slow, square, size = total, 0.0, 0.0
    y, w, across, by_twist, by_rate, decay, frequency = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0
    gain, slope, middle, rate = 0.0, 0.0, 0.0, 0.0
    for _ in range(_SEPARATIONS):
        gain, middle, rate, slope, bend, p, q, square_frequency = _slow_motion(slow, square, *both, kloss)
        # The square of the slow rates: how fast P comes to rest, and how fast that changes.
        grows = slope * mobility
        slowest = grows * grows + abs(bend * gain) * mobility
        decay, frequency = 0.5 * p, math.sqrt(square_frequency)
        # Beside the frequency, the rate k/b of a shaft damped beyond vibration.
        if not (slowest <= _SLOW * q and b * b * slowest <= _SLOW * k * k):
            return 0.0, twist, v, speed
        twice = 0.0, 0.0, 0.0
        if frequency > 0.0:
            twice = _doubled(bend, first, share, mobility, frequency, y, w)
        y, w = twist - middle - twice[0], v - rate - twice[1]
        if not frequency > 0.0:
            if not k * abs(y) + b * abs(w) <= NOTHING * abs(k * middle):
                return 0.0, twist, v, speed
            y, w, decay, frequency = 0.0, 0.0, 0.0, math.sqrt(q)
        # What vibrates of the speed of both taken together.
        by_twist = grows * share / (1.0 + grows * (p + grows) / q)
        by_rate = -grows * by_twist / q
        slow = total - by_twist * y - by_rate * w - twice[2]
        across = (w + decay * y) / frequency
        size = math.hypot(y, across) * math.sqrt(q)
        square = (share * size) ** 2
    turn, largest = math.tau / frequency, _SMALL * (kloss[1] * kloss[3]) ** 2
    if followed < turn or not square <= largest:
        return 0.0, twist, v, speed
    moment, swing = k * middle + b * rate, size * math.hypot(k - b * decay, b * frequency) / math.sqrt(q)
    rise, fade = share * slope * gain, decay * swing
    breakdown = kloss[3] * (1.0 - kloss[1])
    # A moment that grows is greatest in the last turn.
    time = most - 1.5 * turn
    for _ in range(HALVINGS):
        if time < LEAST_TURNS * turn:
            break
        half, grown_half, turned_half, calm = _step(slow, share * size, 0.5 * time, *both, kloss, room)
        until, grown, turned, exact = half, 0.0, 0.0, False
        if calm:
            until, grown, turned, exact = _step(
                half, share * size * math.exp(grown_half), 0.5 * time, *both, kloss, room
            )
        if not exact:
            time *= 0.5
            continue
        at_half = _slow_motion(half, square * math.exp(2.0 * grown_half), *both, kloss)
        grown, turned = grown_half + grown, turned_half + turned
        at_end = _slow_motion(until, square * math.exp(2.0 * grown), *both, kloss)
        moment_end = k * at_end[1] + b * at_end[2]
        outer = max(1.0, math.exp(grown_half), math.exp(grown))
        lowest, highest = min(moment, moment_end), max(moment, moment_end)
        passes = min(slow, until) < breakdown < max(slow, until)
        if passes:
            at_breakdown = _slow_motion(breakdown, 0.0, *both, kloss)
            highest = max(highest, k * at_breakdown[1] + b * at_breakdown[2])
        lowest, highest = lowest - outer * swing, highest + outer * swing
        calm = square * outer * outer <= largest and (held == 0 or held * (lowest if held > 0 else highest) > 0.0)
        if moves == 0:
            calm &= lowest > -load and highest < load
        else:
            # Vibrations of the load's speed, with what they are now taken for granted twice.
            away = 2.0 * ((1.0 - share) * (abs(rate) + abs(at_end[2]) + outer * size) + abs(slow - total))
            low, high = min(slow, until) - away, max(slow, until) + away
            calm &= load == 0.0 or (low > 0.0 if moves > 0 else high < 0.0)
        if max(-lowest, highest) > greatest * _HIGHER:
            # Envelopes that rise, or fall, throughout.
            rises = rise, share * at_half[3] * at_half[0], share * at_end[3] * at_end[0]
            fades = fade, 0.5 * at_half[5] * swing * math.exp(grown_half), 0.5 * at_end[5] * swing * math.exp(grown)
            upper = _one_way(rises[0] - fades[0], rises[1] - fades[1], rises[2] - fades[2])
            lower = _one_way(-rises[0] - fades[0], -rises[1] - fades[1], -rises[2] - fades[2])
            calm &= upper and lower and not passes
        if calm:
            decay_end, q_end = 0.5 * at_end[5], at_end[6]
            frequency_end = math.sqrt(at_end[7])
            if not (frequency_end > 0.0 or size == 0.0):
                break
            grows = at_end[3] * mobility
            by_twist = grows * share / (1.0 + grows * (at_end[5] + grows) / q_end)
            by_rate = -grows * by_twist / q_end
            if size > 0.0:
                scale = math.exp(grown) * math.sqrt(frequency / frequency_end)
                cosine, sine = math.cos(turned), math.sin(turned)
                y, across = scale * (y * cosine + across * sine), scale * (across * cosine - y * sine)
                w = frequency_end * across - decay_end * y
            twice = 0.0, 0.0, 0.0
            if size > 0.0:
                twice = _doubled(at_end[4], first, share, mobility, frequency_end, y, w)
            twist, v = at_end[1] + y + twice[0], at_end[2] + w + twice[1]
            return time, twist, v, until + by_twist * y + by_rate * w + twice[2] - (1.0 - share) * v
        time *= 0.5
    return 0.0, twist, v, speed
