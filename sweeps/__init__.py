"""Studies over machines: sampling, execution, HDF5 results, pictures, command line.

The names below are loaded when they are first used, so that the command line starts quickly.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sweeps.results import Result
    from sweeps.runner import run_study
    from sweeps.scenefile import read_scene, write_scene
    from sweeps.store import StoreError, read
    from sweeps.study import Study, read_study
    from sweeps.textfile import InputError

_HOMES = {
    "InputError": "sweeps.textfile",
    "Result": "sweeps.results",
    "StoreError": "sweeps.store",
    "Study": "sweeps.study",
    "read": "sweeps.store",
    "read_scene": "sweeps.scenefile",
    "read_study": "sweeps.study",
    "run_study": "sweeps.runner",
    "write_scene": "sweeps.scenefile",
}

__all__ = [
    "InputError",
    "Result",
    "StoreError",
    "Study",
    "read",
    "read_scene",
    "read_study",
    "run_study",
    "write_scene",
]


def __getattr__(name: str) -> object:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'sweeps' has no attribute {name!r}")
