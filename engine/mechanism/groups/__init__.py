"""The structural groups: groups of free links, and the dyads, each assembled in the module of its type."""

from engine import on_use

__getattr__ = on_use(__name__)
