"""Reactions of scenes as nodes, and their values."""

import numpy as np
from graph_values import GraphValues

from engine import Scene
from engine.graph.nodes import Graph
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.loads import Loads
from engine.mechanism.reactions import Reactions
from engine.scene.pairs import pairs
from engine.scene.structure.ordering import order


class ReactionValues:
    """Fields of the reactions of a scene, at any positions; the input moves uniformly."""

    def __init__(self, scene: dict | Scene) -> None:
        self.scene = scene if isinstance(scene, Scene) else Scene.model_validate(scene)
        self.graph, structure = Graph(), order(self.scene)
        self.kinematics = Kinematics(self.scene, structure, self.graph, frozenset())
        loads = Loads(self.scene, self.kinematics)
        self.reactions = Reactions(self.kinematics, structure, loads.terms, InputMotion.uniform(self.graph))
        self.values = GraphValues(self.scene, self.graph)

    def __call__(self, names: list[str], q: np.ndarray) -> dict[str, np.ndarray]:
        nodes = [self.reactions.variables[name] for name in names]
        # Laws compare numbers that are undefined where friction jams.
        with np.errstate(invalid="ignore"):
            return dict(zip(names, self.values(nodes, q), strict=True))

    def margins(self, q: np.ndarray) -> np.ndarray:
        """Least margin against jamming of all groups."""
        return np.min(self.values([s.margin for s in self.reactions.settlings.values()], q), axis=0)


def in_all_pairs(scene: dict, seed: int, most: float) -> dict:
    """A scene with friction in all of its pairs, some sliders long enough to tilt."""
    rng, friction = np.random.default_rng(seed), {}
    for i, pair in enumerate(pairs(Scene.model_validate(scene))):
        own = friction[f"f{i}"] = {"pair": pair.name, "coefficient": rng.uniform(0.2, 1) * most}
        if pair.kind == "revolute":
            own |= {"diameter": rng.uniform(0.02, 0.1)} | ({"contact": "worn in"} if i % 2 else {})
        elif i % 2:
            own["length"] = rng.uniform(0.1, 0.5)
    return {**scene, "friction": friction}
