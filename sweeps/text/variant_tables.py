"""Tables of variants: CSV, Parquet, HDF5; a number of the scene in each column, with one unit."""

import json
from collections.abc import Sequence
from pathlib import Path

import h5py
import numpy as np

from sweeps.text.csv_text import read_csv
from sweeps.text.input_files import InputError, check_file

# Bytes that a binary table may have.
LARGEST_BINARY = 4_000_000_000
# Characters of a column's name that a message shows.
LONGEST_NAME = 60
Columns = dict[str, tuple[str, Sequence[str] | np.ndarray]]


def read_variant_table(path: Path) -> Columns:
    """Columns of a table by name: unit, and numbers as texts or as an array (rows,).

    Parameters
    ----------
    path : Path
        Ending .parquet: columns named `name [unit]`. Ending .h5 or .hdf5: datasets at the root with one dimension,
        their unit in the attribute `units`, or a result of a sweep, whose parameters are read. Else CSV.

    Raises
    ------
    InputError
        The file can't be read, or has no columns of numbers.
    """
    ending = path.suffix.lower()
    if ending not in (".parquet", ".h5", ".hdf5"):
        return read_csv(path)
    check_file(path, LARGEST_BINARY)
    if not path.is_file():
        message = "is a folder; name a file" if path.is_dir() else "there is no such file"
        raise InputError(path.name, [(None, "", message)])
    columns = _from_parquet(path) if ending == ".parquet" else _from_hdf5(path)
    if not columns:
        raise InputError(path.name, [(None, "", "has no columns of numbers")])
    for name, (_, column) in columns.items():
        if column.ndim != 1 or column.dtype.kind not in "fiu":
            raise InputError(path.name, [(None, "", f"column {_shown(name)} doesn't hold numbers: leave it out")])
    if len({column.size for _, column in columns.values()}) > 1:
        raise InputError(path.name, [(None, "", "has columns of different lengths")])
    return {name: (unit, column.astype(float)) for name, (unit, column) in columns.items()}


def _from_parquet(path: Path) -> dict[str, tuple[str, np.ndarray]]:
    pyarrow, parquet = parquet_library(path.name)
    try:
        with parquet.ParquetFile(path) as file:
            _check_rows(path, file.metadata.num_rows, file.metadata.num_columns)
            table = file.read()
    except (pyarrow.ArrowException, OSError):
        raise InputError(path.name, [(None, "", "is damaged, or not Parquet")]) from None
    columns: dict[str, tuple[str, np.ndarray]] = {}
    for title, column in zip(table.column_names, table.columns, strict=True):
        name, _, unit = title.rstrip("]").partition("[")
        if name.strip() in columns:
            raise InputError(path.name, [(None, "", f"column {_shown(name.strip())} is given twice")])
        columns[name.strip()] = unit, column.to_numpy()
    return columns


def _from_hdf5(path: Path) -> dict[str, tuple[str, np.ndarray]]:
    try:
        with h5py.File(path) as file:
            known = file.attrs.get("study_json")
            names = list(json.loads(known)["parameters"]) if known else _columns_in(file)
            _check_rows(path, max((file[name].size or 0 for name in names), default=1), len(names))
            return {name: (_unit_of(file[name]), file[name][()]) for name in names}
    except (OSError, KeyError, ValueError):
        raise InputError(path.name, [(None, "", "is damaged, or no HDF5 file with columns")]) from None


def _columns_in(file: h5py.File) -> list[str]:
    return [name for name, part in file.items() if isinstance(part, h5py.Dataset) and part.ndim == 1]


def _check_rows(path: Path, rows: int, columns: int) -> None:
    """See that a table has rows, and no more than fit in memory: what is packed may be a thousand times as long."""
    if not rows:
        raise InputError(path.name, [(None, "", "needs at least one row of numbers")])
    if 8 * rows * columns > LARGEST_BINARY:
        message = f"has {rows} rows of {columns} numbers, more than the {LARGEST_BINARY / 8e6:.0f} million numbers allowed"
        raise InputError(path.name, [(None, "", message)])


def _shown(name: str) -> str:
    return repr(name if len(name) <= LONGEST_NAME else name[: LONGEST_NAME - 3] + "...")


def _unit_of(column: h5py.Dataset) -> str:
    unit = column.attrs.get("units", "")
    unit = unit.decode() if isinstance(unit, bytes) else str(unit)
    return "" if unit == "1" else unit


def parquet_library(source: str) -> tuple:
    """The modules `pyarrow` and `pyarrow.parquet`.

    Parameters
    ----------
    source : str
        The file that needs them, for the message.

    Raises
    ------
    InputError
        They aren't installed.
    """
    try:
        import pyarrow
        from pyarrow import parquet
    except ImportError:
        message = "Parquet needs a library that isn't installed: pip install 'machine-sweeps[parquet]'"
        raise InputError(source, [(None, "", message)]) from None
    return pyarrow, parquet
