"""A machine on an elastic shaft, under a governor, or exciting a torsional train."""

from engine import on_use

__getattr__ = on_use(__name__)
