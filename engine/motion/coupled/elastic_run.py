"""Run of a machine on an elastic shaft, over time: I₁φ̈₁ = M_m − T, I(φ₂)φ̈₂ + ½I′φ̇₂² = T + M, T = kq + bq̇.

It is a run at two speeds, those of the machine and of the motor end. Where the machine stops it continues, turns back,
or sticks until the shaft's torque overcomes the resistance in either direction. With backlash, contact opens and
closes.
"""

from collections.abc import Sequence

import numpy as np

from engine.motion.coupled.coupled_fields import CoupledMotion
from engine.motion.coupled.coupled_run import CoupledRuns
from engine.motion.coupled.two_sides import CoupledSides
from engine.motion.coupled.two_speeds import CRANK_SPEED, SHAFT_SPEED, SHAFT_TURNED, TURNED
from engine.motion.fields.recorded_motion import Observer
from engine.motion.runs.run_progress import CoupledStanding, Ends, Standing, Stepping
from engine.words.verdicts import Verdict

# Radians of the shaft's vibration per step, for the forecast of the number of steps; more than MOST_STEPS are refused.
FINEST, MOST_STEPS = 0.3, 200_000
# Fractions of a step at which its history is stored.
SAMPLED = np.linspace(0.0, 1.0, 17)[:, None]
# State of a run: twist, speed at the motor end, angle turned by the machine, its speed.
STATE = [SHAFT_TURNED, SHAFT_SPEED, TURNED, CRANK_SPEED]


def steps_on_shaft(frequency: np.ndarray, duration: np.ndarray) -> np.ndarray:
    """Approximate number of steps of a run for the shaft's vibration, (variants,); 0 if the run is refused.

    Parameters
    ----------
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    duration : ndarray (variants,)
        [s].
    """
    steps = np.ceil(duration * frequency / FINEST)
    return np.where(steps > MOST_STEPS, 0.0, steps)


def run_on_shaft(
    sides: CoupledSides,
    frequency: np.ndarray,
    begin: np.ndarray,
    duration: np.ndarray,
    stepping: Stepping,
    observers: Sequence[Observer],
) -> CoupledRuns:
    """Run machines on their shafts; the runs at their end.

    Parameters
    ----------
    sides : CoupledSides
        The machines, and the motors at the other end.
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    begin : ndarray (4, variants)
        Initial state, the twist without backlash; a shaft initially at rest has to close all of it.
    duration : ndarray (variants,)
        [s].
    stepping : Stepping
    observers : sequence of Observer
        Each receives the `CoupledMotion` of every walk.
    """
    twist, motor, turned, machine = begin
    backlash, zero = sides.coupling.backlash, np.zeros_like(duration)
    standing = Standing(sides.crank.start, machine, zero, zero.astype(np.uint8), CoupledStanding(motor, zero))
    runs = CoupledRuns(sides, standing, Ends.never(zero.size, time=duration), stepping, observers)
    at_rest = (twist == 0.0) & (motor == 0.0) & (machine == 0.0)
    side = np.where(twist < 0.0, -1.0, 1.0)
    # Steady running ignores backlash: where the damper pulls, the sides part.
    pressed = side * sides.coupling.moment(np.ones_like(twist), twist, motor - machine) > 0.0
    runs.joined.touch[:] = np.where(backlash > 0.0, side * (pressed & ~at_rest), 1.0)
    behind = at_rest | (side < 0.0)
    runs.state[TURNED], runs.state[SHAFT_TURNED] = turned, twist - np.where(behind, backlash, 0.0)
    # Refused variants take no steps.
    hopeless = steps_on_shaft(frequency, duration) == 0.0
    runs.give_up(np.flatnonzero(hopeless), Verdict.SHAFT_RIGID)
    runs.done |= duration <= 0.0
    runs.go_to_end()
    return runs


class ElasticHistory:
    """Stores the first variant: time, state and torque of the shaft, (6, instants)."""

    def __init__(self) -> None:
        self._seen: list[np.ndarray] = []

    def see(self, motion: CoupledMotion) -> None:
        """Store a part of the motion."""
        steps = np.flatnonzero(motion.who == 0)
        states = motion.at(steps, np.broadcast_to(SAMPLED, (SAMPLED.size, steps.size)))
        rows = np.array([states.time, *states.moving[STATE], states.moment])
        self._seen.append(rows.transpose(0, 2, 1).reshape(len(rows), -1))

    @property
    def rows(self) -> np.ndarray:
        """The stored rows, (6, instants)."""
        return np.concatenate(self._seen, axis=1)
