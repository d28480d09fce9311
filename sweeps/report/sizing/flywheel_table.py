"""A flywheel from a turning-moment diagram in a CSV file: torques, or areas about the mean line."""

from pathlib import Path

import engine
from sweeps.text import tables
from sweeps.text.csv_text import named_columns, read_csv
from sweeps.text.numbers_in_row import numbers_in_row


def flywheel_text(
    table: Path, speed: str, fluctuation: str, interpolation: str, inertia: str = "0", area_energy: str | None = None
) -> str:
    """Report on the flywheel for a turning-moment diagram, in its units.

    Parameters
    ----------
    table : Path
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
    written = [f"1 {column.unit}" for column in read_csv(table).values() if column.unit]
    engine.show_units_of({"table": [*written, inertia, area_energy or ""]})
    mean_speed, delta = engine.in_text(speed, "angular_speed"), engine.in_text(fluctuation, "number")
    already = engine.in_text(inertia, "inertia")
    if area_energy is None:
        phi, moment = named_columns(table, {"phi": "angle", "moment": "moment"}, "phi [deg], moment [N m]")
        found = engine.turning_moment_from_table(
            phi, moment, mean_speed, delta, interpolation=interpolation, inertia=already
        )
        mean = [("mean torque", engine.quantity_text(found.mean_moment, "N m"))]
        places = [("at", engine.quantity_text(angle, "rad")) for angle in (found.fastest_at, found.slowest_at)]
    else:
        (areas,) = named_columns(table, {"area": None}, "area [mm2]")
        (energy,) = numbers_in_row("--area-energy", area_energy, ("energy",))
        found, mean = engine.turning_moment_from_areas(areas, energy, mean_speed, delta, already), []
        places = [("after", f"{count:.0f} areas") for count in (found.fastest_at, found.slowest_at)]
    rows = [
        *mean,
        ("excess work", engine.quantity_text(found.excess_work, "J")),
        *((f"{which} {word}", place) for which, (word, place) in zip(("fastest", "slowest"), places, strict=True)),
        ("flywheel inertia", engine.quantity_text(found.flywheel_inertia, "kg m2")),
        ("speed fluctuation", engine.quantity_text(found.speed_fluctuation, "1")),
    ]
    return tables.table(rows)
