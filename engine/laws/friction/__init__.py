"""Friction in the pairs of a machine: coefficients, inclined faces, feedback on reactions, losses between teeth."""

from engine import on_use

__getattr__ = on_use(__name__)
