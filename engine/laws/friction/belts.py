"""Belts, bands and ropes on a drum: Euler's (Eytelwein's, the capstan) formula; tension of a running belt.

On the point of slipping the tension of the tight strand is e^(f alpha) times that of the slack one. A running belt with
mass q per unit length presses less: q v² of the tension of each strand only provides the centripetal force.

Sources: L. Euler, 1769; R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 11.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.friction.guides import vee_friction


@scalar
def tension_ratio(friction: float, wrap: float) -> float:
    """Tension of the tight strand divided by that of the slack one, e^(f alpha): Euler's or Eytelwein's formula.

    Parameters
    ----------
    friction, wrap : float
        f, in a V groove from `engine.laws.friction.guides.vee_friction`; angle of contact alpha [rad].
    """
    return math.exp(friction * wrap)


@scalar
def slack_share(friction: float, wrap: float) -> float:
    """Tension of the slack strand divided by that of the tight one: e^(-f alpha).

    Parameters
    ----------
    friction, wrap : float
        As in `tension_ratio`.
    """
    return math.exp(-friction * wrap)


@scalar
def gripped_share(friction: float, wrap: float) -> float:
    """Maximum tangential force divided by the tension of the tight strand: 1 - e^(-f alpha).

    Parameters
    ----------
    friction, wrap : float
        As in `tension_ratio`.
    """
    return -math.expm1(-friction * wrap)


@scalar
def centrifugal_tension(linear_density: float, speed: float) -> float:
    """Centrifugal tension of a running belt: q v².

    Parameters
    ----------
    linear_density, speed : float
        q [kg/m], v [m/s].

    Returns
    -------
    float
        [N].
    """
    return linear_density * speed * speed


@scalar
def belt_moment(tight: float, centrifugal: float, friction: float, wrap: float, radius: float) -> float:
    """Maximum torque of a belt: (T - q v²) (1 - e^(-f alpha)) r.

    Parameters
    ----------
    tight, centrifugal : float
        Tension T of the tight strand, including q v², and q v² [N].
    friction, wrap, radius : float
        f, alpha [rad], radius of the pulley r [m].

    Returns
    -------
    float
        [N·m]; 0 where the belt runs too fast to press on the pulley.
    """
    return max(tight - centrifugal, 0.0) * gripped_share(friction, wrap) * radius


@scalar
def tight_tension(moment: float, centrifugal: float, friction: float, wrap: float, radius: float) -> float:
    """Tension of the tight strand required for a torque: M/(r (1 - e^(-f alpha))) + q v².

    Parameters
    ----------
    moment : float
        Torque M [N·m].
    centrifugal, friction, wrap, radius : float
        As in `belt_moment`.

    Returns
    -------
    float
        T [N].
    """
    return moment / (radius * gripped_share(friction, wrap)) + centrifugal


@scalar
def speed_of_most_power(tight: float, linear_density: float) -> float:
    """Speed at which a belt of given tension transmits maximum power: √(T/(3 q)), where q v² is a third of T.

    Parameters
    ----------
    tight, linear_density : float
        T [N], q [kg/m].

    Returns
    -------
    float
        [m/s]; infinite for a belt without mass.
    """
    return math.sqrt(tight / (3 * linear_density))


@scalar
def shaft_force(tight: float, slack: float, wrap: float) -> float:
    """Force of both strands on the shaft: √(T1² + T2² - 2 T1 T2 cos(alpha)).

    Parameters
    ----------
    tight, slack : float
        Tensions of the strands without q v², which doesn't load the shaft [N].
    wrap : float
        alpha [rad].

    Returns
    -------
    float
        [N]; T1 + T2 for parallel strands, alpha = pi.
    """
    # The half angle avoids cancellation where the strands nearly balance.
    sine = math.sin(wrap / 2)
    return math.sqrt((tight - slack) * (tight - slack) + 4 * tight * slack * sine * sine)


@scalar
def belt(
    diameter: float, wrap: float, friction: float, groove: float, tension: float, moment: float, q: float, speed: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Belt with a given tension, or with a given moment if the tension is NaN: its results in order."""
    radius, reduced = diameter / 2, vee_friction(friction, groove / 2)
    centrifugal = centrifugal_tension(q, speed)
    tight = tight_tension(moment, centrifugal, reduced, wrap, radius) if math.isnan(tension) else tension
    carried = belt_moment(tight, centrifugal, reduced, wrap, radius)
    pressing = max(tight - centrifugal, 0.0)
    slack = pressing * slack_share(reduced, wrap)
    return (
        tension_ratio(reduced, wrap),
        tight,
        tight - pressing * gripped_share(reduced, wrap),
        carried,
        shaft_force(pressing, slack, wrap),
        carried / radius * speed,
        centrifugal,
        speed_of_most_power(tight, q),
    )
