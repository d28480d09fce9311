"""The structure of a mechanism: input link, dyads, and groups of free links."""

from engine import on_use

__getattr__ = on_use(__name__)
