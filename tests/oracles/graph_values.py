"""Values of a graph's nodes at any positions, for graphs that no machine is made of."""

from collections.abc import Mapping, Sequence

import numpy as np

from engine.cycle.one_variant import OneVariant
from engine.graph.nodes import Graph, Held, Node, reached
from engine.mechanism.input_motion import input_span
from engine.scene.scene import Numbers, Scene, scene_numbers


class GraphValues(OneVariant):
    """Values of nodes for one scene. Held nodes have the value of the position itself, unless others are given."""

    def __init__(self, scene: Scene, graph: Graph) -> None:
        turns = getattr(scene.input, "revolutions", 1)
        super().__init__(graph, Numbers(scene_numbers(scene), {}), input_span(scene, graph), turns)
        self.graph, (self.first, self.last) = graph, sorted((self.first, self.last))
        self.samples = np.linspace(self.first, self.last, 181)

    def __call__(
        self, nodes: Sequence[Node], q: np.ndarray, held: Mapping[Node, np.ndarray] | None = None
    ) -> list[np.ndarray]:
        return self.values(nodes, np.asarray(q, float), held)

    def in_panel(self, nodes: Sequence[Node], left: float, right: float, q: np.ndarray) -> list[np.ndarray]:
        """Values of nodes in a panel, what is held being that of its middle."""
        held = [n for n in reached(nodes) if isinstance(n, Held)]
        middle = self(held, np.array([0.5 * (left + right)]))
        return self(nodes, q, {node: value[0] for node, value in zip(held, middle, strict=True)})
