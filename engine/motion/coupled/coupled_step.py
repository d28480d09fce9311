"""A step of order eight in time of both sides of a coupling, for many variants, each in a state of its own.

Slipping, the coupling's moment T acts between the sides, I ε₁ + ½ω₁² dI/dφ = M₁ + T and J ε₂ = M₂ − T; held together
they move as one, and T follows. Every stage evaluates the machine at the angles it comes to.
"""

from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE
from engine.compiling.widths import LANES
from engine.laws.runge_kutta import DENSE_PARTS, ORDER_EIGHT
from engine.motion.coupled.coupled_lanes import BY_FLUID, CLUTCH, NONE, found_rows, new_both_room, step_of_both
from engine.motion.coupled.stiff_step import decay_rate, stiff_step
from engine.motion.coupled.two_sides import CoupledSides, Joined
from engine.motion.moments.at_speed import Drive
from engine.motion.steppers.places import form_of, source_of

# How the sides are joined: held together, slipping forwards (the shaft is faster) or backwards, free of each other, or
# by a fluid.
TOGETHER, FORWARDS, BACKWARDS, APART, FLUID = 0, 1, -1, 2, 3
# Rows of a state: angle and speed of the crank, of the shaft, all reduced to the crank and in the direction of motion;
# what follows is gathered: heat of the coupling, angle slipped, motors' moment squared over time, works of the motors
# and of each channel.
CRANK, CRANK_SPEED, SHAFT, SHAFT_SPEED, HEAT, SLIPPED, SQUARES, WORKS = range(8)
MOVING = 4
# Of a fluid coupling, the product of step and decay rate from which on a step is an implicit one.
STIFF = 2.0


class Pull(NamedTuple):
    """What moves both sides at an instant, each (variants,).

    Attributes
    ----------
    moment : ndarray
        Of the coupling on the crank [N·m]; of sides held together what it takes.
    crank, shaft : ndarray
        Accelerations [rad/s²].
    rate : ndarray
        How fast moments pull speeds together, about [1/s].
    """

    moment: np.ndarray
    crank: np.ndarray
    shaft: np.ndarray
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
    rate = np.abs(of_crank.slope[0] - w1 * rows.inertia_phi[0]) / inertia + np.abs(of_shaft.slope[0]) / own
    return Pull(moment, first, second, rate)


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
        # p₀θ + p₁θ(1−θ) + p₂θ²(1−θ) + …, nested.
        factors, found = (share, 1.0 - share), self.parts[-1]
        for i in range(DENSE_PARTS - 1, 0, -1):
            found = self.parts[i - 1] + factors[i % 2] * found
        return self.begin[:MOVING] + share * found


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
    stiff = _stiff(sides, joined, state, time, length)
    if not stiff.any():
        return _explicit_step(sides, joined, state, time, length, goal, tolerance)
    who = np.flatnonzero(stiff)
    some = (sides, joined, state, time, length, goal) if stiff.all() else None
    if some is None:
        some = (sides.some(who), joined.some(who), state[:, who], time[who], length[who], goal[who])
    implicit = _implicit_step(*some, tolerance)
    if stiff.all():
        return implicit
    step = _explicit_step(sides, joined, state, time, length, goal, tolerance)
    for whole, part in zip(step[1:], implicit[1:], strict=True):
        whole[..., who] = part
    return step


def _stiff(sides: CoupledSides, joined: Joined, state: np.ndarray, time: np.ndarray, length: np.ndarray) -> np.ndarray:
    """Of which variants a step is to be an implicit one, (variants,) of bool."""
    if not sides.is_fluid:
        return np.zeros(time.size, bool)
    both = (joined.crank_way != 0.0) & (joined.shaft_way != 0.0)
    with np.errstate(all="ignore"):
        return both & (length * decay_rate(sides, joined, state[:MOVING], time) > STIFF)


def _implicit_step(
    sides: CoupledSides,
    joined: Joined,
    state: np.ndarray,
    time: np.ndarray,
    length: np.ndarray,
    goal: np.ndarray,
    tolerance: float,
) -> CoupledStep:
    """As `coupled_step`, where a fluid coupling is steep."""
    with np.errstate(all="ignore"):
        found = stiff_step(sides, joined, state[:MOVING], time, length, goal, tolerance)
    return CoupledStep(state, state + found.changes, length, found.missed, found.parts, found.moments)


def _explicit_step(
    sides: CoupledSides,
    joined: Joined,
    state: np.ndarray,
    time: np.ndarray,
    length: np.ndarray,
    goal: np.ndarray,
    tolerance: float,
) -> CoupledStep:
    """As `coupled_step`, where nothing is steep."""
    dynamics, crank, own = sides.crank.dynamics, sides.crank, sides.crank.variants
    form, other = form_of(dynamics, len(own.drive.kloss)), form_of(sides.shaft.dynamics, len(_drive_of(sides).kloss))
    source, tabulation, coupling = source_of(dynamics, form), dynamics.reduction.tabulation, sides.coupling
    facing = np.where(joined.crank_way < 0.0, -1.0, 1.0)
    numbers = crank.parameters_facing(facing)
    moving = (joined.crank_way != 0.0, joined.shaft_way != 0.0)
    given = [crank.start, own.direction, own.flywheel, state[CRANK], state[CRANK_SPEED], state[SHAFT_SPEED]]
    given += [joined.clock + time, length, facing, goal, joined.mode, *moving, joined.engaged + time, coupling.fluid]
    parts = [numbers, own.drive.rows, own.drive.exponents, _drive_of(sides).rows, _drive_of(sides).exponents]
    parts += [sides.shaft.place(other, joined.shaft_way), coupling.times, coupling.capacity, np.array(given, float)]
    parts = [np.require(part, requirements="CW") for part in parts]
    joint = BY_FLUID if sides.is_fluid else NONE if sides.open else CLUTCH
    breaks, pieces = (np.array([0.0, 1.0]), np.zeros((1, 1)))
    if coupling.coefficient is not None:
        breaks, pieces = coupling.coefficient.x, np.ascontiguousarray(coupling.coefficient.c)
    found = np.empty((found_rows(form), time.size))

    def arguments() -> tuple:
        room = new_both_room(form, other, numbers.shape[0], source.target.size, coupling.times.shape[0])
        laws = dynamics.channel_of_laws, sides.shaft.dynamics.channel_of_laws
        fill, by = tabulation.function("curves_at"), (tolerance, joint, breaks, pieces)
        return fill, source, ORDER_EIGHT, form, other, *laws, *by, *parts, found, room

    if not step_of_both.overloads:
        kinds = (numba.typeof(part) for part in arguments()[1:])
        prepare(step_of_both, [types.intp, types.intp, FILLS_TILE, *kinds])
    spread(step_of_both, -(-time.size // LANES), arguments)
    rows = state.shape[0]
    polynomials = found[rows + 1 : -2].reshape(MOVING, DENSE_PARTS, time.size).swapaxes(0, 1)
    return CoupledStep(state, state + found[:rows], length, found[rows], polynomials, found[-2:])


def _drive_of(sides: CoupledSides) -> Drive:
    """Motors on the shaft's side."""
    return sides.shaft.variants.drive
