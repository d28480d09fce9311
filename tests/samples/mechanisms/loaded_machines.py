"""Machines with loads on all links, and the reactions to ask of them."""

import numpy as np

from engine import Scene
from engine.scene.pairs import pairs
from engine.scene.structure.ordering import order


def loaded(scene: dict, seed: int) -> dict:
    """A scene with a body and a force on every link, and moments on some."""
    rng = np.random.default_rng(seed)
    links = order(Scene.model_validate(scene)).links
    numbers = {"mass": (0.1, 3.0), "x": (-0.3, 0.3), "y": (-0.3, 0.3), "inertia": (0.01, 0.3)}
    scene = {**scene, "points": {**scene["points"]}, "gravity": 9.81, "bodies": {}, "forces": {}}
    for link in links:
        scene["bodies"][f"body_{link}"] = {"link": link, **{k: rng.uniform(*ends) for k, ends in numbers.items()}}
        scene["points"][f"on_{link}"] = {"link": link, "x": rng.uniform(-0.5, 0.5), "y": rng.uniform(-0.5, 0.5)}
        scene["forces"][f"force_{link}"] = {
            "type": "constant",
            "on": f"on_{link}",
            "angle": rng.uniform(-3, 3),
            "force": rng.uniform(-50, 50),
        }
    scene["moments"] = {"twist": {"type": "constant", "on": "crank", "moment": -3.0}} if "crank" in links else {}
    return scene


def asked(scene: Scene) -> list[str]:
    """Fields that the equations of Newton and Euler give, under the engine's names."""
    parts = {"revolute": ("reaction_x", "reaction_y"), "prismatic": ("reaction", "reaction_moment")}
    found = [f"{pair.name}.{part}" for pair in pairs(scene) for part in parts[pair.kind]]
    return [*found, "frame.reaction_x", "frame.reaction_y", "frame.reaction_moment", "input_moment_by_equilibrium"]
