"""Results of runs at two speeds: the shaft's state between two regimes, and the quantities of each."""

from collections.abc import Sequence

import numpy as np

from engine.motion.coupled.coupled_run import CoupledRuns
from engine.motion.coupled.two_sides import CoupledSides, TwoSides, coupling_numbers
from engine.motion.coupled.two_speeds import SHAFT_SPEED, SHAFT_TURNED
from engine.motion.moments.at_speed import greatest_moment
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.runs.run_progress import CoupledStanding, Ends, RunOutcome, Standing, State, Stepping
from engine.motion.runs.watching import Observer

# Relative tolerance of equal grid steps.
EVEN = 1e-9


def run_coupled(
    sides: CoupledSides, standing: Standing, ends: Ends, stepping: Stepping, observers: Sequence[Observer] = ()
) -> RunOutcome:
    """Run to the end; parameters are those of `CoupledRuns`."""
    runs, clock = CoupledRuns(sides, standing, ends, stepping, observers), standing.clock
    begun, started = runs.energies()
    runs.go_to_end()
    state, ratio, names = runs.state, sides.coupling.ratio, sides.two.system.names
    after, ended = runs.energies()
    heat, slipped, squares = (state[names[name]] for name in ("heat", "slipped", "squares"))
    with np.errstate(all="ignore"):
        slip = np.where(state[SHAFT_TURNED] == 0.0, 0.0, slipped / np.abs(state[SHAFT_TURNED]))
        mean = state[SHAFT_TURNED] / runs.time
    drives = (form.variants.drive for form in (sides.crank, sides.shaft.form))
    # Motors are on only one of the two sides.
    peaks = [greatest_moment(d, low, high) for d, low, high in zip(drives, runs.lows, runs.highs, strict=True)]
    values = {
        "motor_moment_peak": np.maximum(*peaks),
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
    final = State(runs.turned, runs.omega, runs.time, state[names["motors"] :], squares)
    most = np.maximum(np.maximum(started, ended), begun + after + np.abs(heat))
    # The engagement of an open coupling begins with the next regime.
    engaged = np.zeros_like(clock) if sides.open else standing.coupled.engaged + runs.time
    return RunOutcome(
        runs.verdict,
        final,
        runs.lows[0],
        runs.highs[0],
        started,
        ended,
        most,
        runs.covered,
        runs.steep,
        np.zeros(sides.count),
        coupled=CoupledStanding(runs.shaft_omega, engaged),
        values=values,
    )


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
    zero, forward, way = np.zeros(variants.count), np.ones(variants.count), variants.direction
    coupling, shaft = coupling_numbers(two.scene, variants.numbers, variants.count), two.of(variants, zero).shaft
    omega = np.sqrt(2.0 * energy / dynamics.rows(variants, places).inertia)
    whole = EquationOfMotion(dynamics, variants, zero)
    rows, moments = whole.along(way * places, omega, np.zeros_like(omega), forward)
    change = (moments.total - 0.5 * omega**2 * rows.inertia_phi) / rows.inertia
    own = shaft.moments(omega, forward).total
    steps = np.diff(places, axis=0)
    even = np.isclose(steps[1:], steps[:-1], rtol=EVEN, atol=0.0)
    peak = _greatest_between(np.abs(own - shaft.inertia * change), even)
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
