"""From a scene to its mathematics: kinematics, masses, loads, reactions, friction; and what may be asked."""

from engine import on_use

__getattr__ = on_use(__name__)
