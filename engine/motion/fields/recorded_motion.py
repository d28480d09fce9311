"""Recorded motion: the steps of runs, and the states of machines at any instant within them.

A step is smooth: torques jump only at its ends, where they are evaluated inside the step.
"""

from typing import NamedTuple, Protocol

import numpy as np

from engine.motion.moments.breaks import GAP
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.stepping.recorded import weighted, weights_at
from engine.stepping.system import RECORDED_AT

TIME, TURNED, DRIVE = range(3)


class Snapshots(NamedTuple):
    """States of machines at instants, (instants, columns) unless stated.

    Attributes
    ----------
    who : ndarray (columns,) of int
        Variants.
    time, turned : ndarray
        From the start of the run [s], [rad].
    facing : ndarray (columns,)
        +1 or −1: direction of motion.
    omega : ndarray
        In the scene's direction of motion, negative backwards [rad/s].
    moment : ndarray
        Total torque if known more accurately than from the speed, else NaN [N·m].
    """

    who: np.ndarray
    time: np.ndarray
    turned: np.ndarray
    facing: np.ndarray
    omega: np.ndarray
    moment: np.ndarray


class RecordedMotion(Protocol):
    """Recorded steps of runs, those of a variant in order of time.

    Attributes
    ----------
    who : ndarray (steps,) of int
        Variants, ascending.
    samples : ndarray (states, RECORDED_AT, steps)
        Time and angle turned from the start of the run [s], [rad], and other states at the fractions RECORDED_AT.
    over_angle : bool
        Whether the angle turned is linear in the fraction, not the time.
    """

    who: np.ndarray
    samples: np.ndarray
    over_angle: bool

    def at(self, step: np.ndarray, share: np.ndarray) -> Snapshots:
        """States at fractions (instants, columns) of the length of steps (columns,)."""

    def durations(self, step: np.ndarray, states: Snapshots) -> np.ndarray:
        """Time per fraction of the steps [s], as the states."""


class Observer(Protocol):
    """An observer of runs; it does not affect their steps."""

    def see(self, motion: RecordedMotion) -> None:
        """Evaluate a part of the motion."""


class OneSpeedMotion:
    """Recorded steps of runs at one speed.

    Parameters
    ----------
    equation : EquationOfMotion
        Equation for all variants of the runs.
    who : ndarray (steps,) of int
        Variants, ascending.
    facing : ndarray (steps,)
        +1 or −1: direction of motion.
    samples : ndarray (3, RECORDED_AT, steps)
        Time [s] and angle turned [rad] from the start of the run; the magnitude of the speed [rad/s] or, of steps over
        the angle, the kinetic energy [J].
    lengths : ndarray (steps,), optional
        Lengths of steps over the angle [rad].
    steep : bool
        Whether the torque follows from the slope of the energy, since that from the speed is less accurate.
    """

    def __init__(
        self,
        equation: EquationOfMotion,
        who: np.ndarray,
        facing: np.ndarray,
        samples: np.ndarray,
        lengths: np.ndarray | None = None,
        steep: np.ndarray | bool = False,
    ) -> None:
        self.who, self.samples, self._equation = who, samples, equation
        self.over_angle = lengths is not None
        self._facing, self._lengths, self._steep = facing, lengths, np.broadcast_to(steep, who.shape)

    def at(self, step: np.ndarray, share: np.ndarray) -> Snapshots:
        """States at fractions (instants, columns) of the length of steps (columns,)."""
        samples, who, facing = self.samples[..., step], self.who[step], self._facing[step]
        time, turned, drive = weighted(weights_at(share), samples)
        turn_inwards(turned, facing * inward(share, samples[TURNED]), self._equation.of(who))
        moment = np.full_like(turned, np.nan)
        if not self.over_angle:
            return Snapshots(who, time, turned, facing, facing * drive, moment)
        steep = np.flatnonzero(self._steep[step])
        if steep.size:
            slopes = weighted(weights_at(share[:, steep], slope=True), samples[DRIVE:, :, steep])[0]
            moment[:, steep] = slopes / self._lengths[step[steep]]
        with np.errstate(invalid="ignore"):
            omega = np.sqrt(2.0 * drive / self._equation.of(who).inertia(turned))
        return Snapshots(who, time, turned, facing, omega, moment)

    def durations(self, step: np.ndarray, states: Snapshots) -> np.ndarray:
        """Time per fraction of the steps [s], as the states."""
        if not self.over_angle:
            lengths = self.samples[TIME, -1] - self.samples[TIME, 0]
            return np.broadcast_to(lengths[step], states.time.shape)
        return self._lengths[step] / states.omega


def inward(share: np.ndarray, turned: np.ndarray) -> np.ndarray:
    """Direction into a step from fractions (instants, columns) of its length: +1 at its start, −1 at its end, else 0.

    Parameters
    ----------
    share : ndarray (instants, columns)
    turned : ndarray (RECORDED_AT, columns)
        Angle turned [rad].
    """
    long = np.abs(turned[-1] - turned[0]) > GAP
    return np.where(long, (share == 0.0) * 1.0 - (share == 1.0), 0.0)


def turn_inwards(turned: np.ndarray, inwards: np.ndarray, equation: EquationOfMotion) -> None:
    """Move the ends of steps at jumps into the steps, in place.

    Parameters
    ----------
    turned : ndarray (instants, columns)
        Angles turned [rad].
    inwards : ndarray (instants, columns)
        +1 or −1 at ends, else 0.
    equation : EquationOfMotion
        Equation for the columns.
    """
    ends = np.flatnonzero(inwards.any(axis=1))
    if ends.size:
        turned[ends] += inwards[ends] * equation.break_offset(turned[ends])


def at_instant(equation: EquationOfMotion, time: np.ndarray, turned: np.ndarray, omega: np.ndarray) -> OneSpeedMotion:
    """States of all variants at one instant, as a step without length; (variants,) each."""
    every, facing = np.arange(time.size), np.where(omega < 0.0, -1.0, 1.0)
    samples = np.repeat(np.array([time, turned, np.abs(omega)])[:, None], RECORDED_AT.size, axis=1)
    return OneSpeedMotion(equation, every, facing, samples)
