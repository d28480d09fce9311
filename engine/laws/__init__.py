"""Laws: scalar functions that read like a textbook's equations."""

from engine import on_use

__getattr__ = on_use(__name__)
