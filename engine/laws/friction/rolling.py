"""Rolling friction, the limit between rolling and sliding, and the friction of two rollers.

Under a load N the pressure on a roller acts ahead of its middle by k, the arm of rolling friction: M = k N. Higher
pairs roll where that needs less force than sliding, otherwise they slide.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines (rolling friction); R. S. Khurmi and J. K. Gupta,
Theory of Machines, chapter 10.
"""

from engine.compiling.decorators import scalar


@scalar
def rolling_moment(normal: float, arm: float) -> float:
    """Moment of rolling friction: k N.

    Parameters
    ----------
    normal, arm : float
        N [N], k [m].

    Returns
    -------
    float
        [N·m], against the rolling.
    """
    return arm * normal


@scalar
def reduced_friction(arm: float, height: float) -> float:
    """Equivalent coefficient of rolling friction: k/h, the force that rolls a load divided by the load.

    Parameters
    ----------
    arm, height : float
        k, and the height h of the pull above the contact [m]: r at the roller's axle, 2 r at its top.
    """
    return arm / height


@scalar
def rolls(arm: float, height: float, friction: float) -> float:
    """1 if a pulled roller rolls, k/h < f, 0 if it slides.

    Parameters
    ----------
    arm, height, friction : float
        k and h as in `reduced_friction` [m], f of sliding.
    """
    return 1.0 if arm / height < friction else 0.0


@scalar
def pull(normal: float, arm: float, height: float, friction: float) -> float:
    """Force that moves a roller, by rolling or sliding, whichever needs less: N min(k/h, f).

    Parameters
    ----------
    normal, arm, height, friction : float
        N [N], k and h as in `reduced_friction` [m], f of sliding.

    Returns
    -------
    float
        [N].
    """
    return normal * min(arm / height, friction)


@scalar
def reduced_radius(radius: float, mate_radius: float) -> float:
    """Radius of the roller on a plane that is equivalent to two rollers in contact: 1/r = 1/r1 + 1/r2.

    Parameters
    ----------
    radius, mate_radius : float
        r1 and r2 [m]; r2 is negative for a hollow roller around the first, infinite for a plane.
    """
    return radius / (1 + radius / mate_radius)


@scalar
def rollers_moment(normal: float, arm: float, radius: float, mate_radius: float) -> float:
    """Moment on the first of two rollers that overcomes their rolling friction: k N (1 + r1/r2).

    They roll on each other with the difference of their angular velocities, w1 (1 + r1/r2).

    Parameters
    ----------
    normal, arm : float
        N [N], k [m].
    radius, mate_radius : float
        As in `reduced_radius` [m].

    Returns
    -------
    float
        [N·m].
    """
    return rolling_moment(normal, arm) * abs(1 + radius / mate_radius)


@scalar
def roller(
    load: float, diameter: float, arm: float, friction: float, height: float, mate: float
) -> tuple[float, float, float, float, float, float, float]:
    """Roller on a plane or on a second roller: its results in order."""
    radius = diameter / 2
    return (
        rolling_moment(load, arm),
        reduced_friction(arm, height),
        pull(load, arm, height, friction),
        rolls(arm, height, friction),
        friction * load * radius,
        reduced_radius(radius, mate / 2),
        rollers_moment(load, arm, radius, mate / 2),
    )
