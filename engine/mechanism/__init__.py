"""Build the graph of a scene: kinematics, masses, loads, reactions and friction as nodes."""

from engine import on_use

__getattr__ = on_use(__name__)
