"""Nodes of each kind of action: magnitude, line of action, and switching events."""

from engine import on_use

__getattr__ = on_use(__name__)
