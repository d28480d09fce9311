"""Verdicts on machines that fail: where, by which group, under which condition."""

from engine import on_use

__getattr__ = on_use(__name__)
