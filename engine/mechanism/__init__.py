"""From a scene to its graph: kinematics, masses, loads, reactions and friction, each as nodes."""

from engine import on_use

__getattr__ = on_use(__name__)
