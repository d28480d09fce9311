"""Steady state: the motion that comes back to its own speed after every cycle, found directly.

The return map takes the kinetic energy E at the first node to the energy P(E) one cycle later. Steady motion is a
fixed point; its multiplier λ = dP/dE = exp ∮ ∂M/∂E dφ tells how a small disturbance grows from cycle to cycle, and
the steady motion is stable where |λ| < 1. Newton's method on P(E) − E with that λ converges in a few cycles, where
waiting takes hundreds.
"""

from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE
from engine.compiling.widths import LANES
from engine.laws.runge_kutta import ORDER_EIGHT, Method
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.grid import edges_of
from engine.motion.steppers.places import form_of, source_of
from engine.motion.steppers.radau import ORDER_NINE
from engine.motion.steppers.settling import (
    FOUND,
    STALLS_AT_ONCE,
    STALLS_HERE,
    TOO_MANY_STEPS,
    Settling,
    new_block_room,
    settle,
)
from engine.verdicts import Verdict

# Steps of a cycle besides those that end where moments jump or bend, at most: explicit ones, and implicit ones, for
# motors that are too steep for so many. How often they are laid anew where the motion needs others than thought of.
MOST_STEPS, MOST_IMPLICIT_STEPS, MOST_MESHES = 200, 3000, 5
# Where rounding keeps steps of so steep a motor from missing as little as asked, so many times as much is allowed, and
# so often more.
LOOSER, MOST_LOOSENED = 100.0, 3
# Steps that miss so many times what is allowed are laid anew.
ALLOWED = 10.0


class Steady(NamedTuple):
    """Steady motion of a set of variants; NaN where there is none. All (variants,) but for works and record.

    Attributes
    ----------
    verdict : ndarray of uint8
    energy, ended : ndarray
        Kinetic energy at the begin of the cycle and at its end [J].
    multiplier : ndarray
        λ.
    residual : ndarray
        |P(E) − E|/E, what is left.
    period : ndarray
        [s].
    slowest, fastest : ndarray
        Least and greatest speed [rad/s].
    squares : ndarray
        Integral of the motors' moment squared over time [N²·m²·s].
    works : ndarray (channels + 1, variants)
        Work of the motors and of each channel [J].
    record : ndarray (3, nodes, variants)
        Energy [J] and time [s] at the angles that were asked for; of motors that are very steep the moment [N·m], which
        the energy says less surely, else NaN.
    besides : ndarray (variants,)
        By how much δ changes besides, with every step changed by its estimated error.
    """

    verdict: np.ndarray
    energy: np.ndarray
    ended: np.ndarray
    multiplier: np.ndarray
    residual: np.ndarray
    period: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray
    squares: np.ndarray
    works: np.ndarray
    record: np.ndarray
    besides: np.ndarray | float = 0.0

    @property
    def fluctuation(self) -> np.ndarray:
        """δ."""
        return 2.0 * (self.fastest - self.slowest) / (self.fastest + self.slowest) + self.besides


def steady_motion(
    dynamics: Dynamics, variants: Variants, tolerance: float, asked: np.ndarray | None = None
) -> tuple[Steady, Steady]:
    """Find the steady motion: as it is, and with every step changed by its estimated error.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    tolerance : float
        What a step may miss, of the greatest work of a step.
    asked : ndarray (nodes, variants), optional
        Angles turned at which energy, time and moment are wanted, in order [rad].
    """
    count = variants.count
    asked = np.empty((0, count)) if asked is None else asked
    speed, driven = no_load_speed(variants)
    own = np.zeros(count), variants.direction, variants.flywheel, np.full(count, tolerance), speed, speed, driven
    numbers = np.array([*own, np.zeros(count)], float)
    found, record = np.empty((2, FOUND + len(dynamics.channels), count)), np.empty((2, 3, asked.shape[0], count))
    _search(ORDER_EIGHT, dynamics, variants, np.arange(count), numbers, asked, found, record)
    steep = np.flatnonzero(found[0, 0] == TOO_MANY_STEPS)
    for _ in range(1 + MOST_LOOSENED):
        if not steep.size:
            break
        # Down from the speed without load, a steep motor comes to its own speed at once.
        numbers[4, steep], numbers[7, steep] = found[0, 11, steep], 1.0
        _search(ORDER_NINE, dynamics, variants, steep, numbers, asked, found, record)
        steep = steep[found[0, 0, steep] == TOO_MANY_STEPS]
        numbers[3, steep] *= LOOSER
    lost = np.flatnonzero((found[0, 0] == Verdict.OK) & (found[1, 0] != Verdict.OK))
    if lost.size:
        # Where steps can't be gone with their estimated errors, others that may miss more tell how sure it is. They may
        # happen to be the same: the energy's drift is added.
        numbers[3, lost], numbers[4, lost], numbers[7, lost] = LOOSER * tolerance, found[0, 1, lost], 1.0
        loose, notes, drift = found.copy(), record.copy(), found[1, 12, lost]
        _search(ORDER_NINE, dynamics, variants, lost, numbers, asked, loose, notes)
        found[1][:, lost], record[1][..., lost] = loose[0][:, lost], notes[0][..., lost]
        found[1, 12, lost] = drift
        for row in (7, 8):
            fine, other = found[0, row, lost], found[1, row, lost]
            found[1, row, lost] = other + np.copysign(drift * fine, other - fine)
    fine, doubtful = (_steady_of(*parts) for parts in zip(found, record, strict=True))
    return fine, doubtful


def _search(
    method: Method,
    dynamics: Dynamics,
    variants: Variants,
    pending: np.ndarray,
    numbers: np.ndarray,
    asked: np.ndarray,
    found: np.ndarray,
    record: np.ndarray,
) -> None:
    """Settle those of the variants that are pending, with steps laid anew where the motion found needs others.

    Those that never miss as little as is allowed have, as it were, too many steps.
    """
    unsure = np.zeros(pending.size, bool)
    for mesh in range(MOST_MESHES):
        if not pending.size:
            break
        part, some = variants.some(pending), np.ascontiguousarray(asked[:, pending])
        own, notes = _settled(method, dynamics, part, numbers[:, pending], some)
        found[..., pending], record[..., pending] = own, notes
        verdict, energy, worst, highest = own[0, 0], own[0, 1], own[0, 9], own[0, 11]
        stalls, unsure = verdict == STALLS_HERE, (verdict == Verdict.OK) & ~(worst <= ALLOWED)
        again = stalls | unsure | ((verdict == STALLS_AT_ONCE) & (mesh == 0))
        numbers[4, pending] = np.where(unsure, energy, highest)
        numbers[7, pending] = 1.0
        pending, unsure = pending[again], unsure[again]
    found[:, 0, pending[unsure]] = TOO_MANY_STEPS


def _settled(
    method: Method, dynamics: Dynamics, variants: Variants, numbers: np.ndarray, asked: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """What `settle` finds, and what it records at the asked angles."""
    drive, tabulation = variants.drive, dynamics.reduction.tabulation
    form = form_of(dynamics, len(drive.kloss))
    source, fill = source_of(dynamics, form), tabulation.function("curves_at")
    # In a motion that repeats itself nothing that depends on time acts.
    parameters = variants.parameters.copy()
    parameters[source.clocks] = 0.0
    given = Settling(
        parameters, drive.rows, drive.exponents, *edges_of(variants.direction, variants.breaks, dynamics.cycle), numbers
    )
    given = Settling(*(np.require(part, requirements="CW") for part in given))
    most = (MOST_IMPLICIT_STEPS if method.implicit else MOST_STEPS) + given.edges.shape[0]
    found = np.empty((2, FOUND + form.channels, variants.count))
    record, asked = np.empty((2, 3, *asked.shape)), np.require(asked, requirements="CW")

    def arguments() -> tuple:
        memory = new_block_room(form, given, source.target.size, most)
        laws, cycle = dynamics.channel_of_laws, dynamics.cycle
        return fill, source, method, form, laws, cycle, most, given, asked, found, record, memory

    if not settle.overloads:
        prepare(settle, [types.intp, types.intp, FILLS_TILE, *(numba.typeof(part) for part in arguments()[1:])])
    spread(settle, -(-variants.count // LANES), arguments)
    return found, record


def _steady_of(found: np.ndarray, record: np.ndarray) -> Steady:
    verdict, energy, log_multiplier, residual, period, motors, squares, slowest, fastest, _, ended, _, besides = found[
        :FOUND
    ]
    verdict = np.where((verdict == STALLS_HERE) | (verdict == STALLS_AT_ONCE), Verdict.STALLS, verdict)
    verdict = np.where(verdict == TOO_MANY_STEPS, Verdict.NOT_FINITE, verdict)
    works = np.concatenate((motors[None], found[FOUND:]))
    if works.shape[0] == 2:
        # What the motors didn't give.
        works[1] = ended - energy - motors
    with np.errstate(all="ignore"):
        multiplier = np.exp(np.minimum(log_multiplier, 700.0))
    values = energy, ended, multiplier, residual, period, slowest, fastest, squares, works, record, besides
    failed = verdict != Verdict.OK
    return Steady(verdict.astype(np.uint8), *(np.where(failed, np.nan, value) for value in values))


def no_load_speed(variants: Variants) -> tuple[np.ndarray, np.ndarray]:
    """Speed beyond which no motor drives, and whether there is a motor at all; else the scene's own speed."""
    drive, own = variants.drive, np.abs(np.broadcast_to(variants.numbers["input.speed"], (variants.count,)))
    with np.errstate(all="ignore"):
        speeds = [np.where(drive.line[1] < 0.0, -drive.line[0] / drive.line[1], 0.0)]
    speeds += [constants[3] / constants[4] for constants in drive.kloss]
    top = np.max(speeds, axis=0)
    return np.where(top > 0.0, top, own), top > 0.0
