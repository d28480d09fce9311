"""What a machine is: its parts, units, names, and their structural order."""

from engine import on_use

__getattr__ = on_use(__name__)
