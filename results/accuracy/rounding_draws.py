"""Random arguments of the scalar functions: by the parameters' names, over wide ranges and near singular places."""

import inspect
import math
from collections.abc import Callable

import numpy as np

from engine.laws.tables import make_table

Draws = Callable[[np.random.Generator, bool], dict]
DECADES = 6.0


def size(rng: np.random.Generator, decades: float = DECADES) -> float:
    """A positive number, evenly by its logarithm."""
    return 10.0 ** rng.uniform(-decades, decades)


def signed(rng: np.random.Generator, decades: float = DECADES) -> float:
    """A number of either sign, evenly by its logarithm."""
    return rng.choice([-1.0, 1.0]) * size(rng, decades)


def tiny(rng: np.random.Generator, decades: float = 10.0) -> float:
    """A share from 10^-decades to one half."""
    return 10.0 ** rng.uniform(-decades, math.log10(0.5))


def between(low: float, high: float) -> Callable[[np.random.Generator], float]:
    """Evenly between two numbers."""
    return lambda rng: rng.uniform(low, high)


# What a parameter of a name is in any function; of all other names, a number of either sign.
NAMED = {
    **dict.fromkeys(("r1", "r2", "radius", "mate_radius", "half_length", "length", "h"), size),
    **dict.fromkeys(("inertia", "m2", "t", "width", "stribeck_speed", "linear_density", "diameter", "height"), size),
    **dict.fromkeys(("load", "lead", "mean_diameter", "mean_radius", "collar_radius", "pressure", "arm"), size),
    **dict.fromkeys(("tight", "slack", "arm_below", "arm_above", "stiffness", "magnitude", "resistance"), size),
    **dict.fromkeys(
        ("friction", "base_friction", "guide_friction", "collar", "slope"), lambda rng: size(rng, 2.0) / 100
    ),
    **dict.fromkeys(("static", "kinetic", "factor"), lambda rng: size(rng, 1.5)),
    "sine": lambda rng: rng.choice([-1.0, 1.0]) * tiny(rng, 7.0),
    "mode": lambda rng: rng.choice([-1.0, 1.0]),
    "angle": between(0.0, 1.57),
    "pull_angle": between(-1.57, 1.57),
    "half_angle": between(0.01, 1.5),
    "wrap": between(0.0, 12.0),
    "exponent": between(0.0, 4.0),
    "delta": lambda rng: tiny(rng, 12.0),
    "toward_head": lambda rng: bool(rng.integers(2)),
    "stroke_number": lambda rng: int(rng.integers(4)),
    "intake": lambda rng: size(rng, 1.0) * 1e5,
    "exhaust": lambda rng: size(rng, 1.0) * 1e5,
    # Expansion, outflow, inflow, compression.
    "branch": lambda rng: int(rng.integers(4)),
    "inflow": lambda rng: size(rng, 1.0) * 1e5,
    "outflow": lambda rng: size(rng, 1.0) * 1e5,
    "peak": lambda rng: size(rng, 1.0) * 1e6,
    "n_compression": between(1.0, 1.7),
    "n_expansion": between(1.0, 1.7),
    "port": between(0.5, 0.95),
}


def triangle(rng: np.random.Generator, near: bool) -> dict:
    """Outer joints that the links reach, of links of any ratio, up to 1e-12 from the dead centres."""
    r1, r2 = size(rng), 1.0
    share = tiny(rng, 12.0 if near else 0.5)
    share = 1.0 - share if rng.integers(2) else share
    distance = abs(r1 - r2) + share * 2.0 * min(r1, r2)
    at, scale = rng.uniform(-math.pi, math.pi), size(rng, 3.0)
    ax, ay = signed(rng, 2.0), signed(rng, 2.0)
    dx, dy = ax + scale * distance * math.cos(at), ay + scale * distance * math.sin(at)
    return {"ax": ax, "ay": ay, "dx": dx, "dy": dy, "r1": scale * r1, "r2": scale * r2}


def rod_on_guide(rng: np.random.Generator, near: bool) -> dict:
    """A rod that reaches the guide, up to 1e-12 from being square to it."""
    at, r1 = rng.uniform(-math.pi, math.pi), size(rng)
    given = {"ax": signed(rng, 3), "ay": signed(rng, 3), "gx": signed(rng, 3), "gy": signed(rng, 3)}
    c, s = math.cos(at), math.sin(at)
    across = (given["ay"] - given["gy"]) * c - (given["ax"] - given["gx"]) * s
    height = rng.choice([-1.0, 1.0]) * (1.0 - tiny(rng, 12.0 if near else 0.5))
    return {**given, "c": c, "s": s, "r1": r1, "offset": across - height * r1}


def rocker(rng: np.random.Generator, near: bool) -> dict:
    """A block beyond its offset, up to 1e-12 from it."""
    at, distance = rng.uniform(-math.pi, math.pi), size(rng)
    dx, dy = signed(rng, 3.0), signed(rng, 3.0)
    ax, ay = dx + distance * math.cos(at), dy + distance * math.sin(at)
    offset = rng.choice([-1.0, 1.0]) * (1.0 - tiny(rng, 12.0 if near else 0.5)) * math.hypot(ax - dx, ay - dy)
    return {"ax": ax, "ay": ay, "dx": dx, "dy": dy, "offset": offset}


def directions(rng: np.random.Generator, near: bool) -> dict:
    """Two directions, up to 1e-10 from parallel."""
    first = rng.uniform(-math.pi, math.pi)
    second = first + (tiny(rng) + rng.choice([0.0, math.pi]) if near else rng.uniform(0.1, 3.0))
    return {"c1": math.cos(first), "s1": math.sin(first), "c2": math.cos(second), "s2": math.sin(second)}


def stroke(rng: np.random.Generator, near: bool) -> dict:
    """Travel within the stroke, the clearance, and pressures before and behind the valves."""
    length, suction = size(rng, 3.0), size(rng, 1.0) * 1e5
    travel = length * (tiny(rng) if near else rng.uniform(0.0, 1.0))
    clearance, discharge = 10.0 ** rng.uniform(-3, 0), suction * rng.uniform(1.1, 20.0)
    given = {"travel": travel, "stroke": length, "clearance": clearance, "suction": suction, "discharge": discharge}
    return {**given, "before": size(rng, 1.0), "after": size(rng, 1.0), "length": travel + clearance * length}


def two_stroke(rng: np.random.Generator, near: bool) -> dict:
    """As `stroke`, of an engine with two strokes."""
    return {**stroke(rng, near), "stroke_number": int(rng.integers(2))}


def induction(rng: np.random.Generator, near: bool) -> dict:
    """Speeds from backwards to beyond synchronous, up to 1e-10 from it."""
    synchronous = size(rng, 3.0)
    slip = rng.choice([-1.0, 1.0]) * tiny(rng) if near else rng.uniform(-1.0, 2.0)
    ratio = {"rotor_ratio": rng.uniform(0.0, 2.0), "breakdown_slip": tiny(rng, 3.0)}
    return {"synchronous_speed": synchronous, "omega": synchronous * (1.0 - slip), **ratio}


def direct_current(rng: np.random.Generator, near: bool) -> dict:
    """Speeds up to 1e-10 from no load."""
    no_load = signed(rng, 3.0)
    return {"no_load_speed": no_load, "omega": no_load * (1.0 - tiny(rng) if near else rng.uniform(-1.0, 2.0))}


def two_speeds(rng: np.random.Generator, near: bool) -> dict:
    """Two speeds, up to 1e-10 from one another, and moments of like size."""
    omega0 = size(rng, 2.0)
    omega = omega0 * (1.0 + rng.choice([-1.0, 1.0]) * tiny(rng)) if near else size(rng, 2.0)
    m0, m1 = signed(rng, 2.0), signed(rng, 2.0)
    return {"omega0": omega0, "omega": omega, "m0": m0, "m1": m1, "m2": size(rng, 2.0), "inertia": size(rng, 2.0)}


def some_time(rng: np.random.Generator, near: bool) -> dict:
    """A time that is short beside the time constant, or of its order."""
    inertia, m1 = size(rng, 2.0), signed(rng, 2.0)
    x = tiny(rng) if near else rng.uniform(0.0, 20.0)
    time = x * inertia / abs(m1)
    return {"inertia": inertia, "m1": m1, "t": time, "m0": signed(rng, 2.0), "omega0": signed(rng, 2.0)}


def fan_time(rng: np.random.Generator, near: bool) -> dict:
    """A time that is short beside the time constant of a fan, or of its order."""
    inertia, m0, m2 = size(rng, 2.0), signed(rng, 2.0), size(rng, 2.0)
    x = tiny(rng) if near else rng.uniform(0.0, 3.0)
    time = x * inertia / math.sqrt(abs(m0) * m2)
    return {"inertia": inertia, "m0": m0, "m2": m2, "t": time, "omega0": size(rng, 2.0)}


def two_numbers(rng: np.random.Generator, near: bool) -> dict:
    """Two numbers of one sign, up to 1e-10 from one another."""
    a = signed(rng)
    return {"a": a, "b": a * (1.0 + tiny(rng) if near else size(rng))}


def any_table(rng: np.random.Generator, near: bool) -> dict:
    """A spline through six rows, at a place within it, up to 1e-10 from a row."""
    x = np.cumsum(rng.uniform(0.2, 2.0, 6)) + rng.uniform(-5.0, 5.0)
    table = make_table(x, rng.uniform(-1.0, 1.0, 6), "spline")
    at = x[rng.integers(5)] + 0.2 * (tiny(rng) if near else rng.uniform(0.0, 1.0))
    return {**table._asdict(), "x": at}


def friction_of_motion(rng: np.random.Generator, near: bool) -> dict:
    """Speeds of the order of the width of a smoothed sign, or far above it."""
    width = size(rng, 2.0)
    speed = width * (rng.uniform(0.0, 5.0) if near else size(rng, 2.0))
    return {"width": width, "speed": speed, "least_speed": speed, "stribeck_speed": width}


def cosine_near_zero(rng: np.random.Generator, near: bool) -> dict:
    """Angles up to a hundred turns, some of them near a multiple of a right angle."""
    angle = rng.integers(-400, 400) * math.pi / 2 + signed(rng) * 1e-6 if near else signed(rng, 2.8)
    return {"angle": angle}


DRAWS: dict[str, Draws] = {
    **dict.fromkeys(("rrr_position",), triangle),
    **dict.fromkeys(("rrp_position",), rod_on_guide),
    **dict.fromkeys(("rpr_position",), rocker),
    **dict.fromkeys(("oblique_components", "prp_reactions", "rpp_reactions", "rrr_rates", "rrr_reactions"), directions),
    **dict.fromkeys(("polytropic_compressor", "four_stroke_engine", "_gas_length", "_polytropic"), stroke),
    **dict.fromkeys(("_compressor_compression",), lambda rng, near: {**stroke(rng, near), "most": size(rng, 1.0)}),
    "branch_pressure": stroke,
    "two_stroke_engine": two_stroke,
    "induction_motor": induction,
    "induction_motor_slope": induction,
    "dc_motor": direct_current,
    **dict.fromkeys(
        ("constant_moment_to_speed", "linear_moment_to_speed", "quadratic_moment_to_speed", "ahead"), two_speeds
    ),
    **dict.fromkeys(("constant_moment", "constant_moment_to_angle"), some_time),
    **dict.fromkeys(("linear_moment", "linear_moment_squares"), some_time),
    "quadratic_moment": fan_time,
    "logarithmic_mean": two_numbers,
    "table_value": any_table,
    **dict.fromkeys(("tanh_sign", "tanh_sign_error", "root_sign", "root_sign_error", "stribeck"), friction_of_motion),
    "direction_of": cosine_near_zero,
    "exponential": lambda rng, near: {"x": signed(rng, 2.0)},
    "arcsine": lambda rng, near: {"x": 1.0 - tiny(rng) if near else tiny(rng)},
    **dict.fromkeys(("logarithm", "power"), lambda rng, near: {"x": 1.0 + tiny(rng) if near else size(rng)}),
    "transmission_angle": lambda rng, near: {"sine": 1.0 - tiny(rng) if near else tiny(rng)},
}


_PAIRS = (("c", "s"), ("cosine", "sine"), ("c1", "s1"), ("c2", "s2"), ("slot_c", "slot_s"))


def arguments_of(function: Callable, rng: np.random.Generator, near: bool, dtype: type) -> list:
    """Arguments of a function in a precision; c and s (c1 and s1, …) are cosine and sine of an angle."""
    names = list(inspect.signature(function).parameters)
    given = DRAWS[function.__name__](rng, near) if function.__name__ in DRAWS else {}
    for c, s in _PAIRS:
        if c in names and s in names and c not in given:
            angle = rng.uniform(-math.pi, math.pi)
            given |= {c: math.cos(angle), s: math.sin(angle)}
    for name in names:
        if name not in given:
            given[name] = NAMED.get(name, signed)(rng)
    return [_in_precision(given[name], dtype) for name in names]


def _in_precision(argument: object, dtype: type) -> object:
    if isinstance(argument, (bool, int)):
        return argument
    return argument.astype(dtype) if isinstance(argument, np.ndarray) else dtype(argument)
