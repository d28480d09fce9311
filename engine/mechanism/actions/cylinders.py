"""Gas or liquid in cylinders as nodes: the pressure on a piston from the indicator diagram.

A cylinder follows one branch of its diagram throughout a panel, the branch in the panel's middle; panels end at dead
centres and where valves or ports open.
"""

import math
from collections.abc import Callable, Mapping

import numpy as np

from engine.graph.nodes import Node
from engine.laws.indicator_diagrams import (
    branch_pressure,
    compressor_branch,
    compressor_opening_travels,
    compressor_peak,
    flows_in,
    four_stroke_branch,
    line_pressure,
    pump_branch,
    two_stroke_branch,
)
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Characteristic, Grip, Load, load
from engine.scene.attachments import bearer_of

_COMPRESSOR = ("clearance", "suction", "discharge", "n_compression")
_ENGINE = ("intake", "exhaust", "peak")


def cylinder_load(kinematics: Kinematics, name: str) -> Load:
    """The force on the piston of the cylinder `name`, along the slide coordinate."""
    scene, graph, at = kinematics.scene, kinematics.graph, f"cylinders.{name}"
    cylinder = scene.cylinders[name]
    slide, piston = kinematics.slides[cylinder.piston], kinematics.links[cylinder.piston]
    from_head = -1.0 if cylinder.head == "high" else 1.0
    area = graph.derived(f"{at}.area", lambda n: from_head * piston_area(n[f"{at}.bore"]))
    gauge = Diagram(kinematics, name).pressure - graph.number(f"{at}.ambient")
    grip = Grip(cylinder.piston, piston.origin, piston.u, (bearer_of(scene, cylinder.piston), piston.origin))
    return load(name, Characteristic(area, gauge), grip, slide.v, cylinder.role)


def piston_area(bore: float | np.ndarray) -> float | np.ndarray:
    """Area of a piston with a bore [m]."""
    return math.pi / 4 * bore**2


class Diagram:
    """The indicator diagram of one cylinder.

    Attributes
    ----------
    travel, rate : Node
        Distance of the piston from its head-end dead centre, and its derivative in the input's direction of motion.
    stroke : Node
    pressure : Node
        Absolute pressure on the piston [Pa].
    flows_in : Node
        1 while gas or liquid flows in, else 0.
    """

    def __init__(self, kinematics: Kinematics, name: str) -> None:
        self.kinematics, self.graph, self.at = kinematics, kinematics.graph, f"cylinders.{name}"
        self.cylinder = kinematics.scene.cylinders[name]
        self.slide = kinematics.slides[self.cylinder.piston]
        d, v, _ = self.slide
        low, high = self.graph.found(d, v, "low"), self.graph.found(d, v, "high")
        self.stroke = high - low
        self.at_high = self.cylinder.head == "high"
        self.head = high if self.at_high else low
        self.travel = high - d if self.at_high else d - low
        self.rate = (-v if self.at_high else v) * input_sense(kinematics)
        self.graph.switches(self.slide.v, self.slide.a)
        branch, self.pressure = getattr(self, f"_{self.cylinder.type}")()
        self.flows_in = self.graph.held(self.graph.apply(flows_in, branch))

    def _compressor(self) -> tuple[Node, Node]:
        def opening(which: int) -> Callable[[Mapping], np.ndarray]:
            return lambda n: compressor_opening_travels(*self._values(n, *_COMPRESSOR, "n_expansion"))[which]

        # The pressure equals the line pressure when a valve opens, so it has a kink there, not a jump.
        shares = [self._opens_at(f"{valve} opens", opening(i)) for i, valve in enumerate(("discharge", "suction"))]
        branch = self.graph.apply(compressor_branch, self.travel, self.stroke, self.rate, *shares)
        peak = self.graph.derived(f"{self.at}.peak", lambda n: compressor_peak(*self._values(n, *_COMPRESSOR)))
        return self._along(branch, (*self._numbers("suction", "discharge"), peak), self.graph.one)

    def _pump(self) -> tuple[Node, Node]:
        branch = self.graph.apply(pump_branch, self.rate)
        pressure = self.graph.apply(line_pressure, branch, *self._numbers("suction", "discharge"))
        return branch, self.graph.held(pressure)

    def _four_stroke(self) -> tuple[Node, Node]:
        head_at = self.graph.found(*self.slide[:2], "high_at" if self.at_high else "low_at")
        turning = (head_at, *self._numbers("firing_angle"), input_sense(self.kinematics))
        branch = self.graph.apply(four_stroke_branch, self.rate, self.graph.q, *turning)
        return self._along(branch, tuple(self._numbers(*_ENGINE)), self.graph.one)

    def _two_stroke(self) -> tuple[Node, Node]:
        port = self._opens_at("port", lambda n: n[f"{self.at}.port"])
        branch = self.graph.apply(two_stroke_branch, self.travel, self.stroke, self.rate, port)
        return self._along(branch, tuple(self._numbers(*_ENGINE)), port)

    def _along(self, branch: Node, pressures: tuple[Node, Node, Node], port: Node) -> tuple[Node, Node]:
        """The branch, and the pressure along the held branch."""
        cylinder = (self.stroke, *self._numbers("clearance"), port)
        exponents = tuple(self._numbers("n_compression", "n_expansion"))
        held = self.graph.held(branch)
        return branch, self.graph.apply(branch_pressure, held, self.travel, cylinder, pressures, exponents)

    def _opens_at(self, key: str, share: Callable[[Mapping], float | np.ndarray]) -> Node:
        """Register the switching event of a valve or port; return its piston travel as a share of the stroke."""
        number = self.graph.derived(f"{self.at}.{key}", share)
        opening = number * self.stroke
        level = self.head - opening if self.at_high else self.head + opening
        self.graph.switches(self.slide.d, self.slide.v, level)
        return number

    def _numbers(self, *keys: str) -> list[Node]:
        return [self.graph.number(f"{self.at}.{key}") for key in keys]

    def _values(self, numbers: Mapping, *keys: str) -> list[float | np.ndarray]:
        return [numbers[f"{self.at}.{key}"] for key in keys]
