"""Vectors that turn with the orders of the crank: shaking forces and couples as circles, lines and ellipses.

A plane vector that repeats with the crank's turn is, written as x + iy, the sum over the orders n of

    F_n exp(i n phi) + B_n exp(−i n phi),

one part turning with the crank and one against it. Alone, either draws a circle; equal in size they draw a line; in
general an ellipse with the half axes |F_n| + |B_n| and ||F_n| − |B_n||, the longer one at half the sum of their angles.
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
        Parts that turn with the crank and against it.
    """

    orders: tuple[int, ...]
    forward: np.ndarray
    backward: np.ndarray

    @property
    def major(self) -> np.ndarray:
        """Longer half axes of the ellipses: the greatest size of each order (..., orders)."""
        return np.abs(self.forward) + np.abs(self.backward)

    @property
    def minor(self) -> np.ndarray:
        """Shorter half axes, 0 for a line, as long as the longer ones for a circle (..., orders)."""
        return np.abs(np.abs(self.forward) - np.abs(self.backward))

    @property
    def direction(self) -> np.ndarray:
        """Angle of the longer half axes [rad], within a half turn about 0 (..., orders); none for a circle."""
        return np.angle(self.forward * self.backward) / 2

    @property
    def rms(self) -> np.ndarray:
        """Root mean square of the size of all orders together (...)."""
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
            [rad].

        Returns
        -------
        ndarray of complex (..., positions)
        """
        turned = np.exp(1j * np.multiply.outer(np.asarray(self.orders, float), np.asarray(phi, float)))
        return self.forward @ turned + self.backward @ np.conj(turned)

    def plus(self, other: "Hodograph") -> "Hodograph":
        """The sum with another one of the same orders."""
        return Hodograph(self.orders, self.forward + other.forward, self.backward + other.backward)
