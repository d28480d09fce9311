"""Static balancing on knife edges: the unbalance that rolling friction hides.

The rotor rolls until its heavy side is at the bottom. It stays where the moment of its unbalance, D g sin(theta), does
not exceed that of rolling friction, m g k: for D below m k it rests in any position, above that within theta =
arcsin(m k/D) of the lowest position of the heavy side. A couple has no effect.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (static unbalance of a rotor).
"""

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.element import ElementResult, NamedRows, Numbers


def residual_unbalance(mass: ArrayLike, arm: ArrayLike) -> np.ndarray:
    """Residual unbalance D = m k.

    Parameters
    ----------
    mass, arm : array_like (...)
        m [kg]; coefficient of rolling friction k [m].

    Returns
    -------
    ndarray (...)
        [kg·m].
    """
    return np.multiply(mass, arm)


def resting_angle(unbalance: ArrayLike, mass: ArrayLike, arm: ArrayLike) -> np.ndarray:
    """Maximum angle of the heavy side from its lowest position at rest, arcsin(m k/D).

    Parameters
    ----------
    unbalance : array_like (...)
        Magnitude of D [kg·m].
    mass, arm : array_like (...)
        m [kg]; k [m].

    Returns
    -------
    ndarray (...)
        [rad]; pi if the rotor rests in any position.
    """
    residual, unbalance = residual_unbalance(mass, arm), np.asarray(unbalance, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(residual >= unbalance, np.pi, np.arcsin(np.minimum(residual / unbalance, 1.0)))


def knife_edge_results(unbalance: np.ndarray, n: Numbers) -> NamedRows:
    """Results on knife edges, for a rotor with a `mass` and a `rolling_arm`; unbalance as for `resting_angle`."""
    if "rolling_arm" in n:
        given, words = (n["mass"], n["rolling_arm"]), "unbalance that rolling friction on knife edges leaves"
        yield ElementResult("knife_edge_unbalance", words, "kg m"), residual_unbalance(*given)
        words = "maximum angle between the heavy side and the lowest position at rest on knife edges"
        yield ElementResult("knife_edge_angle", words, "rad"), resting_angle(unbalance, *given)
