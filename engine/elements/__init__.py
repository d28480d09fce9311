"""Machine elements: models and laws of what needs no mechanism, or stands beside one."""

from engine import on_use

__getattr__ = on_use(__name__)
