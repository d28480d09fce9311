"""The formula language: expressions, their names, dimensions and switching."""

from engine import on_use

__getattr__ = on_use(__name__)
