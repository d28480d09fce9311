"""Tables of numbers in the formats of other programs: CSV, JSON, Parquet, MAT; SI units beside every column."""

import csv
import json
import re
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from sweeps.text.input_files import InputError
from sweeps.text.variant_tables import parquet_library
from sweeps.text.whole_files import whole_file

# MATLAB's names are this long at most.
_LONGEST_NAME = 63


class DataTable(NamedTuple):
    """Columns of equal length.

    Attributes
    ----------
    columns : dict of str to ndarray (rows,)
        Numbers in SI units, or texts.
    units : dict of str to str
        Unit of each column of numbers, as CF spells it.
    title : str
    """

    columns: dict[str, np.ndarray]
    units: dict[str, str]
    title: str = ""


def write_table(out: Path, table: DataTable) -> None:
    """Write a table in the format that the file's ending says.

    Parameters
    ----------
    out : Path
        Ending as in `TABLE_ENDINGS`.
    table : DataTable

    Raises
    ------
    InputError
        The ending is another one, the file can't be written, or Parquet's library isn't installed.
    """
    if out.suffix not in _WRITERS:
        message = f"ending {out.suffix!r} isn't a table's; allowed are {', '.join(TABLE_ENDINGS)}"
        raise InputError(str(out), [(None, "", message)])
    try:
        with whole_file(out) as draft:
            _WRITERS[out.suffix](draft, table)
    except OSError as error:
        raise InputError(str(out), [(None, "", f"can't be written: {error.strerror}")]) from None


def plain_number(value: float) -> float | int | None:
    """A number as JSON has it; None where it is infinite or undefined."""
    number = value.item() if isinstance(value, np.generic) else value
    return number if isinstance(number, int) or np.isfinite(number) else None


def _header(name: str, units: str) -> str:
    return name if units in ("", "1") else f"{name} [{units}]"


def _write_csv(out: Path, table: DataTable) -> None:
    columns = [_cells(column) for column in table.columns.values()]
    with out.open("w", newline="", encoding="utf8") as file:
        writer = csv.writer(file)
        writer.writerow([_header(name, table.units.get(name, "1")) for name in table.columns])
        writer.writerows(zip(*columns, strict=True))


def _cells(column: np.ndarray) -> Iterable[str]:
    """Numbers to all their digits, nothing for what is infinite or undefined."""
    if column.dtype.kind != "f":
        return map(str, column.tolist())
    known = np.isfinite(column).tolist()
    return (repr(number) if is_known else "" for number, is_known in zip(column.tolist(), known, strict=True))


def table_data(table: DataTable) -> dict[str, Any]:
    """A table in types that JSON has, column by column."""
    return {
        name: {"unit": table.units.get(name, "1"), "values": _plain(column)} for name, column in table.columns.items()
    }


def _write_json(out: Path, table: DataTable) -> None:
    content = {"title": table.title, "columns": table_data(table)}
    out.write_text(json.dumps(content, ensure_ascii=False), encoding="utf8")


def _plain(column: np.ndarray) -> list:
    return column.tolist() if column.dtype.kind != "f" else [plain_number(value) for value in column.tolist()]


def _write_parquet(out: Path, table: DataTable) -> None:
    pyarrow, parquet = parquet_library(str(out))
    headers = {_header(name, table.units.get(name, "1")): column for name, column in table.columns.items()}
    made = pyarrow.table(headers).replace_schema_metadata({"title": table.title})
    parquet.write_table(made, out)


def _write_mat(out: Path, table: DataTable) -> None:
    from scipy.io import savemat

    names = _matlab_names(table.columns)
    columns = {names[name]: _for_matlab(column) for name, column in table.columns.items()}
    of_each = {names[name]: table.units.get(name, "1") for name in table.columns}
    told = {names[name]: name for name in table.columns}
    content = {"data": columns, "units": of_each, "names": told, "title": table.title}
    savemat(out, content, long_field_names=True, oned_as="column")


def _for_matlab(column: np.ndarray) -> np.ndarray:
    return column if column.dtype.kind in "fiub" else np.array(column.tolist(), dtype=object)


def _matlab_names(names: Iterable[str]) -> dict[str, str]:
    """Names that MATLAB allows for fields, each once."""
    found: dict[str, str] = {}
    for name in names:
        plain = re.sub(r"\W", "_", name, flags=re.ASCII).lstrip("_0123456789")[:_LONGEST_NAME] or "column"
        taken, number = set(found.values()), 1
        chosen = plain
        while chosen in taken:
            number += 1
            chosen = f"{plain[: _LONGEST_NAME - 1 - len(str(number))]}_{number}"
        found[name] = chosen
    return found


_WRITERS: dict[str, Callable[[Path, DataTable], None]] = {
    ".csv": _write_csv,
    ".json": _write_json,
    ".parquet": _write_parquet,
    ".mat": _write_mat,
}
TABLE_ENDINGS = tuple(_WRITERS)
