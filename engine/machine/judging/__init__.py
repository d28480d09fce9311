"""Verdicts on machines that fail: where, and by which group."""

from engine import on_use

__getattr__ = on_use(__name__)
