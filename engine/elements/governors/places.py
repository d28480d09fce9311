"""A governor at one position: everything that statics and motion need of it, whatever its kind.

The numbers of a variant stand in a row, in the order of the constants below; what a kind of governor or an engine
doesn't have is not read. Tables are the same for all variants and stand one after another in a memory.
"""

from enum import IntEnum

from engine.compiling.decorators import routine
from engine.cycle.panels.lanes import Memory
from engine.laws.governors.equilibrium import (
    controlling_force,
    equilibrium_speed,
    holding,
    moving_inertia,
    sleeve_equivalent,
    sleeve_stiffness,
    stability_margin,
)
from engine.laws.governors.linkages import balls_on_bell_cranks, balls_on_lower_arms, balls_on_upper_arms
from engine.laws.rounding import EPS
from engine.laws.tables import table_segment

BALL, SLEEVE, STIFFNESS, PRELOAD, GRAVITY, FRICTION, DAMPING, LEAST, GREATEST, CHANGE = range(10)
GEOMETRY = 10
GEOMETRY_NUMBERS = 6
ENGINE = GEOMETRY + GEOMETRY_NUMBERS
INERTIA, RATIO, FULL, CLOSED, SELF_REGULATION, LOAD, NEW_LOAD, DURATION, BAND, SWITCH = range(ENGINE, ENGINE + 10)
NUMBERS = ENGINE + 10
# Where the engine is a mechanism, curves over its cycle follow, each at so many equally spaced crank angles: what its
# reduced inertia is beside the mean, the derivative of that by the angle, what drives it over the mean of that, and
# what else acts, without its mean; and the length of the cycle.
CYCLE_POSITIONS = 360
CURVES = 4
CYCLE_LENGTH = NUMBERS + CURVES * CYCLE_POSITIONS

# What the motion begins from: positions of the stops, of half the lift, of the loads before and after their change; the
# mean speed.
INNER, OUTER, MIDDLE, BEFORE, AFTER, MEAN_KEPT = range(6)


class Holding(IntEnum):
    """What a governor is: how its balls move, or over what its controlling force is tabled."""

    UPPER_ARMS = 0
    LOWER_ARMS = 1
    BELL_CRANKS = 2
    OVER_RADIUS = 3
    OVER_LIFT = 4


class Throttling(IntEnum):
    """How the engine's moment depends on the lift of the sleeve; none without an engine."""

    NONE = 0
    LINEAR = 1
    TABLE = 2
    FULL_AND_SHUT = 3


_UPPER_ARMS, _LOWER_ARMS, _BELL_CRANKS = (int(k) for k in tuple(Holding)[:3])
_OVER_RADIUS = int(Holding.OVER_RADIUS)
_LINEAR, _TABLE, _FULL_AND_SHUT = (int(k) for k in tuple(Throttling)[1:])


@routine
def linkage_at(kind: int, p: Memory, x: float) -> tuple[float, float, float, float, float, float, float, float]:
    """r, r', r'', h', h'', z, z', z'' of a governor at a position.

    Parameters
    ----------
    kind : int
        `Holding`.
    p : Memory (NUMBERS,)
    x : float
        Position: radius of the joint of arms, or of the balls [m].

    Returns
    -------
    tuple of 8 floats
        As `engine.laws.governors.linkages` has them.
    """
    g = GEOMETRY
    if kind == _UPPER_ARMS:
        return balls_on_upper_arms(x, p[g], p[g + 1], p[g + 2], p[g + 3], p[g + 4])
    if kind == _LOWER_ARMS:
        return balls_on_lower_arms(x, p[g], p[g + 1], p[g + 2], p[g + 3], p[g + 4], p[g + 5])
    if kind == _BELL_CRANKS:
        return balls_on_bell_cranks(x, p[g], p[g + 1], p[g + 2])
    return x, 1.0, 0.0, 0.0, 0.0, (x - p[LEAST]) * p[g], p[g], 0.0


@routine
def value_and_rate(memory: Memory, offset: float, u: float) -> tuple[float, float]:
    """Value and slope of a table in memory.

    It is called, not inlined: what arrays cost in bookkeeping is then paid for by governors with tables alone.
    """
    left, c3, c2, c1, c0 = table_segment(memory, offset, u)
    t = u - left
    return ((c3 * t + c2) * t + c1) * t + c0, (3.0 * c3 * t + 2.0 * c2) * t + c1


@routine
def held_at(kind: int, p: Memory, memory: Memory, x: float, link: tuple, zero: float) -> tuple[float, float, float]:
    """V', V'' at a position, and the magnitudes that V' is a sum of.

    Parameters
    ----------
    kind : int
    p : Memory (NUMBERS,)
    memory : Memory
        Tables, that of the controlling force first.
    x : float
    link : tuple of 8 floats
        `linkage_at` that position.
    zero : float
        Height of the sleeve at the inner stop, as `linkage_at` counts it [m].

    Returns
    -------
    tuple of 3 floats
    """
    _, _, _, h1, h2, z, z1, z2 = link
    if kind >= _OVER_RADIUS:
        u, rate = (x, 1.0) if kind == _OVER_RADIUS else (z - zero, z1)
        force, change = value_and_rate(memory, 0.0, u)
        return 2.0 * force, 2.0 * rate * change, abs(2.0 * force)
    ball = p[BALL] * p[GRAVITY]
    spring, weight = p[STIFFNESS] * (z - zero), p[SLEEVE] * p[GRAVITY]
    slope, curvature = holding(ball, weight + p[PRELOAD] + spring, p[STIFFNESS], h1, h2, z1, z2)
    size = 2.0 * ball * abs(h1) + (weight + abs(p[PRELOAD]) + p[STIFFNESS] * (abs(z) + abs(zero))) * abs(z1)
    return slope, curvature, size


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
def rounding_of_margin(kind: int, p: Memory, memory: Memory, x: float, zero: float, margin: float) -> float:
    """What rounding may move the stability of a governor at a position by."""
    slope, _, size = held_at(kind, p, memory, x, linkage_at(kind, p, x), zero)
    return 32.0 * EPS * (1.0 + abs(margin + 1.0)) * (1.0 + size / abs(slope))


@routine
def throttle_at(
    throttle: int, p: Memory, memory: Memory, offset: float, lift: float, whole: float
) -> tuple[float, float]:
    """Moment of the engine at the mean speed of the governor, and by how much it falls for each metre of lift.

    Parameters
    ----------
    throttle : int
        `Throttling`, but NONE.
    p : Memory (NUMBERS,)
    memory : Memory
        Tables.
    offset : float
        Where the table of the throttle begins in it.
    lift, whole : float
        Of the sleeve, and its greatest [m].

    Returns
    -------
    tuple of 2 floats
        [N·m], [N]; a valve that is open or shut falls by nothing beside its switch.
    """
    if throttle == _LINEAR:
        fall = (p[FULL] - p[CLOSED]) / whole
        return p[FULL] - fall * lift, fall
    if throttle == _TABLE:
        moment, rise = value_and_rate(memory, offset, lift)
        return moment, -rise
    return (p[FULL] if lift <= p[SWITCH] else p[CLOSED]), 0.0
