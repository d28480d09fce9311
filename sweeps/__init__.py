"""Studies over machines: sampling, execution, HDF5 results, pictures, command line.

The names below are loaded when they are first used, so that the command line starts quickly.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sweeps.report.readings import readings_at, readings_in_time
    from sweeps.report.sweep_result import SweepResult
    from sweeps.run.runner import run_study
    from sweeps.store import StoreError, read
    from sweeps.study.study import Study, read_study
    from sweeps.text.input_files import InputError
    from sweeps.text.scene_text import read_scene, write_scene

_HOMES = {
    "InputError": "sweeps.text.toml_text",
    "SweepResult": "sweeps.report.sweep_result",
    "StoreError": "sweeps.store",
    "Study": "sweeps.study.study",
    "read": "sweeps.store",
    "readings_at": "sweeps.report.readings",
    "readings_in_time": "sweeps.report.readings",
    "read_scene": "sweeps.text.scene_text",
    "read_study": "sweeps.study.study",
    "run_study": "sweeps.run.runner",
    "write_scene": "sweeps.text.scene_text",
}

__all__ = [
    "InputError",
    "StoreError",
    "Study",
    "SweepResult",
    "read",
    "read_scene",
    "read_study",
    "readings_at",
    "readings_in_time",
    "run_study",
    "write_scene",
]


def __getattr__(name: str) -> object:
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'sweeps' has no attribute {name!r}")
