"""Speed governors: characteristics, stability with the governed engine, and response to a change of load."""

from engine import on_use

__getattr__ = on_use(__name__)
