"""Forces of a rigid rotor on its two bearings: rotating forces and the weight.

Arrays have any axes and are broadcast.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (unbalance of rotors).
"""

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.rotors.unbalance import Resultant, unbalance_in_two_planes
from engine.parts.bodies import STANDARD_GRAVITY


def rotating_forces(rotor: Resultant, first: ArrayLike, second: ArrayLike, omega: ArrayLike) -> np.ndarray:
    """Forces that rotate with the rotor: omega² times its unbalance in the planes of the bearings.

    Parameters
    ----------
    rotor : Resultant
    first, second : array_like (...)
        Positions of the bearings [m].
    omega : array_like (...)
        Constant speed [rad/s].

    Returns
    -------
    ndarray of complex (2, ...)
        In the rotor's axes [N]; infinite or NaN if both bearings are at the same position.
    """
    return np.square(omega) * np.array(unbalance_in_two_planes(rotor, first, second))


def static_forces(
    mass: ArrayLike, centre: ArrayLike, first: ArrayLike, second: ArrayLike, gravity: ArrayLike = STANDARD_GRAVITY
) -> np.ndarray:
    """Weight carried by each bearing of a horizontal rotor.

    Parameters
    ----------
    mass : array_like (...)
        [kg].
    centre, first, second : array_like (...)
        Positions of the centre of mass and of the bearings [m].
    gravity : array_like (...)
        Acceleration across the axis [m/s²].

    Returns
    -------
    ndarray (2, ...)
        Downwards [N]; negative if an overhung rotor lifts its shaft off the far bearing.
    """
    weight = np.multiply(mass, gravity)
    with np.errstate(divide="ignore", invalid="ignore"):
        span = np.subtract(second, first)
        return np.array([weight * np.subtract(second, centre) / span, weight * np.subtract(centre, first) / span])


def peak_forces(rotating: np.ndarray, static: np.ndarray) -> np.ndarray:
    """Peak forces over a turn, when the rotating force points along the weight [N]."""
    return np.abs(rotating) + np.abs(static)
