"""Inertia forces: their resultant for a link in plane motion, their moments for a rotor in space.

In plane motion the inertia forces of a link come down to the force U = −m a_S at its centre of mass S and the moment
M_U = −J_S ε; the two together to the force U alone, on a line at the distance h = M_U/U from S. Of a link that
swings about a point O, that line crosses OS in the centre of percussion K.

In space Euler's equations take their place. The rotor's axes x, y, z turn with it and begin at the point about which
moments are taken: its centre of mass, or a point at rest. Products of inertia are J_xy = ∫ xy dm and so on.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on kinetostatics; L. D. Landau, E. M. Lifshitz,
Mechanics, § 36, for Euler's equations.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def inertia_force(mass: float, ax: float, ay: float) -> tuple[float, float]:
    """Principal vector of a link's inertia forces, U = −m a_S [N].

    Parameters
    ----------
    mass : float
        [kg].
    ax, ay : float
        Acceleration of the centre of mass [m/s²].
    """
    return -mass * ax, -mass * ay


@scalar
def inertia_moment(inertia: float, epsilon: float) -> float:
    """Principal moment of a link's inertia forces about its centre of mass, M_U = −J_S ε [N·m].

    Parameters
    ----------
    inertia : float
        J_S [kg·m²].
    epsilon : float
        Angular acceleration [rad/s²].
    """
    return -inertia * epsilon


@scalar
def inertia_offset(gyration2: float, ax: float, ay: float, epsilon: float) -> float:
    """Distance h = M_U/U of the resultant's line from the centre of mass [m].

    Positive where the line passes to the right of S, seen along U. Accelerations may be transfer functions at
    uniform input speed: the speed cancels. Infinite for a pure moment, NaN where there are no inertia forces.

    Parameters
    ----------
    gyration2 : float
        Square of the radius of gyration, J_S/m [m²].
    ax, ay : float
        Acceleration of the centre of mass [m/s²].
    epsilon : float
        Angular acceleration [rad/s²].
    """
    return -gyration2 * epsilon / math.sqrt(ax * ax + ay * ay)


@scalar
def resultant_point(gyration2: float, ax: float, ay: float, epsilon: float) -> tuple[float, float]:
    """Point of the resultant's line of action nearest to the centre of mass S, from S [m].

    Parameters
    ----------
    gyration2 : float
        Square of the radius of gyration, J_S/m [m²].
    ax, ay : float
        Acceleration of the centre of mass [m/s²].
    epsilon : float
        Angular acceleration [rad/s²].
    """
    share = gyration2 * epsilon / (ax * ax + ay * ay)
    return share * ay, -share * ax


@scalar
def centre_of_percussion(gyration2: float, arm: float) -> float:
    """Distance OK = OS + J_S/(m·OS) of the centre of percussion K from the axis O of a swinging link [m].

    A blow at K leaves the axis unloaded, and a mathematical pendulum of the length OK swings with the link (K is its
    centre of oscillation). A uniform rod hung at its end: OK = 2L/3.

    Parameters
    ----------
    gyration2 : float
        Square of the radius of gyration, J_S/m [m²].
    arm : float
        OS [m].
    """
    return arm + gyration2 / arm


@scalar
def euler_moment(
    jx: float,
    jy: float,
    jz: float,
    wx: float,
    wy: float,
    wz: float,
    ex: float,
    ey: float,
    ez: float,
) -> tuple[float, float, float]:
    """Inertia moment of a rotor about its principal axes, M_x = −J_x ε_x − (J_z − J_y) ω_y ω_z and cyclic [N·m].

    Parameters
    ----------
    jx, jy, jz : float
        Principal moments of inertia [kg·m²].
    wx, wy, wz, ex, ey, ez : float
        Angular velocity [rad/s] and acceleration [rad/s²] in the principal axes.
    """
    return (
        -jx * ex - (jz - jy) * wy * wz,
        -jy * ey - (jx - jz) * wz * wx,
        -jz * ez - (jy - jx) * wx * wy,
    )


@scalar
def euler_moment_of_products(
    jxy: float,
    jyz: float,
    jzx: float,
    wx: float,
    wy: float,
    wz: float,
    ex: float,
    ey: float,
    ez: float,
) -> tuple[float, float, float]:
    """What products of inertia add to `euler_moment` where the axes are not principal [N·m].

    M_x = J_xy (ε_y − ω_z ω_x) + J_zx (ε_z + ω_x ω_y) + J_yz (ω_y² − ω_z²) and cyclic.

    Parameters
    ----------
    jxy, jyz, jzx : float
        Products of inertia [kg·m²].
    wx, wy, wz, ex, ey, ez : float
        Angular velocity [rad/s] and acceleration [rad/s²] in the same axes.
    """
    return (
        jxy * (ey - wz * wx) + jzx * (ez + wx * wy) + jyz * (wy * wy - wz * wz),
        jyz * (ez - wx * wy) + jxy * (ex + wy * wz) + jzx * (wz * wz - wx * wx),
        jzx * (ex - wy * wz) + jyz * (ey + wz * wx) + jxy * (wx * wx - wy * wy),
    )


@scalar
def fixed_axis_moment(jz: float, jyz: float, jzx: float, omega: float, epsilon: float) -> tuple[float, float, float]:
    """Inertia moment of a rotor that turns about its fixed axis z, in its own axes [N·m].

    M_x = J_zx ε − J_yz ω² and M_y = J_yz ε + J_zx ω² load the bearings, as a couple that turns with the rotor;
    M_z = −J_z ε resists the drive. At constant speed only the terms with ω² remain; in a rotor without J_yz and J_zx
    (the axis is a principal one: no couple unbalance) none do.

    Parameters
    ----------
    jz : float
        Moment of inertia about the axis [kg·m²].
    jyz, jzx : float
        Products of inertia with the axis [kg·m²].
    omega, epsilon : float
        Angular velocity [rad/s] and acceleration [rad/s²].
    """
    square = omega * omega
    return jzx * epsilon - jyz * square, jyz * epsilon + jzx * square, -jz * epsilon
