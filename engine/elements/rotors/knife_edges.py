"""Static balancing on knife edges: what rolling friction leaves.

The rotor rolls until its heavy side is below. It stays where the moment of its unbalance D g sin(theta) is no greater
than that of rolling friction, m g k: below D = m k it rests in any position, above that up to theta =
arcsin(m k/D) from the lowest position of the heavy side. A couple isn't seen at all.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (static unbalance of a rotor).
"""

import numpy as np
from numpy.typing import ArrayLike


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
    """How far from the lowest position the heavy side may come to rest, arcsin(m k/D).

    Parameters
    ----------
    unbalance : array_like (...)
        D as a magnitude [kg·m].
    mass, arm : array_like (...)
        m [kg]; k [m].

    Returns
    -------
    ndarray (...)
        [rad]; pi where the rotor rests in any position.
    """
    residual, unbalance = residual_unbalance(mass, arm), np.asarray(unbalance, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(residual >= unbalance, np.pi, np.arcsin(np.minimum(residual / unbalance, 1.0)))
