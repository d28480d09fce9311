"""Speed governors: characteristics, stability with the engine they govern, and what a change of load does."""

from engine import on_use

__getattr__ = on_use(__name__)
