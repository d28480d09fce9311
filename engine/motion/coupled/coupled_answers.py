"""Results of runs at two speeds: the shaft's state between two regimes, and the quantities of each."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.compiling.running import of_all
from engine.motion.coupled.coupled_run import CoupledEnds, CoupledRuns, Precision
from engine.motion.coupled.two_sides import TOGETHER, CoupledSides, Joined, TwoSides, coupling_pull
from engine.motion.coupled.two_speeds import CRANK_SPEED, SHAFT_SPEED, SHAFT_TURNED, TURNED
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.runs.watching import Observer
from engine.words.verdicts import Verdict

# Relative tolerance of equal grid steps.
EVEN = 1e-9


class CoupledStanding(NamedTuple):
    """State of a coupling's shaft between two regimes.

    Attributes
    ----------
    speed : ndarray (variants,)
        Reduced to the crank, in the direction of motion [rad/s].
    engaged : ndarray (variants,)
        Time since the coupling was engaged [s].
    """

    speed: np.ndarray
    engaged: np.ndarray


class CoupledOutcome(NamedTuple):
    """Results of runs at two speeds; arrays (variants,) except where noted.

    Attributes
    ----------
    verdict : ndarray of uint8
    turned, omega, shaft_omega, time : ndarray
        Angle turned and speed of the crank, speed of the shaft, and time at the end.
    works : ndarray (sorts, variants)
        Of the motors, and of each channel [J].
    squares : ndarray
        Integral of the squared motor torque over time [N²·m²·s].
    energy, change : ndarray
        Approximate maximum kinetic energy, and its change [J].
    covered : ndarray (2, variants)
        Minimum and maximum angle turned by the crank [rad].
    values : dict of str to ndarray
        By their names in a regime, without the prefixes of the coupling and the shaft.
    """

    verdict: np.ndarray
    turned: np.ndarray
    omega: np.ndarray
    shaft_omega: np.ndarray
    time: np.ndarray
    works: np.ndarray
    squares: np.ndarray
    energy: np.ndarray
    change: np.ndarray
    covered: np.ndarray
    values: dict[str, np.ndarray]

    def over_all(self, ready: np.ndarray, count: int) -> "CoupledOutcome":
        """The outcome of the `ready` variants, spread over all `count` of them, NaN for the others."""
        verdict = np.full(count, Verdict.OK, np.uint8)
        verdict[ready] = self.verdict
        rows = (of_all(row, ready, count) for row in self[1:-1])
        return CoupledOutcome(verdict, *rows, {key: of_all(row, ready, count) for key, row in self.values.items()})


def run_coupled(
    sides: CoupledSides,
    speeds: tuple[np.ndarray, np.ndarray],
    clock: np.ndarray,
    engaged: np.ndarray,
    ends: CoupledEnds,
    precision: Precision,
    observers: Sequence[Observer] = (),
) -> CoupledOutcome:
    """Run to the end; parameters are those of `CoupledRuns`."""
    runs = CoupledRuns(sides, speeds, clock, engaged, ends, precision, observers)
    started, begun = _energy(sides, runs.state)
    runs.go_to_end()
    state, ratio = runs.state, sides.coupling.ratio
    ended, after = _energy(sides, state)
    heat, slipped, squares = (state[sides.two.system.names[name]] for name in ("heat", "slipped", "squares"))
    with np.errstate(all="ignore"):
        slip = np.where(state[SHAFT_TURNED] == 0.0, 0.0, slipped / np.abs(state[SHAFT_TURNED]))
        mean = state[SHAFT_TURNED] / runs.time
    forms = zip((sides.crank, sides.shaft.form), runs.lows, runs.highs, strict=True)
    # Motors are on only one of the two sides.
    peaks = [form.dynamics.greatest_moment(form.variants.numbers, low, high) for form, low, high in forms]
    values = {
        "speed_min": runs.lows[0],
        "speed_max": runs.highs[0],
        "motor_moment_peak": np.maximum(*peaks),
        "implicit_steps": runs.once_steep,
        "coupling_heat": heat,
        "coupling_slip_angle": ratio * slipped,
        "coupling_slip": slip,
        "coupling_moment_peak": runs.peak / ratio,
        "coupling_slip_time": runs.slip_time,
        "coupling_lock_up_time": runs.lock_time,
        "coupling_lock_up_speed": runs.lock_speed,
        "shaft_final_speed": ratio * state[SHAFT_SPEED],
        "shaft_mean_speed": ratio * mean,
    }
    most = np.maximum(np.maximum(started, ended), begun + after + np.abs(heat))
    return CoupledOutcome(
        runs.verdict,
        state[TURNED],
        state[CRANK_SPEED],
        state[SHAFT_SPEED],
        runs.time,
        state[sides.two.system.names["motors"] :],
        squares,
        most,
        ended - started,
        runs.covered,
        values,
    )


def _energy(sides: CoupledSides, state: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Kinetic energy of both sides together, and that of the shaft [J]."""
    shaft = 0.5 * sides.shaft.inertia * state[SHAFT_SPEED] ** 2
    return 0.5 * sides.crank.inertia(state[TURNED]) * state[CRANK_SPEED] ** 2 + shaft, shaft


def held_moment(
    two: TwoSides, dynamics: Dynamics, variants: Variants, places: np.ndarray, energy: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Peak torque that a locked clutch transmits in steady running, and its capacity [N·m].

    Parameters
    ----------
    two : TwoSides
    dynamics : Dynamics
        Of both sides together.
    variants : Variants
    places : ndarray (places, variants)
        Crank angles over a cycle [rad].
    energy : ndarray (places, variants)
        Kinetic energy there [J].
    """
    zero, forward = np.zeros(variants.count), np.ones(variants.count)
    sides, omega = two.of(variants, zero), np.sqrt(2.0 * energy / dynamics.inertia(variants, places))
    joined = Joined(np.full(variants.count, TOGETHER), forward, forward, zero, zero, forward)
    moving = np.array([variants.direction * places, omega, np.zeros_like(omega), omega])
    moment, coupling = coupling_pull(sides, joined, moving, np.zeros_like(omega)).moment, sides.coupling
    steps = np.diff(places, axis=0)
    even = np.isclose(steps[1:], steps[:-1], rtol=EVEN, atol=0.0)
    peak = _greatest_between(np.abs(moment), even)
    return peak / coupling.ratio, coupling.capacity[-1] / coupling.ratio


def _greatest_between(values: np.ndarray, even: np.ndarray) -> np.ndarray:
    """Maximum along the first axis, including the peaks of parabolas through three nodes.

    Parameters
    ----------
    values : ndarray (places, variants)
    even : ndarray (places - 2, variants) of bool
        Whether an inner node is equally far from both neighbours.
    """
    low, middle, high = values[:-2], values[1:-1], values[2:]
    bend = low - 2.0 * middle + high
    inside = (middle >= low) & (middle >= high) & (bend < 0.0) & even
    with np.errstate(all="ignore"):
        tops = np.where(inside, middle - (high - low) ** 2 / (8.0 * bend), middle)
    return np.maximum(tops.max(axis=0), np.maximum(values[0], values[-1]))
