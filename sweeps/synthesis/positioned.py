"""Four-bar linkages whose coupler passes through given positions without defects."""

import cmath
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sweeps.synthesis.dyads import PlaneDyad, PlanePosition, dyads_of_turn
from sweeps.synthesis.synthesis_error import SynthesisError

# Grid steps per turn on the curve of four positions.
_STEPS = 72
# Maximum link length, as a multiple of the largest distance between positions.
_LONGEST = 8.0


class PositionedFourBar(NamedTuple):
    """A four-bar linkage with a plane on its coupler that passes through given positions.

    Attributes
    ----------
    crank_pivot, rocker_pivot : complex
        x + iy [m].
    crank, coupler, rocker : float
        Lengths [m].
    mode : int
        Assembly mode: +1 where the rocker's joint lies to the left of the line from the crank's pin to its bearing.
    crank_angles : tuple of float
        At the positions, monotonic [rad].
    point : complex
        The plane's point P from the crank's pin, along the coupler and to its left [m].
    angle : float
        Angle of the plane relative to the coupler [rad].
    turns : bool
        Whether the crank turns fully.
    least_transmission : float
        Minimum acute angle between coupler and rocker during the motion [rad].
    """

    crank_pivot: complex
    rocker_pivot: complex
    crank: float
    coupler: float
    rocker: float
    mode: int
    crank_angles: tuple[float, ...]
    point: complex
    angle: float
    turns: bool
    least_transmission: float


def four_bar_through(positions: Sequence[PlanePosition], driven: PlaneDyad, other: PlaneDyad) -> PositionedFourBar:
    """Four-bar linkage of two dyads, if it passes through the positions without defects.

    Parameters
    ----------
    positions : sequence of PlanePosition
    driven, other : PlaneDyad
        Dyads of crank and rocker.

    Raises
    ------
    SynthesisError
        Branch defect (positions on different branches), order defect (the crank must reverse), or it can't move between
        the positions.
    """
    pins = np.array([driven.joint(place) for place in positions])
    joints = np.array([other.joint(place) for place in positions])
    links = (pins[0] - driven.centre, joints[0] - pins[0], joints[0] - other.centre)
    crank, coupler, rocker = (float(abs(link)) for link in links)
    if min(crank, coupler, rocker) <= 1e-9 * max(crank, coupler, rocker, abs(other.centre - driven.centre)):
        raise SynthesisError("the joints of a link coincide: choose other joints")
    sides = np.sign(((other.centre - pins).conj() * (joints - pins)).imag)
    if abs(sides.sum()) != len(positions):
        raise SynthesisError("the positions are on different branches (branch defect): choose other joints")
    angles = _in_order(np.angle(pins - driven.centre))
    plane, along = cmath.exp(1j * positions[0].angle), complex(joints[0] - pins[0]) / coupler
    least = least_transmission(crank, coupler, rocker, other.centre - driven.centre, angles)
    if least is None:
        raise SynthesisError("the linkage can't move between the positions: choose other joints")
    whole = least_transmission(crank, coupler, rocker, other.centre - driven.centre)
    return PositionedFourBar(
        crank_pivot=driven.centre,
        rocker_pivot=other.centre,
        crank=crank,
        coupler=coupler,
        rocker=rocker,
        mode=int(sides[0]),
        crank_angles=angles,
        point=complex(positions[0].point - pins[0]) / along,
        angle=cmath.phase(plane / along),
        turns=whole is not None,
        least_transmission=least if whole is None else whole,
    )


def best_four_bar_through(positions: Sequence[PlanePosition]) -> PositionedFourBar:
    """The four-bar linkage through four positions with the best transmission angle on a grid of the curve.

    Fully rotating cranks are preferred.

    Parameters
    ----------
    positions : sequence of PlanePosition
        Four.

    Raises
    ------
    SynthesisError
        Not four positions, or no linkage without defects.
    """
    size = max(abs(a.point - b.point) for a in positions for b in positions)
    dyads = [d for i in range(1, _STEPS) for d in dyads_of_turn(positions, math.tau * i / _STEPS)]
    dyads = [d for d in dyads if 1e-3 * size < abs(d.joint(positions[0]) - d.centre) < _LONGEST * size]
    dyads = [d for d in dyads if max(abs(d.centre - positions[0].point), abs(d.circle)) < _LONGEST * size]
    found = []
    for driven in dyads:
        for other in dyads:
            try:
                found.append(four_bar_through(positions, driven, other))
            except SynthesisError:
                continue
    if not found:
        raise SynthesisError(
            "no four-bar linkage passes through these four positions without defects; change one of them"
        )
    return max(found, key=lambda four_bar: (four_bar.turns, four_bar.least_transmission))


def _in_order(angles: np.ndarray) -> tuple[float, ...]:
    """Monotonic angles, in the shorter direction."""
    ways = []
    for sense in (1.0, -1.0):
        turned = np.cumsum(np.mod(sense * np.diff(angles), math.tau))
        if turned[-1] < math.tau and (np.diff(turned, prepend=0.0) > 0.0).all():
            ways.append((float(turned[-1]), tuple(float(angles[0] + sense * t) for t in (0.0, *turned))))
    if not ways:
        raise SynthesisError(
            "the crank would have to reverse between the positions (order defect): choose other joints"
        )
    return min(ways)[1]


def least_transmission(
    crank: float, coupler: float, rocker: float, frame: complex, angles: Sequence[float] = (0.0, math.tau)
) -> float | None:
    """Minimum acute angle between coupler and rocker between two crank angles; None if the links don't reach.

    The distance between crankpin and rocker pivot, which determines it, is extreme when crank and frame are in line.

    Parameters
    ----------
    crank, coupler, rocker : float
    frame : complex
        From the crank pivot to the rocker pivot.
    angles : sequence of float, optional
        The first and the last one count [rad]; default: a full turn.
    """
    low, high = min(angles[0], angles[-1]), max(angles[0], angles[-1])
    base = cmath.phase(frame)
    turns = range(math.ceil((low - base) / math.pi), math.floor((high - base) / math.pi) + 1)
    apart = [abs(frame - cmath.rect(crank, angle)) for angle in (low, high, *(base + math.pi * t for t in turns))]
    if min(apart) <= abs(coupler - rocker) or max(apart) >= coupler + rocker:
        return None
    # At a change point, rounding may exceed 1.
    cosines = (abs(coupler * coupler + rocker * rocker - d * d) / (2.0 * coupler * rocker) for d in apart)
    return min(math.acos(min(1.0, cosine)) for cosine in cosines)
