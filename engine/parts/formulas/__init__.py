"""The language of formulas: expressions, their names, dimensions and switches."""

from engine import on_use

__getattr__ = on_use(__name__)
