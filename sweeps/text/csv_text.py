"""CSV tables whose headers name a unit for each column."""

import csv
import io
import re
from pathlib import Path

from sweeps.text.input_files import InputError, read_text

_HEADER = re.compile(r"^\s*(?P<key>[\w.\[\]]+)\s*(?:\[(?P<unit>[^\]]*)\])?\s*$")


def read_csv(path: Path) -> dict[str, tuple[str, list[str]]]:
    """Columns of a CSV file whose header cells are `name [unit]`: (unit, values as text) by name.

    Raises
    ------
    InputError
        Unreadable file, a header that isn't of that form, rows of the wrong length, or cells that aren't numbers.
    """
    rows = _csv_rows(path)
    if len(rows) < 2:
        raise InputError(path.name, [(None, "", "needs a header line and at least one row of numbers")])
    (first, cells), *rest = rows
    headers = [_HEADER.match(cell) for cell in cells]
    if None in headers:
        bad = cells[headers.index(None)]
        raise InputError(path.name, [(first, "", f"header {bad!r}: write a name and a unit, such as 'force [kN]'")])
    names = [header["key"] for header in headers]
    if len(set(names)) < len(names):
        raise InputError(path.name, [(first, "", f"a column is given twice: {', '.join(names)}")])
    for line, row in rest:
        if len(row) != len(headers):
            raise InputError(path.name, [(line, "", f"has {len(row)} cells, the header {len(headers)}")])
        for cell in row:
            if not _is_number(cell):
                raise InputError(path.name, [(line, "", f"{cell!r} is not a number; use a decimal point")])
    return {h["key"]: (h["unit"] or "", [row[i].strip() for _, row in rest]) for i, h in enumerate(headers)}


def _csv_rows(path: Path) -> list[tuple[int, list[str]]]:
    """Rows of a CSV file with their lines, blank lines and comments left out."""
    reader = csv.reader(io.StringIO(read_text(path)))
    try:
        return [(reader.line_num, row) for row in reader if row and not row[0].lstrip().startswith("#")]
    except csv.Error as error:
        raise InputError(path.name, [(reader.line_num, "", f"is not CSV: {error}")]) from None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
