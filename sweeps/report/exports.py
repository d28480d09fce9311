"""Results, positions and drawings in the formats of other programs."""

import csv
from collections.abc import Iterable, Mapping
from pathlib import Path

import numpy as np

from engine import InputUnits, Machine, Scene, Verdict, did_you_mean, history, history_fields
from sweeps.report.regime_words import failure_text
from sweeps.report.sweep_result import SweepResult
from sweeps.text.input_files import InputError
from sweeps.text.scene_text import with_values, write_scene


def result_csv(path: Path, out: Path, where: str | None = None) -> None:
    """Parameters, verdicts and summaries of a result as CSV, SI units in the header.

    Parameters
    ----------
    path, out : Path
    where : str, optional
        Only computed variants that meet a condition; without it all variants, failed ones too.
    """
    result = SweepResult(path)
    chosen = np.arange(result.description.variants) if where is None else result.select(where)
    names = [*result.parameters, "status", "status_at", *result.summaries]
    names += [f"{n}_error" for n in result.summaries]
    header = ["variant", *(_header(n, result.units[n]) for n in names)]
    rows = ([int(v), *(_cell(result.columns[n][v]) for n in names)] for v in chosen)
    _write_csv(out, header, rows)


def positions_csv(scene: Scene, values: Mapping[str, float], out: Path, positions: int = 360) -> None:
    """Positions and transfer functions of all points, links and sliders over the cycle as CSV.

    The first column is the input's angle or displacement.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        Numbers of the scene (SI) to be replaced.
    out : Path
    positions : int
    """
    available = Machine(scene).available_fields
    names = [n for n in available if "." in n and not n.endswith(".moment")]
    names = [n for n in names if n.partition(".")[0] not in scene.regimes]
    names += ["reduced_inertia", "reduced_inertia_phi", "reduced_moment"]
    machine = Machine(scene, fields=names, varied=list(values), positions=positions)
    outcome = machine.evaluate({p: np.array([v]) for p, v in values.items()})
    unit = InputUnits.of(scene).q
    header = [_header("phi" if unit == "rad" else "q", unit), *(_header(n, available[n].units) for n in names)]
    inputs = machine.nodes
    if unit == "m":
        start, stop = (values.get(f"input.{end}", getattr(scene.input, end)) for end in ("start", "stop"))
        inputs = start + (stop - start) * inputs
    rows = ([repr(float(q)), *(_cell(outcome.fields[n][0, k]) for n in names)] for k, q in enumerate(inputs))
    _write_csv(out, header, rows)


def history_csv(
    scene: Scene, values: Mapping[str, float], out: Path, fields: Iterable[str] = (), steps: int = 360
) -> str:
    """History of a machine through its regimes as CSV; a steady regime is there for one cycle.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        Numbers of the scene (SI) to be replaced.
    out : Path
    fields : iterable of str
        Loads on the pairs and on the frame to write as well, such as "input.reaction".
    steps : int
        Steps a cycle.

    Returns
    -------
    str
        Why the history ends before its last regime does; "" where it doesn't.

    Raises
    ------
    InputError
        The scene has no regimes or no such loads, or the file can't be written.
    """
    if not scene.regimes:
        message = 'the scene has none, so no history; add [regimes.NAME] with type = "run" or "steady"'
        raise InputError(scene.title or "scene", [(None, "regimes", message)])
    scene, fields = with_values(scene, values), tuple(fields)
    known = history_fields(scene) if fields else {}
    for name in fields:
        if name not in known:
            message = f"{name!r} is no load that a history keeps; {did_you_mean(name, known)}"
            raise InputError(scene.title or "scene", [(None, "--loads", message)])
    seen = history(scene, steps, fields)
    columns = {
        "time [s]": seen.time,
        "angle [rad]": seen.angle,
        "speed [rad s-1]": seen.speed,
        "acceleration [rad s-2]": seen.acceleration,
        "motor_moment [N m]": seen.motor_moment,
        **{f"{channel}_moment [N m]": moment for channel, moment in seen.load_moments.items()},
        "energy [J]": seen.energy,
        **{_header(name, known[name].units): row for name, row in seen.loads_on_pairs.items()},
    }
    rows = ([name, *map(_cell, row)] for name, *row in zip(seen.regime, *columns.values(), strict=True))
    _write_csv(out, ["regime", *columns], rows)
    return "" if seen.verdict == Verdict.OK else failure_text(scene, seen.verdict, seen)


def scene_toml(scene: Scene, values: Mapping[str, float], out: Path) -> None:
    """Scene with some numbers replaced, as TOML."""
    try:
        out.write_text(write_scene(scene, values), encoding="utf8")
    except OSError as error:
        raise InputError(str(out), [(None, "", f"can't be written: {error.strerror}")]) from None


def write_columns(out: Path, columns: Mapping[str, np.ndarray], kept: np.ndarray) -> None:
    """Columns of numbers as CSV.

    Parameters
    ----------
    out : Path
    columns : mapping of header to ndarray (rows,)
    kept : ndarray (rows,) of bool
        Which rows to write.

    Raises
    ------
    InputError
        The file can't be written.
    """
    rows = ([_cell(value) for value in row] for row in zip(*(c[kept] for c in columns.values()), strict=True))
    _write_csv(out, list(columns), rows)


def _header(name: str, units: str) -> str:
    return name if units == "1" else f"{name} [{units}]"


def _cell(value: np.generic) -> str:
    number = value.item()
    return repr(number) if isinstance(number, int) or np.isfinite(number) else ""


def _write_csv(out: Path, header: list[str], rows: Iterable[list]) -> None:
    try:
        with out.open("w", newline="", encoding="utf8") as file:
            writer = csv.writer(file)
            writer.writerow(header)
            writer.writerows(rows)
    except OSError as error:
        raise InputError(str(out), [(None, "", f"can't be written: {error.strerror}")]) from None
