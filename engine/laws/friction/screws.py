"""Screws: torques to raise and to lower a load, self-locking and efficiency.

A thread of mean radius r is an incline of slope t = tan(beta) = lead/(2 pi r) wound on a cylinder. Flanks inclined by
gamma to the plane normal to the axis, half of the thread angle (square 0, trapezoidal 15, metric 30 degrees), act like
a V guide: the friction of the square thread becomes f* = f/cos(gamma) = tan(phi*).
Lowering reverses the rotation: a negative torque means that the load drives the screw and must be held.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines (friction in the screw pair); R. G. Budynas and
J. K. Nisbett, Shigley's Mechanical Engineering Design, chapter 8.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.friction.inclines import push_down, push_up


@scalar
def thread_slope(lead: float, mean_diameter: float) -> float:
    """Slope of a thread on its mean cylinder, tan(beta) = lead/(pi d).

    Parameters
    ----------
    lead, mean_diameter : float
        Advance per turn, pitch times number of starts, and d [m].
    """
    return lead / (math.pi * mean_diameter)


@scalar
def flank_friction(friction: float, half_angle: float) -> float:
    """Equivalent coefficient of friction of a thread, for the axial force: f* = f/cos(gamma).

    Parameters
    ----------
    friction, half_angle : float
        f, half of the thread angle gamma [rad].

    Notes
    -----
    As in textbooks, gamma is the angle in the axial section. The flank is inclined by the smaller angle of the normal
    section, tan(gamma_n) = tan(gamma) cos(beta), so f* is too large by about f sin(gamma) tan(gamma) tan²(beta)/2:
    relative to f*, 1e-4 for a metric thread with beta = 1.5 degrees and 3e-4 for a trapezoidal one with 5.
    """
    return friction / math.cos(half_angle)


@scalar
def raise_moment(load: float, radius: float, slope: float, friction: float) -> float:
    """Torque in the thread that raises a load: Q r tan(beta + phi*).

    Parameters
    ----------
    load, radius, slope, friction : float
        Q [N], mean radius r [m], tan(beta), f*.

    Returns
    -------
    float
        [N·m]; infinite where the thread jams, beta + phi* >= 90 degrees.
    """
    return radius * push_up(load, slope, friction)


@scalar
def lower_moment(load: float, radius: float, slope: float, friction: float) -> float:
    """Torque in the thread that lowers a load: Q r tan(phi* - beta), negative where the load drives the screw.

    Parameters
    ----------
    load, radius, slope, friction : float
        Q [N], mean radius r [m], tan(beta), f*.

    Returns
    -------
    float
        [N·m], positive in the direction that lowers.
    """
    return radius * push_down(load, slope, friction)


@scalar
def collar_moment(load: float, mean_radius: float, friction: float) -> float:
    """Friction torque at the thrust collar, against either rotation: f Q r_m.

    Parameters
    ----------
    load, mean_radius, friction : float
        Q [N], r_m [m] by `uniform_wear_radius` or `uniform_pressure_radius` of `engine.laws.brakes`, f.
    """
    return friction * load * mean_radius


@scalar
def raise_efficiency(load: float, radius: float, slope: float, moment: float) -> float:
    """Efficiency of raising, work on the load divided by work of the torque: Q r tan(beta)/M.

    Parameters
    ----------
    load, radius, slope : float
        Q [N], mean radius r [m], tan(beta).
    moment : float
        Torque M in thread and collar together [N·m].
    """
    return load * radius * slope / moment


@scalar
def lower_efficiency(load: float, radius: float, slope: float, moment: float) -> float:
    """Efficiency of lowering, fraction of the load's work that drives the screw: -M/(Q r tan(beta)), 0 if self-locking.

    Parameters
    ----------
    load, radius, slope : float
        Q [N], mean radius r [m], tan(beta).
    moment : float
        Torque M that lowers, in thread and collar together [N·m], negative where the load drives.
    """
    return -moment / (load * radius * slope) if moment < 0.0 else 0.0


@scalar
def locking_friction(radius: float, slope: float, half_angle: float, collar_radius: float, collar: float) -> float:
    """Minimum coefficient of friction f of the thread for which the screw is self-locking.

    Without a collar f = tan(beta) cos(gamma). The friction torque of a collar reduces the torque left to the thread,
    tan(beta - phi*) = f_c r_m/r.

    Parameters
    ----------
    radius, slope, half_angle : float
        Mean radius r [m], tan(beta), half of the thread angle gamma [rad].
    collar_radius, collar : float
        Mean radius r_m [m] and friction f_c of the collar; 0 without a collar.

    Returns
    -------
    float
        f; 0 if the collar holds the load even without friction in the thread.
    """
    held = collar * collar_radius / radius
    return math.cos(half_angle) * push_down(1.0, held, slope) if slope > held else 0.0


@scalar
def screw(
    load: float, diameter: float, lead: float, angle: float, friction: float, collar_diameter: float, collar: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Screw with its thrust collar: its results in order."""
    radius, collar_radius, slope = diameter / 2, collar_diameter / 2, thread_slope(lead, diameter)
    reduced = flank_friction(friction, angle / 2)
    held = collar_moment(load, collar_radius, collar)
    up = raise_moment(load, radius, slope, reduced) + held
    down = lower_moment(load, radius, slope, reduced) + held
    return (
        math.atan(slope),
        math.atan(reduced),
        up,
        down,
        held,
        raise_efficiency(load, radius, slope, up),
        lower_efficiency(load, radius, slope, down),
        0.0 if down < 0.0 else 1.0,
        locking_friction(radius, slope, angle / 2, collar_radius, collar),
    )
