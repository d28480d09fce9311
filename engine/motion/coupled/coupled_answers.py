"""Results of runs at two speeds: the shaft's state between two regimes, and the quantities of each."""

from collections.abc import Sequence

import numpy as np

from engine.motion.coupled.coupled_run import CoupledRuns
from engine.motion.coupled.two_sides import CoupledSides
from engine.motion.coupled.two_speeds import SHAFT_SPEED, SHAFT_TURNED
from engine.motion.fields.recorded_motion import Observer
from engine.motion.runs.run_progress import CoupledStanding, Ends, RunOutcome, Standing, State, Stepping


def run_coupled(
    sides: CoupledSides, standing: Standing, ends: Ends, stepping: Stepping, observers: Sequence[Observer]
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
    forms = zip((sides.crank, sides.shaft.form), runs.lows, runs.highs, strict=True)
    # Motors are on only one of the two sides.
    peaks = [form.dynamics.greatest_moment(form.variants.numbers, low, high) for form, low, high in forms]
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
    engaged = np.zeros_like(clock) if sides.two.open else standing.coupled.engaged + runs.time
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
