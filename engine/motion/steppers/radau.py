"""Radau IIA of order nine, as data: for motors so steep that explicit steps would be as short as their time constant.

The collocation polynomial is the one within the step. It is L-stable, and its last stage is the end of the step.

Source: E. Hairer and G. Wanner, Solving Ordinary Differential Equations II, section IV.5.
"""

import numpy as np
from numpy.polynomial import Polynomial

from engine.motion.steppers.tableaux import DENSE_PARTS, Method, Tableau, part_at

NODES = np.array(
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


def integrals(nodes: np.ndarray) -> list[Polynomial]:
    """Integrals from 0 on of the polynomials that are 1 at one of the nodes and 0 at the others."""
    found = []
    for i, node in enumerate(nodes):
        others = np.delete(nodes, i)
        found.append((Polynomial.fromroots(others) / np.prod(node - others)).integ())
    return found


def _quadrature(chosen: tuple[int, ...]) -> np.ndarray:
    """Weights over the step of some of the nodes."""
    weights = np.zeros(NODES.size)
    weights[list(chosen)] = [integral(1.0) for integral in integrals(NODES[list(chosen)])]
    return weights


def _parts() -> np.ndarray:
    """Weights of the parts of the collocation polynomial."""
    count = NODES.size
    values = np.array([[part_at(i, theta) for i in range(count)] for theta in NODES])
    parts = np.zeros((DENSE_PARTS, count))
    parts[:count] = np.linalg.solve(values, RADAU.matrix)
    return parts


RADAU = Tableau(
    NODES,
    np.array([[integral(node) for integral in integrals(NODES)] for node in NODES]),
    np.array([integral(1.0) for integral in integrals(NODES)]),
)
ORDER_NINE = Method(
    implicit=True,
    stages=NODES.size,
    dense_stages=NODES.size,
    matrix=RADAU.matrix,
    inverse=np.linalg.inv(RADAU.matrix),
    weights=RADAU.weights,
    # Its begin is no stage, but looked at.
    shares=np.array([*NODES, 0.0]),
    place_of=np.arange(NODES.size),
    less_fine=RADAU.weights - _quadrature(FEWER),
    # Through five nodes there is no other one.
    besides=np.zeros((0, NODES.size)),
    less_coarse=RADAU.weights - _quadrature(FEWEST),
    parts=_parts(),
    looked_at=np.array([5, 0, 1, 2, 3, 4]),
)
