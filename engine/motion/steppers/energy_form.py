"""The equation of motion in the energy form, dE = M dφ, step by step over the nodes of a grid in crank angle.

With E = ½Iω² the equation I·ε + ½ω²·dI/dφ = M reads dE/dφ = M(φ, √(2E/I)): no derivative of I is needed, and a
machine without moments keeps its energy to the last bit. Time and works are integrals over φ of 1/ω and of the
moments, carried along by the same Runge–Kutta method of order four. Everything that depends on φ alone is tabulated
at the nodes and the middles between them and used again every cycle. `engine.motion.steppers.energy_lanes` makes the
steps.

Angles here are turned in the direction of motion, so ω > 0 and moments are positive where they drive.
"""

from enum import IntEnum
from typing import NamedTuple

import numpy as np

# Too near to rest for the energy form: where loads take so many times the energy per radian (1/ω is a root of the angle
# there, and no refinement helps), or more than this share of it in a step.
TIMES_PER_RADIAN = 4.0
SHARE_PER_STEP = 0.5

# Steps are stiff where an explicit method is about to become unstable, unless the moments at stake are too small to
# matter: then their differences are rounding.
STIFF_SHARE = 1e-9


class Tables(NamedTuple):
    """What depends on the crank angle, at the nodes and the middles between them: 2·steps + 1 places.

    Attributes
    ----------
    steps : ndarray (steps, variants)
        Lengths of the steps [rad].
    inertia : ndarray (places, variants)
        Reduced inertia with the flywheel [kg·m²].
    loads : ndarray (channels, 3, places, variants)
        Reduced moments over ω⁰, ω¹ and ω², separately for each sort of work; one channel for all if not asked.
    powers : ndarray (laws, places, variants)
        Reduced moments over ω to a power of their own.
    """

    steps: np.ndarray
    inertia: np.ndarray
    loads: np.ndarray
    powers: np.ndarray

    def some(self, chosen: np.ndarray) -> "Tables":
        """Tables of some of the variants, by index."""
        return Tables(*(np.ascontiguousarray(rows[..., chosen]) for rows in self))

    def at(self, places: np.ndarray | slice, columns: np.ndarray | slice = slice(None)) -> "Tables":
        """The tables at some of the places, of each variant at one of its own, or at the nodes with a slice.

        Parameters
        ----------
        places, columns : ndarray (variants,) of int, or slice
        """

        def picked(rows: np.ndarray) -> np.ndarray:
            rows = rows[..., places, columns]
            return rows if isinstance(places, slice) else rows[..., None, :]

        return Tables(self.steps, picked(self.inertia), picked(self.loads), picked(self.powers))


NODES = slice(None, None, 2)


class Stop(IntEnum):
    """Why a stretch of motion ended."""

    ANGLE = 0
    TIME = 1
    ABOVE = 2
    BELOW = 3
    NEAR_REST = 4
    STIFF = 5


ANGLE, TIME, ABOVE, BELOW, NEAR_REST, STIFF = (int(stop) for stop in Stop)


class Limits(NamedTuple):
    """Ends of a stretch, each (variants,): steps to make at most, time [s], speeds from below and above [rad/s].

    A speed `below` that is negative says that the stretch goes on as long as there is energy, near to rest as well.
    """

    steps: np.ndarray
    time: np.ndarray
    above: np.ndarray
    below: np.ndarray


class Course(NamedTuple):
    """State of each variant at a node, and what has gathered on the way; arrays (variants,) unless said.

    Attributes
    ----------
    energy, time : ndarray
        [J], [s].
    made : ndarray of int
        Steps made.
    stop : ndarray of int
        `Stop`: the next step would pass the end for this reason.
    works : ndarray (channels + 1, variants)
        Work of the motors and of each channel [J].
    slowest, fastest, peak : ndarray
        Least and greatest speed at nodes [rad/s], greatest moment of the motors by magnitude [N·m].
    squares : ndarray
        Integral of the motors' moment squared over time [N²·m²·s].
    """

    energy: np.ndarray
    time: np.ndarray
    made: np.ndarray
    stop: np.ndarray
    works: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray
    peak: np.ndarray
    squares: np.ndarray


def new_course(variants: int, channels: int) -> Course:
    """Memory for the courses of a number of variants."""
    numbers = (np.zeros(variants) for _ in range(4))
    counts = (np.zeros(variants, np.int64) for _ in range(2))
    return Course(np.zeros(variants), np.zeros(variants), *counts, np.zeros((channels + 1, variants)), *numbers)
