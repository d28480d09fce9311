"""Guides of the frame: rails on both sides of a slider, with the head and valves of a cylinder."""

from collections.abc import Iterator
from functools import lru_cache
from itertools import combinations
from typing import NamedTuple

import numpy as np

from sweeps.pictures.drawing.motion import DrawnMotion, Slider
from sweeps.pictures.drawing.symbols import HALF_HEIGHT, HATCH_STEP, Primitive, half_length, hatched, line

# In hinge radii: maximum half height of a block, gap between rail and links, shortest hatching, margin beyond strokes.
MOST_HALF, CLEAR, SHORTEST, MARGIN = 8.0, 0.6, 3.0, 2.0
# Step between the nodes of the motion that are checked; cells of a rail per hinge radius.
EVERY, CELLS = 4, 4
# Of a cylinder, in hinge radii: gap between piston and head, length of a valve's stem, half its width.
DEAD_SPACE, STEM, HALF_VALVE = 1.4, 2.6, 0.9


class Rails(NamedTuple):
    """Guide of a slider: half the height between its rails, and its figures."""

    half: float
    figures: tuple[Primitive, ...]


@lru_cache(64)
def rails_of(m: DrawnMotion, slider: Slider) -> Rails:
    """Rails of a slider on a guide of the frame.

    They are far enough apart for links that pass between them. Where links still cross a rail, it isn't hatched.

    Parameters
    ----------
    m : DrawnMotion
    slider : Slider
    """
    r, (low, high) = m.radius, m.range_of(slider.link)
    place, u = (complex(values[0]) for values in m.guides[slider.guide])
    base = place + 1j * slider.offset * u
    heads = {cylinder.head for cylinder in m.scene.cylinders.values() if cylinder.piston == slider.link}
    ends = [
        end + side * r * (half_length(slider.link) + (DEAD_SPACE if name in heads else MARGIN))
        for name, end, side in (("low", low, -1), ("high", high, 1))
    ]
    passing = (_passing(m, slider) - base) / u
    needed = [_reach(passing, ends, side) + CLEAR * r for side in (1, -1)]
    half = max([HALF_HEIGHT * r, *(reach for reach in needed if reach <= MOST_HALF * r)])
    found: list[Primitive] = []
    for side in (1, -1):
        rail = base + 1j * side * half * u
        for a, b in _free(passing, ends, side, half, r):
            # The frame is on the right of its line.
            *strokes, _ = hatched(*(rail + x * u for x in ((b, a) if side > 0 else (a, b))), r)
            found += strokes
        found.append(line(*(rail + x * u for x in ends), layer="frame"))
    for name, end, side in (("low", ends[0], -1), ("high", ends[1], 1)):
        if name in heads:
            found += _head(base + end * u, side * u, half, r)
    return Rails(half, tuple(found))


def _passing(m: DrawnMotion, slider: Slider) -> np.ndarray:
    """Lines of all other links over the motion, complex (nodes · lines, 2)."""
    found = [np.empty((0, 2), complex)]
    for link in m.links[:-1]:
        if link != slider.link:
            rows = [m.axes[link][0], *(m.points[name] for name in m.members(link))]
            found += [np.stack(pair, axis=1)[::EVERY] for pair in combinations(rows, 2)]
    lines = np.concatenate(found)
    return lines[np.isfinite(lines).all(axis=1)]


def _within(lines: np.ndarray, low: float, high: float) -> tuple[np.ndarray, np.ndarray]:
    """Lowest and highest imaginary part, between two real parts, of each line that passes there."""
    x, y = lines.real, lines.imag
    there = (x.max(axis=1) > low) & (x.min(axis=1) < high)
    x, y = x[there], y[there]
    steps = np.where(np.ptp(x, axis=1) > 0, np.diff(x, axis=1)[:, 0], 1.0)
    shares = np.where(np.ptp(x, axis=1)[:, None] > 0, (np.clip(x, low, high) - x[:, :1]) / steps[:, None], [[0.0, 1.0]])
    ends = y[:, :1] + shares * np.diff(y, axis=1)
    return ends.min(axis=1), ends.max(axis=1)


def _reach(passing: np.ndarray, ends: list[float], side: int) -> float:
    """How far links reach to a side of a guide between its ends."""
    low, high = _within(passing, *ends)
    return float(np.max(high if side > 0 else -low, initial=0.0))


def _free(passing: np.ndarray, ends: list[float], side: int, half: float, r: float) -> Iterator[tuple[float, float]]:
    """Stretches of a rail that no link passes, hatching included."""
    turned = -1j * side * passing
    # With real and imaginary parts exchanged: where along the guide do links cross the rail?
    low, high = _within(turned, half - 0.2 * r, half + HATCH_STEP * r)
    count = max(2, round(CELLS * (ends[1] - ends[0]) / r))
    edges = np.linspace(*ends, count + 1)
    first, last = (-high, -low) if side > 0 else (low, high)
    covered = np.zeros(count + 1)
    np.add.at(covered, np.searchsorted(edges[1:], first - CLEAR * r).clip(max=count), 1)
    np.add.at(covered, np.searchsorted(edges[:-1], last + CLEAR * r).clip(max=count), -1)
    free = np.append(np.cumsum(covered)[:count] <= 0, False)
    changes = np.flatnonzero(np.diff(np.concatenate([[False], free])))
    for a, b in zip(changes[::2], changes[1::2], strict=True):
        if edges[b] - edges[a] > SHORTEST * r:
            yield float(edges[a]), float(edges[b])


def _head(at: complex, out: complex, half: float, r: float) -> list[Primitive]:
    """Head of a cylinder with two valves."""
    across = 1j * out
    found = list(hatched(at - half * across, at + half * across, r))
    for side in (1, -1):
        seat = at + side * 0.5 * half * across
        found.append(line(seat - HALF_VALVE * r * across, seat + HALF_VALVE * r * across))
        found.append(line(seat, seat + STEM * r * out, layer="frame"))
    return found
