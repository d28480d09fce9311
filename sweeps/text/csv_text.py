"""CSV tables with units in the headers."""

import csv
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from engine import column_in_text
from sweeps.text.input_files import InputError, read_text

# Maximum size of a table [bytes], enough for a million rows of ten columns.
LARGEST_TABLE = 256_000_000
_HEADER = re.compile(r"^\s*(?P<key>[\w.\[\]]+)\s*(?:\[(?P<unit>[^\]]*)\])?\s*$")
# Maximum length of a number or header.
_LONGEST = 100
# Extensions of files whose content messages may quote, unlike /etc/passwd.
_TABLES = (".csv", ".tsv", ".txt", ".dat")


def read_csv(path: Path) -> dict[str, tuple[str, list[str]]]:
    """Columns of a CSV file whose header cells are `name [unit]`: (unit, values as text) by name.

    Columns are separated by commas, or by semicolons or tabs as in the header; numbers may then have decimal commas.

    Raises
    ------
    InputError
        Unreadable file, invalid header, rows of the wrong length, or non-numeric cells.
    """
    text = read_text(path, LARGEST_TABLE).replace("\r\n", "\n").replace("\r", "\n")
    every = text.split("\n")
    numbers = [n for n, line in enumerate(every, 1) if line.strip() and not _is_remark(line)]
    if len(numbers) < 2:
        raise InputError(path.name, [(None, "", "needs a header line and at least one row of numbers")])
    lines = [every[n - 1] for n in numbers]
    delimiter = next((mark for mark in ";\t" if mark in lines[0]), ",")
    keys, units = _header(path, numbers[0], next(csv.reader(lines[:1], delimiter=delimiter)))
    columns = _columns(path, numbers[1:], lines[1:], delimiter, len(keys))
    if delimiter != ",":
        columns = [list(map(_with_point, column)) for column in columns]
    for column in columns:
        _check_numbers(path, numbers[1:], column)
    return {key: (unit, column) for key, unit, column in zip(keys, units, columns, strict=True)}


def named_columns(path: Path, dimensions: Mapping[str, str | None], header: str) -> list[list[float]]:
    """Numbers (SI) of some columns of a CSV file.

    Parameters
    ----------
    path : Path
    dimensions : mapping of str to str or None
        By column name; None for plain numbers.
    header : str
        Example header for messages.

    Raises
    ------
    InputError, UnitError
        As for `read_csv`; a column is missing, or has another dimension.
    """
    columns = read_csv(path)
    for key in dimensions:
        if key not in columns:
            message = f"no column {key!r}: the header must be '{header}', it has {', '.join(columns)}"
            raise InputError(str(path), [(1, "", message)])
    return [
        [float(cell) for cell in columns[key][1]] if kind is None else column_in_text(*columns[key][::-1], kind)
        for key, kind in dimensions.items()
    ]


def _with_point(cell: str) -> str:
    """Replace a decimal comma by a point, unless there are thousands separators."""
    return cell.replace(",", ".") if cell.count(",") == 1 and "." not in cell else cell


def _columns(path: Path, numbers: Sequence[int], lines: Sequence[str], delimiter: str, count: int) -> list[list[str]]:
    """Cells column by column."""
    if not any('"' in line for line in lines):
        wrong = next((n for n, line in zip(numbers, lines, strict=True) if line.count(delimiter) != count - 1), None)
        if wrong is None:
            # Lists of rows would be ten times slower.
            cells = delimiter.join(lines).split(delimiter)
            return [cells[i::count] for i in range(count)]
    reader = csv.reader(lines, delimiter=delimiter, strict=True)
    rows = []
    try:
        rows.extend(reader)
    except csv.Error as error:
        raise InputError(path.name, [(numbers[reader.line_num - 1], "", f"is not CSV: {error}")]) from None
    if len(rows) != len(lines):
        raise InputError(path.name, [(None, "", "a quoted cell spans several lines")])
    for line, row in zip(numbers, rows, strict=True):
        if len(row) != count:
            raise InputError(path.name, [(line, "", f"has {len(row)} cells, the header {count}")])
    return [list(column) for column in zip(*rows, strict=True)]


def _is_remark(line: str) -> bool:
    """Whether a line is a comment, or a spreadsheet's separator line."""
    return line.lstrip().startswith("#") or (line.startswith("sep=") and len(line.strip()) == 5)


def _header(path: Path, line: int, cells: Sequence[str]) -> tuple[list[str], list[str]]:
    headers = [_HEADER.match(cell) if len(cell) <= _LONGEST else None for cell in cells]
    if None in headers:
        shown = _quoted(path, cells[headers.index(None)])
        message = f"header{shown}: write a name and a unit for each column, such as 'force [kN]'"
        raise InputError(path.name, [(line, "", message)])
    names = [header["key"] for header in headers]
    if len(set(names)) < len(names):
        raise InputError(path.name, [(line, "", f"a column is given twice: {', '.join(names)}")])
    return names, [header["unit"] or "" for header in headers]


def _check_numbers(path: Path, lines: Sequence[int], column: list[str]) -> None:
    """Check that all cells of a column are numbers."""
    try:
        for cell in column:
            float(cell)
        sound = max(map(len, column)) <= _LONGEST
    except ValueError:
        sound = False
    if not sound:
        bad = next(i for i, cell in enumerate(column) if not _is_number(cell))
        message = f"{_quoted(path, column[bad]).strip() or 'a cell'} is not a number such as 0.5 (with a decimal point)"
        raise InputError(path.name, [(lines[bad], "", message)])


def _quoted(path: Path, cell: str) -> str:
    """A cell for a message, with a leading blank; "" if the file may not be a table."""
    shown = cell if len(cell) <= 60 else cell[:57] + "..."
    return f" {shown!r}" if path.suffix.lower() in _TABLES else ""


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return len(cell) <= _LONGEST
