"""Vectors that rotate with the orders of the crank: shaking forces and couples as circles, lines and ellipses.

A plane vector with the period of the crank's turn, written as x + iy, is the sum over the orders n of

    F_n exp(i n phi) + B_n exp(−i n phi),

one part rotating with the crank and one against it. A single part describes a circle; two of equal magnitude describe
a line; in general they describe an ellipse with the semi-axes |F_n| + |B_n| and ||F_n| − |B_n||, the major axis at half
the sum of their angles.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike


class Hodograph(NamedTuple):
    """A plane vector by orders of the crank.

    Attributes
    ----------
    orders : tuple of int
    forward, backward : ndarray of complex (..., orders)
        Parts that rotate with the crank and against it.
    """

    orders: tuple[int, ...]
    forward: np.ndarray
    backward: np.ndarray

    @property
    def major(self) -> np.ndarray:
        """Semi-major axes of the ellipses: the maximum magnitude of each order (..., orders)."""
        return np.abs(self.forward) + np.abs(self.backward)

    @property
    def minor(self) -> np.ndarray:
        """Semi-minor axes (..., orders): 0 for a line, equal to the semi-major axes for a circle."""
        return np.abs(np.abs(self.forward) - np.abs(self.backward))

    @property
    def direction(self) -> np.ndarray:
        """Angle of the major axes [rad], within a quarter turn of 0 (..., orders); arbitrary for a circle."""
        return np.angle(self.forward * self.backward) / 2

    @property
    def rms(self) -> np.ndarray:
        """Rms magnitude of all orders together (...)."""
        return np.sqrt((np.abs(self.forward) ** 2 + np.abs(self.backward) ** 2).sum(axis=-1))

    def of(self, order: int) -> tuple[np.ndarray, np.ndarray]:
        """Forward and backward part of one order (...)."""
        i = self.orders.index(order)
        return self.forward[..., i], self.backward[..., i]

    def at(self, phi: ArrayLike) -> np.ndarray:
        """The vector at crank angles.

        Parameters
        ----------
        phi : array_like (positions,)
            Crank angles [rad].

        Returns
        -------
        ndarray of complex (..., positions)
        """
        turned = np.exp(1j * np.multiply.outer(np.asarray(self.orders, float), np.asarray(phi, float)))
        return self.forward @ turned + self.backward @ np.conj(turned)
