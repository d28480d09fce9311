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


class Method(NamedTuple):
    """A method with everything that steps of lengths of their own need of it.

    Attributes
    ----------
    implicit : bool
        Whether it is a collocation method, whose last stage is the end of the step.
    newton : bool
        Whether its stages are found by Newton's method to the last digits, however steep a moment is by the speed;
        those of other collocation methods are found by fewer corrections, as exactly as a step has to be.
    stages, dense_stages : int
        How many stages a step has, and with those of its polynomial.
    matrix : ndarray (dense stages, dense stages)
        A.
    inverse : ndarray (stages, stages)
        That of A, of an implicit method.
    weights : ndarray (stages,)
        b.
    shares : ndarray (places,)
        Where the places of stages lie, shares of the step.
    place_of : ndarray (dense stages,) of int
        The place of each stage.
    fine, coarse, coarsest : ndarray (formulas, stages)
        Formulas that vanish up to some order, up to a lower one, and up to a still lower one, if there are any: their
        sizes tell how much what they find fades from order to order.
    exponent : float
        To which power of what a step misses its length goes.
    parts : ndarray (DENSE_PARTS, dense stages)
        Weights of the parts of the polynomial p within the step,
        p(θ) = p₀θ + p₁θ(1−θ) + p₂θ²(1−θ) + p₃θ²(1−θ)² + …
    looked_at : ndarray of int
        Some of the places, in order from the begin to the end, between which extremes are searched.
    """

    implicit: bool
    newton: bool
    stages: int
    dense_stages: int
    matrix: np.ndarray
    inverse: np.ndarray
    weights: np.ndarray
    shares: np.ndarray
    place_of: np.ndarray
    fine: np.ndarray
    coarse: np.ndarray
    coarsest: np.ndarray
    exponent: float
    parts: np.ndarray
    looked_at: np.ndarray


# Parts of the polynomial within a step.
DENSE_PARTS = 7


def part_at(part: int, theta: np.ndarray) -> np.ndarray:
    """One of the functions θ, θ(1−θ), θ²(1−θ), θ²(1−θ)², … that the polynomial within a step is made of."""
    return theta ** ((part + 2) // 2) * (1.0 - theta) ** ((part + 1) // 2)
