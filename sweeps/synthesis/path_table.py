"""Places on a wanted path from a table."""

from pathlib import Path

from engine import column_in_text
from sweeps.text.csv_text import read_csv
from sweeps.text.input_files import InputError


def path_places(table: Path) -> list[complex]:
    """Places of a CSV with the columns `x [mm]` and `y [mm]`, or in another unit, x + iy [m].

    Parameters
    ----------
    table : Path

    Raises
    ------
    InputError, UnitError
        There is no such table, or it has other columns.
    """
    columns = read_csv(table)
    for key in ("x", "y"):
        if key not in columns:
            message = f"no column {key!r}: the header must be 'x [mm], y [mm]', it has {', '.join(columns)}"
            raise InputError(str(table), [(1, "", message)])
    x, y = (column_in_text(columns[key][1], columns[key][0], "length") for key in ("x", "y"))
    return [complex(*place) for place in zip(x, y, strict=True)]
