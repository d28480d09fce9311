"""Forces of a rigid rotor on its two bearings: rotating forces and the weight.

Arrays have any axes and are broadcast.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (unbalance of rotors).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.rotors.unbalance import Resultant, unbalance_in_two_planes
from engine.parts.bodies import STANDARD_GRAVITY


class BearingForces(NamedTuple):
    """Forces of the rotor on its first and second bearing [N]."""

    first: np.ndarray
    second: np.ndarray


def rotating_forces(rotor: Resultant, first: ArrayLike, second: ArrayLike, omega: ArrayLike) -> BearingForces:
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
    BearingForces
        Complex, in the rotor's axes [N]; infinite or NaN if both bearings are at the same position.
    """
    square = np.square(omega)
    return BearingForces(*(square * part for part in unbalance_in_two_planes(rotor, first, second)))


def static_forces(
    mass: ArrayLike, centre: ArrayLike, first: ArrayLike, second: ArrayLike, gravity: ArrayLike = STANDARD_GRAVITY
) -> BearingForces:
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
    BearingForces
        Downwards [N]; negative if an overhung rotor lifts its shaft off the far bearing.
    """
    weight = np.multiply(mass, gravity)
    with np.errstate(divide="ignore", invalid="ignore"):
        span = np.subtract(second, first)
        return BearingForces(weight * np.subtract(second, centre) / span, weight * np.subtract(centre, first) / span)


def peak_forces(rotating: BearingForces, static: BearingForces) -> BearingForces:
    """Peak forces over a turn, when the rotating force points along the weight [N]."""
    return BearingForces(*(np.abs(r) + np.abs(s) for r, s in zip(rotating, static, strict=True)))
