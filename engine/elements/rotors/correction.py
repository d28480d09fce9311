"""Correction of a rotor's unbalance in given planes.

- One plane: C = -U; the resultant vanishes, a couple may remain.
- Two planes: resultant and moment vanish.
- More planes: of all corrections that cancel both, the one with the minimum sum of squares of the masses at the
  planes' radii.

All three are C_k = -r_k² (U/Σr² + P_c (z_k - c)/Σr²(z - c)²), where c is the planes' mean position weighted with r² and
P_c the moment about it: the minimum-norm solution of two equations, by Lagrange multipliers.

Arrays have the planes along their last axis; all other axes are free and are broadcast.

Sources: ISO 21940-11, 4.5; K. V. Frolov et al., Theory of Mechanisms and Machines (full balancing of a rotor).
"""

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.rotors.unbalance import Resultant, about, resultant_unbalance


def correct(rotor: Resultant, planes: ArrayLike, radii: ArrayLike = 1.0) -> np.ndarray:
    """Unbalances to add in the planes.

    Parameters
    ----------
    rotor : Resultant
    planes : array_like (..., planes)
        Positions along the axis [m].
    radii : array_like (..., planes)
        Radii of the added masses [m]; relevant for more than two planes only.

    Returns
    -------
    ndarray of complex (..., planes)
        [kg·m]; infinite or NaN if all planes are at the same position.
    """
    planes = np.asarray(planes, dtype=float)
    if planes.shape[-1] == 1:
        shape = np.broadcast_shapes(rotor.unbalance.shape, planes.shape[:-1])
        return -np.broadcast_to(rotor.unbalance, shape)[..., None]
    weights = np.broadcast_to(np.square(radii), np.broadcast_shapes(np.shape(radii), planes.shape))
    total = weights.sum(axis=-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        # Sums of differences: positions less the middle would lose the short arm of a plane with a large radius.
        apart = planes[..., :, None] - planes[..., None, :]
        arms = (weights[..., None, :] * apart).sum(axis=-1) / total[..., None]
        even = rotor.unbalance / total
        moment = about(rotor, planes[..., 0]).moment + arms[..., 0] * rotor.unbalance
        tilting = moment / (weights * arms**2).sum(axis=-1)
        return -weights * (even[..., None] + tilting[..., None] * arms)


def corrected_unbalance(rotor: Resultant, corrections: ArrayLike, planes: ArrayLike) -> Resultant:
    """Unbalance that remains after a correction.

    Parameters
    ----------
    rotor : Resultant
    corrections : array_like of complex (..., planes)
        Unbalances added [kg·m].
    planes : array_like (..., planes)
        Their positions [m].
    """
    added = resultant_unbalance(corrections, planes, rotor.plane)
    return Resultant(rotor.unbalance + added.unbalance, rotor.moment + added.moment, rotor.plane)
