"""Machine elements, alone or next to a mechanism: input models and laws."""

from engine import on_use

__getattr__ = on_use(__name__)
