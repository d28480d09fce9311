"""Long stretches of a drive in touch under a straight characteristic, in which nothing ends its phase: at one leap.

With M = M₀ + S ω₁, twist y, relative speed v = ẏ and the load's speed ω₂, a drive whose load moves is linear: one slow
motion x = r z, in which it turns as a whole, ż = λ z + f, and a vibration of the shaft about its middle,
ÿ + p ẏ + q y = 0; λ and the roots of μ² + p μ + q are those of

    λ³ + ((b − S)/I₁ + b/I₂) λ² + (k/I₁ + k/I₂ − S b/(I₁ I₂)) λ − S k/(I₁ I₂) = 0.

Where the load sticks, there is the vibration alone. z and the vibration's envelope are monotonic. So bounds of what
ends a phase over any time are known beforehand, and that time may have as many vibrations as it likes: a shaft of any
stiffness can be followed, up to the limit of a rigid one. Of the shaft's moment every peak in such a stretch is lower
than the first, or lower than the last, which are left to be followed.

Source: A. A. Andronov, A. A. Vitt and S. E. Khaikin, Theory of Oscillators (piecewise linear systems).
"""

import math

from engine.compiling.decorators import inlined, routine

# A stretch that is leapt over has more turns of the vibration than these.
LEAST_TURNS = 6
# How often a time that isn't calm is halved, and what is nothing beside the slow moment.
HALVINGS, NOTHING = 40, 1e-13
_ITERATIONS = 60
# The slow motion counts as one where its rate is this share of the vibration's frequency.
_SLOW = 0.1
_HIGHER = 1.0 + 1e-11


@inlined
def _grown(rate: float, time: float) -> float:
    """∫ e^(rate t) dt from 0 to time."""
    x = rate * time
    return time if x == 0.0 else math.expm1(x) / rate


@routine
def calm_stretch(
    twist: float,
    v: float,
    speed: float,
    first: float,
    second: float,
    k: float,
    b: float,
    level: float,
    slope: float,
    load: float,
    moves: int,
    held: int,
    below: float,
    above: float,
    greatest: float,
    followed: float,
    most: float,
) -> tuple[float, float, float, float]:
    """A time in which nothing ends the phase of a drive in touch, and what it has come to then.

    Parameters
    ----------
    twist, v, speed : float
        Twist of the shaft, its rate, and speed of the load.
    first, second, k, b : float
        Inertias, stiffness, damping.
    level, slope : float
        The motor's moment is level + slope ω₁.
    load : float
        What the load resists with.
    moves : int
        Which way the load moves; 0 where it sticks.
    held : int
        Sign that the shaft's moment has to keep, 0 for any.
    below, above : float
        Speeds of the motor between which its characteristic is this line.
    greatest : float
        Greatest magnitude of the shaft's moment so far.
    followed : float
        For how long it has been followed since the phase began, or since the last leap: a turn at least is needed.
    most : float
        No longer than this.

    Returns
    -------
    time, twist, v, speed : float
        Time 0 where it isn't worth it.
    """
    rate, f, slip, r1, z = 0.0, 0.0, 0.0, 1.0, 0.0
    left_twist, left_load, whole = 0.0, 0.0, 1.0
    if moves != 0:
        both = first * second
        c2, c1 = (b - slope) / first + b / second, k * (1.0 / first + 1.0 / second) - slope * b / both
        start = slope * k / both
        for _ in range(_ITERATIONS):
            new = start / (c1 + rate * (c2 + rate))
            if abs(new - rate) <= 2e-16 * abs(new):
                break
            rate = new
        p, q = c2 + rate, c1 + rate * (c2 + rate)
        if not abs(rate) < _SLOW * math.sqrt(max(q, 0.0)):
            return 0.0, twist, v, speed
        # Right and left vectors of the slow motion: of twist, motor and load, and of twist, relative speed and load.
        r0 = rate * second / (k + b * rate)
        slip = rate * r0
        r1 = 1.0 + slip
        left_load = both * q / k - first
        left_twist = rate * first - slope + b * (1.0 - left_load / second)
        whole = left_twist * r0 + first * r1 + left_load
        z = (left_twist * twist + first * (v + speed) + left_load * speed) / whole
        f = (level - left_load * moves * load / second) / whole
        push = level / first + moves * load / second - slip * f
    else:
        p, q, r0 = (b - slope) / first, k / first, 0.0
        push = level / first
    # The vibration about its middle; while the slow motion changes, so does the twist, by −r₀ f.
    drift = -r0 * f
    middle = (push + p * drift) / q
    y, w = twist - r0 * z - middle, v - slip * z + drift
    level_moment, slope_moment = k * middle - b * drift, rate * second
    decay, frequency = 0.5 * p, math.sqrt(max(q - 0.25 * p * p, 0.0))
    if not frequency > 0.0:
        # Damped beyond vibration: there is none once that is over.
        if not k * abs(y) + b * abs(w) <= NOTHING * (abs(level_moment) + abs(slope_moment * z)):
            return 0.0, twist, v, speed
        y, w, decay, frequency = 0.0, 0.0, 0.0, math.sqrt(q)
    turn = math.tau / frequency
    if followed < turn:
        return 0.0, twist, v, speed
    across = (w + decay * y) / frequency
    size = math.hypot(y, across)
    swing = size * math.hypot(k - b * decay, b * frequency)
    size_rate = size * math.sqrt(q)
    swing_load = swing / (second * math.sqrt(q)) if moves != 0 else 0.0
    swing_motor = swing_load + size_rate
    # A moment that grows is greatest in the last turn.
    time = most - 1.5 * turn
    for _ in range(HALVINGS):
        if time < LEAST_TURNS * turn:
            break
        grown = math.exp(-decay * time)
        outer = max(1.0, grown)
        until = math.exp(rate * time) * z + f * _grown(rate, time)
        low, high = min(z, until), max(z, until)
        lowest = min(level_moment + slope_moment * low, level_moment + slope_moment * high) - outer * swing
        highest = max(level_moment + slope_moment * low, level_moment + slope_moment * high) + outer * swing
        calm = held == 0 or held * (lowest if held > 0 else highest) > 0.0
        if moves == 0:
            calm &= lowest > -load and highest < load
        else:
            away = abs(speed - z) + (1.0 + outer) * swing_load
            calm &= load == 0.0 or (low - away > 0.0 if moves > 0 else high + away < 0.0)
        away = abs(v + speed - r1 * z) + (1.0 + outer) * swing_motor
        calm &= min(r1 * low, r1 * high) - away > below and max(r1 * low, r1 * high) + away < above
        if max(-lowest, highest) > greatest * _HIGHER:
            # Envelopes |T| are sums of two exponentials: monotonic where they rise, or fall, at both ends.
            slow, fast = slope_moment * (rate * z + f), -decay * swing
            slow_end, fast_end = slow * math.exp(rate * time), fast * grown
            upper = (slow + fast) * (slow_end + fast_end) >= 0.0
            lower = (-slow + fast) * (-slow_end + fast_end) >= 0.0
            calm &= upper and lower
        if calm:
            cosine, sine = math.cos(frequency * time), math.sin(frequency * time)
            y, w = grown * (y * cosine + across * sine), grown * (w * cosine - (q * y + decay * w) / frequency * sine)
            twist, v = y + r0 * until + middle, w + slip * until - drift
            if moves != 0:
                speed = (whole * until - left_twist * twist - first * v) / (first + left_load)
            return time, twist, v, speed
        time *= 0.5
    return 0.0, twist, v, speed
