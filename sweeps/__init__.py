"""Parameter studies of machines: sampling, execution, HDF5 results, plots, command line, mechanism synthesis.

The names in `__init__.pyi` are loaded on first use, so that the command line starts quickly.
"""

import sys
from importlib import import_module

from engine import door

__all__, __getattr__ = door(__file__, globals())

if "IPython" in sys.modules:
    # In a notebook the load time doesn't matter.
    import_module("sweeps.python.display").register()
