"""An implicit step of both sides of a fluid coupling that pulls their speeds together faster than they move.

By the method of Radau of order nine. Newton's method solves for the speeds of all stages together, with the derivatives
of the moments by both speeds; the angle follows from the crank's.
"""

from typing import NamedTuple

import numpy as np

from engine.laws.couplings import slip_of
from engine.motion.coupled.two_sides import CoupledSides, CouplingNumbers, Joined
from engine.motion.steppers.radau import ORDER_NINE

# Newton's method: most rounds, and when speeds are found, or nearly so, as shares of the greatest one.
MOST_ROUNDS, SOLVED, NEARLY_SOLVED = 12, 1e-14, 1e-11


class StiffStep(NamedTuple):
    """What follows from a step, with rows as those of a state and of `CoupledStep`.

    Attributes
    ----------
    changes : ndarray (rows, variants)
    missed : ndarray (variants,)
    parts : ndarray (parts, 4, variants)
    moments : ndarray (2, variants)
    """

    changes: np.ndarray
    missed: np.ndarray
    parts: np.ndarray
    moments: np.ndarray


class Pulls(NamedTuple):
    """What moves both sides at some instants; the sides are the crank and the shaft.

    Attributes
    ----------
    rises : ndarray (2, instants, variants)
        Accelerations of the sides [rad/s²].
    slopes : ndarray (2, 2, instants, variants)
        Their derivatives by both speeds [1/s].
    shaft_moment : ndarray (instants, variants)
        Of everything on the shaft but the coupling [N·m].
    motors : ndarray (2, instants, variants)
        Moments of the motors on either side [N·m].
    channels : ndarray (2, channels, instants, variants)
        So of each channel of loads.
    """

    rises: np.ndarray
    slopes: np.ndarray
    shaft_moment: np.ndarray
    motors: np.ndarray
    channels: np.ndarray


def fluid_slopes(coupling: CouplingNumbers, crank: np.ndarray, shaft: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Derivatives of a fluid coupling's moment on the crank by the speeds of the crank and of the shaft [N·m·s].

    Parameters
    ----------
    coupling : CouplingNumbers
    crank, shaft : ndarray (…, variants)
        Speeds [rad/s].
    """
    shaft_drives = np.abs(shaft) >= np.abs(crank)
    fast, slow = np.where(shaft_drives, shaft, crank), np.where(shaft_drives, crank, shaft)
    slip = slip_of(fast, slow)
    value, steep = coupling.coefficient(slip), coupling.coefficient(slip, 1)
    # T = ± c λ(1 − ω₂/ω₁) ω₁ |ω₁|
    factor = np.where(shaft_drives, 1.0, -1.0) * coupling.fluid
    by_slow = -factor * steep * np.abs(fast)
    by_fast = factor * (2.0 * value * np.abs(fast) + steep * slow * np.sign(fast))
    return np.where(shaft_drives, by_slow, by_fast), np.where(shaft_drives, by_fast, by_slow)


def decay_rate(sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray) -> np.ndarray:
    """How fast moments pull speeds to where they balance [1/s], about; parameters are those of `stiff_step`."""
    pulls = _pulls(sides, joined, moving[0][None], moving[1][None], moving[3][None], time[None])
    return np.abs(pulls.slopes).sum(axis=1).max(axis=0)[0]


def stiff_step(
    sides: CoupledSides,
    joined: Joined,
    moving: np.ndarray,
    time: np.ndarray,
    length: np.ndarray,
    goal: np.ndarray,
    tolerance: float,
) -> StiffStep:
    """Make a step of sides that both move.

    Parameters
    ----------
    sides : CoupledSides
        With a fluid coupling.
    joined : Joined
    moving : ndarray (4, variants)
        Angle and speed of the crank, and of the shaft.
    time, length : ndarray (variants,)
        Since the begin of the run, and of the step [s].
    goal : ndarray (variants,)
        Angle turned by the crank that no stage goes beyond [rad].
    tolerance : float
        What may be missed, as a share of the angles turned and of the speeds or their changes.
    """
    method, count = ORDER_NINE, time.size
    stages, begin = method.stages, moving[1::2]
    shares, clock = length * method.matrix[:, :, None], time + method.shares[:stages, None] * length
    speeds = np.repeat(begin[:, None], stages, axis=1)
    worst, found = np.full(count, np.inf), np.zeros(count, bool)
    for _ in range(MOST_ROUNDS):
        pulls = _pulls(sides, joined, _turned(joined, moving[0], shares, speeds[0], goal), *speeds, clock)
        left = begin[:, None] + np.einsum("skv,ikv->isv", shares, pulls.rises) - speeds
        # Of the equations of the speeds (side, stage) by those of the speeds (side, stage), of each variant.
        moved = np.einsum("skv,ijkv->visjk", shares, pulls.slopes)
        matrix = np.eye(2 * stages) - moved.reshape(count, 2 * stages, 2 * stages)
        sound = np.isfinite(matrix).all(axis=(1, 2)) & np.isfinite(left).all(axis=(0, 1))
        matrix = np.where(sound[:, None, None], matrix, np.eye(2 * stages))
        change = np.linalg.solve(matrix, left.reshape(2 * stages, count).T[:, :, None])[:, :, 0].T
        change = np.where(sound & ~found, change, 0.0).reshape(2, stages, count)
        size = np.abs(change).max(axis=(0, 1)) / np.abs(speeds).max(axis=(0, 1))
        worst = np.where(found, worst, np.where(sound, size, np.nan))
        speeds = speeds + change
        found |= ~(worst > SOLVED)
        if found.all():
            break
    pulls = _pulls(sides, joined, _turned(joined, moving[0], shares, speeds[0], goal), *speeds, clock)
    # Of a steep coupling accelerations are less sure by the speeds than these are themselves.
    rises = np.einsum("sk,ikv->isv", method.inverse, speeds - begin[:, None]) / length
    rises = np.where(length > 0.0, rises, pulls.rises)
    moment = pulls.shaft_moment - sides.shaft.inertia * rises[1]
    rates = np.array([speeds[0], rises[0], speeds[1], rises[1]])
    slip, motors = speeds[1] - speeds[0], pulls.motors
    gathered = np.array([moment * slip, np.abs(slip), motors.sum(axis=0) ** 2, (motors * speeds).sum(axis=0)])
    every = length * np.concatenate((rates, gathered, (pulls.channels * speeds[:, None]).sum(axis=0)))
    changes = np.einsum("s,rsv->rv", method.weights, every)
    missed = _missed(moving, every[: len(rates)], tolerance)
    parts = np.einsum("ps,rsv->prv", method.parts, every[: len(rates)])
    first = sides.coupling.fluid_moment(*begin)
    return StiffStep(changes, np.where(worst < NEARLY_SOLVED, missed, np.nan), parts, np.array([first, moment[-1]]))


def _turned(joined: Joined, begin: np.ndarray, shares: np.ndarray, speeds: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """Angle turned by the crank at the stages, (stages, variants), by its speeds there."""
    turned = begin + np.einsum("skv,kv->sv", shares, speeds)
    return np.where(joined.crank_way < 0.0, np.maximum(turned, goal), np.minimum(turned, goal))


def _pulls(
    sides: CoupledSides, joined: Joined, turned: np.ndarray, crank: np.ndarray, shaft: np.ndarray, time: np.ndarray
) -> Pulls:
    """What moves both sides at instants, (instants, variants)."""
    rows, of_crank = sides.crank.along(turned, crank, joined.clock + time, joined.crank_way)
    of_shaft, own = sides.shaft.moments(shaft, joined.shaft_way), sides.shaft.inertia
    passed, (by_crank, by_shaft) = sides.coupling.fluid_moment(crank, shaft), fluid_slopes(sides.coupling, crank, shaft)
    shaft_moment = of_shaft.total
    rises = np.array(
        [
            (of_crank.total - 0.5 * crank * crank * rows.inertia_phi + passed) / rows.inertia,
            (shaft_moment - passed) / own,
        ]
    )
    of_crank_speed = (of_crank.slope - crank * rows.inertia_phi + by_crank) / rows.inertia
    slopes = np.array([[of_crank_speed, by_shaft / rows.inertia], [-by_crank / own, (of_shaft.slope - by_shaft) / own]])
    motors, channels = np.array([of_crank.motors, of_shaft.motors]), np.array([of_crank.loads, of_shaft.loads])
    return Pulls(rises, slopes, shaft_moment, motors, channels)


def _missed(moving: np.ndarray, every: np.ndarray, tolerance: float) -> np.ndarray:
    """Estimated error of what moves, by what is allowed, of changes (4, stages, variants) as they are at the stages."""
    fine, coarse = (np.abs(np.einsum("s,rsv->rv", of[0], every)) for of in (ORDER_NINE.fine, ORDER_NINE.coarse))
    size = np.hypot(fine, coarse)
    error = np.where(size > 0.0, fine * fine / size, 0.0 * size)
    reach = np.abs(every).max(axis=1)
    reach[1::2] = np.maximum(reach[1::2], np.abs(moving[1::2]))
    return np.where(error == 0.0, 0.0, error / (tolerance * reach)).max(axis=0)
