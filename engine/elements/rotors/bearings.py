"""Forces of a rigid rotor on its two bearings: those that turn with it, and the weight.

Arrays have any axes and are broadcast.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (unbalance of rotors).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.rotors.unbalance import Resultant, unbalance_in_two_planes
from engine.parts.skeleton import STANDARD_GRAVITY


class BearingForces(NamedTuple):
    """Forces of the rotor on its first and second bearing [N]."""

    first: np.ndarray
    second: np.ndarray


def rotating_forces(rotor: Resultant, first: ArrayLike, second: ArrayLike, omega: ArrayLike) -> BearingForces:
    """Forces that turn with the rotor, omega² times its unbalance in the bearings' planes.

    Parameters
    ----------
    rotor : Resultant
    first, second : array_like (...)
        Positions of the bearings [m].
    omega : array_like (...)
        Speed, uniform [rad/s].

    Returns
    -------
    BearingForces
        Complex, in the rotor's axes [N]; not finite where both bearings are in one place.
    """
    square = np.square(omega)
    return BearingForces(*(square * part for part in unbalance_in_two_planes(rotor, first, second)))


def static_forces(
    mass: ArrayLike, centre: ArrayLike, first: ArrayLike, second: ArrayLike, gravity: ArrayLike = STANDARD_GRAVITY
) -> BearingForces:
    """Shares of the weight on the bearings of a horizontal rotor.

    Parameters
    ----------
    mass : array_like (...)
        [kg].
    centre, first, second : array_like (...)
        Positions of the centre of mass and of the bearings [m].
    gravity : array_like (...)
        Across the axis [m/s²].

    Returns
    -------
    BearingForces
        Downwards [N]; negative where an overhung rotor lifts its shaft off the far bearing.
    """
    weight = np.multiply(mass, gravity)
    with np.errstate(divide="ignore", invalid="ignore"):
        span = np.subtract(second, first)
        return BearingForces(
            weight * np.subtract(second, centre) / span,
            weight * np.subtract(centre, first) / span,
        )


def peak_forces(rotating: BearingForces, static: BearingForces) -> BearingForces:
    """Greatest magnitudes over a turn, where the rotating force points along the weight [N]."""
    return BearingForces(*(np.abs(r) + np.abs(s) for r, s in zip(rotating, static, strict=True)))
