"""Correction of a rotor's unbalance in given planes.

- One plane: C = -U; the resultant vanishes, a couple may remain.
- Two planes: resultant and moment vanish.
- More: of all corrections that make both vanish, the one with the least sum of the squares of the masses at the
  planes' radii.

All three are C_k = -r_k² (U/Σr² + P_c (z_k - c)/Σr²(z - c)²), c being the planes' middle weighted with r² and P_c the
moment about it: the least-norm solution of two equations, from their Lagrange multipliers.

Arrays have the planes along their last axis; all other axes are free and are broadcast.

Sources: ISO 21940-11, 4.5; K. V. Frolov et al., Theory of Mechanisms and Machines (full balancing of a rotor).
"""

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.rotors.unbalance import Resultant, about, resultant_unbalance


def correct(rotor: Resultant, planes: ArrayLike, radii: ArrayLike = 1.0) -> np.ndarray:
    """Unbalances to be added in the planes.

    Parameters
    ----------
    rotor : Resultant
    planes : array_like (..., planes)
        Their positions along the axis [m].
    radii : array_like (..., planes)
        At which masses are added [m]; matter only where there are more than two planes.

    Returns
    -------
    ndarray of complex (..., planes)
        [kg·m]; not finite where the planes are all in one place.
    """
    planes = np.asarray(planes, dtype=float)
    if planes.shape[-1] == 1:
        shape = np.broadcast_shapes(rotor.unbalance.shape, planes.shape[:-1])
        return -np.broadcast_to(rotor.unbalance, shape)[..., None]
    weights = np.broadcast_to(np.square(radii), np.broadcast_shapes(np.shape(radii), planes.shape))
    total = weights.sum(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        middle = (weights * planes).sum(axis=-1) / total
        arms = planes - middle[..., None]
        even = rotor.unbalance / total
        tilting = about(rotor, middle).moment / (weights * arms**2).sum(axis=-1)
        return -weights * (even[..., None] + tilting[..., None] * arms)


def corrected_unbalance(rotor: Resultant, corrections: ArrayLike, planes: ArrayLike) -> Resultant:
    """What remains after a correction.

    Parameters
    ----------
    rotor : Resultant
    corrections : array_like of complex (..., planes)
        Unbalances added [kg·m].
    planes : array_like (..., planes)
        Where [m].
    """
    added = resultant_unbalance(corrections, planes, rotor.plane)
    return Resultant(rotor.unbalance + added.unbalance, rotor.moment + added.moment, rotor.plane)


def misplaced_share(mass_error: ArrayLike, angle_error: ArrayLike) -> np.ndarray:
    """How far a correction made with errors is off, as a share of it: |(1 + mu) exp(i delta) - 1|.

    Errors of either sign up to mu and delta leave no more than this.

    Parameters
    ----------
    mass_error, angle_error : array_like (...)
        mu >= 0, of the mass or the radius, as a share; delta, 0 … pi [rad].

    Returns
    -------
    ndarray (...)
        √(mu² + 4 (1 + mu) sin²(delta/2)), about √(mu² + delta²).
    """
    mu = np.asarray(mass_error, dtype=float)
    return np.sqrt(mu**2 + 4.0 * (1.0 + mu) * np.sin(np.asarray(angle_error, dtype=float) / 2.0) ** 2)
