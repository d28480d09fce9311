"""Flywheels and speed fluctuation of a cycle at a steady mean speed, from the works and the inertia measured on it.

With the work W about its mean, the reduced inertia I, the mean speed ω and the coefficient of fluctuation δ:

    excess work       J = (max W − min W) / (δ ω²)
    Merzalov          J = (max − min of W − ½ ω² I) / (δ ω²) − I_const
    Wittenbauer       J = (max of W − ½ ω_max² I − min of W − ½ ω_min² I) / (δ ω²) − I₁

The last is exact: the tangents to the diagram of energy over inertia at ω_max and ω_min.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on the choice of a flywheel.
"""

import dataclasses
from collections.abc import Hashable
from typing import Protocol

import numpy as np

from engine.cycle.measured import Measured, maximum, where
from engine.cycle.measures.extremes import BOTH, GREATEST, LEAST
from engine.graph.nodes import Node
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import SteadyCycle, Work

_OF_WORKS = ("excess_work", "flywheel_excess_work")


class CycleReadings(Protocol):
    """Measurements of the cycles of some variants."""

    def number(self, node: Node) -> Measured:
        """A per-variant number."""

    def first(self, curve: Node) -> Measured:
        """Value of a curve at the first position."""

    def knows(self, key: Hashable) -> bool:
        """Whether there is a result of this key."""

    def read(self, key: Hashable) -> Measured:
        """The result of a key: see `engine.machine.measuring.measured_cycles`."""


def without_result(steady: SteadyCycle) -> SteadyCycle:
    """The steady cycle without its `result`."""
    return dataclasses.replace(steady, result="")


class SteadyMeasurements:
    """Requirements of a steady cycle: works, extremes of works minus slope × inertia, the speed fluctuation."""

    def __init__(self, of: SteadyCycle, results: set[str], mechanics: Mechanics) -> None:
        self.of = of
        half_square = 0.5 * mechanics.speed_squared
        nothing = mechanics.graph.derived("flywheel used", lambda n: 0.0)
        self.speed_asked = "" in results
        others = {*_OF_WORKS, "flywheel_merzalov"}
        exact = "flywheel_wittenbauer" in results or (of.wheel is None and not results <= others)
        self.asks_works = bool(results & set(_OF_WORKS))
        self.slopes: dict[Node, tuple[int, str]] = {}
        if of.fluctuation is not None:
            # ½ω² at minimum, mean and maximum speed.
            slow, fast = 1.0 - 0.5 * of.fluctuation, 1.0 + 0.5 * of.fluctuation
            self.slow, self.middle, self.fast = half_square * slow * slow, half_square, half_square * fast * fast
            self.slopes |= {self.middle: (BOTH, "range")} if "flywheel_merzalov" in results else {}
            self.slopes |= {self.slow: (LEAST, "least"), self.fast: (GREATEST, "greatest")} if exact else {}
        asked = of.wheel is not None or of.fluctuation is not None
        moving = not results.isdisjoint({"", "speed_fluctuation", "speed_min", "speed_max"})
        self.wheel = (of.wheel or nothing) if asked and moving else None
        # A flywheel that is computed from the cycle, and whose fluctuation is requested.
        self.unknown_wheel = nothing if self.wheel is nothing else None
        self.numbers = [*self.slopes, of.speed, of.wheel or nothing, of.first_kind]
        self.numbers += [of.fluctuation] if of.fluctuation is not None else []

    def result(self, asked: SteadyCycle, of: CycleReadings) -> Measured:
        """A result of the cycle from its measurements."""
        speed, speed_squared = of.number(asked.speed), of.number(asked.speed) * of.number(asked.speed)
        if asked.result == "excess_work":
            return of.read(("range", Work(asked.moment)))
        if asked.fluctuation is not None:
            delta = of.number(asked.fluctuation)
            energy = delta * speed_squared
            if asked.result == "flywheel_excess_work":
                # The excess work over δ ω²: the whole reduced inertia, taken as constant.
                return of.read(("range", Work(asked.moment))) / energy
            if asked.result == "flywheel_merzalov":
                # The kinetic energy of the constant part of I changes by W − ½ ω² I, with the variable I.
                return of.read((self.of, self.middle)) / energy - of.number(asked.first_kind)
            if asked.wheel is None or asked.result == "flywheel_wittenbauer":
                first = of.first(asked.inertia)
                top = of.read((self.of, self.fast))
                bottom = of.read((self.of, self.slow))
                # Exact: the tangents to the diagram of energy over inertia at ω_max and ω_min.
                exact = (top - bottom) / energy - first
            if asked.result == "flywheel_wittenbauer":
                return exact
        wheel = of.number(asked.wheel) if asked.wheel is not None else maximum(exact, Measured(np.zeros(exact.shape)))
        if asked.result == "flywheel_used":
            return wheel
        if asked.wheel is None:
            # With the required flywheel the fluctuation is the required one; it decreases as the inertia increases.
            whole = first + wheel
            found = Measured(delta.value * np.ones(wheel.shape), delta.value * wheel.error / whole.value)
        if of.knows(self.of):
            computed = of.read(self.of)
            found = computed if asked.wheel is not None else where(wheel.value > 0.0, found, computed)
        if asked.result == "speed_fluctuation":
            return found
        half = 0.5 * found
        return abs(speed) * (1.0 - half if asked.result == "speed_min" else 1.0 + half)
