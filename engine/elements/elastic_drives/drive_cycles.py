"""Steady running of a machine on an elastic shaft: its periodic cycle, and the results."""

import math
from functools import partial
from typing import NamedTuple

import numpy as np

from engine.compiling.running import spread, sum_of_rows
from engine.cycle.panels.chebyshev import PLACES
from engine.cycle.panels.sampled import tops
from engine.elements.elastic_drives.elastic_cycle import (
    CLOSES,
    COLUMNS,
    GAUSS,
    MOST_ITERATIONS,
    NOT_FOUND,
    STAGES,
    STATE,
    TURNS_BACK,
    UNKNOWNS,
    CyclesToClose,
    improve_cycles,
)
from engine.stepping.system import PrintedSystem
from engine.words.verdicts import Verdict

# Values at the positions of a panel of the polynomial through a step's points: its ends and the Gauss points.
_POWERS = np.arange(GAUSS.stages + 2)
_THROUGH = (0.5 * (PLACES + 1.0))[:, None] ** _POWERS @ np.linalg.inv(
    np.array([0.0, *GAUSS.nodes, 1.0])[:, None] ** _POWERS
)


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
        Of the machine, at the ends and Gauss points of every step [kg·m²].
    system : PrintedSystem
        Elastic torque, speed at the motor end and energy of the machine over the crank angle, with the integrals of
        `CycleSums` and the Jacobian of the rates.
    numbers : ndarray (numbers, variants)
        Of the system.
    """

    steps: np.ndarray
    places: np.ndarray
    inertia: np.ndarray
    system: PrintedSystem
    numbers: np.ndarray

    def at(self, states: np.ndarray, rows: list[int], who: np.ndarray) -> np.ndarray:
        """Rows of the system at states (variants, steps, STAGES, STATE) of some variants, (rows, points, variants)."""
        motion = np.moveaxis(states.reshape(who.size, -1, STATE), 0, 1)
        return self.system.at(self.numbers[:, who], self.places[:, who], np.moveaxis(motion, 2, 0), rows)


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
    guess : ndarray (variants, steps, STAGES, STATE)
        Initial guess of the motion.
    """
    (variants, count), system = machine.steps.shape, machine.system
    batch = CyclesToClose(
        np.ascontiguousarray(given[:, 0]),
        machine.steps,
        guess.copy(),
        np.zeros((variants, count, UNKNOWNS)),
        np.zeros((variants, count + 1, STATE)),
        np.empty((variants, STATE, STATE)),
        np.full(variants, NOT_FOUND),
        np.zeros(variants, bool),
    )
    jacobian = [system.shown[f"slope {i}"] for i in range(STATE * STATE)]
    pending = np.arange(variants)
    for _ in range(MOST_ITERATIONS):
        found = np.moveaxis(machine.at(batch.states[pending], [*range(STATE), *jacobian], pending), 0, 2)
        found = np.ascontiguousarray(np.moveaxis(found, 1, 0)).reshape(pending.size, count, STAGES, -1)
        spread(improve_cycles, pending.size, partial(_arguments, batch, pending, found))
        pending = pending[batch.ended[pending] != CLOSES]
        if not pending.size:
            break
    states, nodes, monodromy, ended = batch.states, batch.nodes, batch.monodromy, batch.ended
    rows = [system.names[name] for name in CycleSums._fields]
    weights = (machine.steps[:, :, None] * GAUSS.weights).reshape(variants, -1).T
    sums = CycleSums(*(sum_of_rows(weights * row) for row in machine.at(states, rows, np.arange(variants))))
    points = np.concatenate([nodes[:, :-1, None], states, nodes[:, 1:, None]], axis=2)
    elastic, motor_speed, energy = np.moveaxis(points, 3, 0)
    stiffness, damping = given[:, 0, None, None], given[:, 1, None, None]
    with np.errstate(all="ignore"):
        speed = np.sqrt(2.0 * energy / machine.inertia)
        moment = elastic + damping * (motor_speed - speed)
    verdict = np.where(ended == TURNS_BACK, Verdict.TURNS_BACK, Verdict.NOT_FINITE)
    sound = (ended == CLOSES) & np.isfinite(monodromy).all(axis=(1, 2)) & np.isfinite(moment).all(axis=(1, 2))
    multipliers = np.full((variants, STATE), np.nan)
    multipliers[sound] = -np.sort(-np.abs(np.linalg.eigvals(monodromy[sound])), axis=1)
    verdict = np.where(sound, Verdict.OK, verdict).astype(np.uint8)
    return ElasticCycle(moment, elastic / stiffness, motor_speed, speed, multipliers, sums, verdict)


def _arguments(batch: CyclesToClose, pending: np.ndarray, found: np.ndarray) -> tuple:
    """Arguments of `improve_cycles` for one thread, with its scratch."""
    return batch, pending, found, np.empty((found.shape[1], UNKNOWNS, COLUMNS)), np.empty((2, UNKNOWNS, UNKNOWNS))


def least_and_greatest(curve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Minimum and maximum of a curve through the points of its steps, (variants, steps, points)."""
    return -_top(-curve), _top(curve)


def _top(curve: np.ndarray) -> np.ndarray:
    variants, count, _ = curve.shape
    who, highest = np.arange(variants), curve.max(axis=2).argmax(axis=1)
    # The peak may lie in the step with the highest point or in either neighbour.
    near = (curve[who, (highest + beside) % count] @ _THROUGH.T for beside in (-1, 0, 1))
    return np.fmax.reduce([tops(values, np.zeros(variants)).values for values in near])


def drive_results(
    cycle: ElasticCycle, given: np.ndarray, frequency: np.ndarray, length: float, rigid_moment: np.ndarray
) -> np.ndarray:
    """Results of drives in the order of RESULTS, (results, variants).

    Parameters
    ----------
    cycle : ElasticCycle
    given : ndarray (variants, 3)
        As for `elastic_cycle`.
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    length : float
        Crank angle of a cycle [rad].
    rigid_moment : ndarray (variants,)
        Peak magnitude of the torque of a rigid shaft [N·m].
    """
    (least, greatest), (slow, fast) = least_and_greatest(cycle.moment), least_and_greatest(cycle.motor_speed)
    (slowest, fastest), (near, far) = least_and_greatest(cycle.machine_speed), least_and_greatest(cycle.twist)
    period, motors, loads, damped, impulse = cycle.sums
    with np.errstate(all="ignore"):
        return np.stack(
            [
                given[:, 0],
                given[:, 1],
                frequency,
                period,
                length / period,
                2.0 * (fast - slow) / (fast + slow),
                2.0 * (fastest - slowest) / (fastest + slowest),
                impulse / period,
                greatest,
                least,
                0.5 * (greatest - least),
                rigid_moment,
                np.fmax(np.abs(greatest), np.abs(least)) / rigid_moment,
                np.fmax(np.abs(near), np.abs(far)),
                0.5 * (far - near),
                motors / period,
                damped / period,
                (motors + loads - damped) / (np.abs(motors) + np.abs(loads) + damped),
                *cycle.multipliers.T,
                np.log(cycle.multipliers[:, 0]) / period,
            ]
        )


def rounding_scales(results: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Magnitudes to which the rounding of results is relative, by name.

    Torques round with the peak torque, the twist's range with its peak, the power of damping with that of the motors,
    all multipliers with the largest, and shares with 1.
    """
    scales = {name: np.abs(result) for name, result in results.items()}
    peak = np.fmax(scales["greatest_moment"], scales["least_moment"])
    scales |= dict.fromkeys(("greatest_moment", "least_moment", "mean_moment", "alternating_moment"), peak)
    scales |= dict.fromkeys(("second_multiplier", "third_multiplier"), scales["multiplier"])
    scales |= dict.fromkeys(("motor_fluctuation", "machine_fluctuation", "power_residual"), np.ones_like(peak))
    scales |= {"position_error": scales["greatest_twist"], "damping_power": scales["motor_power"]}
    return scales | {"growth_rate": scales["growth_rate"] + 1.0 / results["period"]}


def steps_needed(frequency: np.ndarray, speed: np.ndarray, length: float) -> np.ndarray:
    """Number of steps per cycle, (variants,): powers of 2 that resolve the shaft's vibration and the machine's curves.

    Parameters
    ----------
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    speed : ndarray (variants,)
        Of the crank [rad/s].
    length : float
        Crank angle of a cycle [rad].
    """
    with np.errstate(all="ignore"):
        needed = np.nan_to_num(2.0 * frequency / speed * length, nan=0.0, posinf=MOST_STEPS)
    most = np.clip(needed, LEAST_STEPS * length / math.tau, MOST_STEPS)
    return 2 ** np.ceil(np.log2(most)).astype(int)


# Maximum number of steps per cycle (vibrations of a stiffer shaft hardly matter), and minimum number per revolution.
MOST_STEPS, LEAST_STEPS = 8192, 128
