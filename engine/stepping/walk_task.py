"""Settings of a walk: its system, method, tolerance and ends; and the reasons why a walk may end."""

import math
from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np

# Factors by which steps are longer in a walk and in the two for its comparison. Steps grow faster by the squares of the
# factors: from one first step, 4^k, 2·16^k and √2·8^k times as long, those of two walks never have the same length. The
# tolerance of those two is larger by the power COARSER of the factors, but at most COARSEST, beyond which it says
# nothing; their steps differ even where growth, an instant or a longest step limits them. The range of the three
# results estimates the error: the difference of two may cross zero. For the same reason, one of them alone adds known
# errors: LONGEST those of the motion before, LONGER those of its stretches over the angle.
LONGER, LONGEST = math.sqrt(2.0), 2.0
WALKS = (1.0, LONGEST, LONGER)
COARSER, COARSEST = 7, 1e-1
# With friction in pairs, each walk displaces the ends of its steps by these multiples of their error estimates. A
# reaction that passes near zero bends friction within a few degrees, so longer steps miss no more than shorter ones,
# and the range of three results may be small by chance. The multiples fall as the errors of smooth steps grow, by the
# eighth power of the factors. A motor so steep that steps are implicit would answer with a jump of its torque.
DISPLACED = (0.0, -0.125, 2.0)


def tolerance_of_walk(tolerance: float, longer: float) -> float:
    """Step tolerance of a walk with steps longer by one of the factors `WALKS`."""
    return tolerance if longer == 1.0 else max(tolerance, min(longer**COARSER * tolerance, COARSEST))


def change_or_anything(change: np.ndarray, value: np.ndarray) -> np.ndarray:
    """Change of a result with the errors of a motion; a result that they make undefined may be anything."""
    return np.where(np.isnan(change) & np.isfinite(value), np.inf, change)


def range_of_walks(rows: Sequence[np.ndarray]) -> np.ndarray:
    """Range of the results of several walks; infinite where the first has a result and another has none."""
    with np.errstate(invalid="ignore"):
        return change_or_anything(np.ptp(rows, axis=0), rows[0])


class Why(IntEnum):
    """Why a walk ended.

    STEEP: an implicit method would be faster. FADED: the speed has dropped below `floor`. From GUARD on: the guard of
    that number.
    """

    GOING = -1
    GOAL = 0
    RANGE = 1
    LOST = 2
    STEEP = 3
    FULL = 4
    OTHER_GOAL = 5
    FADED = 6
    GUARD = 7


GOING, GOAL, RANGE, LOST, STEEP, FULL, OTHER_GOAL, FADED, GUARD = (int(why) for why in Why)


class WalkTask(NamedTuple):
    """Settings of a walk, common to all variants.

    Attributes
    ----------
    along_time : bool
        Whether time is the independent variable and the angle turned the first state; otherwise the angle is the
        independent variable.
    method, stages : int
        Number of the method, and of its stages.
    fixed : bool
        Whether steps have fixed lengths.
    longer : float
        One of `WALKS`.
    displaces : float
        Multiple of their error estimates by which the ends of steps are displaced.
    steepest : float
        Limit of |h ∂f/∂y| for an explicit step.
    nodes : ndarray
        Nodes of the method.
    implicit : bool
        Whether Newton's method finds the stages.
    solved : int
        Number of states Newton's method solves for: the energy, or the speeds; 0 if it can't.
    slopes : int
        First row of the Jacobian of their rates in `watch`.
    solves : int
        State with an implicit rate, −1: none; the row of that rate in P follows those of the states.
    matrix, inverse : ndarray
        A and its inverse, for an implicit method.
    states, width : int
        Rows of `rates`: those of the states, and those including the integrals.
    scales : int
        First row of the error scales of the states in `watch`, along time; −1: the states themselves.
    watched, guards, endings : int
        Number of rows of `watch`, of the guards, which are the last ones, and of the first guards, which end the walk;
        others change held numbers.
    kinks : ndarray of int
        Rows of `watch` at whose changes of sign the rates have kinks.
    carries : bool
        Whether error estimates are propagated.
    first_place, places, rated : int
        First row of P that the printed function `places` fills, the number of these rows, and how many of them `rates`
        reads; the rows of the states follow.
    clock : int
        Row of P that holds the time; −1: none.
    extremes : bool
        Whether steps end at the extremes of the speed.
    root : float
        Relative tolerance of the length of the step to a guard's root.
    recorded : ndarray (fractions + 1, dense stages)
        Weights of the rates in the mean rate up to each fraction of a step at which its polynomial is recorded, and in
        the largest last term of the polynomial.
    cycle : float
        Period of the angle; infinite if there is none [rad].
    held : ndarray of int
        Rows of P that change where a guard ends a step; their new values are the rows of `watch` before the guards.
    signed : bool
        Whether speeds may be negative.
    """

    along_time: bool
    method: int
    stages: int
    fixed: bool
    longer: float
    displaces: float
    steepest: float
    implicit: bool
    solved: int
    slopes: int
    scales: int
    solves: int
    nodes: np.ndarray
    matrix: np.ndarray
    inverse: np.ndarray
    states: int
    width: int
    watched: int
    guards: int
    endings: int
    kinks: np.ndarray
    carries: bool
    first_place: int
    places: int
    rated: int
    clock: int
    extremes: bool
    root: float
    recorded: np.ndarray
    cycle: float
    held: np.ndarray
    signed: bool
