"""Flywheel sizes of several variants of one shape side by side, without a row of any of them.

A pass over the rows of one variant waits for memory: the bases of its shape are more than the nearest cache holds.
Here each position's bases are read once for many variants, and what is kept of a variant are its extremes so far.
Positions go in pairs: the first of each is also a position of every second.
"""

import math

import numpy as np

from engine.compiling.jit import scalar
from engine.equal_positions.flywheel import NO_EXTREMES, energy_slopes, sizes, widened
from engine.equal_positions.rows import is_finite, larger, second_difference

# Variants side by side; what is kept of them fills a third of the nearest cache.
LANES = 128
# Instructions work on at most eight numbers: lanes are filled up to a multiple of it.
VECTOR = 8

# What is kept of each variant, (KEPT, LANES): extremes at all positions, extremes at every second one, the greatest
# bend of the energy, the energies of the two positions before, and the slopes ½ω_min², ½ω², ½ω_max².
WHOLE, HALF, BEND, BEFORE, LAST, SLOPES, KEPT = 0, 7, 14, 15, 16, 17, 20


@scalar
def room_for_lanes(loads: int) -> np.ndarray:
    """Room for what is kept of each lane and for a number of its loads, (KEPT + loads, LANES).

    Rows begin with a line of the cache: a vector that lies across two of them is read twice.
    """
    room = np.empty((KEPT + loads, LANES + VECTOR))
    start = -(room.ctypes.data // room.itemsize) % VECTOR
    return room[:, start : start + LANES]


@scalar
def whole_vectors(count: int) -> int:
    """Least number of lanes, in whole vectors, for a number of variants."""
    return (count + VECTOR - 1) // VECTOR * VECTOR


@scalar
def begin_cycle(
    kept: np.ndarray,
    lane: int,
    omega: float,
    delta: float,
    work_before: float,
    inertia_before: float,
    work_last: float,
    inertia_last: float,
) -> None:
    """Make a lane ready for a cycle.

    Parameters
    ----------
    kept : ndarray (KEPT, LANES)
    lane : int
    omega, delta : float
        As for `flywheel_sizes`.
    work_before, inertia_before, work_last, inertia_last : float
        W [J] and I [kg·m²] at the last position but one and at the last: those before the first.
    """
    slow, middle, fast = energy_slopes(omega, delta)
    kept[SLOPES, lane], kept[SLOPES + 1, lane], kept[SLOPES + 2, lane] = slow, middle, fast
    keep_extremes(kept, WHOLE, lane, NO_EXTREMES)
    keep_extremes(kept, HALF, lane, NO_EXTREMES)
    kept[BEND, lane] = 0.0
    kept[BEFORE, lane] = work_before - middle * inertia_before
    kept[LAST, lane] = work_last - middle * inertia_last


@scalar
def kept_extremes(kept: np.ndarray, part: int, lane: int) -> tuple[float, float, float, float, float, float, float]:
    """Extremes of a lane so far; `part` is WHOLE or HALF."""
    low, high, low_middle = kept[part, lane], kept[part + 1, lane], kept[part + 2, lane]
    high_middle, bottom, top = kept[part + 3, lane], kept[part + 4, lane], kept[part + 5, lane]
    return low, high, low_middle, high_middle, bottom, top, kept[part + 6, lane]


@scalar
def keep_extremes(kept: np.ndarray, part: int, lane: int, extremes: tuple) -> None:
    """Keep the extremes of a lane."""
    low, high, low_middle, high_middle, bottom, top, total = extremes
    kept[part, lane], kept[part + 1, lane], kept[part + 2, lane] = low, high, low_middle
    kept[part + 3, lane], kept[part + 4, lane], kept[part + 5, lane] = high_middle, bottom, top
    kept[part + 6, lane] = total


@scalar
def two_positions(
    kept: np.ndarray, lane: int, work: float, inertia: float, work_after: float, inertia_after: float, work_half: float
) -> None:
    """Let a lane see a pair of positions.

    Parameters
    ----------
    kept : ndarray (KEPT, LANES)
    lane : int
    work, inertia : float
        W [J] and I [kg·m²] at the first of the pair.
    work_after, inertia_after : float
        The same at the second.
    work_half : float
        W at the first, summed over every second position.
    """
    slow, middle, fast = kept[SLOPES, lane], kept[SLOPES + 1, lane], kept[SLOPES + 2, lane]
    halved = widened(kept_extremes(kept, HALF, lane), work_half, inertia, slow, middle, fast)
    keep_extremes(kept, HALF, lane, halved)
    extremes = widened(kept_extremes(kept, WHOLE, lane), work, inertia, slow, middle, fast)
    keep_extremes(kept, WHOLE, lane, widened(extremes, work_after, inertia_after, slow, middle, fast))
    before, last = kept[BEFORE, lane], kept[LAST, lane]
    energy, energy_after = work - middle * inertia, work_after - middle * inertia_after
    bend = larger(abs(second_difference(before, last, energy)), abs(second_difference(last, energy, energy_after)))
    kept[BEND, lane] = larger(kept[BEND, lane], bend)
    kept[BEFORE, lane], kept[LAST, lane] = energy, energy_after


@scalar
def sizes_of_lane(
    kept: np.ndarray, part: int, lane: int, omega: float, delta: float, first_kind: float
) -> tuple[float, float, float, float]:
    """Sizes of a lane's flywheel after the cycle, as `flywheel_sizes` gives them."""
    return sizes(kept_extremes(kept, part, lane), omega, delta, first_kind)


@scalar
def missed_by_lane(kept: np.ndarray, lane: int) -> float:
    """How far an extreme of a lane's energy may be missed, as `missed_extreme` gives it."""
    return 0.125 * kept[BEND, lane] if is_finite(kept[WHOLE + 6, lane]) else math.nan
