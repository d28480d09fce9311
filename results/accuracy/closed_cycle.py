"""True summaries of a cycle: extremes, means, work and flywheels from Legendre series on the pieces between breaks.

The cycle is cut where a load switches, and further into panels until the Legendre series of degree 15 of every field
on every panel has decayed to rounding; values at the nodes come from closed formulas in extended precision. Extremes,
integrals and the flywheel's equations are then exact operations on polynomials.
"""

from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from closed_forces import Dynamics, Ends, Loads
from closed_motion import Motion, numbers_of
from numpy.polynomial import legendre
from taylor import PI, Series

from engine import Scene
from engine.scene.pairs import pairs

NODES = 16
FIRST_PANELS, MOST_PANELS = 20, 600
GRID = 1440
# Legendre coefficients that remain at degree 15, relative to the largest of the field.
RESOLVED, SMALL = 1e-15, 1e-9
# Extremes that differ by less than this, relative to the range, are one extreme at several positions.
EQUAL = 1e-9
TURN = 2 * PI


def legendre_sum(x: np.ndarray, series: np.ndarray) -> np.ndarray:
    """Σ cₖ Pₖ(x) by Clenshaw's recurrence; NumPy's has its factors in double precision."""
    one = np.longdouble(1)
    above, here = (series[-1] + x) * 0, series[-1] + x * 0
    for k in range(series.shape[0] - 2, -1, -1):
        here, above = series[k] + (2 * k + 1) * one / (k + 1) * x * here - (k + 1) * one / (k + 2) * above, here
    return here


def _gauss() -> tuple[np.ndarray, np.ndarray]:
    """Nodes and weights in extended precision: those of double precision, improved by Newton's method."""
    x, top = legendre.leggauss(NODES)[0].astype(np.longdouble), np.eye(NODES + 1, dtype=np.longdouble)[-1]
    slope = legendre.legder(top)
    for _ in range(3):
        x = x - legendre_sum(x, top) / legendre_sum(x, slope)
    return x, 2 / ((1 - x * x) * legendre_sum(x, slope) ** 2)


X, W = _gauss()
TO_SERIES = np.stack(
    [(2 * k + 1) * W * legendre_sum(X, np.eye(NODES, dtype=np.longdouble)[k]) / 2 for k in range(NODES)]
)


class Panels(NamedTuple):
    """Panels of a cycle: starts and lengths."""

    begin: np.ndarray
    length: np.ndarray

    @property
    def nodes(self) -> np.ndarray:
        """Angles of the nodes, (panels, nodes)."""
        return self.begin[:, None] + self.length[:, None] * (X + 1) / 2


class Curve:
    """A field over the cycle as Legendre series, coefficients (degree, panels)."""

    def __init__(self, panels: Panels, series: np.ndarray) -> None:
        self.panels, self.series = panels, series

    @classmethod
    def through(cls, panels: Panels, values: np.ndarray) -> "Curve":
        """The curve through values at the panels' nodes."""
        return cls(panels, TO_SERIES @ values.T)

    def integral(self) -> "Curve":
        """Integral from the start of the cycle, as a curve."""
        parts = legendre.legint(self.series, lbnd=-1) * (self.panels.length / 2)
        parts[0] += np.concatenate(([0], np.cumsum(parts.sum(axis=0))[:-1]))
        return Curve(self.panels, parts)

    @property
    def tail(self) -> float:
        """Largest coefficient at the last two degrees, relative to the largest of all panels."""
        size = np.abs(self.series)
        return float(size[-2:].max() / size.max())

    @property
    def total(self) -> np.longdouble:
        """Integral over the cycle."""
        return (self.series[0] * self.panels.length).sum()

    def plus(self, other: "Curve", factor: object) -> "Curve":
        """Sum with a multiple of another."""
        a, b = (np.pad(c.series, ((0, NODES + 2 - c.series.shape[0]), (0, 0))) for c in (self, other))
        return Curve(self.panels, a + factor * b)

    def at(self, panel: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Values at local positions, from −1 to 1, of panels."""
        return legendre_sum(x, self.series[:, panel])

    def on_nodes(self) -> np.ndarray:
        """Values at the panels' nodes."""
        return legendre_sum(X, self.series[:, :, None])

    def stationary(self) -> tuple[np.ndarray, np.ndarray]:
        """Panels and local positions of the ends of all panels and of all zeros of the derivative."""
        slope = legendre.legder(self.series)
        samples = np.linspace(-1, 1, NODES + 1).astype(np.longdouble)
        values = legendre_sum(samples, slope[:, :, None])
        panel, k = np.nonzero((values[:, :-1] > 0) != (values[:, 1:] > 0))
        low, high = samples[k], samples[k + 1]
        rising = values[panel, k] <= 0
        for _ in range(70):
            middle = (low + high) / 2
            left = (legendre_sum(middle, slope[:, panel]) > 0) == rising
            low, high = np.where(left, low, middle), np.where(left, middle, high)
        every = np.arange(self.series.shape[1])
        places = np.concatenate([(low + high) / 2, -np.ones(every.size), np.ones(every.size)])
        return np.concatenate([panel, every, every]), places

    def extremes(self) -> tuple["Extreme", "Extreme"]:
        """Minimum and maximum of the cycle."""
        panel, x = self.stationary()
        values = self.at(panel, x)
        begin, length = self.panels.begin[panel], self.panels.length[panel]
        angles = begin + length * (x + 1) / 2
        found = []
        for pick in (np.argmin, np.argmax):
            k = pick(values)
            tied = np.abs(values - values[k]) <= EQUAL * (values.max() - values.min())
            found.append(Extreme(values[k], angles[k], angles[tied]))
        return found[0], found[1]


class Extreme(NamedTuple):
    """An extreme value, its angle, and all angles at which the curve reaches it."""

    value: np.longdouble
    angle: np.longdouble
    ties: np.ndarray


def refined(function: Callable, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """Zeros of a series-valued function of angles between brackets, by Newton's method kept within them."""
    rising = function(low)[0] <= 0
    place = (low + high) / 2
    for _ in range(12):
        value = function(place)
        left = (value[0] > 0) == rising
        high, low = np.where(left, place, high), np.where(left, low, place)
        ahead = place - value[0] / value[1]
        inside = (ahead >= low) & (ahead <= high)
        place = np.where(inside, ahead, (low + high) / 2)
    return place


def stroke_ends(motion: Callable, sliders: Iterable[str], grid: np.ndarray) -> tuple[Ends, dict]:
    """Ends of all strokes, and the angles at which sliders are there; `motion` gives the motion at angles."""
    ends, places = {}, {}
    for name in sliders:

        def rate(angles: np.ndarray, name: str = name) -> Series:
            return motion(angles).slides[name].by_angle()

        v = rate(grid)[0]
        k = np.flatnonzero((v[:-1] > 0) != (v[1:] > 0))
        at = refined(rate, grid[k], grid[k + 1])
        d = motion(at).slides[name][0]
        ends[name] = d.min(), d.max()
        # A ram behind a rocker reaches the same dead centre twice in a turn.
        near = EQUAL * (d.max() - d.min())
        places[name] = at[d <= d.min() + near], at[d >= d.max() - near]
    return ends, places


class Field(NamedTuple):
    """A field or, for the magnitude of a vector, its square, which is smooth where the vector vanishes."""

    series: Series
    magnitude: bool = False


def fields_of(dynamics: Dynamics) -> dict[str, Field]:
    """Fields by the engine's names."""
    motion, speed = dynamics.motion, dynamics.numbers["input.speed"]
    found = {"reduced_inertia": dynamics.inertia, "reduced_inertia_phi": dynamics.slope}
    found |= {"reduced_moment": dynamics.moment, "input_moment": dynamics.input_moment}
    for group in dynamics.scene.groups.values():
        inner = getattr(group, "inner", None)
        if inner is not None:
            x, y = motion.points[inner]
            found |= {f"{inner}.x": x, f"{inner}.y_phi": y.by_angle(), f"{inner}.x_phiphi": x.by_angle().by_angle()}
        for side in (group.first, group.second):
            if side.link not in motion.slides and group.type != "RPP":
                rate = motion.links[side.link].rate
                found[f"{side.link}.angular_velocity"] = rate * speed
                found[f"{side.link}.angular_acceleration"] = rate.by_angle() * (speed * speed)
    for name, slide in motion.slides.items():
        found |= {f"{name}.slide": slide, f"{name}.velocity": slide.by_angle() * speed}
        found[f"{name}.acceleration"] = slide.by_angle().by_angle() * (speed * speed)
    found["shaking_force_x"] = dynamics.shaking.x
    magnitudes = {"shaking_force": dynamics.shaking.squared}
    for pair in pairs(dynamics.scene):
        force = dynamics.reactions[pair.name]
        if pair.kind == "prismatic":
            found[f"{pair.name}.reaction"] = force.along(motion.links[pair.link].way.left)
        else:
            magnitudes[f"{pair.name}.reaction"] = force.squared
            found[f"{pair.name}.reaction_x"] = force.x
    return {n: Field(f) for n, f in found.items()} | {n: Field(f, True) for n, f in magnitudes.items()}


class Cycle:
    """A machine's cycle at constant crank speed, cut into panels."""

    def __init__(self, scene: Scene, varied: dict[str, float]) -> None:
        self.scene, self.numbers = scene, numbers_of(scene, varied)
        grid = np.longdouble(0.1234567) + TURN * np.arange(GRID + 1) / GRID
        self.ends, self.ends_at = stroke_ends(self.motion, self.motion(grid[:1]).slides, grid)
        self.breaks = self._breaks(grid)
        count, before = FIRST_PANELS, np.inf
        while True:
            tail = self._resolve(count)
            # A small remainder that halving the panels doesn't reduce is rounding.
            if tail <= RESOLVED or (0.5 * before < tail < SMALL) or count > MOST_PANELS:
                break
            count, before = 2 * count, tail

    def motion(self, angles: np.ndarray) -> Motion:
        """Motion at some angles."""
        return Motion(self.scene, self.numbers, angles, 2)

    def _loads(self, angles: np.ndarray) -> Loads:
        return Loads(self.motion(angles), self.ends)

    def _breaks(self, grid: np.ndarray) -> np.ndarray:
        found = []
        for i, switch in enumerate(self._loads(grid).switches):
            k = np.flatnonzero((switch[0][:-1] > 0) != (switch[0][1:] > 0))
            if k.size:
                found.append(refined(lambda angles, i=i: self._loads(angles).switches[i], grid[k], grid[k + 1]))
        for moment in self.scene.moments.values():
            if moment.type == "table":
                found.append(np.array(moment.over_angle, np.longdouble))
        breaks = np.sort(np.concatenate(found) % TURN) if found else np.zeros(1, np.longdouble)
        # Two loads that switch at the same angle make one break.
        return breaks[np.concatenate(([True], np.diff(breaks) > 1e-13))]

    def _cut(self, count: int) -> Dynamics:
        """Cut the pieces into panels; returns the dynamics at their nodes."""
        ends = np.append(self.breaks, self.breaks[0] + TURN)
        begins, lengths = [], []
        for a, b in pairwise(ends):
            parts = max(int(np.ceil((b - a) * count / TURN)), 1)
            begins.append(a + (b - a) * np.arange(parts) / parts)
            lengths.append(np.full(parts, (b - a) / parts))
        self.panels = Panels(np.concatenate(begins), np.concatenate(lengths))
        return Dynamics(self.motion(self.panels.nodes.ravel()), self.ends)

    def _resolve(self, count: int) -> float:
        """Fields on a number of panels; returns the remainder of the series at their last degrees."""
        self.dynamics = self._cut(count)
        self.fields = fields_of(self.dynamics)
        self.curves = {name: self.curve(field.series) for name, field in self.fields.items()}
        return max(curve.tail for curve in self.curves.values())

    def curve(self, field: Series) -> Curve:
        """A field at the panels' nodes as a curve."""
        return Curve.through(self.panels, field[0].reshape(self.panels.nodes.shape))
