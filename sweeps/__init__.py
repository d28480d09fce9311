"""Studies over machines: sampling, execution, HDF5 results, pictures, command line; mechanisms from what is wanted.

The names in `__init__.pyi` are loaded when they are first used, so that the command line starts quickly.
"""

import sys
from importlib import import_module

from engine import door

__all__, __getattr__ = door(__file__, globals())

if "IPython" in sys.modules:
    # A notebook is at work: what is loaded here is slow beside a command, and nothing beside a notebook.
    import_module("sweeps.python.display").register()
