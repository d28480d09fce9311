"""The register of quantities: each declared once, with its name, unit, meaning and expression."""

from engine import on_use

__getattr__ = on_use(__name__)
