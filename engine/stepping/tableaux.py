"""Methods other than that of order eight, as data.

The classical Runge–Kutta method of order four uses equal steps without an error estimate; the dense output is the cubic
with the values and slopes at both ends. Radau IIA of order nine is for motors and couplings so steep that explicit
steps would be as short as their time constant: it is L-stable, its last stage is the end of the step, and its dense
output is the collocation polynomial.

Sources: W. Kutta, Beitrag zur näherungsweisen Integration totaler Differentialgleichungen, Z. Math. Phys. 46 (1901);
E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.5.
"""

import numpy as np
from numpy.polynomial import Polynomial

from engine.laws.runge_kutta import DENSE_PARTS, Method, Tableau, part_at

_FOUR_WEIGHTS = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
_FOUR_MATRIX = np.zeros((5, 5))
_FOUR_MATRIX[1, 0] = _FOUR_MATRIX[2, 1] = 0.5
_FOUR_MATRIX[3, 2] = 1.0
# The slope at the end.
_FOUR_MATRIX[4, :4] = _FOUR_WEIGHTS


def _parts_of_cubic() -> np.ndarray:
    """Weights for the coefficients of the cubic from values and slopes at both ends."""
    parts, whole = np.zeros((DENSE_PARTS, 5)), np.append(_FOUR_WEIGHTS, 0.0)
    first, last = np.eye(5)[0], np.eye(5)[4]
    parts[:3] = whole, first - whole, 2.0 * whole - first - last
    return parts


ORDER_FOUR = Method(
    implicit=False,
    stages=4,
    dense_stages=5,
    matrix=_FOUR_MATRIX,
    inverse=np.zeros((0, 0)),
    weights=_FOUR_WEIGHTS,
    nodes=np.array([0.0, 0.5, 0.5, 1.0, 1.0]),
    # There is no embedded formula: the error estimate comes from steps of twice the length.
    fine=np.zeros((1, 4)),
    coarse=np.zeros((1, 4)),
    parts=_parts_of_cubic(),
)

FIVE_NODES = np.array(
    [
        0.057104196114517682193121192554116,
        0.27684301363812382768004599768563,
        0.58359043236891682005669766866292,
        0.86024013565621944784791291887512,
        1.0,
    ]
)
# Nodes of a formula of lower order, for error estimates.
FEWER = (1, 2, 3, 4)


def integrals(nodes: np.ndarray) -> list[Polynomial]:
    """Integrals from 0 of the Lagrange polynomials of the nodes."""
    found = []
    for i, node in enumerate(nodes):
        others = np.delete(nodes, i)
        found.append((Polynomial.fromroots(others) / np.prod(node - others)).integ())
    return found


def collocation(nodes: np.ndarray) -> Tableau:
    """The collocation method with the given nodes."""
    own = integrals(nodes)
    return Tableau(
        nodes,
        np.array([[integral(node) for integral in own] for node in nodes]),
        np.array([integral(1.0) for integral in own]),
    )


def _quadrature(nodes: np.ndarray, chosen: tuple[int, ...]) -> np.ndarray:
    """Weights over the step of a subset of the nodes."""
    weights = np.zeros(nodes.size)
    weights[list(chosen)] = [integral(1.0) for integral in integrals(nodes[list(chosen)])]
    return weights


def _method(tableau: Tableau, fine: np.ndarray) -> Method:
    count = tableau.stages
    values = np.array([[part_at(i, theta) for i in range(count)] for theta in tableau.nodes])
    # Weights for the coefficients of the collocation polynomial.
    parts = np.zeros((DENSE_PARTS, count))
    parts[:count] = np.linalg.solve(values, tableau.matrix)
    return Method(
        implicit=True,
        stages=count,
        dense_stages=count,
        matrix=tableau.matrix,
        inverse=np.linalg.inv(tableau.matrix),
        weights=tableau.weights,
        nodes=tableau.nodes,
        fine=fine,
        # Five nodes allow no second formula of the same order. With one of a still lower order, as in explicit steps,
        # an estimate would pass its zeros quadratically, and a steep motor forgets all steps but the last.
        coarse=np.zeros((1, count)),
        parts=parts,
    )


RADAU = collocation(FIVE_NODES)
ORDER_NINE = _method(RADAU, (RADAU.weights - _quadrature(FIVE_NODES, FEWER))[None])
