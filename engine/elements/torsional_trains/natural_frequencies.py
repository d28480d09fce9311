"""Natural frequencies and modes of a tree of masses and shafts, each frequency enclosed by counts.

Masses are eliminated from the ends of the tree towards its root. A mass with everything beyond it acts as a spring of
the dynamic stiffness s = Σ t − ω² J on the shaft to its parent, and through the shaft as t = k s/(k + s). The values
k + s of all nodes, and s of the root, have the signs of the pivots of an LDLᵀ factorisation of K − ω² M: the number of
negative pivots is the number of natural frequencies below ω. Rounding is equivalent to changing every inertia and
stiffness by a few rounding units for each mass between it and the root. So the count is exact for a nearby train, and
the frequencies of the given train have relative errors of the same order, whatever the ratios of its numbers.

Each frequency is enclosed by bisection between two squares with different counts. Inverse iteration gives the modes.

Sources: J. W. Demmel and W. Gragg, On computing accurate singular values and eigenvalues of matrices with acyclic
graphs, Linear Algebra Appl. 185 (1993); B. N. Parlett, The Symmetric Eigenvalue Problem (counts of pivots, inverse
iteration); R.-C. Li, Relative perturbation theory II, SIAM J. Matrix Anal. Appl. 20 (1998), for the modes' errors.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import driver, routine
from engine.compiling.running import spread
from engine.compiling.widths import LANES
from engine.elements.torsional_trains.reduced_train import ReducedTrain
from engine.laws.rounding import EPS

# Relative width of a squared frequency's bracket at which bisection ends.
ENCLOSED = 2.0**-50
# Lower limit of positive squares, relative to the largest one.
_LOWEST = 2.0**-400
# Replaces a zero pivot, relative to the stiffness.
_NO_PIVOT = -(2.0**-60)
_ITERATIONS = 2
# Scratch rows per block: one element for each node, and single ones.
_ROWS, _SINGLE = 7, 5
# Rounding units of every inertia and stiffness for each mass between it and the root.
_PER_MASS = 5.0


class TreeRows(NamedTuple):
    """Parents of the nodes, and rows (nodes, variants) of a train's numbers, for compiled code."""

    parents: np.ndarray
    inertias: np.ndarray
    ground: np.ndarray
    stiffnesses: np.ndarray


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
    nodes, variants = train.inertias.shape
    free = 0 if train.ground.any() else 1
    # One more, for the gap between the last mode and the next.
    found = min(count + 1, nodes - free)
    squares, modes = np.empty((found, variants)), np.empty((found, nodes, variants))
    rows = (train.parents, train.inertias, train.ground, train.stiffnesses)
    tree = TreeRows(*(np.ascontiguousarray(row) for row in rows))

    def arguments() -> tuple:
        return (free, tree, squares, modes, np.empty((_ROWS, nodes, LANES)), np.empty((_SINGLE, LANES)))

    spread(_enclose, -(-variants // LANES), arguments)
    # Relative errors of inertias and stiffnesses add up in the square, and halve in the frequency.
    rounded = EPS * (train.roundings + _PER_MASS * nodes + 1.0)
    frequencies = np.sqrt(squares)
    errors = frequencies * (rounded + ENCLOSED)
    mode_errors = _mode_errors(train, squares, modes, rounded)
    mixed = np.isnan(mode_errors)
    return NaturalVibration(
        frequencies[:count],
        errors[:count],
        np.where(mixed, math.nan, modes)[:count],
        mode_errors[:count],
    )


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


@routine
def _count_below(
    parents: np.ndarray,
    inertias: np.ndarray,
    ground: np.ndarray,
    stiffnesses: np.ndarray,
    squares: np.ndarray,
    dynamic: np.ndarray,
    below: np.ndarray,
) -> None:
    """Count the natural frequencies below √squares, lane by lane; leaves the dynamic stiffnesses s in `dynamic`."""
    nodes = inertias.shape[0]
    for node in range(nodes):
        for lane in range(LANES):
            dynamic[node, lane] = ground[node, lane] - squares[lane] * inertias[node, lane]
    for lane in range(LANES):
        below[lane] = 0.0
    for node in range(nodes - 1, 0, -1):
        parent = parents[node]
        for lane in range(LANES):
            k, s = stiffnesses[node, lane], dynamic[node, lane]
            pivot = k + s
            pivot = _NO_PIVOT * k if pivot == 0.0 else pivot
            below[lane] += 1.0 if pivot < 0.0 else 0.0
            dynamic[parent, lane] += k * s / pivot
    for lane in range(LANES):
        below[lane] += 1.0 if dynamic[0, lane] < 0.0 else 0.0


@routine
def _iterate(
    parents: np.ndarray,
    inertias: np.ndarray,
    stiffnesses: np.ndarray,
    squares: np.ndarray,
    dynamic: np.ndarray,
    pushed: np.ndarray,
    mode: np.ndarray,
    size: np.ndarray,
) -> None:
    """One step of inverse iteration, (K − ω² M) q = M q_before, by the dynamic stiffnesses of the tree; Σ J q² = 1."""
    nodes = inertias.shape[0]
    for node in range(nodes):
        for lane in range(LANES):
            pushed[node, lane] = inertias[node, lane] * mode[node, lane]
    for node in range(nodes - 1, 0, -1):
        parent = parents[node]
        for lane in range(LANES):
            k = stiffnesses[node, lane]
            pivot = k + dynamic[node, lane]
            pivot = _NO_PIVOT * k if pivot == 0.0 else pivot
            pushed[parent, lane] += k / pivot * pushed[node, lane]
    for lane in range(LANES):
        s = dynamic[0, lane]
        s = _NO_PIVOT * inertias[0, lane] * squares[lane] if s == 0.0 else s
        mode[0, lane] = pushed[0, lane] / s
        size[lane] = inertias[0, lane] * mode[0, lane] ** 2
    for node in range(1, nodes):
        parent = parents[node]
        for lane in range(LANES):
            k = stiffnesses[node, lane]
            pivot = k + dynamic[node, lane]
            pivot = _NO_PIVOT * k if pivot == 0.0 else pivot
            mode[node, lane] = (pushed[node, lane] + k * mode[parent, lane]) / pivot
            size[lane] += inertias[node, lane] * mode[node, lane] ** 2
    for lane in range(LANES):
        size[lane] = 1.0 / math.sqrt(size[lane])
    for node in range(nodes):
        for lane in range(LANES):
            mode[node, lane] *= size[lane]


@driver
def _enclose(
    begin: int,
    end: int,
    free: int,
    tree: TreeRows,
    squares: np.ndarray,
    modes: np.ndarray,
    room: np.ndarray,
    lanes: np.ndarray,
) -> None:
    """Squares of natural frequencies, and modes, of blocks `begin` … `end` − 1 of LANES variants.

    `room` (_ROWS, nodes, LANES) and `lanes` (_SINGLE, LANES) are scratch arrays.
    """
    parents, (nodes, variants) = tree.parents, tree.inertias.shape
    inertias, ground, stiffnesses, dynamic = room[0], room[1], room[2], room[3]
    pushed, mode, rows = room[4], room[5], room[6]
    low, high, middle, below, greatest = lanes[0], lanes[1], lanes[2], lanes[3], lanes[4]
    for block in range(begin, end):
        first = block * LANES
        count = min(LANES, variants - first)
        for node in range(nodes):
            for lane in range(LANES):
                place = first + min(lane, count - 1)
                inertias[node, lane] = tree.inertias[node, place]
                ground[node, lane] = tree.ground[node, place]
                stiffnesses[node, lane] = tree.stiffnesses[node, place]
        # Gershgorin: no square exceeds the largest row sum of magnitudes of M⁻¹ K.
        for node in range(nodes):
            for lane in range(LANES):
                rows[node, lane] = ground[node, lane] + 2.0 * stiffnesses[node, lane]
        for node in range(1, nodes):
            for lane in range(LANES):
                rows[parents[node], lane] += 2.0 * stiffnesses[node, lane]
        for lane in range(LANES):
            greatest[lane] = below[lane] = 0.0
        for node in range(nodes):
            for lane in range(LANES):
                bound = 2.0 * rows[node, lane] / inertias[node, lane]
                greatest[lane] = bound if bound > greatest[lane] else greatest[lane]
                below[lane] += bound
        for lane in range(LANES):
            # A comparison ignores NaN; the sum does not.
            greatest[lane] = greatest[lane] if below[lane] < math.inf else math.nan
            low[lane] = _LOWEST * greatest[lane]
        for k in range(squares.shape[0]):
            for lane in range(LANES):
                high[lane] = greatest[lane]
            wide, found_before = 1.0, float(free + k)
            while wide > 0.0:
                for lane in range(LANES):
                    a, b = low[lane], high[lane]
                    middle[lane] = math.sqrt(a) * math.sqrt(b) if b > 4.0 * a else 0.5 * (a + b)
                _count_below(parents, inertias, ground, stiffnesses, middle, dynamic, below)
                wide = 0.0
                for lane in range(LANES):
                    # Converged lanes stay unchanged while the others continue.
                    a, b, m, count_below = low[lane], high[lane], middle[lane], below[lane]
                    lower = a if count_below > found_before else m
                    upper = m if count_below > found_before else b
                    lower = lower if b - a > ENCLOSED * b else a
                    upper = upper if b - a > ENCLOSED * b else b
                    low[lane], high[lane] = lower, upper
                    wide += 1.0 if upper - lower > ENCLOSED * upper else 0.0
            for lane in range(LANES):
                middle[lane] = 0.5 * (low[lane] + high[lane])
            _count_below(parents, inertias, ground, stiffnesses, middle, dynamic, below)
            for node in range(nodes):
                # The start must not be orthogonal to the mode: use irregular numbers.
                start = 1.0 + (0.618 * (node + 1)) % 1.0
                for lane in range(LANES):
                    mode[node, lane] = start / math.sqrt(inertias[node, lane])
            for _ in range(_ITERATIONS):
                _iterate(parents, inertias, stiffnesses, middle, dynamic, pushed, mode, below)
            for lane in range(count):
                squares[k, first + lane] = middle[lane]
            for node in range(nodes):
                for lane in range(count):
                    modes[k, node, first + lane] = mode[node, lane]
