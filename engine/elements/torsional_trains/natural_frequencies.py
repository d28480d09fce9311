"""Natural frequencies and modes of a tree of masses and shafts, each frequency enclosed by counts.

Masses are eliminated from the ends of the tree towards its root. A mass with everything beyond it acts as a spring of
the dynamic stiffness s = Σ t − ω² J on the shaft to its parent, and through the shaft as t = k s/(k + s). The values
k + s of all nodes, and s of the root, have the signs of the pivots of an LDLᵀ factorisation of K − ω² M: the number of
negative pivots is the number of natural frequencies below ω. Rounding is equivalent to changing every inertia and
stiffness by a few rounding units for each mass between it and the root. So the count is exact for a nearby train, and
the frequencies of the given train have relative errors of the same order, whatever the ratios of its numbers.

Each frequency is enclosed between two squares with different counts: first on either side of LAPACK's estimate, whose
error is a fraction of the largest square, then by bisection. Inverse iteration gives the modes.

Sources: J. W. Demmel and W. Gragg, On computing accurate singular values and eigenvalues of matrices with acyclic
graphs, Linear Algebra Appl. 185 (1993); B. N. Parlett, The Symmetric Eigenvalue Problem (counts of pivots, inverse
iteration); R.-C. Li, Relative perturbation theory II, SIAM J. Matrix Anal. Appl. 20 (1998), for the modes' errors.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.elements.torsional_trains.reduced_train import ReducedTrain
from engine.laws.rounding import EPS

# Relative width of a squared frequency's bracket at which bisection ends.
ENCLOSED = 2.0**-50
# Lower limit of positive squares, and LAPACK's error for each mass, relative to the largest square.
_LOWEST, _OFF = 2.0**-400, EPS
# Replaces a zero pivot, relative to the stiffness.
_NO_PIVOT = -(2.0**-60)
_ITERATIONS = 2
# Rounding units of every inertia and stiffness for each mass between it and the root.
_PER_MASS = 5.0


class NaturalVibration(NamedTuple):
    """Natural frequencies and modes of a reduced train.

    Attributes
    ----------
    frequencies, frequency_errors : ndarray (modes, variants)
        Ascending, positive [rad/s]; NaN if a number is infinite or NaN.
    modes, mode_errors : ndarray (modes, nodes, variants)
        Amplitudes of the nodes, with Σ J q² = 1; NaN if two frequencies are too close to separate their modes.
    """

    frequencies: np.ndarray
    frequency_errors: np.ndarray
    modes: np.ndarray
    mode_errors: np.ndarray


def natural_vibration(train: ReducedTrain, count: int) -> NaturalVibration:
    """The lowest positive natural frequencies and their modes.

    Parameters
    ----------
    train : ReducedTrain
    count : int
        Number of frequencies; at most the number that exist.
    """
    nodes, free = len(train.inertias), 0 if train.ground.any() else 1
    # One more, for the gap between the last mode and the next.
    found = min(count + 1, nodes - free)
    with np.errstate(all="ignore"):
        squares = _squares(train, free + np.arange(found))
        modes = _modes(train, squares)
    # Relative errors of inertias and stiffnesses add up in the square, and halve in the frequency.
    rounded = EPS * (train.roundings + _PER_MASS * nodes + 1.0)
    frequencies = np.sqrt(squares)
    errors = frequencies * (rounded + ENCLOSED)
    mode_errors = _mode_errors(train, squares, modes, rounded)
    modes = np.where(np.isnan(mode_errors), math.nan, modes)
    return NaturalVibration(*(row[:count] for row in (frequencies, errors, modes, mode_errors)))


def _mode_errors(train: ReducedTrain, squares: np.ndarray, modes: np.ndarray, rounded: np.ndarray) -> np.ndarray:
    """Error estimates of the modes from the gaps between squared frequencies; NaN if the gaps are too small."""
    with np.errstate(divide="ignore", invalid="ignore"):
        # The estimates of two equal squares may be in either order.
        gaps = np.abs(np.diff(squares, axis=0)) / (squares[1:] + squares[:-1])
        # The zero frequency of a free train, and those above the highest found, count as far away.
        far = np.ones_like(squares[:1])
        nearest = np.minimum(np.concatenate([far, gaps]), np.concatenate([gaps, far]))
        turned = 4.0 * (rounded + ENCLOSED) / nearest
        turned = np.where(turned < 0.1, turned, math.nan)
        return turned[:, None] / np.sqrt(train.inertias) + 8.0 * EPS * np.abs(modes)


def _squares(train: ReducedTrain, below: np.ndarray) -> np.ndarray:
    """Squares of natural frequencies (modes, variants), each with a number `below` (modes,) of others below it."""
    nodes, parents = len(train.inertias), train.parents[1:]
    # Gershgorin: no square exceeds the largest row sum of magnitudes of M⁻¹ K.
    rows = train.ground + 2.0 * train.stiffnesses
    np.add.at(rows, parents, 2.0 * train.stiffnesses[1:])
    greatest = (2.0 * rows / train.inertias).max(axis=0)
    greatest = np.where(greatest < math.inf, greatest, math.nan)
    twists, root = np.eye(nodes), np.sqrt(train.inertias.T)
    twists[np.arange(1, nodes), parents] = -1.0
    matrix = (twists.T * train.stiffnesses.T[:, None]) @ twists + train.ground.T[:, None] * np.eye(nodes)
    matrix = np.where(np.isfinite(greatest)[:, None, None], matrix / root[:, :, None] / root[:, None], 0.0)
    estimate = np.linalg.eigvalsh(matrix).T[below]

    def narrowed(low: np.ndarray, high: np.ndarray, square: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The part of brackets above or below a square; narrow ones stay as they are."""
        above, wide = (_pivots(train, square) < 0.0).sum(axis=0) <= below[:, None], high - low > ENCLOSED * high
        return np.where(wide & above, square, low), np.where(wide & ~above, square, high)

    low, high = (np.broadcast_to(limit, estimate.shape) for limit in (_LOWEST * greatest, greatest))
    for side in (-1.0, 1.0):
        low, high = narrowed(low, high, np.clip(estimate + side * _OFF * nodes * greatest, low, high))
    while (high - low > ENCLOSED * high).any():
        low, high = narrowed(low, high, np.where(high > 4.0 * low, np.sqrt(low) * np.sqrt(high), 0.5 * (low + high)))
    return 0.5 * (low + high)


def _pivots(train: ReducedTrain, squares: np.ndarray) -> np.ndarray:
    """Pivots k + s of all nodes, and s of the root, (nodes, modes, variants): dynamic stiffnesses at some squares."""
    pivots = train.ground[:, None] - squares * train.inertias[:, None]
    for node in range(len(pivots) - 1, 0, -1):
        k, s = train.stiffnesses[node], pivots[node]
        pivot = np.where(k + s == 0.0, _NO_PIVOT * k, k + s)
        pivots[train.parents[node]] += k * s / pivot
        pivots[node] = pivot
    return pivots


def _modes(train: ReducedTrain, squares: np.ndarray) -> np.ndarray:
    """Modes (modes, nodes, variants) by inverse iteration, (K − ω² M) q = M q_before; Σ J q² = 1."""
    inertias, pivots, children = train.inertias[:, None], _pivots(train, squares), range(1, len(train.inertias))
    pivots[0] = np.where(pivots[0] == 0.0, _NO_PIVOT * inertias[0] * squares, pivots[0])
    # The start must not be orthogonal to the mode: use irregular numbers.
    start = 1.0 + (0.618 * np.arange(1.0, len(pivots) + 1.0)) % 1.0
    modes = start[:, None, None] / np.sqrt(inertias) + 0.0 * squares
    for _ in range(_ITERATIONS):
        modes = inertias * modes
        for node in reversed(children):
            modes[train.parents[node]] += train.stiffnesses[node] / pivots[node] * modes[node]
        modes[0] /= pivots[0]
        for node in children:
            modes[node] = (modes[node] + train.stiffnesses[node] * modes[train.parents[node]]) / pivots[node]
        modes /= np.sqrt(sum(inertias * modes**2))
    return np.moveaxis(modes, 0, 1)
