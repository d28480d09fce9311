"""Higher pairs inside a mechanism: cams that drive links of it."""

from engine import on_use

__getattr__ = on_use(__name__)
