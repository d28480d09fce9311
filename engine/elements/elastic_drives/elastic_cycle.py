"""Steady running of a motor, an elastic shaft and a machine with variable inertia: the periodic cycle.

The crank angle is the independent variable; the state x is the elastic torque of the shaft, the motor's speed and the
machine's energy. Newton's method solves all steps of the cycle together, by collocation of order eight at Gauss points:
the slopes k there satisfy k = f + J (x + h A k − s) about the last states s. Each iteration composes the linear maps of
the steps into that of the cycle, P, and closes the cycle: (I − P) x = p. At the solution P is the monodromy matrix of
the Poincaré map, and its eigenvalues are the multipliers. The collocation is stable for arbitrarily stiff shafts, so
rigid motion is a limit of the same equations.

Sources: K. V. Frolov et al., Theory of Mechanisms and Machines (drives with elastic links); U. M. Ascher,
R. M. M. Mattheij and R. D. Russell, Numerical Solution of Boundary Value Problems for Ordinary Differential Equations
(quasilinearization, collocation at Gaussian points).
"""

from typing import NamedTuple

import numpy as np
from numpy.polynomial.legendre import leggauss

from engine.compiling.running import sum_of_rows
from engine.stepping.system import PrintedSystem
from engine.stepping.tableaux import collocation
from engine.words.verdicts import Verdict

# Size of the state: elastic torque, motor speed, energy of the machine.
STATE = 3
GAUSS = collocation(0.5 * (leggauss(4)[0] + 1.0))
STAGES, _MATRIX, _WEIGHTS = GAUSS.stages, GAUSS.matrix, GAUSS.weights
UNKNOWNS, COLUMNS = STATE * STAGES, STATE + 1
MOST_ITERATIONS = 60
# Relative change of the state after which one more iteration is the last.
_SETTLED = 1e-7
# Rounding of an elastic torque, relative to stiffness plus energy.
_ROUNDED = 1e-13
# Limits of the factor by which an iteration changes the energy at a Gauss point.
_LEAST, _MOST = 0.2, 5.0


def _closed(
    steps: np.ndarray, jacobian: np.ndarray, right: np.ndarray, lacking: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Solve the linear equations of cycles, k = J (x + h A k) + r, for the slopes k and the nodes x of all steps.

    Parameters
    ----------
    steps : ndarray (drives, steps)
        h [rad].
    jacobian : ndarray (drives, STATE, STATE, steps, STAGES)
    right : ndarray (drives, STATE, steps, STAGES)
        r.
    lacking : ndarray (drives, STATE)
        Shortfall in the growth of x over a cycle.

    Returns
    -------
    slopes : ndarray (drives, STATE, steps, STAGES)
        k.
    nodes : ndarray (drives, STATE, steps + 1)
        x.
    monodromy : ndarray (drives, STATE, STATE)
        P.
    """
    drives, count = steps.shape
    own = np.concatenate([jacobian, right[:, :, None]], axis=2).transpose(0, 3, 4, 1, 2)
    shares = (steps[:, :, None, None] * -_MATRIX)[:, :, :, None, :, None]
    stages = (shares * own[:, :, :, :, None, :STATE]).reshape(drives, count, UNKNOWNS, UNKNOWNS)
    stages[..., np.arange(UNKNOWNS), np.arange(UNKNOWNS)] += 1.0
    # The slopes of a step, and the state at its end, as affine maps of the state at its start.
    maps = _solved(stages, own.reshape(drives, count, UNKNOWNS, COLUMNS))
    # Filled up to a power of 2 by steps that change nothing.
    after = np.tile(np.eye(COLUMNS), (drives, 1 << count.bit_length(), 1, 1))
    after[:, :count, :STATE] += (steps[:, :, None] * (_WEIGHTS @ maps.reshape(drives, count, STAGES, -1))).reshape(
        drives, count, STATE, COLUMNS
    )
    # Maps of two steps together, of four, … of all.
    joined = [after]
    while joined[-1].shape[1] > 1:
        joined.append(joined[-1][:, 1::2] @ joined[-1][:, ::2])
    whole = joined.pop()[:, 0, :STATE]
    matrix = np.eye(STATE) - whole[:, :, :STATE]
    start = _solved(matrix, (whole[:, :, STATE] + lacking)[:, :, None])
    nodes = np.concatenate([start, np.ones((drives, 1, 1))], axis=1)[:, None]
    for maps_of_steps in reversed(joined):
        nodes = np.stack([nodes, maps_of_steps[:, ::2] @ nodes], axis=2).reshape(drives, -1, COLUMNS, 1)
    nodes = nodes[:, : count + 1, :, 0]
    slopes = (maps @ nodes[:, :-1, :, None]).reshape(drives, count, STAGES, STATE).transpose(0, 3, 1, 2)
    return slopes, np.moveaxis(nodes[..., :STATE], 1, 2), whole[:, :, :STATE]


def _solved(matrices: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Solutions of linear equations, as by `np.linalg.solve`, but NaN where a matrix is singular."""
    try:
        return np.linalg.solve(matrices, right)
    except np.linalg.LinAlgError:
        singular = np.linalg.slogdet(matrices).sign == 0.0
        return np.linalg.solve(np.where(singular[..., None, None], np.nan, matrices), right)


class CycleSums(NamedTuple):
    """Results for cycles, (variants,): period [s], works [J], integral of the shaft torque over time [N·m·s]."""

    period: np.ndarray
    motor_work: np.ndarray
    load_work: np.ndarray
    damping_work: np.ndarray
    impulse: np.ndarray


class DrivenMachine(NamedTuple):
    """A machine, its shaft and its motors over a cycle of the machine.

    Attributes
    ----------
    steps : ndarray (variants, steps)
        [rad].
    places : ndarray (steps · STAGES, variants)
        Crank angles at the Gauss points of every step [rad].
    inertia : ndarray (variants, steps, points)
        Reduced inertia of the machine, at the ends and Gauss points of every step [kg·m²].
    system : PrintedSystem
        Elastic torque, speed at the motor end and energy of the machine over the crank angle, with the integrals of
        `CycleSums` and the Jacobian of the rates.
    numbers : ndarray (numbers, variants)
        Numbers of the system.
    """

    steps: np.ndarray
    places: np.ndarray
    inertia: np.ndarray
    system: PrintedSystem
    numbers: np.ndarray

    def at(self, states: np.ndarray, rows: list[int], who: np.ndarray) -> np.ndarray:
        """Rows of the system at states (variants, STATE, steps, STAGES) of some variants, (rows, points, variants)."""
        motion = np.moveaxis(states.reshape(who.size, STATE, -1), 0, 2)
        return self.system.at(self.numbers, self.places[:, who], motion, rows, who=who)


class ElasticCycle(NamedTuple):
    """Steady running of a machine on an elastic shaft, at the points of every step; (variants, steps, points).

    Attributes
    ----------
    moment, twist : ndarray
        Torque [N·m] and twist [rad] of the shaft.
    motor_speed, machine_speed : ndarray
        [rad/s].
    multipliers : ndarray (variants, 3)
        Magnitudes, in descending order.
    sums : CycleSums
    verdict : ndarray (variants,) of uint8
    """

    moment: np.ndarray
    twist: np.ndarray
    motor_speed: np.ndarray
    machine_speed: np.ndarray
    multipliers: np.ndarray
    sums: CycleSums
    verdict: np.ndarray

    @property
    def begin(self) -> np.ndarray:
        """Twist, speed at the motor end, angle turned and speed of the machine at the start, (4, variants)."""
        rows = (self.twist, self.motor_speed, np.zeros_like(self.twist), self.machine_speed)
        return np.array([row[:, 0, 0] for row in rows])


def elastic_cycle(machine: DrivenMachine, given: np.ndarray, guess: np.ndarray) -> ElasticCycle:
    """Find the steady running of drives.

    Parameters
    ----------
    machine : DrivenMachine
    given : ndarray (variants, 3)
        Stiffness and damping of the shaft, inertia at the motor end.
    guess : ndarray (variants, STATE, steps, STAGES)
        Initial guess of the motion.
    """
    (variants, count), system, states = machine.steps.shape, machine.system, guess.copy()
    slopes, nodes = np.zeros_like(states), np.zeros((variants, STATE, count + 1))
    monodromy, verdict = np.empty((variants, STATE, STATE)), np.empty(variants, np.uint8)
    rows = [*range(STATE), *(system.rows_of[f"slope {i}"] for i in range(STATE * STATE))]
    last, pending = np.zeros(variants, bool), np.arange(variants)
    for _ in range(MOST_ITERATIONS):
        h, before, k, x = (row[pending] for row in (machine.steps, states, slopes, nodes))
        found = np.moveaxis(machine.at(before, rows, pending), 2, 0).reshape(pending.size, -1, count, STAGES)
        jacobian = found[:, STATE:].reshape(pending.size, STATE, STATE, count, STAGES)
        off = before - _within(h, x, k)
        change = found[:, :STATE] - k - np.einsum("drcns,dcns->drns", jacobian, off)
        raised, moved, own = _closed(h, jacobian, change, x[..., -1] - x[..., 0])
        k += raised
        x += moved
        x[..., -1] = x[..., -2] + h[:, -1:] * (k[:, :, -1] @ _WEIGHTS)
        after = _within(h, x, k)
        # The torque of an unloaded shaft is rounding of its twist and of the work.
        sizes, left = (np.abs(x).reshape(pending.size, STATE, -1).max(axis=2) for x in (after, after - before))
        negligible = _SETTLED * sizes
        negligible[:, 0] += _ROUNDED * (given[pending, 0] + sizes[:, -1])
        turns_back = ~(after[:, -1] > 0.0).all(axis=(1, 2))
        verdict[pending] = np.where(turns_back, Verdict.TURNS_BACK, Verdict.NOT_FINITE)
        verdict[pending[last[pending]]] = Verdict.OK
        last[pending] = (left <= negligible).all(axis=1)
        after[:, -1] = np.clip(after[:, -1], _LEAST * before[:, -1], _MOST * before[:, -1])
        states[pending], slopes[pending], nodes[pending], monodromy[pending] = after, k, x, own
        pending = pending[verdict[pending] != Verdict.OK]
        if not pending.size:
            break
    rows = [system.names[name] for name in CycleSums._fields]
    weights = (machine.steps[:, :, None] * _WEIGHTS).reshape(variants, -1).T
    sums = CycleSums(*(sum_of_rows(weights * row) for row in machine.at(states, rows, np.arange(variants))))
    points = np.concatenate([nodes[:, :, :-1, None], states, nodes[:, :, 1:, None]], axis=3)
    elastic, motor_speed, energy = np.moveaxis(points, 1, 0)
    stiffness, damping = given[:, 0, None, None], given[:, 1, None, None]
    with np.errstate(all="ignore"):
        speed = np.sqrt(2.0 * energy / machine.inertia)
        moment = elastic + damping * (motor_speed - speed)
    finite = np.isfinite(monodromy).all(axis=(1, 2)) & np.isfinite(moment).all(axis=(1, 2))
    verdict[(verdict == Verdict.OK) & ~finite] = Verdict.NOT_FINITE
    sound = verdict == Verdict.OK
    multipliers = np.full((variants, STATE), np.nan)
    multipliers[sound] = -np.sort(-np.abs(np.linalg.eigvals(monodromy[sound])), axis=1)
    return ElasticCycle(moment, elastic / stiffness, motor_speed, speed, multipliers, sums, verdict)


def _within(steps: np.ndarray, nodes: np.ndarray, slopes: np.ndarray) -> np.ndarray:
    """States at the Gauss points, x + h A k."""
    return nodes[..., :-1, None] + steps[:, None, :, None] * (slopes @ _MATRIX.T)
