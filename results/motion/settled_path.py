"""True motion under an induction motor in extended precision: runs and steady running.

I(φ) and the moment of the loads M(φ) are Legendre series on panels between the positions where loads switch
(`closed_cycle`). In the energy form dE/dψ = M + M_motor(ω), ω = √(2E/I), ψ the angle turned, the energy at the 16 nodes
of a panel is the integral of its right-hand side's own series: collocation, solved by Newton's method with slopes in
double precision. Panels are halved until the series of the energy has decayed.
"""

import sys
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

sys.path.append(str(Path(__file__).parents[1] / "accuracy"))
from closed_cycle import NODES, TO_SERIES, TURN, Curve, Cycle, Panels, W, X, legendre_sum

from engine import Scene

REAL = np.longdouble
# Integral from the start of a panel to its nodes, from values at the nodes, per half unit of length.
TO_NODES = legendre_sum(X[:, None], legendre.legint(TO_SERIES, lbnd=-1)[:, None, :])
MOST_ROUNDS, SAME, DECAYED, SHORTEST = 40, 1e-18, 1e-17, 1e-9
# Maximum number of pieces of a cycle.
MOST_PIECES = 500


class Path80(Cycle):
    """Reduced inertia and moment of the loads over a cycle from φ = 0, without motors and regimes."""

    def __init__(self, scene: Scene, varied: dict[str, float]) -> None:
        bare = {k: m for k, m in scene.moments.items() if m.type != "induction_motor"}
        super().__init__(scene.model_copy(update={"moments": bare}), varied)

    def _breaks(self, grid: np.ndarray) -> np.ndarray:
        return np.unique(np.append(super()._breaks(grid), REAL(0)))

    def _resolve(self, count: int) -> float:
        dynamics = self._cut(count)
        self.inertia, self.moment = self.curve(dynamics.inertia), self.curve(dynamics.moment)
        return max(self.inertia.tail, self.moment.tail)


class Piece(NamedTuple):
    """A solved panel: its length, speed and motor torque at its nodes, ∂M/∂E there, energy at its end."""

    length: np.longdouble
    omega: np.ndarray
    motor: np.ndarray
    slope: np.ndarray
    end: np.longdouble


class UnderMotor:
    """A machine with an induction motor by Kloss on its crank.

    Parameters
    ----------
    path : Path80
    wheel : float
        Inertia of the flywheel [kg·m²].
    breakdown, slip, synchronous : float
        Of the motor: breakdown torque [N·m], breakdown slip, synchronous speed [rad/s].
    """

    def __init__(self, path: Path80, wheel: float, breakdown: float, slip: float, synchronous: float) -> None:
        self.breakdown, self.slip, self.synchronous = REAL(breakdown), REAL(slip), REAL(synchronous)
        backwards = path.numbers["input.speed"] < 0
        order = slice(None, None, -1 if backwards else 1)
        # Legendre polynomials of odd degree are odd; a driving moment is positive.
        mirror = REAL(-1 if backwards else 1) ** np.arange(NODES)[:, None]
        self.lengths = path.panels.length[order]
        self.inertia = (path.inertia.series * mirror)[:, order].copy()
        self.moment = (path.moment.series * mirror * mirror[1])[:, order]
        self.inertia[0] += REAL(wheel)

    def _motor(self, omega: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Motor torque and its derivative by the speed."""
        s, b = 1 - omega / self.synchronous, self.slip
        below = s * s + b * b
        rise = 2 * self.breakdown * b * (b * b - s * s) / below**2
        return 2 * self.breakdown * b * s / below, -rise / self.synchronous

    def _piece(self, k: int, begin: np.longdouble, end: np.longdouble, energy: np.longdouble) -> Piece | None:
        """The part of a panel between two local positions, −1 … 1; None if it must be halved."""
        x, length = begin + (end - begin) * (X + 1) / 2, self.lengths[k] * (end - begin) / 2
        inertia, moment = (legendre_sum(x, rows[:, k, None]) for rows in (self.inertia, self.moment))
        here, half = np.full(NODES, energy), length / 2
        for _ in range(MOST_ROUNDS):
            if not (here > 0).all():
                return None
            omega = np.sqrt(2 * here / inertia)
            motor, by_speed = self._motor(omega)
            slope = by_speed / (inertia * omega)
            off = energy + half * (TO_NODES @ (moment + motor)) - here
            matrix = np.eye(NODES) - np.asarray(half * TO_NODES * slope, float)
            change = np.linalg.solve(matrix, np.asarray(off, float))
            here = here + change
            if abs(change).max() <= SAME * abs(here).max():
                break
        else:
            return None
        series = abs(TO_SERIES @ here)
        if series[-2:].max() > DECAYED * series.max() and length > SHORTEST:
            return None
        return Piece(length, omega, motor, slope, energy + half * (W @ (moment + motor)))

    def cycle(self, energy: np.longdouble) -> list[Piece]:
        """One cycle from an energy at ψ = 0."""
        found, tried = [], 0
        for k in range(self.lengths.size):
            pending = [(REAL(-1), REAL(1))]
            while pending:
                begin, end = pending.pop()
                piece, tried = self._piece(k, begin, end, energy), tried + 1
                if tried > 2 * MOST_PIECES:
                    raise ArithmeticError("the cycle isn't resolved")
                if piece is None:
                    middle = (begin + end) / 2
                    pending += [(middle, end), (begin, middle)]
                    continue
                found.append(piece)
                energy = piece.end
        return found

    def energy_at(self, omega: float) -> np.longdouble:
        """Energy of a speed at ψ = 0."""
        return legendre_sum(REAL(-1), self.inertia[:, 0]) * REAL(omega) ** 2 / 2

    def run(self, omega: float, cycles: int) -> dict[str, np.longdouble]:
        """Speed and time after a number of cycles from a speed, by the engine's names."""
        energy, time = self.energy_at(omega), REAL(0)
        for _ in range(cycles):
            pieces = self.cycle(energy)
            energy, time = pieces[-1].end, time + sum(p.length / 2 * (W @ (1 / p.omega)) for p in pieces)
        return {"final_speed": np.sqrt(2 * energy / legendre_sum(REAL(-1), self.inertia[:, 0])), "time": time}

    def steady(self, omega: float) -> dict[str, np.longdouble]:
        """Steady running, by the engine's names; `omega` is the start of Newton's method."""
        energy = self.energy_at(omega)
        for _ in range(MOST_ROUNDS):
            pieces = self.cycle(energy)
            exponent = sum(p.length / 2 * (W @ p.slope) for p in pieces)
            change = (pieces[-1].end - energy) / (1 - np.exp(exponent))
            energy = energy + change
            if abs(change / energy) < 1e-17:
                break
        else:
            raise ArithmeticError("the cycle doesn't close")
        pieces = self.cycle(energy)
        lengths = np.array([p.length for p in pieces])
        begins = np.concatenate(([REAL(0)], np.cumsum(lengths[:-1])))
        least, greatest = Curve.through(Panels(begins, lengths), np.array([p.omega for p in pieces])).extremes()

        def integral(row: list[np.ndarray]) -> np.longdouble:
            return sum(p.length / 2 * (W @ values) for p, values in zip(pieces, row, strict=True))

        low, high, time = least.value, greatest.value, integral([1 / p.omega for p in pieces])
        return {
            "speed_fluctuation": 2 * (high - low) / (high + low),
            "speed_min": low,
            "speed_max": high,
            "mean_speed": TURN / time,
            "multiplier": np.exp(integral([p.slope for p in pieces])),
            "motor_moment_rms": np.sqrt(integral([p.motor**2 / p.omega for p in pieces]) / time),
        }
