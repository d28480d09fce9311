"""Studies over machines: sampling, execution, HDF5 results, pictures, command line."""

from sweeps.results import Result
from sweeps.runner import run_study
from sweeps.scenefile import read_scene, write_scene
from sweeps.store import StoreError, read
from sweeps.study import Study, read_study
from sweeps.textfile import InputError

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
