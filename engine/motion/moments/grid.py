"""Grids in crank angle for every variant, with a node at every break of the torques.

The steps over a cycle are equal except where a break divides one: their nodes are the requested positions.
"""

from typing import NamedTuple

import numpy as np

from engine.motion.moments.breaks import JUMP, Breaks

# The nodes among the places of a grid.
NODES = slice(None, None, 2)
# Steps up to this length are within a jump.
GAP = 4.0 * JUMP


class Grid(NamedTuple):
    """Nodes of one cycle in the direction of motion.

    Attributes
    ----------
    places : ndarray (2·steps + 1, variants)
        Crank angles of the nodes and of the midpoints between them [rad].
    steps : ndarray (steps, variants)
        Distances between nodes [rad].
    even : ndarray (equal steps + 1, variants) of int, or None
        Indices of the nodes of the equal steps; None if there are no others.
    """

    places: np.ndarray
    steps: np.ndarray
    even: np.ndarray | None


def make_grid(
    start: np.ndarray,
    length: float | np.ndarray,
    direction: np.ndarray,
    steps: int,
    cycle: float,
    breaks: Breaks,
) -> Grid:
    """Grid from a start angle over a length in the direction of motion.

    Parameters
    ----------
    start : ndarray (variants,)
        [rad].
    length : float or ndarray (variants,)
        [rad]; positive.
    direction : ndarray (variants,)
        +1 or −1.
    steps : int
        Number of equal steps.
    cycle : float
        Period of the breaks [rad].
    breaks : Breaks
    """
    share = np.arange(steps + 1)[:, None] / steps
    turned = share * np.broadcast_to(length, start.shape)
    even = None
    if breaks.jumps.size:
        every = np.concatenate((turned, _edges(start, length, direction, cycle, breaks)))
        order = np.argsort(every, axis=0, kind="stable")
        turned = np.take_along_axis(every, order, axis=0)
        even = np.argsort(order, axis=0, kind="stable")[: steps + 1]
    return Grid(start + direction * _with_middles(turned), np.diff(turned, axis=0), even)


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


def _edges(
    start: np.ndarray, length: float | np.ndarray, direction: np.ndarray, cycle: float, breaks: Breaks
) -> np.ndarray:
    """Angles turned at the breaks, on both sides of a jump; the whole length for a variant without a break."""
    turned = direction * (breaks.angles - start)
    turned = np.concatenate((turned - JUMP * breaks.jumps[:, None], turned[breaks.jumps] + JUMP))
    # For a jump at the start of the cycle, one side is at the end.
    turned = np.mod(turned, cycle)
    return np.where((turned > 0.0) & (turned < length), turned, length)


def _with_middles(turned: np.ndarray) -> np.ndarray:
    """Nodes and the midpoints between them."""
    places = np.empty((2 * turned.shape[0] - 1, turned.shape[1]))
    places[0::2], places[1::2] = turned, 0.5 * (turned[1:] + turned[:-1])
    # In the gap of a jump the new value applies from the midpoint on, as on a coarser grid whose midpoint is the end of
    # the gap.
    places[1::2] = np.where(np.diff(turned, axis=0) < GAP, turned[1:], places[1::2])
    return places
