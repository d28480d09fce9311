"""The register of quantities: each declared once, with its name, unit, words, and what it is computed from."""

from engine import on_use

__getattr__ = on_use(__name__)
