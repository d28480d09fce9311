"""Planar machines: kinematics, reduced inertia and moments, flywheels; one variant or millions, with error figures."""

from engine.elements.elements_alone import ElementsAlone, made_ready
from engine.machine.machine import Machine
from engine.machine.quantities.quantities import Quantity
from engine.machine.results import AskError, Outcome
from engine.panels.accuracy import AccurateMachine
from engine.scene.scene import Scene, SceneError, scene_numbers
from engine.verdicts import SENTENCES, Verdict

__all__ = [
    "SENTENCES",
    "AccurateMachine",
    "AskError",
    "ElementsAlone",
    "Machine",
    "Outcome",
    "Quantity",
    "Scene",
    "SceneError",
    "Verdict",
    "made_ready",
    "scene_numbers",
]
