"""A run of a machine on an elastic shaft, over time: I₁φ̈₁ = M_m − T, I(φ₂)φ̈₂ + ½I′φ̇₂² = T + M, T = kq + bq̇.

It is a run at two speeds, of the machine and of the motors' end. Where the machine comes to a stop it goes on, turns
back, or sticks until the shaft's moment overcomes what resists, whichever way; with a backlash, touch is lost and made.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.motion.coupled.coupled_fields import CoupledPiece
from engine.motion.coupled.coupled_run import FINE, CoupledEnds, CoupledRuns, Precision
from engine.motion.coupled.two_sides import CoupledSides
from engine.motion.coupled.two_speeds import CRANK_SPEED, SHAFT_SPEED, SHAFT_TURNED, TURNED
from engine.motion.runs.watching import Observer
from engine.words.verdicts import Verdict

# A run is forecast by steps of so many radians of the shaft's vibration, and refused where it needs too many.
FINEST, MOST_STEPS = 0.3, 200_000
# State of a run: twist, speed at the motors' end, angle turned by the machine, its speed.
STATE = [SHAFT_TURNED, SHAFT_SPEED, TURNED, CRANK_SPEED]


class ElasticRun(NamedTuple):
    """What machines did, (variants,): greatest magnitude of the shaft's moment and when, state at the end, stops.

    Attributes
    ----------
    greatest, greatest_at : ndarray
        [N·m], [s].
    state : ndarray (4, variants)
        Twist [rad], speed at the motors' end [rad/s], angle turned [rad], speed of the machine [rad/s].
    stops, closings : ndarray
        How often the machine came to a stop on the way, and how often the backlash closed.
    verdict : ndarray of uint8
    """

    greatest: np.ndarray
    greatest_at: np.ndarray
    state: np.ndarray
    stops: np.ndarray
    closings: np.ndarray
    verdict: np.ndarray


def steps_on_shaft(frequency: np.ndarray, duration: np.ndarray) -> np.ndarray:
    """About how many steps a run takes by the shaft's vibration, (variants,); 0 where it isn't followed.

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
    precision: Precision = FINE,
    observers: Sequence[Observer] = (),
) -> ElasticRun:
    """Follow machines on their shafts.

    Parameters
    ----------
    sides : CoupledSides
        The machines, and the motors at the other end.
    frequency : ndarray (variants,)
        Natural frequency [rad/s].
    begin : ndarray (4, variants)
        State at the begin, the twist without backlash; a shaft that begins at rest has to close all of it.
    duration : ndarray (variants,)
        [s].
    precision : Precision
    observers : sequence of Observer
        They see a `CoupledPiece` of each walk.
    """
    twist, motor, turned, machine = begin
    backlash, never, zero = sides.coupling.backlash, np.full_like(duration, np.inf), np.zeros_like(duration)
    ends = CoupledEnds(never, duration, never, False, False, never)
    runs = CoupledRuns(sides, (machine, motor), zero, zero, ends, precision, observers)
    at_rest = (twist == 0.0) & (motor == 0.0) & (machine == 0.0)
    touch = np.where(backlash > 0.0, np.where(at_rest, 0.0, np.where(twist < 0.0, -1.0, 1.0)), 1.0)
    runs.joined.touch[:] = touch
    runs.state[TURNED], runs.state[SHAFT_TURNED] = turned, twist - np.where(touch < 1.0, backlash, 0.0)
    # No steps are lost on what so many can't follow.
    hopeless = steps_on_shaft(frequency, duration) == 0.0
    runs.done |= hopeless | (duration <= 0.0)
    runs.go_to_end()
    verdict = np.where(hopeless, Verdict.SHAFT_RIGID, runs.verdict).astype(np.uint8)
    return ElasticRun(runs.peak, runs.peak_at, runs.state[STATE], runs.stops, runs.closings, verdict)


class ElasticHistory:
    """Keeps what it sees of the first variant: time, state and moment of the shaft, (6, instants)."""

    def __init__(self) -> None:
        self._seen: list[np.ndarray] = []

    def see(self, who: np.ndarray, piece: CoupledPiece) -> None:
        """Keep a piece."""
        if who[0] == 0:
            self._seen.append(np.array([piece.time, *piece.moving[STATE], piece.moment])[:, :, 0])

    @property
    def rows(self) -> np.ndarray:
        """All of it."""
        return np.concatenate(self._seen, axis=1)
