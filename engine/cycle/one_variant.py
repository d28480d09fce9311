"""The cycle of one variant in NumPy: curves at arbitrary positions, work and speed, without compiled code.

Panels are laid as in compiled cycles: cut where something switches, and halved until the series of all curves converge.
"""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from engine.cycle.panels.chebyshev import PLACES, POSITIONS, SHARES
from engine.cycle.panels.sampled import tails, tops
from engine.cycle.regula_falsi import regula_falsi
from engine.graph.nodes import Found, Graph, Held, Node, reached
from engine.graph.values import NodeValues

# Positions per turn, or over the range of a sliding input, at which switching functions are scanned.
_SCANNED = 180
# Minimum number of panels per turn, and maximum number of halvings.
_PANELS_PER_TURN, _HALVINGS = 6, 14
# A curve is rounding if it is rough over more than this share of the range after this many halvings, and if the last
# one left its series as rough as before.
_ROUNDING_FROM, _ROUNDING_OVER = 6, 0.1
# Tolerance of a series, relative to the curve's peak.
_TOLERANCE = 1e-11
# Newton's method for the speed fluctuation: maximum steps, relative last step, and largest δ, at which a machine stops.
_MOST_STEPS, _FOUND, _MOST = 40, 1e-12, 2.0


class WheelNumbers(NamedTuple):
    """A flywheel: its inertia [kg·m²], or the speed fluctuation it is designed for; None for the one not given."""

    inertia: float | None
    fluctuation: float | None


class Panels(NamedTuple):
    """Curves as Chebyshev series, panel by panel.

    Attributes
    ----------
    ends : ndarray (panels + 1,)
    series : ndarray (degree + 1, curves, panels)
        Coefficients over [−1, 1].
    """

    ends: np.ndarray
    series: np.ndarray

    def integrals(self) -> "Panels":
        """Integrals of the curves from the first position."""
        series = chebyshev.chebint(self.series, lbnd=-1) * (0.5 * np.diff(self.ends))
        whole = series.sum(axis=0)
        series[0] += np.cumsum(whole, axis=1) - whole
        return Panels(self.ends, series)

    def derivatives(self) -> "Panels":
        """Derivatives of the curves by the position."""
        return Panels(self.ends, chebyshev.chebder(self.series) / (0.5 * np.diff(self.ends)))

    def at(self, q: np.ndarray) -> np.ndarray:
        """Values of the curves (curves, positions) at positions."""
        panel = np.clip(np.searchsorted(self.ends, q, "right") - 1, 0, self.ends.size - 2)
        left, right = self.ends[panel], self.ends[panel + 1]
        return chebyshev.chebval((2.0 * q - left - right) / (right - left), self.series[:, :, panel], tensor=False)

    def greatest(self, curve: int) -> tuple[float, float]:
        """Maximum of a curve and its position."""
        values = chebyshev.chebval(PLACES, self.series[:, curve])
        found = tops(values, np.zeros(len(values)))
        k = int(np.argmax(found.values))
        left, right = self.ends[k], self.ends[k + 1]
        return float(found.values[k]), float(left + 0.5 * (right - left) * (1.0 + found.places[k]))


class WheelCycle(NamedTuple):
    """The steady cycle of a variant with a flywheel.

    Attributes
    ----------
    whole : Panels
        Work about the mean since the first position, and reduced inertia.
    wheel, exact : float
        Inertia of the flywheel, and the inertia for the required speed fluctuation, possibly negative; NaN if none is
        required.
    fluctuation, energy : float
        Coefficient of speed fluctuation, and kinetic energy at the first position; NaN if the machine would stop.
    """

    whole: Panels
    wheel: float
    exact: float
    fluctuation: float
    energy: float

    def speed(self, q: np.ndarray) -> np.ndarray:
        """Magnitude of the input's speed (positions,); NaN if the machine would stop within the cycle."""
        works, inertias = self.whole.at(q)
        with np.errstate(invalid="ignore"):
            return np.sqrt(2.0 * (self.energy + works) / (inertias + self.wheel))


class OneVariant:
    """A variant at arbitrary positions of its input.

    Parameters
    ----------
    graph : Graph
    numbers : mapping of path to float
    span : tuple of Node
        First and last position of the input.
    turns : int
        Turns of the input between them; 1 for a sliding input.
    """

    def __init__(self, graph: Graph, numbers: Mapping[str, float], span: tuple[Node, Node], turns: int) -> None:
        self.values = NodeValues(graph, numbers, self._extreme_of)
        self._graph, self._turns = graph, turns
        self.first, self.last = (float(self.number(end)) for end in span)
        self._turning_of: dict[Node, np.ndarray] = {}

    def number(self, node: Node) -> float:
        """Value of a number of the variant or of its cycle."""
        return float(self.values([node], np.zeros(1))[0][0])

    def _extreme_of(self, node: Found) -> float:
        """Minimum or maximum of a curve, or its position."""
        places = np.array([self.first, self.last, *self._turning_points(node.curve, node.rate)])
        values = self.values([node.curve], places)[0]
        at = (np.argmin if node.which.startswith("low") else np.argmax)(values)
        return places[at] if node.which.endswith("_at") else values[at]

    def _turning_points(self, curve: Node, rate: Node) -> np.ndarray:
        """Positions at which a curve turns."""
        if curve not in self._turning_of:
            self._turning_of[curve] = self.roots(rate)
        return self._turning_of[curve]

    def roots(self, curve: Node, levels: Sequence[float] = (0.0,), between: Sequence[float] = ()) -> np.ndarray:
        """Positions where a curve takes one of the levels; it must be monotone between scan positions and `between`."""
        scanned = np.linspace(self.first, self.last, _SCANNED * self._turns + 1)
        grid, levels = np.unique([*scanned, *between]), np.asarray(levels)
        above = self.values([curve], grid)[0] > levels[:, None]
        which, places = np.nonzero(above[:, 1:] != above[:, :-1])
        if not places.size:
            return np.zeros(0)
        return regula_falsi(lambda q: self.values([curve], q)[0] - levels[which], grid[places], grid[places + 1])

    def cuts(self, nodes: Sequence[Node]) -> np.ndarray:
        """Ends of the range, and positions at which nodes that `nodes` depend on switch."""
        behind = set(reached([node for node in reached(nodes) if isinstance(node, Held)]))
        levels: dict[tuple[Node, Node], list[float]] = {}
        for c in self._graph.crossings:
            if c.curve in behind:
                levels.setdefault((c.curve, c.rate), []).append(self.number(c.level) + c.offset)
        found = [self.roots(curve, some, self._turning_points(curve, rate)) for (curve, rate), some in levels.items()]
        return np.unique(np.concatenate([[self.first, self.last], *found]))

    def panels(self, nodes: Sequence[Node]) -> Panels:
        """Expand curves over the cycle in series."""
        whole = np.linspace(self.first, self.last, _PANELS_PER_TURN * self._turns + 1)
        kinks = [self.roots(curve) for curve in self._graph.kinks_behind(nodes)]
        ends = np.unique(np.concatenate([whole, self.cuts(nodes), *kinks]))
        held = [node for node in reached(nodes) if isinstance(node, Held)]
        pending, done = (ends[:-1], ends[1:]), []
        sizes, before = np.zeros(len(nodes)), np.full(len(nodes), np.inf)
        for halving in range(_HALVINGS):
            left, right = pending
            middle, half = 0.5 * (left + right), 0.5 * (right - left)
            q = (middle[:, None] + half[:, None] * PLACES).ravel()
            known = dict(zip(held, (np.repeat(v, POSITIONS) for v in self.values(held, middle)), strict=True))
            values = np.array(self.values(nodes, q, known)).reshape(len(nodes), left.size, POSITIONS)
            series = np.einsum("kj,cpj->kcp", SHARES, values)
            sizes = np.fmax(sizes, np.abs(values).max(axis=(1, 2)))
            ahead = tails(values)
            rows, remains = ahead > _TOLERANCE * sizes[:, None], ahead.max(axis=1)
            if halving >= _ROUNDING_FROM:
                wide = (rows * half).sum(axis=1) > _ROUNDING_OVER * np.ptp(ends) / 2.0
                rows[wide & (remains > 0.5 * before)] = False
            before = remains
            rough = rows.any(axis=0) & (halving < _HALVINGS - 1)
            done.append((left[~rough], right[~rough], series[:, :, ~rough]))
            if not rough.any():
                break
            pending = tuple(np.concatenate(p) for p in ((left[rough], middle[rough]), (middle[rough], right[rough])))
        left, right, series = (np.concatenate(parts, axis=-1) for parts in zip(*done, strict=True))
        order = np.argsort(left)
        return Panels(np.append(left[order], right[order[-1]]), series[:, :, order])

    def integral(self, curve: Node) -> float:
        """Integral of a curve over the range of the input."""
        return float(self.panels([curve]).integrals().at(np.array([self.last]))[0, 0])

    def slope(self, curve: Node, q: np.ndarray) -> np.ndarray:
        """Derivative of a curve (positions,) by the input."""
        return self.panels([curve]).derivatives().at(q)[0]

    def extreme(self, curve: Node, sense: str) -> float:
        """Minimum ("least") or maximum ("greatest") of a curve."""
        panels, sign = self.panels([curve]), -1.0 if sense == "least" else 1.0
        return sign * Panels(panels.ends, sign * panels.series).greatest(0)[0]

    def work(self, moment: Node, q: np.ndarray) -> np.ndarray:
        """Work of a moment about its mean (positions,), from the first position."""
        return _about_mean(self.panels([moment])).at(q)[0]

    def steady(self, moment: Node, inertia: Node, omega: float, flywheel: WheelNumbers) -> WheelCycle:
        """Steady cycle with a flywheel; see `engine.cycle.measures.fluctuation`.

        Parameters
        ----------
        moment, inertia : Node
            Reduced moment of everything but the driver, and reduced inertia.
        omega : float
            Mean speed [rad/s].
        flywheel : WheelNumbers
        """
        panels = self.panels([moment, inertia])
        work = _about_mean(panels)
        whole = Panels(
            panels.ends, np.stack([work.series[:, 0], np.pad(panels.series[:, 1], ((0, 1), (0, 0)))], axis=1)
        )
        first, square = float(whole.at(np.array([self.first]))[1, 0]), omega * omega

        def extreme(sign: float, delta: float) -> tuple[float, float]:
            """Extreme of W − ½ω² (I − I₁) at the maximum (1) or minimum (−1) speed, and I − I₁ there."""
            slope = 0.5 * square * (1.0 + 0.5 * sign * delta) ** 2
            series = sign * (whole.series[:, 0] - slope * whole.series[:, 1])
            value, at = Panels(whole.ends, series[:, None]).greatest(0)
            return sign * value + slope * first, float(whole.at(np.array([at]))[1, 0]) - first

        wheel, delta, exact = flywheel.inertia, flywheel.fluctuation, math.nan
        if delta is not None:
            exact = (extreme(1.0, delta)[0] - extreme(-1.0, delta)[0]) / (delta * square) - first
        if wheel is None:
            wheel = max(exact, 0.0)
        if flywheel.inertia is not None or wheel == 0.0:
            delta = 0.0
            for _ in range(_MOST_STEPS):
                (high, fast), (low, slow) = extreme(1.0, delta), extreme(-1.0, delta)
                turning = (1.0 + 0.5 * delta) * fast + (1.0 - 0.5 * delta) * slow
                step = (high - low - delta * square * (first + wheel)) / (square * (0.5 * turning + first + wheel))
                if delta == _MOST and step > 0.0:
                    return WheelCycle(whole, wheel, exact, math.nan, math.nan)
                delta, before = min(max(delta + step, 0.0), _MOST), delta
                if abs(delta - before) <= _FOUND * delta:
                    break
        energy = 0.5 * square * (1.0 + 0.5 * delta) ** 2 * (first + wheel) - extreme(1.0, delta)[0]
        return WheelCycle(whole, wheel, exact, delta, energy)


def _about_mean(panels: Panels) -> Panels:
    """Work of the first curve about its mean since the first position."""
    own = Panels(panels.ends, panels.series[:, :1])
    mean = own.integrals().at(panels.ends[-1:])[0, 0] / (panels.ends[-1] - panels.ends[0])
    series = own.series.copy()
    series[0] -= mean
    return Panels(panels.ends, series).integrals()
