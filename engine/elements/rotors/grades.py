"""Balance quality of rigid rotors: grades G, permissible residual unbalance, its allocation to two tolerance planes.

A grade is the product e_per·omega of the permissible specific unbalance and the maximum service speed: 6.3 mm/s for
G 6.3. Then U_per = (e_per·omega) m/omega; the standard writes it 1000 (e_per·omega) m/omega in g·mm, mm/s, kg, rad/s.
The tolerance planes are the planes of the bearings. Each gets a fraction of U_per proportional to the distance of the
centre of mass from the other bearing, within limits.

Source: ISO 21940-11:2016, 6.3 and table 1 (grades), 7.1, 7.2 (tolerance planes).
"""

import math

import numpy as np
from numpy.typing import ArrayLike

NUMBERS = (0.4, 1.0, 2.5, 6.3, 16.0, 40.0, 100.0, 250.0, 630.0, 1600.0, 4000.0)
LEAST_SHARE = 0.3
GREATEST_SHARE_INBOARD = 0.7
GREATEST_SHARE_OUTBOARD = 1.3
# A residual computed to lie on a grade's limit is within rounding on either side of it.
_ROUNDED = 1e-12


def permissible_unbalance(grade: ArrayLike, mass: ArrayLike, omega: ArrayLike) -> np.ndarray:
    """Permissible residual unbalance U_per = (e_per·omega) m/omega.

    Parameters
    ----------
    grade, mass, omega : array_like (...)
        e_per·omega [m/s]; m [kg]; maximum service speed, of either sign [rad/s].

    Returns
    -------
    ndarray (...)
        [kg·m].
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.multiply(grade, mass) / np.abs(omega)


def tolerance_shares(centre: ArrayLike, first: ArrayLike, second: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Fractions of U_per allocated to the planes of the two bearings.

    0.3 … 0.7 with the centre of mass between the bearings; 0.3 … 1.3 with it beyond one of them.

    Parameters
    ----------
    centre, first, second : array_like (...)
        Positions of the centre of mass and of the bearings [m].

    Returns
    -------
    ndarray (...), ndarray (...)
        NaN if both bearings are at the same position.
    """
    centre, first, second = (np.asarray(z, dtype=float) for z in (centre, first, second))
    span = np.abs(second - first)
    outboard = (centre - first) * (centre - second) > 0.0
    greatest = np.where(outboard, GREATEST_SHARE_OUTBOARD, GREATEST_SHARE_INBOARD)
    with np.errstate(divide="ignore", invalid="ignore"):
        shares = (np.abs(centre - other) / span for other in (second, first))
        return tuple(np.where(span > 0.0, np.clip(share, LEAST_SHARE, greatest), math.nan) for share in shares)


def grade_reached(needed: ArrayLike) -> np.ndarray:
    """The finest grade that admits a given e_per·omega.

    Parameters
    ----------
    needed : array_like (...)
        [m/s].

    Returns
    -------
    ndarray (...)
        Number of the grade, 6.3 for G 6.3 [mm/s]; infinite beyond G 4000.
    """
    needed = np.asarray(needed, dtype=float)
    limits = np.array(NUMBERS) / 1000
    reached = np.array([*NUMBERS, math.inf])[np.searchsorted(limits * (1 + _ROUNDED), needed)]
    return np.where(np.isnan(needed), math.nan, reached)
