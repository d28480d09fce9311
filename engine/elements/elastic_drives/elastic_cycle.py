"""Steady running of a motor, an elastic shaft and a machine with variable inertia: the periodic cycle.

The crank angle is the independent variable; the state is the elastic torque of the shaft, the motor's speed and the
machine's energy. Newton's method solves all steps of the cycle together, by collocation of order eight at Gauss points.
Each iteration composes the linear maps of the steps into that of the cycle, P, and closes the cycle: (I − P) x = p. At
the solution P is the monodromy matrix of the Poincaré map, and its eigenvalues are the multipliers. The collocation is
stable for arbitrarily stiff shafts, so rigid motion is a limit of the same equations.

Sources: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links); U. M. Ascher,
R. M. M. Mattheij and R. D. Russell, Numerical Solution of Boundary Value Problems for Ordinary Differential Equations
(quasilinearization, collocation at Gaussian points).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from engine.compiling.decorators import driver, routine
from engine.stepping.tableaux import collocation

# Outcomes of a search.
CLOSES, TURNS_BACK, NOT_FOUND = range(3)
# Size of the state: elastic torque, motor speed, energy of the machine.
STATE = 3
GAUSS = collocation(0.5 * (leggauss(4)[0] + 1.0))
STAGES, _MATRIX, _WEIGHTS = GAUSS.stages, GAUSS.matrix, GAUSS.weights
UNKNOWNS = STATE * STAGES
COLUMNS = STATE + 1
MOST_ITERATIONS = 60
# Relative change of the state after which one more iteration is the last.
_SETTLED = 1e-7
# Rounding of an elastic torque, relative to stiffness plus energy.
_ROUNDED = 1e-13
# Limits of the factor by which an iteration changes the energy at a node.
_LEAST, _MOST = 0.2, 5.0


@routine
def _solve(matrix: np.ndarray, right: np.ndarray, size: int, columns: int) -> None:
    """Solve a small system of linear equations in place, by Gaussian elimination with pivoting."""
    for i in range(size):
        pivot = i
        for r in range(i + 1, size):
            if abs(matrix[r, i]) > abs(matrix[pivot, i]):
                pivot = r
        if pivot != i:
            for c in range(size):
                matrix[i, c], matrix[pivot, c] = matrix[pivot, c], matrix[i, c]
            for c in range(columns):
                right[i, c], right[pivot, c] = right[pivot, c], right[i, c]
        inverse = 1.0 / matrix[i, i]
        for r in range(i + 1, size):
            factor = matrix[r, i] * inverse
            if factor != 0.0:
                for c in range(i + 1, size):
                    matrix[r, c] -= factor * matrix[i, c]
                for c in range(columns):
                    right[r, c] -= factor * right[i, c]
    for i in range(size - 1, -1, -1):
        for c in range(columns):
            total = right[i, c]
            for r in range(i + 1, size):
                total -= matrix[i, r] * right[r, c]
            right[i, c] = total / matrix[i, i]


class CyclesToClose(NamedTuple):
    """Progress of the search for periodic cycles.

    Attributes
    ----------
    stiffness : ndarray (drives,)
    steps : ndarray (drives, steps)
        [rad].
    states : ndarray (drives, steps, STAGES, STATE)
        The motion at the Gauss points.
    slopes : ndarray (drives, steps, UNKNOWNS)
        Its derivatives there.
    nodes : ndarray (drives, steps + 1, STATE)
        The motion at the ends of steps.
    monodromy : ndarray (drives, STATE, STATE)
    ended : ndarray (drives,) of int
        CLOSES, TURNS_BACK or NOT_FOUND.
    last : ndarray (drives,) of bool
        Whether one more iteration is the last.
    """

    stiffness: np.ndarray
    steps: np.ndarray
    states: np.ndarray
    slopes: np.ndarray
    nodes: np.ndarray
    monodromy: np.ndarray
    ended: np.ndarray
    last: np.ndarray


@driver
def improve_cycles(
    begin: int,
    end: int,
    batch: CyclesToClose,
    pending: np.ndarray,
    found: np.ndarray,
    maps: np.ndarray,
    room: np.ndarray,
) -> None:
    """One iteration for the drives `begin` … `end` − 1 of those pending.

    Parameters
    ----------
    begin, end : int
    batch : CyclesToClose
    pending : ndarray of int
    found : ndarray (pending, steps, STAGES, STATE + STATE²)
        Rates at the Gauss points, and their Jacobian.
    maps : ndarray (steps, UNKNOWNS, COLUMNS)
        Scratch.
    room : ndarray (2, UNKNOWNS, UNKNOWNS)
        Scratch.
    """
    stiffness, steps, states, _, nodes, monodromy, _, _ = batch
    matrix, small = room[0], room[1]
    rates, turned = small[0], small[4:8]
    whole, moved, other = small[8:11], small[11], matrix[0]
    count = steps.shape[1]
    for k in range(begin, end):
        i = pending[k]
        slopes = batch.slopes[i]
        for r in range(STATE):
            for c in range(COLUMNS):
                whole[r, c] = 1.0 if r == c else 0.0
        for n in range(count):
            h, right = steps[i, n], maps[n]
            for s in range(STAGES):
                at, here = STATE * s, found[k, n, s]
                for r in range(STATE):
                    rest = here[r] - slopes[n, at + r]
                    for c in range(STATE):
                        consistent, jacobian = nodes[i, n, c], here[STATE + STATE * r + c]
                        for z in range(STAGES):
                            consistent += h * _MATRIX[s, z] * slopes[n, STATE * z + c]
                        rest -= jacobian * (states[i, n, s, c] - consistent)
                        right[at + r, c] = jacobian
                        for z in range(STAGES):
                            matrix[at + r, STATE * z + c] = -h * _MATRIX[s, z] * jacobian
                    matrix[at + r, at + r] += 1.0
                    right[at + r, STATE] = rest
            _solve(matrix, right, UNKNOWNS, COLUMNS)
            for r in range(STATE):
                for c in range(COLUMNS):
                    turned[r, c] = 1.0 if r == c else 0.0
                    for s in range(STAGES):
                        turned[r, c] += h * _WEIGHTS[s] * right[STATE * s + r, c]
            for c in range(COLUMNS):
                for r in range(STATE):
                    other[r] = turned[r, STATE] if c == STATE else 0.0
                    for z in range(STATE):
                        other[r] += turned[r, z] * whole[z, c]
                for r in range(STATE):
                    whole[r, c] = other[r]
        for r in range(STATE):
            for c in range(STATE):
                monodromy[i, r, c] = whole[r, c]
                matrix[r, c] = (1.0 if r == c else 0.0) - whole[r, c]
            turned[r, 0] = whole[r, STATE] + nodes[i, count, r] - nodes[i, 0, r]
        _solve(matrix, turned, STATE, 1)
        for r in range(STATE):
            moved[r] = turned[r, 0]
        # Largest values of the state, and its largest changes in this iteration.
        sizes, off, positive = other[:STATE], other[STATE : 2 * STATE], True
        for r in range(STATE):
            sizes[r], off[r] = 0.0, 0.0
        for n in range(count):
            h = steps[i, n]
            for r in range(STATE):
                nodes[i, n, r] += moved[r]
            for j in range(UNKNOWNS):
                change = maps[n, j, STATE]
                for c in range(STATE):
                    change += maps[n, j, c] * moved[c]
                slopes[n, j] += change
                rates[j] = change
            for r in range(STATE):
                for s in range(STAGES):
                    moved[r] += h * _WEIGHTS[s] * rates[STATE * s + r]
            for s in range(STAGES):
                for r in range(STATE):
                    value = nodes[i, n, r]
                    for z in range(STAGES):
                        value += h * _MATRIX[s, z] * slopes[n, STATE * z + r]
                    before = states[i, n, s, r]
                    sizes[r], off[r] = max(sizes[r], abs(value)), max(off[r], abs(value - before))
                    if value - before != value - before:
                        off[r] = math.inf
                    if r == STATE - 1:
                        positive &= value > 0.0
                        value = min(max(value, _LEAST * before), _MOST * before)
                    states[i, n, s, r] = value
        for r in range(STATE):
            total = nodes[i, count - 1, r]
            for s in range(STAGES):
                total += steps[i, count - 1] * _WEIGHTS[s] * slopes[count - 1, STATE * s + r]
            nodes[i, count, r] = total
        if batch.last[i]:
            batch.ended[i] = CLOSES
            continue
        # The torque of an unloaded shaft is rounding of its twist and of the work.
        least, last = _ROUNDED * (stiffness[i] + sizes[STATE - 1]), True
        for r in range(STATE):
            last &= off[r] <= _SETTLED * sizes[r] + (least if r == 0 else 0.0)
        batch.last[i], batch.ended[i] = last, NOT_FOUND if positive else TURNS_BACK
