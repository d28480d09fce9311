"""Cosines and sines of multiples and fractions of the crank's angle, for orders of curves over the cycle."""

from engine.graph.nodes import Node
from engine.laws.elementary import direction_of
from engine.mechanism.mechanics import Mechanics


def multiple_angle(m: Mechanics, n: int, revolutions: int = 1) -> tuple[Node, Node]:
    """Cosine and sine of n times the crank's angle over a number of revolutions.

    Parameters
    ----------
    m : Mechanics
    n : int
        At least 1.
    revolutions : int
    """
    cosine, sine = m.graph.cos_q, m.graph.sin_q
    if revolutions != 1:
        cosine, sine = m.graph.apply(direction_of, m.graph.q * (1.0 / revolutions))
    c, s = cosine, sine
    for _ in range(n - 1):
        c, s = c * cosine - s * sine, s * cosine + c * sine
    return c, s
