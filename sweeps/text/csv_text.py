"""CSV tables with units in the headers or in the cells."""

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from engine import UnitError, column_in_text, in_text, recognised
from sweeps.text.input_files import InputError, read_text

# Maximum size of a table [bytes], enough for a million rows of ten columns.
LARGEST_TABLE = 256_000_000
_HEADER = re.compile(r"^\s*(?P<key>[\w.\[\]]+)\s*(?:\[(?P<unit>[^\]]*)\])?\s*$")
# Maximum length of a number or header.
_LONGEST = 100
# Extensions of files whose content messages may quote, unlike /etc/passwd.
_TABLES = (".csv", ".tsv", ".txt", ".dat")


@dataclass(frozen=True, eq=False)
class TableColumn:
    """A column of a table.

    Attributes
    ----------
    source, name : str
        Of the file and of the column, for messages.
    unit : str
        Unit of cells that have none, "" for none.
    cells : sequence of str, or ndarray
    lines : sequence of int
        Lines of the header and of each cell in the file; none of a binary table.
    """

    source: str
    name: str
    unit: str
    cells: Sequence[str] | np.ndarray
    lines: Sequence[int] = ()

    @property
    def texts(self) -> list[str]:
        """Cells with their units."""
        return [cell if _has_unit(cell) else f"{cell} {self.unit}".strip() for cell in map(str, self.cells)]

    @property
    def dimension(self) -> str:
        """Dimension of the first cell.

        Raises
        ------
        InputError
            It has no known unit.
        """
        try:
            return recognised(self.texts[0])[1]
        except UnitError as error:
            raise self.problem(1, str(error)) from None

    def numbers(self, dimension: str) -> list[float]:
        """Values in SI units.

        Parameters
        ----------
        dimension : str
            As for `engine.in_text`.

        Raises
        ------
        InputError
            A cell is wrong; the message names its line and column.
        """
        try:
            return column_in_text(self.cells, self.unit, dimension)
        except UnitError as error:
            if not self.lines:
                raise self.problem(0, str(error)) from None
        if self.unit:
            self._in_si(0, f"1 {self.unit}", dimension)
        return [self._in_si(place, text, dimension) for place, text in enumerate(self.texts, 1)]

    def plain_numbers(self) -> list[float]:
        """Values as they stand, whatever the unit of the header.

        Raises
        ------
        InputError
            A cell has a unit.
        """
        return [self._in_si(place, cell, "number") for place, cell in enumerate(self.cells, 1)]

    def _in_si(self, place: int, text: str, dimension: str) -> float:
        try:
            return in_text(text, dimension)
        except UnitError as error:
            raise self.problem(place, str(error)) from None

    def unit_problem(self, place: int, message: str) -> InputError:
        """An error in the unit of a cell, counted from 1, at the header if it stands there."""
        return self.problem(0 if self.unit and not _has_unit(str(self.cells[place - 1])) else place, message)

    def problem(self, place: int, message: str) -> InputError:
        """An error at a cell, counted from 1, or at the header."""
        return InputError(self.source, [(self.lines[place] if self.lines else None, f"column {self.name}", message)])


def read_csv(path: Path) -> dict[str, TableColumn]:
    """Columns of a CSV file by name; header cells are `name [unit]`, or `name` where cells have units.

    Columns are separated by commas, or by semicolons or tabs as in the header; numbers may then have decimal commas.

    Raises
    ------
    InputError
        Unreadable file, invalid header, rows of the wrong length, or cells that aren't numbers with or without a unit.
    """
    text = read_text(path, LARGEST_TABLE).replace("\r\n", "\n").replace("\r", "\n")
    every = text.split("\n")
    numbers = [n for n, line in enumerate(every, 1) if line.strip() and not _is_remark(line)]
    if len(numbers) < 2:
        raise InputError.of(path.name, "needs a header line and at least one row of numbers")
    lines = [every[n - 1] for n in numbers]
    delimiter = next((mark for mark in ";\t" if mark in lines[0]), ",")
    keys, units = _header(path, numbers[0], next(csv.reader(lines[:1], delimiter=delimiter)))
    columns = _columns(path, numbers[1:], lines[1:], delimiter, len(keys))
    if delimiter != ",":
        columns = [list(map(_with_point, column)) for column in columns]
    named = zip(keys, units, columns, strict=True)
    found = {key: TableColumn(path.name, key, unit, cells, numbers) for key, unit, cells in named}
    for column in found.values():
        _check_numbers(path, column)
    return found


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
            raise InputError.of(str(path), message, 1)
    return [
        columns[key].plain_numbers() if kind is None else columns[key].numbers(kind) for key, kind in dimensions.items()
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
    except csv.Error:
        message = "a cell's quotation marks don't match, or it is too long"
        raise InputError.of(path.name, message, numbers[reader.line_num - 1]) from None
    if len(rows) != len(lines):
        raise InputError.of(path.name, "a quoted cell spans several lines")
    for line, row in zip(numbers, rows, strict=True):
        if len(row) != count:
            commas = "; separate columns by semicolons if numbers have decimal commas" if delimiter == "," else ""
            raise InputError.of(path.name, f"has {len(row)} cells, the header {count}{commas}", line)
    return [list(column) for column in zip(*rows, strict=True)]


def _is_remark(line: str) -> bool:
    """Whether a line is a comment, or a spreadsheet's separator line."""
    return line.lstrip().startswith("#") or (line.startswith("sep=") and len(line.strip()) == 5)


def _header(path: Path, line: int, cells: Sequence[str]) -> tuple[list[str], list[str]]:
    headers = [_HEADER.match(cell) if len(cell) <= _LONGEST else None for cell in cells]
    if None in headers:
        shown = _quoted(path, cells[headers.index(None)])
        message = f"header{shown}: write a name and a unit for each column, such as 'force [kN]'"
        raise InputError.of(path.name, message, line)
    names = [header["key"] for header in headers]
    if any(map(_is_number, names)):
        message = "the first line must name the columns, such as 'input.length [mm]'; it has numbers"
        raise InputError.of(path.name, message, line)
    if len(set(names)) < len(names):
        raise InputError.of(path.name, f"a column is given twice: {', '.join(names)}", line)
    return names, [header["unit"] or "" for header in headers]


def _check_numbers(path: Path, column: TableColumn) -> None:
    """Check that all cells of a column are numbers, with or without a unit."""
    bad = next((i for i, cell in enumerate(column.cells, 1) if not (_is_number(cell) or _has_unit(cell))), None)
    if bad is not None:
        shown = _quoted(path, column.cells[bad - 1]).strip() or "a cell"
        raise column.problem(bad, f"{shown} is not a number such as 0.5 or '40 mm' (with a decimal point)")


def _quoted(path: Path, cell: str) -> str:
    """A cell for a message, with a leading blank; "" if the file may not be a table."""
    shown = cell if len(cell) <= 60 else cell[:57] + "..."
    return f" {shown!r}" if path.suffix.lower() in _TABLES else ""


_WITH_UNIT = re.compile(r"\s*[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?\s*[^\W\d_%°][^,;]*|.*[%°]\s*")


def _has_unit(cell: str) -> bool:
    """Whether a cell looks like a number with a unit."""
    return len(cell) <= _LONGEST and not _is_number(cell) and _WITH_UNIT.fullmatch(cell) is not None


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return len(cell) <= _LONGEST
