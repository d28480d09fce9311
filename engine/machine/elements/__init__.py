"""Machine elements, evaluated together with a machine or alone."""

from engine import on_use

__getattr__ = on_use(__name__)
