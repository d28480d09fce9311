"""A step of order eight in time of both sides of a coupling, for many variants, each in a state of its own.

Slipping, the coupling's moment T acts between the sides, I ε₁ + ½ω₁² dI/dφ = M₁ + T and J ε₂ = M₂ − T; held together
they move as one, and T follows. Every stage evaluates the machine at the angles it comes to.
"""

from typing import NamedTuple

import numpy as np

from engine.motion.coupled.two_sides import CoupledSides
from engine.motion.steppers.dormand_prince import ORDER_EIGHT
from engine.motion.steppers.tableaux import DENSE_PARTS, part_at

# How the sides are joined: held together, slipping forwards (the shaft is faster) or backwards, free of each other, or
# by a fluid.
TOGETHER, FORWARDS, BACKWARDS, APART, FLUID = 0, 1, -1, 2, 3
# Rows of a state: angle and speed of the crank, of the shaft, all reduced to the crank and in the direction of motion;
# what follows is gathered: heat of the coupling, angle slipped, motors' moment squared over time, works of the motors
# and of each channel.
CRANK, CRANK_SPEED, SHAFT, SHAFT_SPEED, HEAT, SLIPPED, SQUARES, WORKS = range(8)
MOVING = 4


class Joined(NamedTuple):
    """How both sides of every variant are in a phase of the motion; arrays (variants,).

    Attributes
    ----------
    mode : ndarray of int
        TOGETHER, FORWARDS, …
    crank_way, shaft_way : ndarray
        +1 or −1, the way each side moves, 0 where it stands.
    clock : ndarray
        Time of moments over time, at the begin of the run [s].
    engaged : ndarray
        For how long the coupling has been engaged, at the begin of the run [s].
    """

    mode: np.ndarray
    crank_way: np.ndarray
    shaft_way: np.ndarray
    clock: np.ndarray
    engaged: np.ndarray

    def some(self, who: np.ndarray) -> "Joined":
        """Of some of the variants, by index."""
        return Joined(*(row[who] for row in self))


class Pull(NamedTuple):
    """What moves both sides at an instant, each (variants,).

    Attributes
    ----------
    moment : ndarray
        Of the coupling on the crank [N·m]; of sides held together what it takes.
    crank, shaft : ndarray
        Accelerations [rad/s²].
    motors : ndarray
        Moment of the motors [N·m].
    powers : ndarray (sorts, variants)
        Of the motors and of each channel [W].
    rate : ndarray
        How fast moments pull speeds together, about [1/s].
    """

    moment: np.ndarray
    crank: np.ndarray
    shaft: np.ndarray
    motors: np.ndarray
    powers: np.ndarray
    rate: np.ndarray


def coupling_pull(sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray) -> Pull:
    """What moves both sides.

    Parameters
    ----------
    sides : CoupledSides
    joined : Joined
    moving : ndarray (4, variants)
        Angle and speed of the crank, and of the shaft.
    time : ndarray (variants,)
        Since the begin of the run [s].
    """
    turned, w1, _, w2 = moving
    forth = np.where(joined.crank_way < 0.0, -1.0, 1.0), np.where(joined.shaft_way < 0.0, -1.0, 1.0)
    rows, of_crank = sides.crank.at(turned, w1, joined.clock + time, forth[0])
    of_shaft = sides.shaft.moments(w2, forth[1])
    inertia, own = rows.inertia[0], sides.shaft.inertia
    crank = of_crank.total[0] - 0.5 * w1 * w1 * rows.inertia_phi[0]
    shaft = of_shaft.total[0]
    together = (crank + shaft) / (inertia + own)
    holds = joined.mode == TOGETHER
    if sides.is_fluid:
        moment = sides.coupling.fluid_moment(w1, w2)
    elif sides.open:
        moment = np.zeros_like(w1)
    else:
        capacity = sides.coupling.capacity_at(joined.engaged + time)
        moment = np.where(holds, shaft - own * together, joined.mode * capacity)
    first = np.where(holds, together, (crank + moment) / inertia) * (joined.crank_way != 0.0)
    second = np.where(holds, together, (shaft - moment) / own) * (joined.shaft_way != 0.0)
    motors = of_crank.motors[0] + of_shaft.motors[0]
    powers = [np.concatenate((m.motors, m.loads[:, 0])) * w for m, w in ((of_crank, w1), (of_shaft, w2))]
    rate = np.abs(of_crank.slope[0] - w1 * rows.inertia_phi[0]) / inertia + np.abs(of_shaft.slope[0]) / own
    return Pull(moment, first, second, motors, powers[0] + powers[1], rate)


def _rates(sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rates of all rows of a state, and the moment of the coupling."""
    found, slip = coupling_pull(sides, joined, moving, time), moving[SHAFT_SPEED] - moving[CRANK_SPEED]
    slip = np.where(joined.mode == TOGETHER, 0.0, slip)
    rows = (moving[CRANK_SPEED], found.crank, moving[SHAFT_SPEED], found.shaft)
    return np.stack((*rows, found.moment * slip, np.abs(slip), found.motors**2, *found.powers)), found.moment


class CoupledStep(NamedTuple):
    """A step made.

    Attributes
    ----------
    begin, end : ndarray (rows, variants)
        States.
    length : ndarray (variants,)
        [s].
    missed : ndarray (variants,)
        Estimated error, by what is allowed.
    parts : ndarray (parts, 4, variants)
        Of the polynomial that angles and speeds follow.
    moments : ndarray (2, variants)
        Of the coupling, at the begin and at the end [N·m].
    """

    begin: np.ndarray
    end: np.ndarray
    length: np.ndarray
    missed: np.ndarray
    parts: np.ndarray
    moments: np.ndarray

    def some(self, who: np.ndarray) -> "CoupledStep":
        """Of some of the variants, by index."""
        return CoupledStep(*(rows[..., who] for rows in self))

    def at(self, share: np.ndarray) -> np.ndarray:
        """Angles and speeds, (4, variants), at a share of the step of each variant."""
        return self.begin[:MOVING] + sum(self.parts[i] * part_at(i, share) for i in range(DENSE_PARTS))


def coupled_step(
    sides: CoupledSides,
    joined: Joined,
    state: np.ndarray,
    time: np.ndarray,
    length: np.ndarray,
    goal: np.ndarray,
    tolerance: float,
) -> CoupledStep:
    """Make a step.

    Parameters
    ----------
    sides : CoupledSides
    joined : Joined
    state : ndarray (rows, variants)
    time, length : ndarray (variants,)
        Since the begin of the run, and of the step [s].
    goal : ndarray (variants,)
        Angle turned by the crank that no stage goes beyond: moments jump there [rad].
    tolerance : float
        What may be missed, as a share of the angles turned and of the speeds or their changes.
    """
    method = ORDER_EIGHT
    slopes, moments = np.empty((method.dense_stages, *state.shape)), np.empty((method.dense_stages, time.size))
    ahead = np.where(joined.crank_way < 0.0, -1.0, 1.0)

    def stage(s: int, moving: np.ndarray) -> None:
        moving[CRANK] = ahead * np.fmin(ahead * moving[CRANK], ahead * goal)
        slopes[s], moments[s] = _rates(sides, joined, moving, time + method.shares[method.place_of[s]] * length)

    for s in range(method.dense_stages):
        stage(s, state[:MOVING] + length * np.tensordot(method.matrix[s, :s], slopes[:s, :MOVING], 1))
    own = slopes[: method.stages]
    end = state + length * np.tensordot(method.weights, own, 1)
    fine, coarse = (length * np.tensordot(w, own[:, :MOVING], 1) for w in (method.less_fine, method.less_coarse))
    with np.errstate(all="ignore"):
        error = fine**2 / np.sqrt(fine**2 + 0.01 * coarse**2)
        speeds = np.abs(state[:MOVING]) * np.array([0.0, 1.0, 0.0, 1.0])[:, None]
        allowed = np.maximum(np.abs(length * own[:, :MOVING]).max(axis=0), speeds)
        missed = np.where(fine == 0.0, 0.0, error / (tolerance * allowed)).max(axis=0)
    parts = length * np.tensordot(method.parts, slopes[:, :MOVING], 1)
    return CoupledStep(state, end, length, missed, parts, moments[[0, method.stages]])
