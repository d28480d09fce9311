"""What commands need of other rooms, each module loaded with the first use of one of its names.

The names in `__init__.pyi` aren't kept: commands start quickly, and each use finds what its module has then.
"""

from engine import door

__all__, __getattr__ = door(__file__, {"__name__": __name__})
