"""A flywheel from a turning-moment diagram in a CSV file: torques, or areas about the mean line."""

from pathlib import Path

import engine
from sweeps.text.csv_text import named_columns, read_csv
from sweeps.text.numbers_in_row import numbers_in_row
from sweeps.text.tables import table


def flywheel_from_csv(
    path: Path,
    speed: str,
    fluctuation: str,
    interpolation: str = "linear",
    inertia: str = "0",
    area_energy: str | None = None,
) -> engine.TurningMoment:
    """Flywheel for a turning-moment diagram.

    Parameters
    ----------
    path : Path
        CSV with the columns `phi [deg]` and `moment [N m]` (or other units); with `area_energy`, with the column
        `area`: areas between diagram and mean line in order, positive above it.
    speed, fluctuation : str
        Mean speed, such as "250 rpm", and required δ, such as "1/50".
    interpolation : {"linear", "pchip", "spline"}
    inertia : str
        Existing constant inertia, such as "0.4 kg m2".
    area_energy : str, optional
        Energy per unit of area, such as "4.5 J".

    Raises
    ------
    InputError, UnitError, TableError
    """
    mean_speed, delta = engine.in_text(speed, "angular_speed"), engine.in_text(fluctuation, "number")
    already = engine.in_text(inertia, "inertia")
    if area_energy is not None:
        (areas,) = named_columns(path, {"area": None}, "area [mm2]")
        (energy,) = numbers_in_row("--area-energy", area_energy, ("energy",))
        return engine.turning_moment_from_areas(areas, energy, mean_speed, delta, already)
    phi, moment = named_columns(path, {"phi": "angle", "moment": "moment"}, "phi [deg], moment [N m]")
    return engine.turning_moment_from_table(
        phi, moment, mean_speed, delta, interpolation=interpolation, inertia=already
    )


def flywheel_text(
    path: Path, speed: str, fluctuation: str, interpolation: str, inertia: str = "0", area_energy: str | None = None
) -> str:
    """Report on the flywheel for a turning-moment diagram, in its units; arguments as for `flywheel_from_csv`."""
    written = [f"1 {column.unit}" for column in read_csv(path).values() if column.unit]
    engine.show_units_of({"table": [*written, inertia, area_energy or ""]})
    found = flywheel_from_csv(path, speed, fluctuation, interpolation, inertia, area_energy)
    rows = [("excess work", engine.quantity_text(found.excess_work, "J"))]
    if area_energy is None:
        rows.insert(0, ("mean torque", engine.quantity_text(found.mean_moment, "N m")))
        rows.append(("fastest at", engine.quantity_text(found.fastest_at, "rad")))
        rows.append(("slowest at", engine.quantity_text(found.slowest_at, "rad")))
    else:
        rows.append(("fastest after", f"{found.fastest_at:.0f} areas"))
        rows.append(("slowest after", f"{found.slowest_at:.0f} areas"))
    rows.append(("flywheel inertia", engine.quantity_text(found.flywheel_inertia, "kg m2")))
    rows.append(("speed fluctuation", engine.quantity_text(found.speed_fluctuation, "1")))
    return table(rows)
