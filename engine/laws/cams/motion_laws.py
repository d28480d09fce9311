"""Motion laws of followers on a unit interval: displacement S(u) from 0 to 1 and its first three derivatives.

A section of a cam over the angle β with the stroke h has s = h S(u), s' = h S'/β, s'' = h S''/β², s''' = h S'''/β³. A
law of several expressions takes a position `held` that selects one of them, so each expression is smooth up to both of
its ends.

Source: R. L. Norton, Cam Design and Manufacturing Handbook (double-dwell functions).
"""

import math

import numpy as np

from engine.compiling.decorators import scalar
from engine.laws.elementary import direction_of

Motion = tuple[float, float, float, float]

# Kinds of motion in a section, as numbers for compiled code, and the names of the laws in scene files.
DWELL, UNIFORM, PARABOLIC, HARMONIC, CYCLOIDAL, P345, P4567, SINE, TRAPEZOID = range(9)
LAW_KINDS = {
    "uniform": UNIFORM,
    "parabolic": PARABOLIC,
    "harmonic": HARMONIC,
    "cycloidal": CYCLOIDAL,
    "3-4-5": P345,
    "4-5-6-7": P4567,
    "modified sine": SINE,
    "modified trapezoid": TRAPEZOID,
}
# Positions on the unit interval where the expressions of a law meet.
LAW_BREAKS = {PARABOLIC: (0.5,), SINE: (0.125, 0.875), TRAPEZOID: (0.125, 0.375, 0.625, 0.875)}


@scalar
def no_motion(u: float) -> Motion:
    """Dwell."""
    return 0.0 * u, 0.0, 0.0, 0.0


@scalar
def uniform_motion(u: float) -> Motion:
    """Constant velocity."""
    return u, 1.0, 0.0, 0.0


@scalar
def parabolic_motion(u: float, held: float) -> Motion:
    """Constant acceleration in the first half, equal deceleration in the second."""
    if held < 0.5:
        return 2.0 * u * u, 4.0 * u, 4.0, 0.0
    v = 1.0 - u
    return 1.0 - 2.0 * v * v, 4.0 * v, -4.0, 0.0


@scalar
def harmonic_motion(u: float) -> Motion:
    """Simple harmonic motion over half its period."""
    # The half angle avoids cancellation in 1 − cos πu near the start.
    c, s = direction_of(0.5 * math.pi * u)
    return s * s, math.pi * s * c, math.pi**2 / 2 * (c * c - s * s), -(math.pi**3) * s * c


@scalar
def cycloidal_motion(u: float) -> Motion:
    """Acceleration by a full sine wave."""
    a = math.tau * u
    c, s = direction_of(a)
    return u - s / math.tau, 1.0 - c, math.tau * s, 4.0 * math.pi**2 * c


@scalar
def polynomial_345(u: float) -> Motion:
    """Polynomial 3-4-5: velocity and acceleration are zero at both ends."""
    v = 1.0 - u
    return (
        u**3 * (10.0 - 15.0 * u + 6.0 * u * u),
        30.0 * u * u * v * v,
        60.0 * u * v * (1.0 - 2.0 * u),
        60.0 * (1.0 - 6.0 * u * v),
    )


@scalar
def polynomial_4567(u: float) -> Motion:
    """Polynomial 4-5-6-7: the jerk is zero at both ends, too."""
    v = 1.0 - u
    return (
        u**4 * (35.0 - 84.0 * u + 70.0 * u**2 - 20.0 * u**3),
        140.0 * (u * v) ** 3,
        420.0 * (u * v) ** 2 * (1.0 - 2.0 * u),
        840.0 * u * v * (1.0 - 5.0 * u * v),
    )


@scalar
def modified_sine(u: float, held: float) -> Motion:
    """Modified sine: acceleration by a quarter of a short sine wave at each end and half a long one in between."""
    if held > 0.875:
        s, s1, s2, s3 = _short_wave(1.0 - u)
        return 1.0 - s, s1, -s2, s3
    if held < 0.125:
        return _short_wave(u)
    a = 4.0 * math.pi / 3.0 * u + math.pi / 3.0
    c, s = direction_of(a)
    k = 1.0 / (4.0 + math.pi)
    return (
        k * (2.0 + math.pi * u - 2.25 * s),
        k * math.pi * (1.0 - 3.0 * c),
        k * 4.0 * math.pi**2 * s,
        k * 16.0 / 3.0 * math.pi**3 * c,
    )


@scalar
def _short_wave(u: float) -> Motion:
    """First eighth of the modified sine."""
    a = 4.0 * math.pi * u
    c, s = direction_of(a)
    k = math.pi / (4.0 + math.pi)
    return k * (u - s / (4.0 * math.pi)), k * (1.0 - c), k * 4.0 * math.pi * s, k * 16.0 * math.pi**2 * c


@scalar
def modified_trapezoid(u: float, held: float) -> Motion:
    """Modified trapezoid of acceleration: its flanks are quarters of a sine wave."""
    if held <= 0.5:
        return _half_trapezoid(u, held)
    s, s1, s2, s3 = _half_trapezoid(1.0 - u, 1.0 - held)
    return 1.0 - s, s1, -s2, s3


@scalar
def _half_trapezoid(u: float, held: float) -> Motion:
    peak = 8.0 * math.pi / (2.0 + math.pi)
    w = 4.0 * math.pi
    if held < 0.125:
        c, s = direction_of(w * u)
        return peak / w * (u - s / w), peak / w * (1.0 - c), peak * s, peak * w * c
    v = u - 0.125
    reached = peak / w * (0.125 - 1.0 / w)
    if held < 0.375:
        return reached + peak * v * (1.0 / w + 0.5 * v), peak * (1.0 / w + v), peak, 0.0
    reached += 0.25 * peak * (1.0 / w + 0.125)
    v = u - 0.375
    c, s = direction_of(w * v)
    return (
        reached + peak * (v * (1.0 / w + 0.25) + (1.0 - c) / w**2),
        peak * (1.0 / w + 0.25 + s / w),
        peak * c,
        -peak * w * s,
    )


@scalar
def motion_if(kind: float, own: float, motion: Motion, other: Motion) -> Motion:
    """A motion where the section is of its own kind, else another motion."""
    return motion if kind == own else other


# Laws by kind; those with breaks also take a position that selects an expression.
MOTIONS = {
    DWELL: no_motion,
    UNIFORM: uniform_motion,
    PARABOLIC: parabolic_motion,
    HARMONIC: harmonic_motion,
    CYCLOIDAL: cycloidal_motion,
    P345: polynomial_345,
    P4567: polynomial_4567,
    SINE: modified_sine,
    TRAPEZOID: modified_trapezoid,
}
# Numbers of a section in the table that `section_at` searches.
SECTION_NUMBERS = 5


@scalar
def section_at(
    memory: np.ndarray, begin: int, apart: int, sections: float, turned: float
) -> tuple[float, float, float, float, float]:
    """Section of a cam at an angle.

    Parameters
    ----------
    memory, begin, apart
        A table of numbers: for each section, in order, those returned, with its start in the first turn.
    sections : float
        Number of sections.
    turned : float
        Angle of the cam, in any turn [rad].

    Returns
    -------
    start : float
        Start of the section in the turn of the angle [rad].
    angle : float
        Length of the section [rad].
    before, stroke : float
        Displacement at its start, and the follower's travel in it.
    kind : float
        Kind of its law.
    """
    turns = math.tau * math.floor(turned * (0.5 / math.pi))
    x, at = turned - turns, begin
    for k in range(1, int(sections)):
        row = begin + SECTION_NUMBERS * k * apart
        if memory[row] <= x:
            at = row
    two, four = 2 * apart, 4 * apart
    return memory[at] + turns, memory[at + apart], memory[at + two], memory[at + two + apart], memory[at + four]
