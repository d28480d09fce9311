"""Steady running of a machine on an elastic shaft: its periodic cycle, and the results."""

import math
from typing import NamedTuple

import numpy as np

from engine.cycle.panels.chebyshev import PLACES
from engine.cycle.panels.sampled import tops
from engine.elements.elastic_drives.elastic_cycle import (
    CLOSES,
    GAUSS,
    STATE,
    TURNS_BACK,
    UNKNOWNS,
    CycleMotion,
    DrivenMachine,
    close_cycles,
)
from engine.words.verdicts import Verdict

# Values at the positions of a panel of the polynomial through a step's points: its ends and the Gauss points.
_POWERS = np.arange(GAUSS.stages + 2)
_THROUGH = (0.5 * (PLACES + 1.0))[:, None] ** _POWERS @ np.linalg.inv(
    np.array([0.0, *GAUSS.nodes, 1.0])[:, None] ** _POWERS
)


class CycleSums(NamedTuple):
    """Integrals over cycles, (variants,).

    Attributes
    ----------
    period : ndarray
        [s].
    motor_work, load_work, damping_work : ndarray
        [J].
    impulse : ndarray
        Integral of the shaft torque over time [N·m·s].
    """

    period: np.ndarray
    motor_work: np.ndarray
    load_work: np.ndarray
    damping_work: np.ndarray
    impulse: np.ndarray


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
    variants, count = machine.steps.shape
    machine = DrivenMachine(*map(np.ascontiguousarray, machine[:-1]), machine.bent)
    empty = map(
        np.empty, ((variants, count, UNKNOWNS), (variants, count + 1, STATE), (variants, STATE, STATE), variants)
    )
    motion = CycleMotion(guess.copy(), *empty)
    close_cycles(variants, np.ascontiguousarray(given), machine, motion)
    nodes, monodromy = motion.nodes, motion.monodromy
    points = np.concatenate([nodes[:, :-1, None], motion.states, nodes[:, 1:, None]], axis=2)
    elastic, motor_speed, energy = np.moveaxis(points, 3, 0)
    inertia = machine.node_inertia
    inertia = np.concatenate([inertia[:, :-1, None], machine.places[..., 0], inertia[:, 1:, None]], axis=2)
    stiffness, damping, first = given.T[..., None, None]
    with np.errstate(all="ignore"):
        speed = np.sqrt(2.0 * energy / inertia)
        slip = motor_speed - speed
        moment = elastic + damping * slip
        # The equations of motion give the torques of motors and loads, at the Gauss points.
        w, w1, torque = (row[..., 1:-1] for row in (speed, motor_speed, moment))
        _, rise, gain = np.moveaxis(motion.slopes.reshape(motion.states.shape), 3, 0)
        time = machine.steps[..., None] * GAUSS.weights / w
        powers = (first * w * rise + torque) * w1, (gain - torque) * w, damping * slip[..., 1:-1] ** 2
        sums = CycleSums(*((time * row).sum(axis=(1, 2)) for row in (1.0, *powers, torque)))
    verdict = np.where(motion.ended == TURNS_BACK, Verdict.TURNS_BACK, Verdict.NOT_FINITE)
    sound = (motion.ended == CLOSES) & np.isfinite(monodromy).all(axis=(1, 2)) & np.isfinite(moment).all(axis=(1, 2))
    multipliers = np.full((variants, STATE), np.nan)
    multipliers[sound] = -np.sort(-np.abs(np.linalg.eigvals(monodromy[sound])), axis=1)
    verdict = np.where(sound, Verdict.OK, verdict).astype(np.uint8)
    return ElasticCycle(moment, elastic / stiffness, motor_speed, speed, multipliers, sums, verdict)


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
