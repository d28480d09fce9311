"""Moments of inertia, inertia forces, replacement masses."""

from engine import on_use

__getattr__ = on_use(__name__)
