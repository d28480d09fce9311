"""Tables of numbers as CSV, JSON, Parquet or MAT files, with a unit for each column."""

import csv
import json
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, count
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from engine import table_unit
from sweeps.study.variant_tables import parquet_library
from sweeps.text.input_files import InputError
from sweeps.text.whole_files import new_file

# Maximum length of MATLAB names.
_LONGEST_NAME = 63
# Maximum numbers in a MAT file, which is built in memory (some hundred megabytes).
MOST_IN_MEMORY = 20_000_000


class _TooLongError(Exception):
    """A table is too large for its format."""


class DataTable(NamedTuple):
    """Columns of equal length, read in parts: numbers in SI units, or texts.

    Attributes
    ----------
    names : tuple of str
        Column names.
    units : dict of str to str
        CF unit of each numeric column.
    title : str
    parts : callable
        Yields the named columns in parts; one empty part if there are no rows.
    """

    names: tuple[str, ...]
    units: dict[str, str]
    title: str
    parts: Callable[[Sequence[str]], Iterator[dict[str, np.ndarray]]]

    @classmethod
    def whole(cls, columns: dict[str, np.ndarray], units: dict[str, str], title: str = "") -> "DataTable":
        """A table of columns in memory (rows,)."""
        return cls(tuple(columns), units, title, lambda names: iter([{name: columns[name] for name in names}]))

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """All columns of a table in memory."""
        return next(self.parts(self.names))


def _in_shown_units(table: DataTable) -> DataTable:
    """A table in the units shown, as from `table_unit`."""
    units = {name: table_unit(unit) for name, unit in table.units.items()}

    def parts(names: Sequence[str]) -> Iterator[dict[str, np.ndarray]]:
        for part in table.parts(names):
            # Whole numbers without units stay whole.
            sizes = {name: units.get(name, (1.0, ""))[0] for name in part}
            yield {name: row if sizes[name] == 1.0 else row / sizes[name] for name, row in part.items()}

    return DataTable(table.names, {name: unit for name, (_, unit) in units.items()}, table.title, parts)


def write_table(out: Path, table: DataTable) -> None:
    """Write a table in the format of the file extension, in the units shown.

    Parameters
    ----------
    out : Path
        Extension as in `TABLE_ENDINGS`.
    table : DataTable

    Raises
    ------
    InputError
        The file can't be written, the table is too large for its format, or pyarrow isn't installed.
    """
    try:
        with new_file(out) as draft:
            _WRITERS[out.suffix](draft, _in_shown_units(table))
    except _TooLongError as error:
        raise InputError.of(str(out), str(error)) from None


def plain_number(value: float) -> float | int | None:
    """A JSON number; None if infinite or undefined."""
    return _plain(np.array([value]))[0]


def header(name: str, units: str) -> str:
    """Header of a column, with its unit: "input.length [m]"."""
    return name if units in ("", "1") else f"{name} [{units}]"


def _headers(table: DataTable) -> list[str]:
    return [header(name, table.units.get(name, "1")) for name in table.names]


def _write_csv(out: Path, table: DataTable) -> None:
    with out.open("w", newline="", encoding="utf8") as file:
        writer = csv.writer(file)
        writer.writerow(_headers(table))
        for part in table.parts(table.names):
            # Full precision; None is empty.
            writer.writerows(zip(*(_plain(part[name]) for name in table.names), strict=True))


def table_data(table: DataTable) -> dict[str, Any]:
    """A table in JSON types, by column."""
    return {
        name: {"unit": table.units.get(name, "1"), "values": _plain(column)} for name, column in table.columns.items()
    }


def _write_json(out: Path, table: DataTable) -> None:
    """Write by column, in the form of `table_data`."""

    def text(value: object) -> str:
        return json.dumps(value, ensure_ascii=False)

    with out.open("w", encoding="utf8") as file:
        file.write(f'{{"title": {text(table.title)}, "columns": {{')
        for i, name in enumerate(table.names):
            unit = text(table.units.get(name, "1"))
            file.write(f'{", " if i else ""}{text(name)}: {{"unit": {unit}, "values": [')
            for k, part in enumerate(table.parts((name,))):
                file.write((", " if k else "") + text(_plain(part[name]))[1:-1])
            file.write("]}")
        file.write("}}")


def _plain(column: np.ndarray) -> list:
    """A column in Python types; None for infinite or undefined numbers."""
    if column.dtype.kind == "f" and not (known := np.isfinite(column)).all():
        column = np.where(known, column, None)
    return column.tolist()


def _write_parquet(out: Path, table: DataTable) -> None:
    """Write a row group per part."""
    pyarrow, parquet = parquet_library(str(out))
    headers = _headers(table)

    def rows_of(part: dict[str, np.ndarray]) -> Any:
        columns = (part[name] for name in table.names)
        made = pyarrow.table(dict(zip(headers, columns, strict=True)))
        return made.replace_schema_metadata({"title": table.title})

    parts = map(rows_of, table.parts(table.names))
    first = next(parts)
    with parquet.ParquetWriter(out, first.schema) as writer:
        for rows in chain((first,), parts):
            writer.write_table(rows)


def _write_mat(out: Path, table: DataTable) -> None:
    from scipy.io import savemat

    names = _matlab_names(table.names)
    columns = {names[name]: _for_matlab(column) for name, column in _whole(table).items()}
    of_each = {names[name]: table.units.get(name, "1") for name in table.names}
    told = {names[name]: name for name in table.names}
    content = {"data": columns, "units": of_each, "names": told, "title": table.title}
    savemat(out, content, long_field_names=True, oned_as="column")


def _whole(table: DataTable) -> dict[str, np.ndarray]:
    """All columns in memory, within the size limit."""
    found, rows = [], 0
    for part in table.parts(table.names):
        found.append(part)
        rows += next(iter(part.values())).size
        if rows * len(part) > MOST_IN_MEMORY:
            message = f"a MAT file holds at most {MOST_IN_MEMORY:.3g} numbers; choose variants with"
            message += " --where, columns with --columns, or write .parquet or .csv"
            raise _TooLongError(message)
    return {name: np.concatenate([part[name] for part in found]) for name in table.names}


def _for_matlab(column: np.ndarray) -> np.ndarray:
    return column if column.dtype.kind in "fiub" else np.array(column.tolist(), dtype=object)


def _matlab_names(names: Iterable[str]) -> dict[str, str]:
    """Unique MATLAB field names."""
    found: dict[str, str] = {}
    for name in names:
        plain = re.sub(r"\W", "_", name, flags=re.ASCII).lstrip("_0123456789")[:_LONGEST_NAME] or "column"
        taken = set(found.values())
        numbered = (f"{plain[: _LONGEST_NAME - 1 - len(str(k))]}_{k}" for k in count(2))
        found[name] = next(chosen for chosen in chain((plain,), numbered) if chosen not in taken)
    return found


_WRITERS: dict[str, Callable[[Path, DataTable], None]] = {
    ".csv": _write_csv,
    ".json": _write_json,
    ".parquet": _write_parquet,
    ".mat": _write_mat,
}
TABLE_ENDINGS = tuple(_WRITERS)
