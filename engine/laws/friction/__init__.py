"""Friction in the pairs of a machine: slides, journals, screws, wedges, rollers and belts, as scalar functions."""

from engine import on_use

__getattr__ = on_use(__name__)
