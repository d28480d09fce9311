"""Grids in crank angle for every variant, with a node at every break of the torques.

The steps over a cycle are equal except where a break divides one: their nodes are the requested positions.
"""

from typing import NamedTuple

import numpy as np

from engine.motion.moments.breaks import JUMP, Breaks

# Steps up to this length are within a jump.
GAP = 4.0 * JUMP


class Grid(NamedTuple):
    """Nodes of one cycle in the direction of motion.

    Attributes
    ----------
    angles : ndarray (steps + 1, variants)
        Crank angles of the nodes [rad].
    steps : ndarray (steps, variants)
        Distances between nodes [rad].
    """

    angles: np.ndarray
    steps: np.ndarray


def make_grid(start: np.ndarray, direction: np.ndarray, steps: int, cycle: float, breaks: Breaks) -> Grid:
    """Grid over a cycle from a start angle in the direction of motion.

    There are nodes on both sides of every break: a force may jump where its torque has only a kink, as at a dead
    centre, where the velocity is zero.

    Parameters
    ----------
    start : ndarray (variants,)
        [rad].
    direction : ndarray (variants,)
        +1 or −1.
    steps : int
        Number of equal steps.
    cycle : float
        [rad].
    breaks : Breaks
    """
    share, at_breaks = np.arange(steps + 1)[:, None] / steps, direction * (breaks.angles - start)
    # For a break at the start of the cycle, one side is at the end.
    sides = np.mod(np.concatenate((at_breaks - JUMP, at_breaks + JUMP)), cycle)
    # A variant without this break gets the end of the cycle again.
    sides = np.where(sides > 0.0, sides, cycle)
    every = np.concatenate((share * np.full(start.shape, cycle), sides))
    turned = np.sort(every, axis=0)
    return Grid(start + direction * turned, np.diff(turned, axis=0))


def edges_of(
    direction: np.ndarray,
    breaks: Breaks,
    cycle: float,
    begin: float | np.ndarray = 0.0,
    bounds: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Angles turned at jumps and kinks of torques, with both ends of the cycle or of the range, ascending.

    Parameters
    ----------
    direction : ndarray (variants,)
        +1 or −1.
    breaks : Breaks
    cycle : float
        [rad].
    begin : float or ndarray (variants,)
        Crank angle at which the angle turned is 0 [rad].
    bounds : ndarray (2, variants), optional
        Angles turned at the ends of the range of an input without a cycle.

    Returns
    -------
    edges, sides : ndarray (edges, variants)
        The angles, and the offset from each at which torques are evaluated, at most to the middle of an interval [rad].
    """
    count = direction.size
    if bounds is not None:
        turned = np.nan_to_num(direction * (breaks.angles - begin), nan=np.inf)
        edges = np.concatenate((bounds[:1], np.sort(np.clip(turned, *bounds), axis=0), bounds[1:]))
        return edges, np.where((edges > bounds[0]) & (edges < bounds[1]), JUMP, 0.0)
    turned = np.nan_to_num(np.mod(direction * (breaks.angles - begin), cycle), nan=cycle)
    # Rounding may move a break across the start.
    at_begin = ((turned <= GAP) | (turned >= cycle - GAP)) & ~np.isnan(breaks.angles)
    ends = np.where(at_begin.any(axis=0), JUMP, 0.0)
    edges = np.concatenate((np.zeros((1, count)), np.sort(turned, axis=0), np.full((1, count), cycle)))
    sides = np.where((edges > 0.0) & (edges < cycle), JUMP, ends)
    return edges, sides
