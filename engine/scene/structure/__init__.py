"""The structure of a mechanism: input link, dyads, and the groups that free links make up."""

from engine import on_use

__getattr__ = on_use(__name__)
