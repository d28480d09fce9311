"""Points on a target path from a table."""

from pathlib import Path

from sweeps.text.csv_text import named_columns


def path_places(table: Path) -> list[complex]:
    """Points from a CSV with the columns `x [mm]` and `y [mm]` (any unit), x + iy [m].

    Parameters
    ----------
    table : Path

    Raises
    ------
    InputError, UnitError
        There is no such table, or it has wrong columns.
    """
    x, y = named_columns(table, {"x": "length", "y": "length"}, "x [mm], y [mm]")
    return [complex(*place) for place in zip(x, y, strict=True)]
