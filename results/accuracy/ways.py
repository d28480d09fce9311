"""Ways to integrate true motion with a DC motor, restated in NumPy for many machines side by side.

By equal steps that know of no jumps: in the energy form by the classical Runge-Kutta method and by two textbook rules,
and in time; by steps that an estimate of the error chooses.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from closed_run import Driven
from numpy.polynomial import legendre
from scipy.integrate import RK45

TURN, APART = 2 * np.pi, 8.0
FIRST_STEP = 0.05
# What an embedded method makes of a step's error: of order 5, with some safety, and not too much at once.
SAFETY, LEAST, MOST, NEGLIGIBLE = 0.9, 0.2, 5.0, 1e-10


class Motors(NamedTuple):
    """Of each machine: its flywheel's moment of inertia, k and ω₀ of its motor, its speed, that at which it starts."""

    flywheel: np.ndarray
    slope: np.ndarray
    top: np.ndarray
    speed: np.ndarray
    first: np.ndarray


class Sampled:
    """Machines in double precision at any angle turned, and a run of theirs over so many cycles."""

    def __init__(self, machines: Driven, motors: Motors, cycles: int) -> None:
        self.motors, self.cycles = motors, cycles
        self.slope, self.top = motors.slope, motors.top
        self.edges = np.concatenate(([0 * self.top], np.cumsum(machines.length, axis=0))).astype(float)
        # One after another, to be searched at once.
        self.apart = np.arange(self.top.size) * APART
        self.row = (self.edges + self.apart).T.ravel()
        self.length = machines.length.astype(float)
        self.series = [rows.astype(float) for rows in (machines.inertia, machines.moment)]

    def at(self, turned: np.ndarray, slope: bool = False) -> list[np.ndarray]:
        """I and M, or I, M and dI/dψ, at angles (places, machines)."""
        inside, columns = turned % (TURN), np.arange(self.top.size)
        panel = np.searchsorted(self.row, inside + self.apart, "right") - columns * self.edges.shape[0]
        # Panels that a machine doesn't have are of no length, at the end.
        panel = np.clip(panel - 1, 0, (self.length > 0).sum(axis=0) - 1)
        length = self.length[panel, columns]
        x = 2 * (inside - self.edges[panel, columns]) / length - 1
        rows = [series[:, panel, columns] for series in self.series]
        found = [legendre.legval(x, row, tensor=False) for row in rows]
        return [*found, legendre.legval(x, legendre.legder(rows[0]), tensor=False) * 2 / length] if slope else found

    def power(self, inertia: np.ndarray, moment: np.ndarray, energy: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """dE/dψ and dt/dψ; NaN where a step has gone too far and no energy is left."""
        with np.errstate(invalid="ignore"):
            omega = np.sqrt(2 * energy / inertia)
        return moment + self.slope * (self.top - omega), 1 / omega

    def start(self) -> np.ndarray:
        """Energy at the begin of the run."""
        inertia, _ = self.at(0 * self.top[None])
        return inertia[0] * self.motors.first**2 / 2


# Ways: each returns the speed and the time after the run


def over_tables(machines: Sampled, steps: int, step: Callable) -> tuple[np.ndarray, np.ndarray]:
    """By equal steps over a cycle, with I and M at nodes and middles."""
    h = TURN / steps
    inertia, moment = machines.at(np.arange(2 * steps)[:, None] * (h / 2) + 0 * machines.top)
    inertia, moment = (np.concatenate([rows, rows[:1]]) for rows in (inertia, moment))
    energy, taken = machines.start(), 0 * machines.top
    for _ in range(machines.cycles):
        for k in range(0, 2 * steps, 2):
            energy, more = step(machines, h, inertia[k : k + 3], moment[k : k + 3], energy)
            taken = taken + more
    return np.sqrt(2 * energy / inertia[0]), taken


def rk4_step(machines: Sampled, h: float, inertia: np.ndarray, moment: np.ndarray, energy: np.ndarray) -> tuple:
    """The classical Runge-Kutta method in the energy form."""
    p1, s1 = machines.power(inertia[0], moment[0], energy)
    p2, s2 = machines.power(inertia[1], moment[1], energy + h / 2 * p1)
    p3, s3 = machines.power(inertia[1], moment[1], energy + h / 2 * p2)
    p4, s4 = machines.power(inertia[2], moment[2], energy + h * p3)
    return energy + h / 6 * (p1 + 2 * p2 + 2 * p3 + p4), h / 6 * (s1 + 2 * s2 + 2 * s3 + s4)


def trapezoid_step(machines: Sampled, h: float, inertia: np.ndarray, moment: np.ndarray, energy: np.ndarray) -> tuple:
    """The trapezoid rule, the speed ahead first by the moment here."""
    p1, s1 = machines.power(inertia[0], moment[0], energy)
    p2, _ = machines.power(inertia[2], moment[2], energy + h * p1)
    after = energy + h / 2 * (p1 + p2)
    return after, h / 2 * (s1 + machines.power(inertia[2], moment[2], after)[1])


def frozen_step(machines: Sampled, h: float, inertia: np.ndarray, moment: np.ndarray, energy: np.ndarray) -> tuple:
    """I and M as at the begin of the step."""
    p, s = machines.power(inertia[0], moment[0], energy)
    after = energy + h * p
    return after, 2 * h / (1 / s + np.sqrt(2 * after / inertia[0]))


def in_time(machines: Sampled, steps: int) -> tuple[np.ndarray, np.ndarray]:
    """RK4 by equal steps in time, `steps` for a cycle at the machine's speed; the last one over the angle left."""
    dt, end = TURN / (machines.motors.speed * steps), machines.cycles * TURN
    state = np.stack([0 * dt, machines.motors.first, 0 * dt])
    while True:
        ahead = _rk4(machines, state, dt, over_angle=False)
        short = ahead[0] < end
        if not short.any():
            break
        state = np.where(short, ahead, state)
    state = _rk4(machines, state, end - state[0], over_angle=True)
    return state[1], state[2]


def _rk4(machines: Sampled, state: np.ndarray, h: np.ndarray, over_angle: bool) -> np.ndarray:
    """A step of angle, speed and time, in time or over the angle."""

    def slopes(at: np.ndarray) -> np.ndarray:
        turned, omega, _ = at
        inertia, moment, slope = (row[0] for row in machines.at(turned[None], slope=True))
        push = moment + machines.slope * (machines.top - omega) - omega**2 * slope / 2
        found = np.stack([omega, push / inertia, np.ones_like(omega)])
        return found / omega if over_angle else found

    k1 = slopes(state)
    k2 = slopes(state + h / 2 * k1)
    k3 = slopes(state + h / 2 * k2)
    return state + h / 6 * (k1 + 2 * k2 + 2 * k3 + slopes(state + h * k3))


def by_tolerance(machines: Sampled, tolerance: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Dormand and Prince's method of order 5 in the energy form, steps by tolerance; also tries a cycle."""
    end, state = machines.cycles * TURN, np.stack([machines.start(), 0 * machines.top])
    at, h, tries = 0 * machines.top, np.full_like(machines.top, FIRST_STEP), 0 * machines.top
    while (at < end).any():
        h, left = np.minimum(h, end - at), at < end
        ahead, gap = _dormand_prince(machines, at, h, state)
        size = abs(gap[0]) / (tolerance * abs(state[0])) + abs(gap[1]) * machines.motors.speed / tolerance
        # A try that goes too far is no success.
        size = np.where(np.isfinite(size), size, np.inf)
        good = left & (size <= 1)
        at, state = np.where(good, at + h, at), np.where(good, ahead, state)
        tries += left
        h = np.where(left, h * np.clip(SAFETY * np.maximum(size, NEGLIGIBLE) ** -0.2, LEAST, MOST), h)
    inertia, _ = machines.at(0 * at[None])
    return np.sqrt(2 * state[0] / inertia[0]), state[1], tries / machines.cycles


def _dormand_prince(machines: Sampled, at: np.ndarray, h: np.ndarray, state: np.ndarray) -> tuple:
    """Energy and time after a step over the angle, and estimates of their errors."""

    def slopes(turned: np.ndarray, state: np.ndarray) -> np.ndarray:
        inertia, moment = (row[0] for row in machines.at(turned[None]))
        return np.stack(machines.power(inertia, moment, state[0]))

    k = [slopes(at, state)]
    for shares, c in zip(RK45.A[1:], RK45.C[1:], strict=True):
        k.append(slopes(at + c * h, state + h * sum(a * s for a, s in zip(shares, k, strict=False))))
    ahead = state + h * sum(b * s for b, s in zip(RK45.B, k, strict=True))
    k.append(slopes(at + h, ahead))
    return ahead, h * sum(e * s for e, s in zip(RK45.E, k, strict=True))
