"""Measurement of the requested quantities on the cycle of every variant, and of fields at equal positions."""

from engine import on_use

__getattr__ = on_use(__name__)
