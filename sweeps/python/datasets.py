"""Results as xarray datasets and pandas tables, with units, error estimates and verdicts."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from engine import Outcome, Verdict, described_dimension, given_numbers, scene_numbers
from sweeps.report.files.data_files import header
from sweeps.report.sweep_result import SweepResult
from sweeps.run.columns import field_columns, number_columns, position_axis
from sweeps.store import StoreError, open_dataset
from sweeps.study.study_content import ReadyMachine
from sweeps.text.versions import extra

if TYPE_CHECKING:
    import pandas
    import xarray


def read(path: Path | str, grid: bool = False, check: bool = True) -> "xarray.Dataset":
    """Open a result file as a dataset in SI units, given in the variables' attributes.

    Parameters
    ----------
    path : Path or str
    grid : bool
        Use one dimension per variable, named by its path, instead of one dimension of variants. Reads all data at once
        instead of lazily.
    check : bool
        Verify the checksums first, which reads the whole file.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    StoreError
        xarray isn't installed, the file is unreadable or damaged, or its variants form no grid.
    """
    path = Path(path)
    data = open_dataset(path, check)
    if not grid:
        return data
    with data:
        return _on_grid(data.load(), _grid(SweepResult(path)))


def _grid(result: SweepResult) -> dict[str, int]:
    """Sizes of a result's grid axes by variable."""
    axes = result.record["vary"]
    if "search" in result.record:
        raise StoreError(f"{result.path} is a search, whose candidates form no grid; read it without grid")
    if not axes:
        raise StoreError(f"{result.path} is a single machine: read it without grid")
    together = next((axis["names"] for axis in axes if len(axis["names"]) > 1), None)
    if together:
        raise StoreError(
            f"the variants of {result.path} form no grid: {' and '.join(together)} vary together"
            f"; read it without grid, then set_index(variant={together!r}) finds variants by them"
        )
    return {axis["names"][0]: axis["size"] for axis in axes}


def _on_grid(data: "xarray.Dataset", sizes: Mapping[str, int]) -> "xarray.Dataset":
    """A dataset over variants as one over a grid, the last axis fastest."""
    shape, dims = tuple(sizes.values()), tuple(sizes)

    def unstacked(variable: "xarray.Variable") -> tuple:
        if "variant" not in variable.dims:
            return variable.dims, variable.values, variable.attrs
        values = variable.values.reshape(*shape, *variable.shape[1:])
        return (*dims, *variable.dims[1:]), values, variable.attrs

    def places(axis: int, name: str) -> np.ndarray:
        return np.moveaxis(data[name].values.reshape(shape), axis, 0).reshape(shape[axis], -1)[:, 0]

    along = {name: (name, places(axis, name), data[name].attrs) for axis, name in enumerate(dims)}
    others = {name: unstacked(v.variable) for name, v in data.coords.items() if name not in dims}
    found = {name: unstacked(v.variable) for name, v in data.data_vars.items()}
    return type(data)(found, others | along, data.attrs)


def to_xarray(outcome: Outcome, machine: ReadyMachine, varied: Mapping[str, np.ndarray]) -> "xarray.Dataset":
    """An outcome as a dataset in the layout of `read`.

    Parameters
    ----------
    outcome : Outcome
    machine : Machine or ElementsAlone
        The machine that evaluated it.
    varied : mapping of path to ndarray (variants,)
        Its input.

    Returns
    -------
    xarray.Dataset
        Summaries NAME with error estimates NAME_error, fields over the input position, verdict codes `status` with
        meanings in their attributes; variables as coordinates.

    Raises
    ------
    StoreError
        xarray isn't installed.
    """
    with extra("xarray", "a dataset", StoreError):
        import xarray
    numbers = scene_numbers(machine.scene)
    units = {path: described_dimension(numbers[path].dimension).unit for path in varied}
    coordinates = {"variant": np.arange(outcome.status.size)} | {
        path: ("variant", np.broadcast_to(values, outcome.status.shape), {"units": units[path]})
        for path, values in given_numbers(numbers, machine.varied, varied, None)[0].items()
    }
    codes = {
        "flag_values": np.array([int(v) for v in Verdict], np.uint8),
        "flag_meanings": " ".join(v.name.lower() for v in Verdict),
    }
    fields, axes = field_columns(machine, outcome.fields)
    axes["position"] = position_axis(machine)
    errors = {f"{name}_error": values for name, values in outcome.errors.items()}
    values = {"status": outcome.status, "status_at": outcome.status_at, **outcome.summaries, **errors, **outcome.fields}
    columns = {}
    for column in (*number_columns(machine, outcome.summaries), *fields):
        if column.name in values:
            along = [axes[dim] for dim in column.dims[1:]]
            coordinates |= {a.name: (a.name, a.values, {"long_name": a.long_name, "units": a.units}) for a in along}
            about = {"long_name": column.long_name, "units": column.units}
            columns[column.name] = (("variant", *(axis.name for axis in along)), values[column.name], about)
    columns["status"][2].update(codes)
    return xarray.Dataset(columns, coordinates, {"title": machine.scene.title})


def to_dataframe(outcome: Outcome, machine: ReadyMachine, varied: Mapping[str, np.ndarray]) -> "pandas.DataFrame":
    """An outcome as a table with a row per variant: variables, verdict, summaries and error estimates.

    Parameters
    ----------
    outcome : Outcome
    machine : Machine or ElementsAlone
        The machine that evaluated it.
    varied : mapping of path to ndarray (variants,)
        Its input.

    Returns
    -------
    pandas.DataFrame
        Column names include units, "input.length [m]"; `verdict` holds names such as "ok". Without fields; see
        `to_xarray`.

    Raises
    ------
    StoreError
        xarray, which brings pandas, isn't installed.
    """
    with extra("xarray", "a table", StoreError):
        import pandas
    data = to_xarray(outcome, machine, varied)
    names = [*varied, *(n for summary in outcome.summaries for n in (summary, f"{summary}_error"))]
    columns = {header(name, data[name].attrs["units"]): data[name].values for name in names}
    verdicts = [Verdict(code).name.lower() for code in outcome.status.tolist()]
    found = pandas.DataFrame(columns, index=pandas.RangeIndex(outcome.status.size, name="variant"))
    found.insert(len(varied), "verdict", verdicts)
    return found
