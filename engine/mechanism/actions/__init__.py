"""What each kind of action of a scene adds to the graph: its size, where it acts along, what in it switches."""

from engine import on_use

__getattr__ = on_use(__name__)
