"""Gas or liquid in cylinders as nodes: the pressure on a piston, by the indicator diagram.

Which curve of its diagram a cylinder follows in the middle of a panel it follows throughout it; panels end at dead
centres and where valves or ports open.
"""

import math
from collections.abc import Callable, Mapping

import numpy as np

from engine.equal_positions.strokes import four_stroke_number
from engine.graph.nodes import Node
from engine.laws.indicator_diagrams import four_stroke_engine, polytropic_compressor, pump, two_stroke_engine
from engine.laws.loads import acts_in_direction
from engine.mechanism.acting import Characteristic, Grip, Load, load
from engine.mechanism.characteristics import sense_of_input
from engine.mechanism.kinematics import Kinematics
from engine.scene.pairs import bearer_of


def cylinder_load(kinematics: Kinematics, name: str) -> Load:
    """The force on a piston along its slide coordinate.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        Of the cylinder.
    """
    scene, graph, at = kinematics.scene, kinematics.graph, f"cylinders.{name}"
    cylinder = scene.cylinders[name]
    slide, piston = kinematics.slides[cylinder.piston], kinematics.links[cylinder.piston]
    from_head = -1.0 if cylinder.head == "high" else 1.0
    area = graph.derived(f"{at}.area", lambda n: from_head * math.pi / 4 * n[f"{at}.bore"] ** 2, "load")
    gauge = _Diagram(kinematics, name).pressure() - graph.number(f"{at}.ambient")
    bearer = bearer_of(scene, cylinder.piston), piston.origin
    grip = Grip(cylinder.piston, piston.origin, piston.u, bearer)
    return load(name, Characteristic(area, gauge), grip, slide.v, cylinder.role)


class _Diagram:
    """The indicator diagram of one cylinder."""

    def __init__(self, kinematics: Kinematics, name: str) -> None:
        self.kinematics, self.graph = kinematics, kinematics.graph
        self.cylinder, self.at = kinematics.scene.cylinders[name], f"cylinders.{name}"
        self.slide = kinematics.slides[self.cylinder.piston]
        d, v, _ = self.slide
        low, high = self.graph.found(d, v, "low"), self.graph.found(d, v, "high")
        self.stroke = high - low
        self.at_high = self.cylinder.head == "high"
        self.travel = high - d if self.at_high else d - low
        self.head = high if self.at_high else low
        self.graph.switches(v, self.slide.a)

    def pressure(self) -> Node:
        """Absolute pressure on the piston [Pa]."""
        return getattr(self, f"_{self.cylinder.type}")()

    def _numbers(self, *keys: str) -> list[Node]:
        return [self.graph.number(f"{self.at}.{key}") for key in keys]

    def _toward_head(self) -> Node:
        """1 while the piston moves towards the head, else 0; not held yet."""
        sense = (1.0 if self.at_high else -1.0) * sense_of_input(self.kinematics)
        return self.graph.apply(acts_in_direction, sense, self.slide.v)

    def _gas(self) -> list[Node]:
        return [self.travel, self.stroke, *self._numbers("clearance")]

    def _opens_at(self, share: str, travel: Callable[[Mapping], float | np.ndarray]) -> None:
        """Say that a valve or port opens at a travel, a share of the stroke."""
        opening = self.graph.derived(f"{self.at} {share}", travel) * self.stroke
        level = self.head - opening if self.at_high else self.head + opening
        self.graph.switches(self.slide.d, self.slide.v, level)

    def _compressor(self) -> Node:
        at = self.at

        def ratio(n: Mapping) -> float | np.ndarray:
            return n[f"{at}.discharge"] / n[f"{at}.suction"]

        def discharge(n: Mapping) -> float | np.ndarray:
            least = n[f"{at}.clearance"]
            return (1.0 + least) * ratio(n) ** (-1.0 / n[f"{at}.n_compression"]) - least

        def suction(n: Mapping) -> float | np.ndarray:
            least = n[f"{at}.clearance"]
            # Where the discharge pressure isn't reached, the expansion begins at the pressure that is.
            reached = np.minimum(ratio(n), ((1.0 + least) / least) ** n[f"{at}.n_compression"])
            return least * reached ** (1.0 / n[f"{at}.n_expansion"]) - least

        self._opens_at("discharge valve", discharge)
        self._opens_at("suction valve", suction)
        toward = self.graph.held(self._toward_head())
        lines = self._numbers("suction", "discharge", "n_compression", "n_expansion")
        return self.graph.apply(polytropic_compressor, *self._gas(), toward, *lines)

    def _four_stroke(self) -> Node:
        forward, d, v = sense_of_input(self.kinematics), self.slide.d, self.slide.v
        head_at = self.graph.found(d, v, "high_at" if self.at_high else "low_at")
        number = self.graph.apply(
            four_stroke_number,
            head_at,
            *self._numbers("firing_angle"),
            forward,
            self.graph.q,
            self._toward_head(),
        )
        return self.graph.apply(four_stroke_engine, *self._gas(), self.graph.held(number), *self._pressures())

    def _two_stroke(self) -> Node:
        port = f"{self.at}.port"
        self._opens_at("port", lambda n: n[port])
        number = self.graph.held(self._toward_head())
        return self.graph.apply(two_stroke_engine, *self._gas(), number, *self._pressures(), *self._numbers("port"))

    def _pressures(self) -> list[Node]:
        return self._numbers("intake", "exhaust", "peak", "n_compression", "n_expansion")

    def _pump(self) -> Node:
        return self.graph.held(self.graph.apply(pump, self._toward_head(), *self._numbers("suction", "discharge")))
