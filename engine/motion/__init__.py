"""Actual motion of a machine: the equation of motion under its motors and loads, its regimes, its flywheel."""

from engine import on_use

__getattr__ = on_use(__name__)
