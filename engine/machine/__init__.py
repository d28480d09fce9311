"""Machines: evaluation of the quantities of a scene for sets of variants."""

from engine import on_use

__getattr__ = on_use(__name__)
