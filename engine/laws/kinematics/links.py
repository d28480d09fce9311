"""Rigid links in plane motion.

A link carries its own axes: an origin and a direction (cos, sin) of its x axis. Everything here is per unit of
the generalised coordinate q (crank angle in rad, or displacement of a sliding input in m): a "velocity" is
dr/dq and an "acceleration" d²r/dq², the transfer functions of the textbooks.
Vectors are given by their components; `arm` is the vector from the link's origin to a point of the link.
"""

import math

from engine.compiling.jit import scalar


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


@scalar
def direction_of(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle, by polynomials: unlike those of the C library they vectorise.

    Parameters
    ----------
    angle : float
        [rad], in float64.

    Returns
    -------
    cosine, sine : float
        To about 2e-16, and as exactly as the angle itself where that is large.

    Notes
    -----
    The angle is taken to the nearest multiple of a right angle; the polynomials are those of S. L. Moshier's Cephes
    library for angles up to 45 degrees.
    """
    quarter = math.floor(angle * (2.0 / math.pi) + 0.5)
    r = angle - quarter * (0.5 * math.pi)
    z = r * r
    p = -2.50507477628578072866e-8 + z * 1.58962301576546568060e-10
    p = -1.98412698295895385996e-4 + z * (2.75573136213857245213e-6 + z * p)
    sine = r + r * z * (-1.66666666666666307295e-1 + z * (8.33333333332211858878e-3 + z * p))
    p = 2.08757008419747316778e-9 - z * 1.13585365213876817300e-11
    p = 2.48015872888517045348e-5 + z * (-2.75573141792967388112e-7 + z * p)
    cosine = 1.0 - 0.5 * z + z * z * (4.16666666666665929218e-2 + z * (-1.38888888888730564116e-3 + z * p))
    # Turned by 0 to 3 right angles.
    turns = quarter - 4.0 * math.floor(0.25 * quarter)
    odd = (turns == 1.0) | (turns == 3.0)
    c, s = (sine if odd else cosine), (cosine if odd else sine)
    return (-c if (turns == 1.0) | (turns == 2.0) else c), (-s if turns >= 2.0 else s)
