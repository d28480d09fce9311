"""The scene: parts, names and structural order of a machine."""

from engine import on_use

__getattr__ = on_use(__name__)
