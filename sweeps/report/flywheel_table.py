"""A flywheel directly from a turning-moment diagram in a CSV file."""

from pathlib import Path

from engine import TurningMoment, in_text, turning_moment_from_table
from sweeps.text.csv_text import read_csv
from sweeps.text.engineer_units import quantity_text
from sweeps.text.input_files import InputError
from sweeps.text.tables import table


def flywheel_from_csv(path: Path, speed: str, fluctuation: str, interpolation: str = "linear") -> TurningMoment:
    """Flywheel for a turning-moment table.

    Parameters
    ----------
    path : Path
        CSV with the columns `phi [deg]` (or rad) and `moment [N m]` (or another unit of moment).
    speed, fluctuation : str
        Mean speed, such as "250 rpm", and δ asked for, such as "1/50".
    interpolation : {"linear", "pchip", "spline"}

    Raises
    ------
    InputError, UnitError, TableError
    """
    columns = read_csv(path)
    for key in ("phi", "moment"):
        if key not in columns:
            message = f"no column {key!r}: the header must be 'phi [deg], moment [N m]', it has {', '.join(columns)}"
            raise InputError(str(path), [(1, "", message)])

    def numbers(key: str, dimension: str) -> list[float]:
        unit, values = columns[key]
        return [in_text(f"{value} {unit}".strip(), dimension) for value in values]

    phi, moment = numbers("phi", "angle"), numbers("moment", "moment")
    mean_speed, delta = in_text(speed, "angular_speed"), in_text(fluctuation, "number")
    return turning_moment_from_table(phi, moment, mean_speed, delta, interpolation=interpolation)


def flywheel_text(path: Path, speed: str, fluctuation: str, interpolation: str) -> str:
    """The flywheel for a turning-moment table, in words."""
    found = flywheel_from_csv(path, speed, fluctuation, interpolation)
    rows = [
        ("mean moment", quantity_text(found.mean_moment, "N m")),
        ("excess work", quantity_text(found.excess_work, "J")),
        ("fastest at", quantity_text(found.fastest_at, "rad")),
        ("slowest at", quantity_text(found.slowest_at, "rad")),
        ("flywheel inertia", quantity_text(found.flywheel_inertia, "kg m2")),
        ("speed fluctuation", quantity_text(found.speed_fluctuation, "1")),
    ]
    return table(rows)
