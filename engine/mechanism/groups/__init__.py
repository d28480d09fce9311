"""The structural groups: those of free links, and the dyads, each put together in the file of its type."""

from engine import on_use

__getattr__ = on_use(__name__)
