"""What a scene may hold: models of its parts, with their quantities, units and formulas."""

from engine import on_use

__getattr__ = on_use(__name__)
