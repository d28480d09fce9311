"""Rigid links in plane motion.

A link carries its own axes: an origin and a direction (cos, sin) of its x axis. Everything here is per unit of
the generalised coordinate q (crank angle in rad, or displacement of a sliding input in m): a "velocity" is
dr/dq and an "acceleration" d²r/dq², the transfer functions of the textbooks.
Vectors are given by their components; `arm` is the vector from the link's origin to a point of the link.
"""

from engine.compiling.decorators import scalar


@scalar
def arm(along: float, across: float, c: float, s: float) -> tuple[float, float]:
    """Vector from the link's origin to the point (along, across) of the link's own axes, in frame axes.

    Parameters
    ----------
    along, across : float
        Coordinates in the link's axes, x along the link and y to its left [m].
    c, s : float
        Cosine and sine of the link's angle.
    """
    return along * c - across * s, along * s + across * c


@scalar
def rigid_velocity(vx: float, vy: float, w: float, px: float, py: float) -> tuple[float, float]:
    """Velocity of a point of a link: v = v_O + w k × p.

    Parameters
    ----------
    vx, vy : float
        Velocity of the link's origin.
    w : float
        Angular velocity of the link, dθ/dq.
    px, py : float
        Arm from the origin to the point [m].
    """
    return vx - w * py, vy + w * px


@scalar
def rigid_acceleration(ax: float, ay: float, w: float, e: float, px: float, py: float) -> tuple[float, float]:
    """Acceleration of a point of a link: a = a_O + e k × p − w² p.

    Parameters
    ----------
    ax, ay : float
        Acceleration of the link's origin.
    w, e : float
        Angular velocity and acceleration of the link, dθ/dq and d²θ/dq².
    px, py : float
        Arm from the origin to the point [m].
    """
    ww = w * w
    return ax - e * py - ww * px, ay + e * px - ww * py


@scalar
def coriolis(w: float, vx: float, vy: float) -> tuple[float, float]:
    """Coriolis acceleration 2 w k × v of a point that slides with the relative velocity v on a turning link."""
    ww = w + w
    return -ww * vy, ww * vx
