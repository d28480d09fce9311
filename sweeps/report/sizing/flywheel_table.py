"""A flywheel directly from a turning-moment diagram in a CSV file: its moments, or the areas about its mean line."""

from pathlib import Path

from engine import TurningMoment, UnitError, in_text, turning_moment_from_areas, turning_moment_from_table
from sweeps.text.csv_text import read_csv
from sweeps.text.engineer_units import quantity_text
from sweeps.text.input_files import InputError
from sweeps.text.tables import table


def flywheel_from_csv(
    path: Path,
    speed: str,
    fluctuation: str,
    interpolation: str = "linear",
    inertia: str = "0",
    area_energy: str | None = None,
) -> TurningMoment:
    """Flywheel for a turning-moment diagram.

    Parameters
    ----------
    path : Path
        CSV with the columns `phi [deg]` (or rad) and `moment [N m]` (or another unit of moment); with `area_energy`,
        with the column `area`: areas between the diagram and its mean line in order, positive above it.
    speed, fluctuation : str
        Mean speed, such as "250 rpm", and δ asked for, such as "1/50".
    interpolation : {"linear", "pchip", "spline"}
    inertia : str
        Constant inertia that the machine has already, such as "0.4 kg m2".
    area_energy : str, optional
        Energy that a unit of area stands for, such as "4.5 J".

    Raises
    ------
    InputError, UnitError, TableError
    """
    columns = read_csv(path)
    mean_speed, delta = in_text(speed, "angular_speed"), in_text(fluctuation, "number")
    already = in_text(inertia, "inertia")
    if area_energy is not None:
        _expect(path, columns, ("area",), "area [mm2]")
        energy = _energy(area_energy)
        areas = [float(value) for value in columns["area"][1]]
        return turning_moment_from_areas(areas, energy, mean_speed, delta, already)
    _expect(path, columns, ("phi", "moment"), "phi [deg], moment [N m]")
    phi, moment = _numbers(columns["phi"], "angle"), _numbers(columns["moment"], "moment")
    return turning_moment_from_table(phi, moment, mean_speed, delta, interpolation=interpolation, inertia=already)


def flywheel_text(
    path: Path, speed: str, fluctuation: str, interpolation: str, inertia: str = "0", area_energy: str | None = None
) -> str:
    """The flywheel for a turning-moment diagram, in words; arguments as for `flywheel_from_csv`."""
    found = flywheel_from_csv(path, speed, fluctuation, interpolation, inertia, area_energy)
    rows = [("excess work", quantity_text(found.excess_work, "J"))]
    if area_energy is None:
        rows.insert(0, ("mean moment", quantity_text(found.mean_moment, "N m")))
        rows.append(("fastest at", quantity_text(found.fastest_at, "rad")))
        rows.append(("slowest at", quantity_text(found.slowest_at, "rad")))
    else:
        rows.append(("fastest after", f"{found.fastest_at:.0f} areas"))
        rows.append(("slowest after", f"{found.slowest_at:.0f} areas"))
    rows.append(("flywheel inertia", quantity_text(found.flywheel_inertia, "kg m2")))
    rows.append(("speed fluctuation", quantity_text(found.speed_fluctuation, "1")))
    return table(rows)


def _expect(path: Path, columns: dict, keys: tuple[str, ...], header: str) -> None:
    for key in keys:
        if key not in columns:
            message = f"no column {key!r}: the header must be '{header}', it has {', '.join(columns)}"
            raise InputError(str(path), [(1, "", message)])


def _numbers(column: tuple[str, list[str]], dimension: str) -> list[float]:
    unit, values = column
    return [in_text(f"{value} {unit}".strip(), dimension) for value in values]


def _energy(text: str) -> float:
    try:
        return in_text(text, "energy")
    except UnitError as error:
        raise InputError("--area-energy", [(None, "", str(error))]) from None
