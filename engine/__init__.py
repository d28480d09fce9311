"""Planar machines: kinematics, reduced inertia and moments, flywheels; one variant or millions, with error figures."""

from engine.accuracy import AccurateMachine
from engine.elements_alone import ElementsAlone, made_ready
from engine.machine import Machine
from engine.outcome import AskError, Outcome
from engine.quantities import Quantity
from engine.scene import Scene, SceneError, scene_numbers
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
