"""True motion with a DC motor on the crank, in extended precision: runs and the motion that repeats itself.

I(φ) and the moment of the loads M(φ) are Legendre series on panels between the places where loads switch
(`closed_cycle`). In the energy form dE/dψ = M + k (ω₀ − ω), ω = √(2 E/I), ψ the angle turned, the energy at the 16
nodes of a panel is the integral of its right-hand side's own series: collocation, found by repeated integration until
nothing changes. Machines go side by side, panel by panel.
"""

from typing import NamedTuple

import numpy as np
from closed_cycle import NODES, TO_SERIES, TURN, Curve, Cycle, Panels, W, X, legendre_sum
from numpy.polynomial import legendre

from engine import Scene

REAL = np.longdouble
# From the begin of a panel to its nodes, of values at the nodes, for half a unit of length.
TO_NODES = legendre_sum(X[:, None], legendre.legint(TO_SERIES, lbnd=-1)[:, None, :])
MOST_ROUNDS, SAME = 60, 1e-19


class Path(Cycle):
    """Reduced inertia and moment of the loads over a cycle that begins at φ = 0."""

    def _breaks(self, grid: np.ndarray) -> np.ndarray:
        return np.unique(np.append(super()._breaks(grid), REAL(0)))

    def _resolve(self, count: int) -> float:
        dynamics = self._cut(count)
        self.inertia, self.moment = self.curve(dynamics.inertia), self.curve(dynamics.moment)
        return max(self.inertia.tail, self.moment.tail)


class Course(NamedTuple):
    """Motion over panels: angular speed at the nodes (panels, nodes, machines), energy and time at the end.

    `damping` is −∫ ∂M/∂E dψ, by which exponent disturbances of the energy decay.
    """

    omega: np.ndarray
    energy: np.ndarray
    time: np.ndarray
    damping: np.ndarray


class Driven:
    """Machines with a motor of the moment k (ω₀ − ω), panel by panel in the direction of motion.

    Attributes
    ----------
    length : ndarray (panels, machines)
        Of panels [rad]; 0 of those that a machine has fewer than others.
    inertia, moment : ndarray (degree, panels, machines)
        Legendre series of I [kg·m²], flywheel included, and of the moment of the loads [N·m], driving if positive.
    slope, top : ndarray (machines,)
        k [N·m·s] and ω₀ [rad/s].
    """

    def __init__(self, paths: list[Path], flywheel: np.ndarray, slope: np.ndarray, top: np.ndarray) -> None:
        most, count = max(path.panels.begin.size for path in paths), len(paths)
        self.length = np.zeros((most, count), REAL)
        self.inertia, self.moment = np.zeros((2, NODES, most, count), REAL)
        self.slope, self.top = REAL(slope), REAL(top)
        for i, path in enumerate(paths):
            backwards = path.numbers["input.speed"] < 0
            order, n = slice(None, None, -1 if backwards else 1), path.panels.begin.size
            # Legendre polynomials of odd degree are odd.
            mirror = REAL(-1 if backwards else 1) ** np.arange(NODES)[:, None]
            self.length[:n, i] = path.panels.length[order]
            self.inertia[:, :n, i] = (path.inertia.series * mirror)[:, order]
            self.moment[:, :n, i] = (path.moment.series * mirror * mirror[1])[:, order]
        self.inertia[0] += REAL(flywheel)
        self._at_nodes = [legendre_sum(X[:, None, None], rows[:, None]) for rows in (self.inertia, self.moment)]

    def cycle(self, energy: np.ndarray) -> Course:
        """One cycle from an energy at ψ = 0."""
        omegas, time, damping = [], 0 * energy, 0 * energy
        for h, inertia, moment in zip(self.length, *(np.moveaxis(rows, 1, 0) for rows in self._at_nodes), strict=True):
            half, here = h / 2, energy + 0 * inertia
            for _ in range(MOST_ROUNDS):
                omega = np.sqrt(2 * here / inertia)
                power = moment + self.slope * (self.top - omega)
                before, here = here, energy + half * (TO_NODES @ power)
                if abs(here - before).max() <= SAME * abs(here).max():
                    break
            omega = np.sqrt(2 * here / inertia)
            energy = energy + half * (W @ (moment + self.slope * (self.top - omega)))
            time = time + half * (W @ (1 / omega))
            damping = damping + half * (W @ (self.slope / (inertia * omega)))
            omegas.append(omega)
        return Course(np.stack(omegas), energy, time, damping)

    def start(self, omega: np.ndarray) -> np.ndarray:
        """Energy of a speed at ψ = 0."""
        return legendre_sum(REAL(-1), self.inertia[:, 0]) * omega**2 / 2

    def run(self, omega: np.ndarray, cycles: int) -> tuple[np.ndarray, np.ndarray]:
        """Speed and time after so many cycles."""
        energy, time = self.start(REAL(omega)), REAL(0)
        for _ in range(cycles):
            course = self.cycle(energy)
            energy, time = course.energy, time + course.time
        return np.sqrt(2 * energy / legendre_sum(REAL(-1), self.inertia[:, 0])), time

    def steady(self, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Coefficient of speed fluctuation, mean speed and multiplier of the motion that repeats itself.

        Newton's method on the energy that comes back after a cycle; `omega` is where to begin.
        """
        energy = self.start(REAL(omega))
        for _ in range(MOST_ROUNDS):
            course = self.cycle(energy)
            change = (course.energy - energy) / (1 - np.exp(-course.damping))
            energy = energy + change
            if abs(change / energy).max() < 1e-17:
                break
        course = self.cycle(energy)
        low, high = np.array([self._extremes(course.omega[:, :, i], self.length[:, i]) for i in range(energy.size)]).T
        return 2 * (high - low) / (high + low), TURN / course.time, np.exp(-course.damping)

    def _extremes(self, omega: np.ndarray, length: np.ndarray) -> tuple[np.longdouble, np.longdouble]:
        """Least and greatest speed, from its series on the panels of a machine."""
        n = np.count_nonzero(length)
        begin = np.concatenate(([REAL(0)], np.cumsum(length[: n - 1])))
        least, greatest = Curve.through(Panels(begin, length[:n], begin), omega[:n]).extremes()
        return least.value, greatest.value


def paths_of(scene: Scene, varied: dict[str, np.ndarray]) -> list[Path]:
    """Inertia and moment of machines; the motor and regimes of a scene are left out."""
    bare = scene.model_copy(update={"moments": {k: m for k, m in scene.moments.items() if m.type != "dc_motor"}})
    count = next(iter(varied.values())).size
    return [Path(bare, {path: float(values[i]) for path, values in varied.items()}) for i in range(count)]
