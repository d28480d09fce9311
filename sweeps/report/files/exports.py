"""Results, positions and histories as tables."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np

from engine import Scene, history, history_fields
from sweeps.report.files.data_files import DataTable
from sweeps.report.readings import Readings
from sweeps.report.readings_in_time import history_readings
from sweeps.report.sweep_result import SweepResult
from sweeps.text.conditions import Where
from sweeps.text.input_files import InputError, need_known

# Rows in memory at once.
ROWS_AT_A_TIME = 1 << 16


def result_table(
    path: Path,
    names: Sequence[str] = (),
    where: Where = None,
    sort: str | None = None,
    descending: bool = False,
    most: int | None = None,
) -> DataTable:
    """Parameters and some columns of a result; with fields, a row per variant and position.

    Parameters
    ----------
    path : Path
    names : sequence of str, optional
        Summaries, error estimates, verdicts, derivatives, and fields with a common axis; default: all columns without
        fields.
    where : str or sequence of str, optional
        Only computed variants that meet these conditions; default: those computed successfully, without `names` all of
        them, including failed ones.
    sort, descending, most
        As for `SweepResult.select`; only variants computed successfully, if any of these is given.

    Raises
    ------
    InputError
        No such column, fields with different axes, or an invalid condition.
    """
    result = SweepResult(path)
    result.show_own_units()
    known = [c.name for c in result.file.described]
    result.need(names, "columns", known)
    every = not (names or where or sort or most)
    chosen = np.arange(result.file.variants) if every else result.select(where, sort, descending, most)
    if not names:
        errors = [f"{name}_error" for name in result.summaries]
        names = [n for n in ("status", "status_at", *result.summaries, *errors, *known) if n in result.columns]
    fields = [name for name in dict.fromkeys(names) if name in result.fields]
    asked = [name for name in dict.fromkeys(("variant", *result.parameters, *names)) if name not in fields]
    axes = {axis.name: axis for axis in map(result.along, fields)}
    if len(axes) > 1:
        message = f"have different axes ({' and '.join(axes)}); export them separately"
        raise InputError.of("--columns", message, key=", ".join(fields))
    axis = next(iter(axes.values()), None)
    places = axis.values.size if axis else 1
    rows = max(ROWS_AT_A_TIME // places, 1)

    def column(name: str, here: np.ndarray) -> np.ndarray:
        if name in fields:
            return result.field_rows(name, here).ravel()
        if axis and name == axis.name:
            return np.tile(axis.values, here.size)
        return np.repeat(here if name == "variant" else result.columns[name][here], places)

    def parts(wanted: Sequence[str]) -> Iterator[dict[str, np.ndarray]]:
        for here in np.split(chosen, range(rows, chosen.size, rows)):
            yield {name: column(name, here) for name in wanted}
            result.release()

    along = {axis.name: axis.units} if axis else {}
    return DataTable((*asked, *along, *fields), dict(result.units) | along, result.file.title, parts)


def reading_table(readings: Readings, title: str) -> DataTable:
    """Readings as a table, a row per position."""
    return DataTable.whole({readings.place: readings.at} | readings.values, readings.units, title)


def history_table(scene: Scene, fields: Sequence[str] = ()) -> tuple[DataTable, str]:
    """History of a machine through its regimes, with one cycle of steady running.

    Parameters
    ----------
    scene : Scene
    fields : sequence of str
        Additional loads on pairs and frame, such as "input.reaction".

    Returns
    -------
    DataTable
    str
        Why the history ends early, or "".

    Raises
    ------
    InputError
        The scene has no regimes, or no such loads.
    """
    if not scene.regimes:
        message = 'a history needs regimes; add [regimes.NAME] with type = "run" or "steady"'
        raise InputError.of(scene.title or "scene", message, key="regimes")
    known = history_fields(scene) if fields else {}
    need_known(fields, known, scene.title or "scene", "is not a load of a history", "--columns")
    seen = history(scene, fields=fields)
    found = history_readings(scene, seen)
    further = {name: (row, known[name].units) for name, row in seen.loads_on_pairs.items()}
    if scene.couplings:
        coupled = {"shaft_speed": (seen.shaft_speed, "rad s-1"), "coupling_moment": (seen.coupling_moment, "N m")}
        further = coupled | further
    values = found.values | {name: row for name, (row, _) in further.items()}
    units = found.units | {name: unit for name, (_, unit) in further.items()}
    return DataTable.whole({"regime": seen.regime, "time": seen.time} | values, units, scene.title), found.remark
