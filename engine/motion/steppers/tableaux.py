"""Runge–Kutta methods as data."""

from typing import NamedTuple

import numpy as np


class Tableau(NamedTuple):
    """A Runge–Kutta method, by its Butcher tableau.

    Attributes
    ----------
    nodes : ndarray (stages,)
        c, shares of the step.
    matrix : ndarray (stages, stages)
        A; strictly lower triangular of an explicit method.
    weights : ndarray (stages,)
        b.
    """

    nodes: np.ndarray
    matrix: np.ndarray
    weights: np.ndarray

    @property
    def stages(self) -> int:
        """How many."""
        return self.weights.size


# The classical method of order four. Source: E. Hairer, S. P. Nørsett and G. Wanner, Solving Ordinary Differential
# Equations I, table II.1.2.
CLASSICAL = Tableau(
    np.array([0.0, 0.5, 0.5, 1.0]),
    np.array([[0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0, 0.0], [0.0, 0.5, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]]),
    np.array([1.0, 2.0, 2.0, 1.0]) / 6.0,
)

# Lobatto IIIC of order four, which is L-stable; its last stage is the end of the step. Source: E. Hairer and
# G. Wanner, Solving Ordinary Differential Equations II, section IV.5.
LOBATTO_IIIC = Tableau(
    np.array([0.0, 0.5, 1.0]),
    np.array([[2.0, -4.0, 2.0], [2.0, 5.0, -1.0], [2.0, 8.0, 2.0]]) / 12.0,
    np.array([1.0, 4.0, 1.0]) / 6.0,
)
