"""Steady motion of a motor, an elastic shaft and a machine whose inertia changes: the cycle that closes in itself.

With the machine's crank angle φ₂ as the independent variable, S = k(φ₁ − φ₂) the elastic moment of the shaft, ω₁ the
motor's speed and E = ½I(φ₂)ω₂² the machine's energy, the equations of motion

    I₁ φ̈₁ = M_m(φ̇₁) − T,   I(φ₂) φ̈₂ + ½ I′(φ₂) φ̇₂² = T + M(φ₂, φ̇₂),   T = S + b(φ̇₁ − φ̇₂)

become S′ = k(ω₁/ω₂ − 1), ω₁′ = (M_m − T)/(I₁ω₂), E′ = T + M: everything but the state is known at every place
beforehand, and no derivative of I is needed. All steps of the cycle are solved together by collocation of order eight,
at Gauss' points, in Newton's iterations: each composes the linear maps of the steps to that of the cycle, P, and closes
it, (I − P) x = p. At the solution P is the monodromy matrix of Poincaré's map, its eigenvalues are the multipliers. The
collocation is stable for the stiffest shafts, so that rigid motion is a limit of the same equations.

Sources: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links); U. M. Ascher,
R. M. M. Mattheij and R. D. Russell, Numerical Solution of Boundary Value Problems for Ordinary Differential Equations
(quasilinearization, collocation at Gaussian points).
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import driver, routine
from engine.laws.elementary import power
from engine.laws.motor_characteristics import BENDS, PER_BEND, motors_at

# Of each variant: stiffness, damping, inertia of the motor.
STIFFNESS, DAMPING, MOTOR_INERTIA = range(3)
# Of a place: inertia, moments over ω⁰, ω¹ and ω², then power laws.
INERTIA, LEVEL, SLOPE, CURVATURE, LAWS = range(5)
# State: elastic moment, speed of the motor, energy of the machine.
ELASTIC, MOTOR_SPEED, ENERGY = range(3)
STATE = 3
# What is found of each variant: how it ended, period, works of motors, loads, damping, moment of the shaft over time.
ENDED, PERIOD, MOTOR_WORK, LOAD_WORK, DAMPING_WORK, MOMENT_TIME = range(6)
FOUND = 6
CLOSES, TURNS_BACK, NOT_FOUND = range(3)

STAGES = 4
UNKNOWNS = STATE * STAGES
COLUMNS = STATE + 1
MOST_ITERATIONS = 60
# Changes of the state, as shares of its size, after which an iteration was the last but one.
_SETTLED = 1e-7
# What rounding leaves of an elastic moment, over stiffness and energy.
_ROUNDED = 1e-13
# In an iteration the energy at a place changes by no more than these factors.
_LEAST, _MOST = 0.2, 5.0


def _gauss() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places, weights and matrix of collocation at Gauss' points on [0, 1]."""
    points, weights = np.polynomial.legendre.leggauss(STAGES)
    points, weights = 0.5 * (points + 1.0), 0.5 * weights
    exponents = np.arange(STAGES)
    integrals = points[:, None] ** (exponents + 1) / (exponents + 1)
    return points, weights, integrals @ np.linalg.inv(points[:, None] ** exponents)


POINTS, WEIGHTS, _MATRIX = _gauss()


@routine
def _loads(place: np.ndarray, exponents: np.ndarray, w: float) -> tuple[float, float]:
    """Moment of the loads at a place and a speed, and its derivative by the speed."""
    moment = place[LEVEL] + w * (place[SLOPE] + w * place[CURVATURE])
    slope = place[SLOPE] + 2.0 * w * place[CURVATURE]
    for law in range(exponents.shape[0]):
        own = place[LAWS + law] * power(w, exponents[law])
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
    """Derivatives of the state by the crank angle, and theirs by the state."""
    k, b, first = own[STIFFNESS], own[DAMPING], own[MOTOR_INERTIA]
    speed = math.sqrt(2.0 * state[ENERGY] / place[INERTIA])
    by_energy = 1.0 / (place[INERTIA] * speed)
    motor, motor_slope = motors_at(*motors, state[MOTOR_SPEED])
    load, load_slope = _loads(place, exponents, speed)
    moment = state[ELASTIC] + b * (state[MOTOR_SPEED] - speed)
    rates[0] = k * (state[MOTOR_SPEED] - speed) / speed
    rates[1] = (motor - moment) / (first * speed)
    rates[2] = moment + load
    jacobian[0, 0], jacobian[0, 1] = 0.0, k / speed
    jacobian[0, 2] = -k * state[MOTOR_SPEED] / (speed * speed) * by_energy
    jacobian[1, 0], jacobian[1, 1] = -1.0 / (first * speed), (motor_slope - b) / (first * speed)
    jacobian[1, 2] = (b / (first * speed) - rates[1] / speed) * by_energy
    jacobian[2, 0], jacobian[2, 1], jacobian[2, 2] = 1.0, b, (load_slope - b) * by_energy


@routine
def _solve(matrix: np.ndarray, right: np.ndarray, size: int, columns: int) -> None:
    """Solve a small system of linear equations in place, by Gauss' elimination with pivots."""
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
    """Drives whose cycles are to be closed, and what is found.

    Attributes
    ----------
    given : ndarray (drives, 3)
        STIFFNESS, DAMPING, MOTOR_INERTIA.
    drives : ndarray (rows, drives)
        Characteristics of the motors, as in `engine.laws.motor_characteristics`.
    exponents : ndarray (drives, laws)
    steps : ndarray (drives, steps)
        [rad].
    places : ndarray (drives, steps, STAGES, LAWS + laws)
        The machine at Gauss' points of every step.
    states : ndarray (drives, steps, STAGES, STATE)
        There, a first guess; the motion when done.
    nodes : ndarray (drives, steps + 1, STATE)
        The motion at the ends of steps.
    monodromy : ndarray (drives, STATE, STATE)
    found : ndarray (drives, FOUND)
    bent : int
        How many bends the characteristics have.
    """

    given: np.ndarray
    drives: np.ndarray
    exponents: np.ndarray
    steps: np.ndarray
    places: np.ndarray
    states: np.ndarray
    nodes: np.ndarray
    monodromy: np.ndarray
    found: np.ndarray
    bent: int


@driver
def close_cycles(
    begin: int, end: int, batch: CyclesToClose, maps: np.ndarray, slopes: np.ndarray, room: np.ndarray
) -> None:
    """Find the steady motion of drives `begin` … `end` − 1.

    Parameters
    ----------
    begin, end : int
    batch : CyclesToClose
    maps, slopes : ndarray (steps, UNKNOWNS, COLUMNS), (steps, UNKNOWNS)
        Memory.
    room : ndarray (2, UNKNOWNS, UNKNOWNS)
        Memory.
    """
    given, drives, exponents, steps, places, states, nodes, monodromy, found = batch[:9]
    matrix, small = room[0], room[1]
    rates, jacobian, turned = small[0], small[1:4], small[4:8]
    whole, moved, other = small[8:11], small[11], matrix[0]
    count, rows = steps.shape[1], (BENDS + PER_BEND * batch.bent, drives.shape[0])
    for i in range(begin, end):
        own, motors, powers = given[i], (drives, i, rows), exponents[i]
        for n in range(count + 1):
            for c in range(STATE):
                nodes[i, n, c] = 0.0
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
                    _rates(own, motors, powers, places[i, n, s], states[i, n, s], rates, jacobian)
                    for r in range(STATE):
                        rest = rates[r] - slopes[n, at + r]
                        for c in range(STATE):
                            consistent = nodes[i, n, c]
                            for z in range(STAGES):
                                consistent += h * _MATRIX[s, z] * slopes[n, STATE * z + c]
                            rest -= jacobian[r, c] * (states[i, n, s, c] - consistent)
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
                            turned[r, c] += h * WEIGHTS[s] * right[STATE * s + r, c]
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
            # Sizes of the state, and how far what it was made linear about is from it.
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
                        moved[r] += h * WEIGHTS[s] * rates[STATE * s + r]
                for s in range(STAGES):
                    for r in range(STATE):
                        value = nodes[i, n, r]
                        for z in range(STAGES):
                            value += h * _MATRIX[s, z] * slopes[n, STATE * z + r]
                        before = states[i, n, s, r]
                        sizes[r], off[r] = max(sizes[r], abs(value)), max(off[r], abs(value - before))
                        if value - before != value - before:
                            off[r] = math.inf
                        if r == ENERGY:
                            positive &= value > 0.0
                            value = min(max(value, _LEAST * before), _MOST * before)
                        states[i, n, s, r] = value
            for r in range(STATE):
                total = nodes[i, count - 1, r]
                for s in range(STAGES):
                    total += steps[i, count - 1] * WEIGHTS[s] * slopes[count - 1, STATE * s + r]
                nodes[i, count, r] = total
            if last:
                ended = CLOSES
                break
            # A shaft without a moment has rounding alone: of the twist, and of the work.
            least = _ROUNDED * (own[STIFFNESS] + sizes[ENERGY])
            last = off[ELASTIC] <= _SETTLED * sizes[ELASTIC] + least
            last &= off[MOTOR_SPEED] <= _SETTLED * sizes[MOTOR_SPEED]
            last &= off[ENERGY] <= _SETTLED * sizes[ENERGY]
            ended = NOT_FOUND if positive else TURNS_BACK
        for j in range(FOUND):
            found[i, j] = 0.0
        found[i, ENDED] = ended
        for n in range(count):
            for s in range(STAGES):
                state, place = states[i, n, s], places[i, n, s]
                speed = math.sqrt(2.0 * state[ENERGY] / place[INERTIA])
                slip = state[MOTOR_SPEED] - speed
                time = steps[i, n] * WEIGHTS[s] / speed
                found[i, PERIOD] += time
                found[i, MOTOR_WORK] += time * motors_at(*motors, state[MOTOR_SPEED])[0] * state[MOTOR_SPEED]
                found[i, LOAD_WORK] += time * _loads(place, powers, speed)[0] * speed
                found[i, DAMPING_WORK] += time * given[i, DAMPING] * slip * slip
                found[i, MOMENT_TIME] += time * (state[ELASTIC] + given[i, DAMPING] * slip)
