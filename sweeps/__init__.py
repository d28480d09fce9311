"""Studies over machines: sampling, execution, HDF5 results, pictures, command line.

The names below are loaded when they are first used, so that the command line starts quickly.
"""

import sys
from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sweeps.imports.foreign_scene import import_scene
    from sweeps.python.datasets import read, to_dataframe, to_xarray
    from sweeps.python.display import to_html
    from sweeps.python.plots import plot_diagrams, plot_fields, plot_history, plot_mechanism, plot_sweep
    from sweeps.report.readings import readings_at, readings_in_time
    from sweeps.report.sweep_result import SweepResult
    from sweeps.run.runner import run_study
    from sweeps.store import StoreError
    from sweeps.study.study import Study
    from sweeps.study.study_reader import read_study
    from sweeps.text.input_files import InputError
    from sweeps.text.scene_text import read_scene, write_scene

_HOMES = {
    "InputError": "sweeps.text.toml_text",
    "SweepResult": "sweeps.report.sweep_result",
    "StoreError": "sweeps.store",
    "Study": "sweeps.study.study",
    "import_scene": "sweeps.imports.foreign_scene",
    "plot_diagrams": "sweeps.python.plots",
    "plot_fields": "sweeps.python.plots",
    "plot_history": "sweeps.python.plots",
    "plot_mechanism": "sweeps.python.plots",
    "plot_sweep": "sweeps.python.plots",
    "read": "sweeps.python.datasets",
    "readings_at": "sweeps.report.readings",
    "readings_in_time": "sweeps.report.readings",
    "read_scene": "sweeps.text.scene_text",
    "read_study": "sweeps.study.study_reader",
    "run_study": "sweeps.run.runner",
    "to_dataframe": "sweeps.python.datasets",
    "to_html": "sweeps.python.display",
    "to_xarray": "sweeps.python.datasets",
    "write_scene": "sweeps.text.scene_text",
}

__all__ = [
    "InputError",
    "StoreError",
    "Study",
    "SweepResult",
    "import_scene",
    "plot_diagrams",
    "plot_fields",
    "plot_history",
    "plot_mechanism",
    "plot_sweep",
    "read",
    "read_scene",
    "read_study",
    "readings_at",
    "readings_in_time",
    "run_study",
    "to_dataframe",
    "to_html",
    "to_xarray",
    "write_scene",
]


def __getattr__(name: str) -> object:
    if name == "__version__":
        return import_module("importlib.metadata").version("machine-sweeps")
    if name in _HOMES:
        return getattr(import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'sweeps' has no attribute {name!r}")


if "IPython" in sys.modules:
    # A notebook is at work: what is loaded here is slow beside a command, and nothing beside a notebook.
    import_module("sweeps.python.display").register()
