"""Runs in closed form, for machines whose reduced inertia is constant: every link turns in a fixed ratio to the crank.

Variants for which a formula ends, because the machine stops or turns round on its way, or never comes to the end of
the run, go step by step.
"""

import numpy as np

from engine.laws.tables import make_table
from engine.motion.cases import MomentLaw
from engine.motion.closed_forms.closed_laws import Motion, MotionEquation, speed_motion
from engine.motion.closed_forms.closed_time import Push, strongest, timed_motion
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.tabulation import Sums
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_progress import DOUBTFUL, Ends, Progress, RunOutcome, Stepping
from engine.motion.steppers.rubbing_form import form_in_time
from engine.motion.steppers.time_form import State, state_at
from engine.verdicts import Verdict


def run_in_closed_form(
    law: MomentLaw,
    dynamics: Dynamics,
    variants: Variants,
    start: np.ndarray,
    omega: np.ndarray,
    clock: np.ndarray,
    ends: Ends,
    steps: int,
    half: bool,
    doubt: float,
    stepping: Stepping,
) -> RunOutcome:
    """Run in closed form, and step by step where that doesn't go.

    Parameters
    ----------
    law : MomentLaw
        Of all variants.
    dynamics, variants, start, omega, clock, ends, steps, half
        As of `Progress`.
    doubt : float
        Every moment is increased by this share of its magnitude: what changes shows how sure an answer is.
    stepping : Stepping
        Of what goes step by step.
    """
    # What isn't reached gives NaN on its way, not a warning.
    with np.errstate(all="ignore"):
        balance, push = _equation(dynamics, variants, start, doubt)
        if push is None:
            motion = speed_motion(law, balance, omega, ends)
        else:
            motion = timed_motion(balance, push, omega, clock, ends.time)
    numbers = (motion.time, motion.angle, motion.omega, motion.squares, *motion.works)
    found = np.isfinite(numbers).all(axis=0) & (motion.slowest >= 0.0)
    found &= (motion.time > 0.0) & (motion.angle <= ends.most_turned)
    if ends.rest:
        # What doesn't stay where it stops turns back.
        form = form_in_time(dynamics, variants, start)
        stopped = state_at(motion.angle, np.zeros_like(omega), clock + motion.time, len(dynamics.channels))
        found &= form.at_rest(stopped) == 0.0
    outcome = _outcome(balance, omega, motion)
    left = np.flatnonzero(~found)
    if left.size:
        begin = start[left], omega[left], clock[left]
        runs = Progress(dynamics, variants.some(left), *begin, ends.some(left), steps, half, stepping=stepping)
        outcome = outcome.with_others(left, run_to_end(runs))
    return outcome


def _equation(
    dynamics: Dynamics, variants: Variants, start: np.ndarray, doubt: float
) -> tuple[MotionEquation, Push | None]:
    """Coefficients of the equation of motion, the moment over time apart."""

    def raised(moment: np.ndarray) -> np.ndarray:
        return moment + doubt * np.abs(moment)

    reduction, push, table = dynamics.reduction, None, None
    timed = next((key for i, _, _ in dynamics.polynomial if reduction.depends_on_time(key := reduction.keys[i])), None)
    instant, value = 0.0, 1.0
    if timed is not None:
        scene = reduction.mechanics.scene
        action = (scene.forces | scene.moments)[timed.action]
        table = make_table(action.abscissae, action.ordinates, action.interpolation, outside=action.outside)
        instant, value = strongest(table)
    rows = len(reduction.keys) + 2
    alone = Sums(np.arange(rows), rows, np.zeros(rows, bool), variants.direction)
    out = reduction.curves(variants, start[None], np.full((1, variants.count), instant), alone)[:, 0]
    loads = np.zeros((len(dynamics.channels), 3, variants.count))
    for i, channel, order in dynamics.polynomial:
        moment = raised(out[i + 2] * variants.direction)
        if reduction.keys[i] == timed:
            push = Push(table, moment / value, channel)
        else:
            loads[channel, order] += moment
    kloss = variants.drive.kloss.copy()
    kloss[:, 0] = raised(kloss[:, 0])
    return MotionEquation(out[0] + variants.flywheel, raised(variants.drive.line), kloss, loads), push


def _outcome(balance: MotionEquation, omega: np.ndarray, motion: Motion) -> RunOutcome:
    count = omega.size
    return RunOutcome(
        np.full(count, Verdict.OK, np.uint8),
        State(motion.angle.copy(), motion.omega.copy(), motion.time.copy(), motion.works, motion.squares),
        motion.slowest,
        motion.fastest,
        motion.peak,
        0.5 * balance.inertia * omega**2,
        0.5 * balance.inertia * motion.omega**2,
        np.zeros(count, int),
        np.full((DOUBTFUL + motion.works.shape[0], count), np.nan),
    )
