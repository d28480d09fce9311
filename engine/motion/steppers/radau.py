"""Radau IIA, as data: of order nine for motors so steep that explicit steps would be as short as their time constant.

The collocation polynomial is the one within the step. The method is L-stable, and its last stage is the end of the
step.

Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.5.
"""

import numpy as np
from numpy.polynomial import Polynomial

from engine.laws.runge_kutta import DENSE_PARTS, Method, Tableau, part_at

FIVE_NODES = np.array(
    [
        0.057104196114517682193121192554116,
        0.27684301363812382768004599768563,
        0.58359043236891682005669766866292,
        0.86024013565621944784791291887512,
        1.0,
    ]
)
# Nodes of formulas of lower orders, with which errors are estimated.
FEWER, FEWEST = (1, 2, 3, 4), (0, 2, 4)
SHARE_OF_COARSE = 0.1


def integrals(nodes: np.ndarray) -> list[Polynomial]:
    """Integrals from 0 on of the polynomials that are 1 at one of the nodes and 0 at the others."""
    found = []
    for i, node in enumerate(nodes):
        others = np.delete(nodes, i)
        found.append((Polynomial.fromroots(others) / np.prod(node - others)).integ())
    return found


def _tableau(nodes: np.ndarray) -> Tableau:
    """The collocation method of some nodes."""
    own = integrals(nodes)
    return Tableau(
        nodes,
        np.array([[integral(node) for integral in own] for node in nodes]),
        np.array([integral(1.0) for integral in own]),
    )


def _quadrature(nodes: np.ndarray, chosen: tuple[int, ...]) -> np.ndarray:
    """Weights over the step of some of the nodes."""
    weights = np.zeros(nodes.size)
    weights[list(chosen)] = [integral(1.0) for integral in integrals(nodes[list(chosen)])]
    return weights


def _method(tableau: Tableau, fine: np.ndarray, coarse: np.ndarray) -> Method:
    count = tableau.stages
    values = np.array([[part_at(i, theta) for i in range(count)] for theta in tableau.nodes])
    # Weights of the parts of the collocation polynomial.
    parts = np.zeros((DENSE_PARTS, count))
    parts[:count] = np.linalg.solve(values, tableau.matrix)
    return Method(
        implicit=True,
        stages=count,
        dense_stages=count,
        matrix=tableau.matrix,
        inverse=np.linalg.inv(tableau.matrix),
        weights=tableau.weights,
        # Its begin is no stage, but looked at.
        shares=np.array([*tableau.nodes, 0.0]),
        place_of=np.arange(count),
        fine=fine,
        coarse=coarse,
        parts=parts,
        looked_at=np.array([count, *range(count)]),
    )


RADAU = _tableau(FIVE_NODES)
# Through five nodes there is no other formula of the finer ones' order.
ORDER_NINE = _method(
    RADAU,
    (RADAU.weights - _quadrature(FIVE_NODES, FEWER))[None],
    SHARE_OF_COARSE * (RADAU.weights - _quadrature(FIVE_NODES, FEWEST))[None],
)
