"""Results of the steady running of a machine on an elastic shaft."""

import math

import numpy as np

from engine.cycle.panels.sampled import weighted_sums
from engine.elements.elastic_drives.elastic_cycle import GAUSS, ElasticCycle
from engine.stepping.recorded import tops_in_steps
from engine.stepping.system import RECORDED_AT

# Values at the fractions RECORDED_AT of a step of the polynomial through its points: its ends and the Gauss points.
_POWERS = np.arange(GAUSS.stages + 2)
_THROUGH = RECORDED_AT[:, None] ** _POWERS @ np.linalg.inv(np.array([0.0, *GAUSS.nodes, 1.0])[:, None] ** _POWERS)


# Rounding of a twist, relative to that of a result of 1 [rad]: of 384 drives at most 2.5e-17 rad was seen.
TWISTED = 5e-4


def least_and_greatest(curve: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Minimum and maximum of a curve through the points of its steps, (variants, steps, points)."""
    variants, count, points = curve.shape
    samples = weighted_sums(_THROUGH, curve.reshape(-1, points))
    found = tops_in_steps(np.repeat(np.arange(variants), count), np.array([-samples, samples]), variants)
    return -found.value[0], found.value[1]


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


def rounding_scales(results: dict[str, np.ndarray], stiffness: np.ndarray) -> dict[str, np.ndarray]:
    """Magnitudes to which the rounding of results is relative, by name.

    Torques round with the peak torque, and with that of a twist as large as the rounding of an angle; the twist's range
    likewise; the power of damping with that of the motors, all multipliers with the largest, and shares with 1.
    """
    scales = {name: np.abs(result) for name, result in results.items()}
    peak = np.fmax(scales["greatest_moment"], scales["least_moment"]) + TWISTED * stiffness
    scales |= dict.fromkeys(("greatest_moment", "least_moment", "mean_moment", "alternating_moment"), peak)
    scales |= dict.fromkeys(("second_multiplier", "third_multiplier"), scales["multiplier"])
    scales |= dict.fromkeys(("motor_fluctuation", "machine_fluctuation", "power_residual"), np.ones_like(peak))
    scales |= {"position_error": scales["greatest_twist"] + TWISTED, "damping_power": scales["motor_power"]}
    return scales | {"growth_rate": scales["growth_rate"] + 1.0 / results["period"]}


def steps_needed(frequency: np.ndarray, speed: np.ndarray, length: float) -> np.ndarray:
    """Number of steps per cycle, (variants,): powers of 2 that resolve the shaft's vibration and the machine's curves.

    Parameters
    ----------
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    speed : ndarray (variants,)
        Crank speed [rad/s].
    length : float
        Crank angle of a cycle [rad].
    """
    with np.errstate(all="ignore"):
        needed = np.nan_to_num(2.0 * frequency / speed * length, nan=0.0, posinf=MOST_STEPS)
    most = np.clip(needed, LEAST_STEPS * length / math.tau, MOST_STEPS)
    return 2 ** np.ceil(np.log2(most)).astype(int)


# Maximum number of steps per cycle (vibrations of a stiffer shaft hardly matter), and minimum number per revolution.
MOST_STEPS, LEAST_STEPS = 8192, 128
