"""Runge–Kutta methods as data, and the eighth-order method of Dormand and Prince.

Stages 0 to 11 make a step. Stage 12 lies at its end; with it and three more, a polynomial of order seven interpolates
the motion within the step (dense output).

Source: E. Hairer, S. P. Nørsett and G. Wanner, Solving Ordinary Differential Equations I, second edition, section
II.10; coefficients as in SciPy.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import DOP853


class Tableau(NamedTuple):
    """Butcher tableau of a Runge–Kutta method.

    Attributes
    ----------
    nodes : ndarray (stages,)
        c, fractions of the step.
    matrix : ndarray (stages, stages)
        A; strictly lower triangular for an explicit method.
    weights : ndarray (stages,)
        b.
    """

    nodes: np.ndarray
    matrix: np.ndarray
    weights: np.ndarray

    @property
    def stages(self) -> int:
        """Number of stages."""
        return self.weights.size


class Method(NamedTuple):
    """A method with everything that adaptive steps need.

    Attributes
    ----------
    implicit : bool
        Whether it is a collocation method whose last stage is the end of the step. Its stages are found by Newton's
        method, however stiff the torque characteristics are.
    stages, dense_stages : int
        Number of stages of a step, without and with those of its dense output.
    matrix : ndarray (dense stages, dense stages)
        A.
    inverse : ndarray (stages, stages)
        Inverse of A for an implicit method.
    weights : ndarray (stages,)
        b.
    nodes : ndarray (dense stages,)
        c, fractions of the step.
    fine, coarse : ndarray (formulas, stages)
        Error formulas that vanish up to some order, and up to a lower order; their ratio gives the decay from order to
        order.
    parts : ndarray (DENSE_PARTS, dense stages)
        Weights of the parts of the dense output p,
        p(θ) = p₀θ + p₁θ(1−θ) + p₂θ²(1−θ) + p₃θ²(1−θ)² + …
    """

    implicit: bool
    stages: int
    dense_stages: int
    matrix: np.ndarray
    inverse: np.ndarray
    weights: np.ndarray
    nodes: np.ndarray
    fine: np.ndarray
    coarse: np.ndarray
    parts: np.ndarray


# Parts of the dense output.
DENSE_PARTS = 7


def part_at(part: int, theta: np.ndarray) -> np.ndarray:
    """Basis function `part` of the dense output, one of θ, θ(1−θ), θ²(1−θ), θ²(1−θ)² and so on."""
    return theta ** ((part + 2) // 2) * (1.0 - theta) ** ((part + 1) // 2)


# Stages of a step of order eight, without and with those of its dense output.
STAGES, DENSE_STAGES = 12, 16
MATRIX = np.zeros((DENSE_STAGES, DENSE_STAGES))
MATRIX[:STAGES, :STAGES] = DOP853.A
MATRIX[STAGES, :STAGES] = DOP853.B
MATRIX[STAGES + 1 :] = DOP853.A_EXTRA
NODES = np.concatenate([DOP853.C, [1.0], DOP853.C_EXTRA])
DORMAND_PRINCE = Tableau(NODES[:STAGES], MATRIX[:STAGES, :STAGES], MATRIX[STAGES, :STAGES])
# Differences between the formula of order eight and those of orders five and three.
ERRORS = np.array([DOP853.E5[:STAGES], DOP853.E3[:STAGES]])
SHARE_OF_COARSE = 0.1
# A second error formula that vanishes up to order five. Its error of order six, over all rooted trees of six vertices
# weighted by their symmetry, has the size of the first one's and is orthogonal to it: both hardly ever vanish together.
_SECOND_ERROR = np.zeros(STAGES)
_SECOND_ERROR[[0, *range(5, STAGES)]] = [
    -2.16575624753399913e-2,
    -2.87929616619069517e-1,
    4.68800979560341058e-1,
    -3.71761606355259955e-1,
    -1.24189137504977531,
    1.32421205179734280,
    1.59378222181324636e-1,
    -2.91510930395638204e-2,
]
# A third one that vanishes up to order six; its error of order seven has the size of the first one's. Where a rate
# depends little on the state, the first two vanish together, at zeros of its fifth derivative.
_THIRD_ERROR = np.zeros(STAGES)
_THIRD_ERROR[[0, *range(5, STAGES - 1)]] = [
    -0.1574653899232401,
    42.75254602721373,
    13.194979909527838,
    -53.8412439783373,
    4.48682266645439,
    -6.265070338431749,
    -0.17056889650354123,
]


def _parts() -> np.ndarray:
    """Weights of the parts of the dense output; the first three follow from values and slopes at both ends."""
    weights, first, last = MATRIX[STAGES], np.eye(DENSE_STAGES)[0], np.eye(DENSE_STAGES)[STAGES]
    return np.array([weights, first - weights, 2.0 * weights - first - last, *DOP853.D])


ORDER_EIGHT = Method(
    implicit=False,
    stages=STAGES,
    dense_stages=DENSE_STAGES,
    matrix=MATRIX,
    inverse=np.zeros((0, 0)),
    weights=DORMAND_PRINCE.weights.copy(),
    nodes=NODES,
    fine=np.array([ERRORS[0], _SECOND_ERROR, _THIRD_ERROR]),
    coarse=SHARE_OF_COARSE * ERRORS[1:],
    parts=_parts(),
)
# Along time, torques may balance; the third formula raises their rounding fifty times, and steps never grow again. A
# comparison walk then shows what the other two miss.
ORDER_EIGHT_IN_TIME = ORDER_EIGHT._replace(fine=ORDER_EIGHT.fine[:2])
