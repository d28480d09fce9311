"""Tables of variants (CSV, Parquet, HDF5): each column is a scene number with one unit."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

import h5py
import numpy as np

from engine import shortened
from sweeps.store import MappedResult, StoreError, read_columns
from sweeps.text.csv_text import TableColumn, read_csv
from sweeps.text.input_files import InputError, check_file
from sweeps.text.versions import extra

# Maximum size of a binary table [bytes].
LARGEST_BINARY = 4_000_000_000


def read_variant_table(path: Path) -> dict[str, TableColumn]:
    """Columns of a table by name.

    Parameters
    ----------
    path : Path
        .parquet: columns `name [unit]`. .h5 or .hdf5: one-dimensional root datasets with the attribute `units`, or a
        sweep result, whose parameters are read. Else CSV.

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
        raise InputError.of(path.name, "is a folder; name a file" if path.is_dir() else "there is no such file")
    columns = _from_parquet(path) if ending == ".parquet" else _from_hdf5(path)
    if not columns:
        raise InputError.of(path.name, "has no columns of numbers")
    for name, (_, column) in columns.items():
        if column.ndim != 1 or column.dtype.kind not in "fiu":
            raise InputError.of(path.name, f"column {shortened(name)!r} is not numeric: remove it")
    if len({column.size for _, column in columns.values()}) > 1:
        raise InputError.of(path.name, "has columns of different lengths; give each a value per variant")
    return {name: TableColumn(path.name, name, unit, column.astype(float)) for name, (unit, column) in columns.items()}


def _from_parquet(path: Path) -> dict[str, tuple[str, np.ndarray]]:
    pyarrow, parquet = parquet_library(path.name)
    with _damage_told(path, "Parquet", pyarrow.ArrowException), parquet.ParquetFile(path) as file:
        _check_rows(path, file.metadata.num_rows, file.metadata.num_columns)
        table = file.read()
        columns: dict[str, tuple[str, np.ndarray]] = {}
        for title, column in zip(table.column_names, table.columns, strict=True):
            name, _, unit = title.rstrip("]").partition("[")
            if name.strip() in columns:
                raise InputError.of(path.name, f"column {shortened(name.strip())!r} is given twice")
            columns[name.strip()] = unit, column.to_numpy()
        return columns


def _from_hdf5(path: Path) -> dict[str, tuple[str, np.ndarray]]:
    with _damage_told(path, "HDF5"), h5py.File(path) as file:
        is_result = "study_json" in file.attrs
        found = {} if is_result else {_text(n): c for n, c in file.items() if isinstance(c, h5py.Dataset)}
        columns = {name: column for name, column in found.items() if column.ndim == 1}
        _check_rows(path, max((column.size for column in columns.values()), default=1), len(columns))
        if any(column.external or column.is_virtual for column in columns.values()):
            raise InputError.of(path.name, "links to other files, which isn't allowed; copy their data into it")
        if not is_result:
            return {name: (_unit_of(column), column[()]) for name, column in columns.items()}
    return _from_result(path)


def _from_result(path: Path) -> dict[str, tuple[str, np.ndarray]]:
    """The parameters of a finished result, after checking their checksums."""
    try:
        result = MappedResult(path)
        if not result.done.all():
            raise InputError.of(path.name, "isn't finished: run its study again")
        with _damage_told(path, "a result"):
            names = list(json.loads(result.attributes["study_json"])["parameters"])
            units = {column.name: "" if column.units == "1" else column.units for column in result.described}
            return {name: (units[name], values) for name, values in read_columns(path, names).items()}
    except StoreError as error:
        raise InputError.of(path.name, str(error)) from None


@contextmanager
def _damage_told(path: Path, kind: str, *errors: type[Exception]) -> Iterator[None]:
    """Report library errors as a damaged file."""
    try:
        yield
    except InputError:
        raise
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, AttributeError, *errors):
        raise InputError.of(path.name, f"is damaged, or not {kind}") from None


def _check_rows(path: Path, rows: int, columns: int) -> None:
    """Check that a table has rows and fits in memory, as compressed data may be a thousand times larger."""
    if columns and not rows:
        raise InputError.of(path.name, "needs at least one row of numbers")
    if 8 * rows * columns > LARGEST_BINARY:
        most = f"more than the allowed {LARGEST_BINARY / 8e6:.0f} million numbers"
        raise InputError.of(path.name, f"has {rows} rows of {columns} columns, {most}")


def _unit_of(column: h5py.Dataset) -> str:
    unit = _text(column.attrs.get("units", ""))
    return "" if unit == "1" else unit


def _text(value: object) -> str:
    """An HDF5 text, possibly bytes."""
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


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
    with extra("parquet", "Parquet", partial(InputError.of, source)):
        import pyarrow
        from pyarrow import parquet
    return pyarrow, parquet
