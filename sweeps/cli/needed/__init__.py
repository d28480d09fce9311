"""Names that commands need from other packages; each module is loaded on the first use of one of its names.

The names in `__init__.pyi` aren't cached: commands start quickly, and each use looks the name up in its module.
"""

from engine import door

__all__, __getattr__ = door(__file__, {"__name__": __name__})
