"""Grids in crank angle for every variant, with a node at every break of the moments.

The steps over a cycle are equal but where a break cuts one in two: the nodes are wanted positions.
"""

from typing import NamedTuple

import numpy as np

from engine.motion.moments.breaks import JUMP, Breaks

# Which of the places of a grid are its nodes.
NODES = slice(None, None, 2)
# A step that is no longer lies within a jump.
GAP = 4.0 * JUMP


class Grid(NamedTuple):
    """Nodes of one cycle in the direction of motion.

    Attributes
    ----------
    places : ndarray (2·steps + 1, variants)
        Crank angles of the nodes and the middles between them [rad].
    steps : ndarray (steps, variants)
        Distances of the nodes [rad].
    even : ndarray (equal steps + 1, variants) of int, or None
        Which nodes belong to the equal steps; None where all do.
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
        Equal steps.
    cycle : float
        The breaks come again after it [rad].
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
    """Angles turned where moments jump or bend, with begin and end of the cycle, or of the range, in order.

    Parameters
    ----------
    direction : ndarray (variants,)
        +1 or −1.
    breaks : Breaks
    cycle : float
        [rad].
    begin : float or ndarray (variants,)
        Crank angle that angles are turned from [rad].
    bounds : ndarray (2, variants), optional
        Angles turned at the ends of the range of an input without a cycle.

    Returns
    -------
    edges, sides : ndarray (edges, variants)
        The angles, and how far from each the moments are taken, but no farther than the middle to the next [rad].
    """
    count = direction.size
    if bounds is not None:
        turned = np.nan_to_num(direction * (breaks.angles - begin), nan=np.inf)
        edges = np.concatenate((bounds[:1], np.sort(np.clip(turned, *bounds), axis=0), bounds[1:]))
        return edges, np.where((edges > bounds[0]) & (edges < bounds[1]), JUMP, 0.0)
    turned = np.nan_to_num(np.mod(direction * (breaks.angles - begin), cycle), nan=cycle)
    # Rounding may put a break on the other side of the begin.
    at_begin = ((turned <= GAP) | (turned >= cycle - GAP)) & ~np.isnan(breaks.angles)
    ends = np.where(at_begin.any(axis=0), JUMP, 0.0)
    edges = np.concatenate((np.zeros((1, count)), np.sort(turned, axis=0), np.full((1, count), cycle)))
    sides = np.where((edges > 0.0) & (edges < cycle), JUMP, ends)
    return edges, sides


def _edges(
    start: np.ndarray, length: float | np.ndarray, direction: np.ndarray, cycle: float, breaks: Breaks
) -> np.ndarray:
    """Angles turned at the breaks, on both sides of a jump; for a variant without a break, the whole length."""
    turned = direction * (breaks.angles - start)
    turned = np.concatenate((turned - JUMP * breaks.jumps[:, None], turned[breaks.jumps] + JUMP))
    # Where the cycle begins with a jump, one side of it is at the very end.
    turned = np.mod(turned, cycle)
    return np.where((turned > 0.0) & (turned < length), turned, length)


def _with_middles(turned: np.ndarray) -> np.ndarray:
    """Nodes with the middles between them."""
    places = np.empty((2 * turned.shape[0] - 1, turned.shape[1]))
    places[0::2], places[1::2] = turned, 0.5 * (turned[1:] + turned[:-1])
    # In the gap of a jump the new value holds from the middle on, as it does where its end is a coarser grid's middle.
    places[1::2] = np.where(np.diff(turned, axis=0) < GAP, turned[1:], places[1::2])
    return places
