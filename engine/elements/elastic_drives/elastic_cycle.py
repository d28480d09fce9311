"""Steady running of a motor, an elastic shaft and a machine with variable inertia: the periodic cycle.

With the machine's crank angle φ₂ as the independent variable, S = k(φ₁ − φ₂) the elastic torque of the shaft, ω₁ the
motor's speed and E = ½I(φ₂)ω₂² the machine's energy, the equations of motion

    I₁ φ̈₁ = M_m(φ̇₁) − T,   I(φ₂) φ̈₂ + ½ I′(φ₂) φ̇₂² = T + M(φ₂, φ̇₂),   T = S + b(φ̇₁ − φ̇₂)

become S′ = k(ω₁/ω₂ − 1), ω₁′ = (M_m − T)/(I₁ω₂), E′ = T + M. Everything but the state is known in advance at every
node, and no derivative of I is needed. Newton's method solves all steps of the cycle together, by collocation of order
eight at Gauss points. Each iteration composes the linear maps of the steps into that of the cycle, P, and closes the
cycle: (I − P) x = p. At the solution P is the monodromy matrix of the Poincaré map, and its eigenvalues are the
multipliers. The collocation is stable for arbitrarily stiff shafts, so rigid motion is a limit of the same equations.

Sources: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links); U. M. Ascher,
R. M. M. Mattheij and R. D. Russell, Numerical Solution of Boundary Value Problems for Ordinary Differential Equations
(quasilinearization, collocation at Gaussian points).
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from engine.compiling.decorators import routine
from engine.compiling.running import over_variants
from engine.laws.elementary import power
from engine.laws.motor_characteristics import BENDS, PER_BEND, motors_at
from engine.stepping.tableaux import collocation

# Outcomes of a search.
CLOSES, TURNS_BACK, NOT_FOUND = range(3)
# Size of the state: elastic torque, motor speed, energy of the machine. Number of known values at a node: inertia and
# torque coefficients in ω⁰, ω¹ and ω²; power laws follow.
STATE, KNOWN = 3, 4
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
def _loads(place: np.ndarray, exponents: np.ndarray, w: float) -> tuple[float, float]:
    """Torque of the loads at a node and a speed, and its derivative with respect to the speed."""
    level, fall, curvature = place[1], place[2], place[3]
    moment = level + w * (fall + w * curvature)
    slope = fall + 2.0 * w * curvature
    for law in range(exponents.shape[0]):
        own = place[KNOWN + law] * power(w, exponents[law])
        moment += own
        slope += exponents[law] * own / w
    return moment, slope


@routine
def _rates(
    own: np.ndarray,
    motors: tuple[np.ndarray, int, tuple[int, int]],
    exponents: np.ndarray,
    place: np.ndarray,
    state: np.ndarray,
    rates: np.ndarray,
    jacobian: np.ndarray,
) -> None:
    """Derivatives of the state with respect to the crank angle, and their Jacobian."""
    k, b, first = own[0], own[1], own[2]
    elastic, motor_speed, energy = state[0], state[1], state[2]
    speed = math.sqrt(2.0 * energy / place[0])
    by_energy = 1.0 / (place[0] * speed)
    motor, motor_slope = motors_at(*motors, motor_speed)
    load, load_slope = _loads(place, exponents, speed)
    moment = elastic + b * (motor_speed - speed)
    rates[0] = k * (motor_speed - speed) / speed
    rates[1] = (motor - moment) / (first * speed)
    rates[2] = moment + load
    jacobian[0, 0], jacobian[0, 1] = 0.0, k / speed
    jacobian[0, 2] = -k * motor_speed / (speed * speed) * by_energy
    jacobian[1, 0], jacobian[1, 1] = -1.0 / (first * speed), (motor_slope - b) / (first * speed)
    jacobian[1, 2] = (b / (first * speed) - rates[1] / speed) * by_energy
    jacobian[2, 0], jacobian[2, 1], jacobian[2, 2] = 1.0, b, (load_slope - b) * by_energy


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


class DrivenMachine(NamedTuple):
    """A machine without its driver, as seen by its drive, at the Gauss points of every step of its cycle.

    Attributes
    ----------
    steps : ndarray (variants, steps)
        [rad].
    places : ndarray (variants, steps, STAGES, KNOWN + laws)
        Inertia [kg·m²], coefficients of the torques in ω⁰, ω¹, ω² and in power laws.
    node_inertia : ndarray (variants, steps + 1)
        At the ends of steps [kg·m²].
    drives : ndarray (rows, variants)
        Characteristics of the motors, as in `engine.laws.motor_characteristics`.
    exponents : ndarray (variants, laws)
        Of the power laws.
    bent : int
        Number of bends of the characteristics.
    """

    steps: np.ndarray
    places: np.ndarray
    node_inertia: np.ndarray
    drives: np.ndarray
    exponents: np.ndarray
    bent: int


class CycleMotion(NamedTuple):
    """Motion of drives over a cycle.

    Attributes
    ----------
    states : ndarray (variants, steps, STAGES, STATE)
        At the Gauss points; an initial guess before the search.
    slopes : ndarray (variants, steps, UNKNOWNS)
        Derivatives of the states with respect to the crank angle.
    nodes : ndarray (variants, steps + 1, STATE)
        At the ends of steps.
    monodromy : ndarray (variants, STATE, STATE)
    ended : ndarray (variants,)
        CLOSES, TURNS_BACK or NOT_FOUND.
    """

    states: np.ndarray
    slopes: np.ndarray
    nodes: np.ndarray
    monodromy: np.ndarray
    ended: np.ndarray


@over_variants
def close_cycles(begin: int, end: int, given: np.ndarray, machine: DrivenMachine, motion: CycleMotion) -> None:
    """Find the steady running of drives `begin` … `end` − 1.

    Parameters
    ----------
    begin, end : int
    given : ndarray (variants, 3)
        Stiffness, damping, inertia of the motor.
    machine : DrivenMachine
    motion : CycleMotion
        Updated.
    """
    steps, places, _, drives, exponents, bent = machine
    count, rows = steps.shape[1], (BENDS + PER_BEND * bent, drives.shape[0])
    maps, room = np.empty((count, UNKNOWNS, COLUMNS)), np.empty((2, UNKNOWNS, UNKNOWNS))
    matrix, small = room[0], room[1]
    rates, jacobian, turned = small[0], small[1:4], small[4:8]
    whole, moved, other = small[8:11], small[11], matrix[0]
    for i in range(begin, end):
        own, motors, powers = given[i], (drives, i, rows), exponents[i]
        states, slopes, nodes, monodromy = motion.states[i], motion.slopes[i], motion.nodes[i], motion.monodromy[i]
        for n in range(count + 1):
            for c in range(STATE):
                nodes[n, c] = 0.0
        for n in range(count):
            for c in range(UNKNOWNS):
                slopes[n, c] = 0.0
        ended, last = NOT_FOUND, False
        for _ in range(MOST_ITERATIONS):
            for r in range(STATE):
                for c in range(COLUMNS):
                    whole[r, c] = 1.0 if r == c else 0.0
            for n in range(count):
                h, right = steps[i, n], maps[n]
                for s in range(STAGES):
                    at = STATE * s
                    _rates(own, motors, powers, places[i, n, s], states[n, s], rates, jacobian)
                    for r in range(STATE):
                        rest = rates[r] - slopes[n, at + r]
                        for c in range(STATE):
                            consistent = nodes[n, c]
                            for z in range(STAGES):
                                consistent += h * _MATRIX[s, z] * slopes[n, STATE * z + c]
                            rest -= jacobian[r, c] * (states[n, s, c] - consistent)
                            right[at + r, c] = jacobian[r, c]
                            for z in range(STAGES):
                                matrix[at + r, STATE * z + c] = -h * _MATRIX[s, z] * jacobian[r, c]
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
                    monodromy[r, c] = whole[r, c]
                    matrix[r, c] = (1.0 if r == c else 0.0) - whole[r, c]
                turned[r, 0] = whole[r, STATE] + nodes[count, r] - nodes[0, r]
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
                    nodes[n, r] += moved[r]
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
                        value = nodes[n, r]
                        for z in range(STAGES):
                            value += h * _MATRIX[s, z] * slopes[n, STATE * z + r]
                        before = states[n, s, r]
                        sizes[r], off[r] = max(sizes[r], abs(value)), max(off[r], abs(value - before))
                        if value - before != value - before:
                            off[r] = math.inf
                        if r == STATE - 1:
                            positive &= value > 0.0
                            value = min(max(value, _LEAST * before), _MOST * before)
                        states[n, s, r] = value
            for r in range(STATE):
                total = nodes[count - 1, r]
                for s in range(STAGES):
                    total += steps[i, count - 1] * _WEIGHTS[s] * slopes[count - 1, STATE * s + r]
                nodes[count, r] = total
            if last:
                ended = CLOSES
                break
            # The torque of an unloaded shaft is rounding of its twist and of the work.
            least, last = _ROUNDED * (own[0] + sizes[STATE - 1]), True
            for r in range(STATE):
                last &= off[r] <= _SETTLED * sizes[r] + (least if r == 0 else 0.0)
            ended = NOT_FOUND if positive else TURNS_BACK
        motion.ended[i] = ended
