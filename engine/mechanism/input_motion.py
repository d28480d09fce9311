"""Motion of the input at a position: at the scene's constant speed, or at any speed and acceleration."""

import math
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Graph, Node, Number
from engine.laws.elementary import direction_of, power
from engine.mechanism.vectors import Vector
from engine.scene.scene import Scene


def input_span(scene: Scene, graph: Graph) -> tuple[Number, Number]:
    """First and last position of the input [rad, or m for a sliding input]."""
    drive = scene.input
    if drive.turns_fully:
        full = math.tau * drive.revolutions
        return graph.derived("first position", lambda n: 0.0), graph.derived("last position", lambda n: full)
    return graph.number("input.start"), graph.number("input.stop")


class InputMotion(NamedTuple):
    """Motion of the input at a position.

    Attributes
    ----------
    square, epsilon : Node
        Square of the speed, and acceleration.
    speed : Node
        Magnitude of the speed.
    given : bool
        Whether the speed differs from the scene's. Coefficients of loads then refer to unit speed, otherwise to the
        scene's speed.
    """

    square: Node
    epsilon: Node
    speed: Node
    given: bool = True

    @classmethod
    def uniform(cls, graph: Graph) -> "InputMotion":
        """The motion at the scene's constant speed."""
        square = graph.derived("square of the input's speed", lambda n: n["input.speed"] ** 2)
        speed = graph.derived("magnitude of the input's speed", lambda n: np.abs(n["input.speed"]))
        return cls(square, graph.zero, speed, given=False)

    def power(self, order: float | str) -> Node:
        """Power of the speed by which the coefficient of a load is multiplied.

        Parameters
        ----------
        order : int, float or str
            The exponent, or its path in the scene.
        """
        graph = self.speed.graph
        if not self.given or order == 0:
            return graph.one
        if order in (1, 2):
            return self.speed if order == 1 else self.square
        return graph.apply(power, self.speed, graph.number(order) if isinstance(order, str) else order)

    def acceleration(self, second: Node | Vector, first: Node | Vector) -> Node | Vector:
        """Acceleration ω² r″ + ε r′ of a point or an angle from its transfer functions r″ and r′."""
        return self.square * second + self.epsilon * first


def multiple_angle(graph: Graph, n: int, revolutions: int = 1) -> tuple[Node, Node]:
    """Cosine and sine of n times the crank angle over a number of revolutions.

    Parameters
    ----------
    graph : Graph
    n : int
        At least 1.
    revolutions : int
    """
    cosine, sine = graph.cos_q, graph.sin_q
    if revolutions != 1:
        cosine, sine = graph.apply(direction_of, graph.q * (1.0 / revolutions))
    c, s = cosine, sine
    for _ in range(n - 1):
        c, s = c * cosine - s * sine, s * cosine + c * sine
    return c, s
