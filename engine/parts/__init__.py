"""Models of the parts of a scene, with their quantities, units and formulas."""

from engine import on_use

__getattr__ = on_use(__name__)
