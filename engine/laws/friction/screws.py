"""Screws: moments to raise and to lower a load, self-locking and efficiency.

A thread of mean radius r is an incline of slope t = tan(beta) = lead/(2 pi r) wound on a cylinder. Flanks at
gamma to the plane across the axis, half of the thread's angle (square 0, trapezoidal 15, metric 30 degrees), press
like a V guide: the friction of the square thread becomes f* = f/cos(gamma) = tan(phi*).
To lower is to turn the other way: a negative moment means that the load drives the screw and has to be held.

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
        Advance in one turn, pitch times starts, and d [m].
    """
    return lead / (math.pi * mean_diameter)


@scalar
def flank_friction(friction: float, half_angle: float) -> float:
    """Friction of a thread in terms of the axial force: f* = f/cos(gamma).

    Parameters
    ----------
    friction, half_angle : float
        f, half of the thread's angle gamma [rad].

    Notes
    -----
    gamma is that of the axial section, as textbooks take it. The flank leans by that of the normal section,
    tan(gamma_n) = tan(gamma) cos(beta), which is less: f* is too great by about f sin(gamma) tan(gamma) tan²(beta)/2,
    1e-4 of itself for a metric thread with beta = 1.5 degrees, 3e-4 for a trapezoidal one with 5.
    """
    return friction / math.cos(half_angle)


@scalar
def raise_moment(load: float, radius: float, slope: float, friction: float) -> float:
    """Moment in the thread that raises a load: Q r tan(beta + phi*).

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
    """Moment in the thread that lowers a load: Q r tan(phi* - beta), negative where the load drives the screw.

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
    """Moment of friction at the thrust collar: f Q r_m; it resists both ways.

    Parameters
    ----------
    load, mean_radius, friction : float
        Q [N], r_m [m] by `uniform_wear_radius` or `uniform_pressure_radius` of `engine.laws.brakes`, f.
    """
    return friction * load * mean_radius


@scalar
def raise_efficiency(load: float, radius: float, slope: float, moment: float) -> float:
    """Work done on the load over the work of the moment that raises it: Q r tan(beta)/M.

    Parameters
    ----------
    load, radius, slope : float
        Q [N], mean radius r [m], tan(beta).
    moment : float
        M in thread and collar together [N·m].
    """
    return load * radius * slope / moment


@scalar
def lower_efficiency(load: float, radius: float, slope: float, moment: float) -> float:
    """Share of the sinking load's work that the screw passes on: -M/(Q r tan(beta)), 0 where it locks by itself.

    Parameters
    ----------
    load, radius, slope : float
        Q [N], mean radius r [m], tan(beta).
    moment : float
        M that lowers, in thread and collar together [N·m], negative where the load drives.
    """
    return -moment / (load * radius * slope) if moment < 0.0 else 0.0


@scalar
def locking_friction(radius: float, slope: float, half_angle: float, collar_radius: float, collar: float) -> float:
    """Least coefficient of friction f of the thread with which the screw locks by itself.

    Without a collar f = tan(beta) cos(gamma); the collar takes its moment off that of the thread,
    tan(beta - phi*) = f_c r_m/r.

    Parameters
    ----------
    radius, slope, half_angle : float
        Mean radius r [m], tan(beta), half of the thread's angle gamma [rad].
    collar_radius, collar : float
        Mean radius r_m [m] and friction f_c of the collar; 0 where there is none.

    Returns
    -------
    float
        f; 0 where the collar alone holds the load.
    """
    held = collar * collar_radius / radius
    return math.cos(half_angle) * push_down(1.0, held, slope) if slope > held else 0.0
