"""Public names of sweeps: the one list, for type checkers, editors and the lazy loader."""

from sweeps.imports.foreign_scene import import_scene
from sweeps.optimising.search_runner import optimise_study
from sweeps.python.datasets import read, to_dataframe, to_xarray
from sweeps.python.display import to_html
from sweeps.python.plots import plot_diagrams, plot_fields, plot_history, plot_mechanism, plot_sweep
from sweeps.report.readings import readings_at
from sweeps.report.readings_in_time import readings_in_time
from sweeps.report.sweep_result import SweepResult
from sweeps.run.runner import run_study
from sweeps.store import StoreError
from sweeps.study.study import Study
from sweeps.study.study_reader import read_study
from sweeps.synthesis.dyads import PlaneDyad, PlanePosition, dyad_of_centre, dyad_of_circle, dyads_of_turn
from sweeps.synthesis.paths import PathFourBar, four_bar_along
from sweeps.synthesis.positioned import PositionedFourBar, best_four_bar_through, four_bar_through
from sweeps.synthesis.quick_return import (
    QuickCrankRocker,
    QuickLever,
    QuickSliderCrank,
    quick_crank_rocker,
    quick_lever,
    quick_return_angle,
    quick_slider_crank,
)
from sweeps.synthesis.synthesis_error import SynthesisError
from sweeps.text.input_files import InputError
from sweeps.text.scene_text import read_scene, write_scene

__all__ = [
    "InputError",
    "PathFourBar",
    "PlaneDyad",
    "PlanePosition",
    "PositionedFourBar",
    "QuickCrankRocker",
    "QuickLever",
    "QuickSliderCrank",
    "StoreError",
    "Study",
    "SweepResult",
    "SynthesisError",
    "best_four_bar_through",
    "dyad_of_centre",
    "dyad_of_circle",
    "dyads_of_turn",
    "four_bar_along",
    "four_bar_through",
    "import_scene",
    "optimise_study",
    "plot_diagrams",
    "plot_fields",
    "plot_history",
    "plot_mechanism",
    "plot_sweep",
    "quick_crank_rocker",
    "quick_lever",
    "quick_return_angle",
    "quick_slider_crank",
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
__version__: str
