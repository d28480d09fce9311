"""Machine elements without a mechanism or separate from it: input models and laws."""

from engine import on_use

__getattr__ = on_use(__name__)
