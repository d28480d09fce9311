"""A grid in crank angle for every variant: equal steps over a cycle, and a node at every break of the moments."""

from typing import NamedTuple

import numpy as np

from engine.motion.breaks import Breaks

# Half the width of a jump [rad]: a node on either side. Beyond the rounding of the angle, and far below all else.
JUMP = 1e-10


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
        extra = np.mod(direction * (breaks.angles - start), cycle)
        extra = np.concatenate((extra - JUMP * breaks.jumps[:, None], extra[breaks.jumps] + JUMP))
        # A variant without this break gets a step of no length instead.
        extra = np.where((extra > 0.0) & (extra < length), extra, length)
        every = np.concatenate((turned, extra))
        order = np.argsort(every, axis=0, kind="stable")
        turned = np.take_along_axis(every, order, axis=0)
        even = np.argsort(order, axis=0, kind="stable")[: steps + 1]
    between = 0.5 * (turned[1:] + turned[:-1])
    places = np.empty((2 * turned.shape[0] - 1, start.size))
    places[0::2], places[1::2] = turned, between
    return Grid(start + direction * places, np.diff(turned, axis=0), even)
