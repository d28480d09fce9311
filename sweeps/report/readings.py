"""Quantities of one machine at single positions of its input, or at single instants of its regimes."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine import (
    CrankInput,
    History,
    InputUnits,
    MovingMachine,
    Scene,
    Verdict,
    has_cycle,
    history,
    sliding_quantity,
)
from sweeps.report.regime_words import failure_text
from sweeps.text.engineer_units import quantity_text
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

# How far a place may be off by rounding, as a share of the range.
_ROUNDING = 1e-13
_OF_HISTORY = {
    "time": ("s", "time since the first regime began"),
    "angle": ("rad", "crank angle, going on beyond a turn"),
    "speed": ("rad s-1", "angular speed of the input link"),
    "acceleration": ("rad s-2", "angular acceleration of the input link"),
    "motor_moment": ("N m", "moment of the motors, reduced to the input"),
    "energy": ("J", "kinetic energy"),
}


class Readings(NamedTuple):
    """What quantities are at some places.

    Attributes
    ----------
    place : str
        Name of the coordinate: "phi", "q" or "time".
    at : ndarray (places,)
        The places [rad, m or s].
    values : dict of str to ndarray (places,)
        SI.
    units, long_names : dict of str to str
        Of the places too.
    remark : str
        What is wrong with the machine as a whole, "" where nothing is.
    """

    place: str
    at: np.ndarray
    values: dict[str, np.ndarray]
    units: dict[str, str]
    long_names: dict[str, str]
    remark: str = ""


def readings_at(scene: Scene, at: Sequence[float], names: Sequence[str] = ()) -> Readings:
    """Fields of one machine at positions of its input.

    Parameters
    ----------
    scene : Scene
        With a mechanism.
    at : sequence of float
        Crank angles [rad], or displacements of a sliding input [m].
    names : sequence of str
        Fields; all at uniform speed of the input unless given.

    Raises
    ------
    InputError
        The scene has no mechanism, or a position lies outside the range of its input.
    AskError
        There is no such field.
    """
    if scene.input is None:
        raise InputError("--at", [(None, "", "the scene has machine elements alone, which have no positions")])
    at, unit = np.asarray(at, float), InputUnits.of(scene).q
    machine = MovingMachine(scene, positions=_in_range(scene, at))
    known, place = machine.register.fields, "phi" if unit == "rad" else "q"
    fields = list(names) or list(known)
    verdict = machine.verdict(fields)
    return Readings(
        place,
        at,
        machine.fields(fields),
        {name: known[name].units for name in fields} | {place: unit},
        {name: known[name].long_name for name in fields} | {"phi": "crank angle", "q": "displacement of the input"},
        "" if verdict in (Verdict.OK, Verdict.NOT_FINITE) else verdict.sentence,
    )


def _in_range(scene: Scene, at: np.ndarray) -> np.ndarray:
    """Positions within the cycle, or within the range of the input."""
    drive = scene.input
    if has_cycle(scene):
        return np.mod(at, 2 * np.pi * drive.revolutions)
    shares = (at - drive.start) / (drive.stop - drive.start)
    if ((shares < -_ROUNDING) | (shares > 1 + _ROUNDING)).any():
        kind = "crank angle" if isinstance(drive, CrankInput) else "displacement"
        ends = f"input.start = {drive.start:g} and input.stop = {drive.stop:g} (SI)"
        raise InputError("--at", [(None, "", f"a {kind} lies outside the range of the input, between {ends}")])
    return np.clip(at, *sorted((drive.start, drive.stop)))


def readings_in_time(scene: Scene, at: Sequence[float]) -> Readings:
    """The motion through the regimes at some instants.

    Parameters
    ----------
    scene : Scene
    at : sequence of float
        Times since the first regime began [s]; a steady regime lasts one cycle.

    Raises
    ------
    InputError
        The scene has no regimes, or they end before.
    """
    if not scene.regimes:
        message = 'a time is of regimes, and the scene has none; give an angle, or add [regimes.NAME] with type = "run"'
        raise InputError("--at", [(None, "", message)])
    seen, times = history(scene), np.asarray(at, float)
    failed = "" if seen.verdict == Verdict.OK else failure_text(scene, seen.verdict, seen)
    if times.min() < 0 or times.max() > seen.time[-1]:
        message = f"the regimes last from 0 to {seen.time[-1]:.6g} s" + (f": {failed}" if failed else "")
        raise InputError("--at", [(None, "", message)])
    rows = _between(seen, times)
    channels = {f"{channel}_moment": row for channel, row in seen.load_moments.items()}
    values = rows | {name: np.interp(times, seen.time, row) for name, row in channels.items()}
    about = _OF_HISTORY | {
        name: ("N m", f"torque of {name.removesuffix('_moment')} loads, reduced to the input") for name in channels
    }
    if not isinstance(scene.input, CrankInput):
        about = {name: sliding_quantity(words, unit)[::-1] for name, (unit, words) in about.items()}
        about["angle"] = ("m", "displacement of the input")
    units, long_names = ({name: pair[i] for name, pair in about.items()} for i in (0, 1))
    return Readings("time", times, values, units, long_names, failed)


def _between(seen: History, times: np.ndarray) -> dict[str, np.ndarray]:
    """Columns of a history at instants between its own: angle and speed by cubics with the slopes known."""
    after = np.clip(np.searchsorted(seen.time, times, "right"), 1, seen.time.size - 1)
    before = after - 1
    step = seen.time[after] - seen.time[before]
    # Where one regime ends and the next begins two instants are the same.
    share = np.where(step > 0, (times - seen.time[before]) / np.where(step > 0, step, 1.0), 1.0)

    def cubic(values: np.ndarray, slopes: np.ndarray) -> np.ndarray:
        begin, end = values[before], values[after]
        rise, of_begin, of_end = end - begin, step * slopes[before], step * slopes[after]
        bend = (of_begin - rise) * (1 - share) - (of_end - rise) * share
        return begin + share * rise + share * (1 - share) * bend

    def line(values: np.ndarray) -> np.ndarray:
        return values[before] + share * (values[after] - values[before])

    return {
        "angle": cubic(seen.angle, seen.speed),
        "speed": cubic(seen.speed, seen.acceleration),
        "acceleration": line(seen.acceleration),
        "motor_moment": line(seen.motor_moment),
        "energy": line(seen.energy),
    }


def readings_text(readings: Readings) -> str:
    """Readings in words and a table: a row for each quantity, a column for each place."""
    heads = [quantity_text(float(at), readings.units[readings.place]) for at in readings.at]
    rows = [["", *heads, ""]]
    for name, row in readings.values.items():
        cells = [quantity_text(float(value), readings.units[name]) for value in row]
        rows.append([name, *cells, readings.long_names[name]])
    return "\n".join([*([f"The machine as a whole: {readings.remark}"] if readings.remark else []), table(rows)])
