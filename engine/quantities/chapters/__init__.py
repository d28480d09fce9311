"""The chapters of the register, each with the quantities of one part of mechanics."""

from engine import on_use

__getattr__ = on_use(__name__)
