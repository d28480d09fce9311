"""What friction costs: its work over the range of the input, the efficiency it leaves, and where it jams."""

import math

import numpy as np

from engine.compiling.jit import scalar
from engine.equal_positions.rows import roughness, total_of


@scalar
def work_over(moment: np.ndarray, h: float, periodic: bool) -> tuple[float, float]:
    """Work of a moment over the range of the input, by the trapezoid rule, and its doubt.

    Parameters
    ----------
    moment : ndarray (positions,)
        Reduced moment [N·m], or force of a sliding input [N].
    h : float
        Spacing of the positions [rad or m].
    periodic : bool
        Whether the last position is followed by the first.

    Returns
    -------
    work : float
        By magnitude [J].
    doubt : float
        How much it may be off because the moment jumps or bends between two positions [J].
    """
    total = total_of(moment)
    if not periodic:
        total -= 0.5 * (moment[0] + moment[moment.shape[0] - 1])
    return abs(total * h), 0.5 * abs(h) * roughness(moment, periodic)


@scalar
def mechanical_efficiency(useful: float, driving: float, resisting: float, friction: float) -> float:
    """Share of what is put into a machine that comes out of it, in the mean over a cycle.

    Parameters
    ----------
    useful, driving : float
        Reduced moments of useful resistances (negative where they resist) and of driving forces [N·m].
    resisting : float
        Reduced moment of everything but the driver and friction in pairs [N·m].
    friction : float
        Reduced moment of the friction in pairs [N·m].

    Returns
    -------
    float
        Useful work and what the input link gives away, over driving work and what it takes; NaN of a machine that
        nothing drives.
    """
    taken = -resisting - friction
    return (max(-useful, 0.0) + max(-taken, 0.0)) / (max(driving, 0.0) + max(taken, 0.0))


@scalar
def less_friction(moment: np.ndarray, friction: np.ndarray, total: np.ndarray) -> None:
    """Input moment with friction from the one without it and the reduced moment of friction, into `total`."""
    for k in range(total.shape[0]):
        total[k] = moment[k] - friction[k]


@scalar
def first_jammed(margin: np.ndarray, least: float) -> float:
    """Index of the first position where the margin against jamming is not more than the least; NaN if there is none.

    Positions where it is undefined don't count: they have another reason.
    """
    for k in range(margin.shape[0]):
        if margin[k] <= least:
            return float(k)
    return math.nan
