"""Plots as Matplotlib figures, without files or pyplot."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from matplotlib.figure import Figure

from engine import AskError, Outcome, Scene, check_scene, names_of, show_system
from sweeps.pictures.drawing import picture
from sweeps.pictures.machine.cycle_sheets import POSITIONS, field_curves
from sweeps.pictures.machine.diagrams import diagrams
from sweeps.pictures.machine.motion_diagrams import motion_sheets
from sweeps.pictures.picture_error import PictureError, need_mechanism
from sweeps.pictures.sweep.maps import plot_result
from sweeps.pictures.sweep.result_pictures import sweep_figure
from sweeps.pictures.sweep.sweep_data import SweepData
from sweeps.report.sweep_result import SweepResult
from sweeps.store import FieldAxis
from sweeps.text.scene_text import with_values

if TYPE_CHECKING:
    import xarray


def plot_mechanism(
    scene: Scene,
    at: float | Sequence[float] = (),
    paths: str | Sequence[str] = (),
    values: Mapping[str, float] | None = None,
    shown: str | Sequence[str] = (),
) -> Figure:
    """Draw a mechanism to scale.

    Parameters
    ----------
    scene : Scene
    at : float or sequence of float
        Crank angles [rad] or displacements of a sliding input [m]: the first in black, the others lightly. Default: the
        crank at 60°, a sliding input in mid-range.
    paths : str or sequence of str
        Points whose paths over the cycle are drawn dashed.
    values : mapping of path to float, optional
        Numbers (SI) that replace the scene's.
    shown : {"masses", "forces", "links", "scale"} or sequence of them
        Optional items.

    Raises
    ------
    AskError
        `scene` isn't one.
    PictureError
        The scene has no mechanism, a position can't be drawn, or a point of `paths` doesn't exist.
    """
    _show_units_of(scene)
    return picture(with_values(scene, values or {}), np.atleast_1d(at).tolist(), names_of(paths), names_of(shown))


def plot_diagrams(scene: Scene, values: Mapping[str, float] | None = None) -> Figure:
    """Diagrams of a machine over its cycle: reduced inertia and torque, work, energy loop, speed.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) that replace the scene's.

    Raises
    ------
    AskError
        `scene` isn't one.
    PictureError
        The scene has no mechanism, or the machine can't be computed.
    """
    _show_units_of(scene)
    need_mechanism(scene)
    return diagrams(with_values(scene, values or {}))


def plot_fields(scene: Scene, names: str | Sequence[str], x: str | None = None, positions: int = POSITIONS) -> Figure:
    """Fields of a machine in stacked panels, over its cycle or against another field.

    Parameters
    ----------
    scene : Scene
    names : str or sequence of str
        One to eight fields, such as "B.vx".
    x : str, optional
        Field on the x axis instead of the input position: "B.x" with "B.y" gives the path of B.
    positions : int

    Raises
    ------
    PictureError, AskError
        `scene` isn't one, has no mechanism or no such field, or a field has no finite values.
    """
    _show_units_of(scene)
    return field_curves(scene, names_of(names), x, positions)


def plot_history(scene: Scene) -> Figure:
    """Speed, torques, power, work and reactions of a machine through its regimes, against time.

    Parameters
    ----------
    scene : Scene
        With regimes.

    Raises
    ------
    AskError
        `scene` isn't one.
    PictureError
        The scene has no regimes.
    """
    _show_units_of(scene)
    if not scene.regimes:
        raise PictureError('the scene has no regimes: add [regimes.NAME] with type = "run" or "steady"')
    return next(motion_sheets(scene))[1]


def plot_sweep(
    result: "Path | str | xarray.Dataset", x: str | None = None, y: str | None = None, colour: str | None = None
) -> Figure:
    """Draw a sweep in the form that suits its design.

    A field as `y` gives a band, a multi-objective search its front, a grid of one axis curves, of two axes a map;
    else a scatter if `x` or `y` is given, or parallel coordinates.

    Parameters
    ----------
    result : Path, str or xarray.Dataset
        A result file, or a dataset over variants from `to_xarray`.
    x, y, colour : str, optional
        Columns to show instead of the defaults.

    Raises
    ------
    AskError
        It is an outcome.
    PictureError
        No such column, or nothing to show.
    StoreError
        The file can't be read.
    """
    if isinstance(result, Outcome):
        raise AskError("an outcome lacks its variants' numbers: plot_sweep(to_xarray(outcome, machine, values))")
    if not isinstance(result, (str, Path)):
        return plot_result(_data_of(result), x, y, colour)
    found = SweepResult(Path(result))
    found.show_own_units()
    return sweep_figure(found, x, y, colour, found.best())


def _show_units_of(scene: Scene) -> None:
    check_scene(scene)
    show_system(scene.units)


def _data_of(data: "xarray.Dataset") -> SweepData:
    """Plot data of a dataset."""
    if "variant" not in data.dims or "status" not in data:
        raise PictureError("this dataset has no variants with a status: use one from to_xarray or read")
    arrays = {str(name): np.asarray(v) for name, v in data.variables.items() if "variant" in v.dims}
    bookkeeping = ("variant", "status", "status_at", "status_group")
    flat = [name for name, values in arrays.items() if values.ndim == 1 and name not in bookkeeping]
    varied = [name for name in flat if name in data.coords]
    along = {}
    for name in (name for name, values in arrays.items() if values.ndim == 2):
        axis = data[name].dims[1]
        about = data[axis].attrs
        units = about.get("units", "1")
        along[name] = FieldAxis(str(axis), about.get("long_name", str(axis)), units, np.asarray(data[axis]))
    return SweepData(
        arrays,
        {name: data[name].attrs.get("units", "1") for name in arrays},
        {name: data[name].attrs.get("long_name", name) for name in arrays},
        varied,
        [name for name in flat if name not in varied and not name.endswith("_error")],
        (int(data.sizes["variant"]),),
        arrays["status"],
        along,
    )
