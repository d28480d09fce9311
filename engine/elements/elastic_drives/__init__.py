"""Transients of a drive with an elastic shaft and backlash: starts, sudden loads, impacts."""

from engine import on_use

__getattr__ = on_use(__name__)
