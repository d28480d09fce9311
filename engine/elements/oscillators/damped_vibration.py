"""Free damped vibration of scalars, for compiled code; `one_mass.free_motion` takes arrays."""

import math

from engine.compiling.decorators import inlined, routine

_NEVER = math.inf


@inlined
def damped_vibration(w: float, beta: float, u: float, v: float, time: float) -> tuple[float, float]:
    """Displacement and velocity of a free vibration ü + 2βu̇ + w²u = 0, a time after they were u and v."""
    square = (w - beta) * (w + beta)
    x_square, decay = square * time * time, math.exp(-beta * time)
    if x_square < -0.01:
        # Far above critical damping, separate exponentials avoid the cancellation in the rate.
        root = math.sqrt(-square)
        slow, fast = -w * w / (beta + root), -(beta + root)
        first, second = (v - fast * u) / (2.0 * root), (slow * u - v) / (2.0 * root)
        first, second = first * math.exp(slow * time), second * math.exp(fast * time)
        return first + second, slow * first + fast * second
    # e^(−βt) cos ω_d t and e^(−βt) sin(ω_d t)/ω_d.
    if x_square > 0.01:
        root = math.sqrt(square)
        cosine, sine = decay * math.cos(root * time), decay * math.sin(root * time) / root
    else:
        cosine = 1.0 - x_square / 2.0 * (1.0 - x_square / 12.0 * (1.0 - x_square / 30.0 * (1.0 - x_square / 56.0)))
        sine = 1.0 - x_square / 6.0 * (1.0 - x_square / 20.0 * (1.0 - x_square / 42.0 * (1.0 - x_square / 72.0)))
        cosine, sine = decay * cosine, decay * time * sine
    return u * cosine + (v + beta * u) * sine, v * cosine - (beta * v + w * w * u) * sine


@routine
def next_turn(w: float, beta: float, value: float, rate: float) -> float:
    """Time of the first stationary point of a free damped vibration with given initial value and rate; inf if none."""
    square = (w - beta) * (w + beta)
    below = beta * rate + w * w * value
    if square > 0.0:
        root = math.sqrt(square)
        angle = math.atan2(root * rate, below)
        # Within (0, π]: a stationary start doesn't count.
        if angle <= 1e-12:
            angle += math.pi
        return min(angle, math.pi) / root
    if below == 0.0:
        return _NEVER
    root = math.sqrt(-square)
    x = root * rate / below
    if root == 0.0:
        return rate / below if rate / below > 0.0 else _NEVER
    return math.atanh(x) / root if 0.0 < x < 1.0 else _NEVER
