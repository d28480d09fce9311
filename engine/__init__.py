"""Planar machines: kinematics, reduced inertia and moments, flywheels; one variant or millions, with error figures."""

from engine.machine import AskError, Machine, Outcome
from engine.quantities import Quantity
from engine.scene import Scene, SceneError, scene_numbers
from engine.verdicts import SENTENCES, Verdict

__all__ = [
    "SENTENCES",
    "AskError",
    "Machine",
    "Outcome",
    "Quantity",
    "Scene",
    "SceneError",
    "Verdict",
    "scene_numbers",
]
