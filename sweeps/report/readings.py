"""Quantities of one machine at single positions of its input, or at single instants of its regimes."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine import (
    CrankInput,
    History,
    InputUnits,
    Machine,
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

# Equally spaced positions between which straight lines will do: of a turn, every hundredth of a degree.
FINEST = 36_000
COARSEST = 720
# What places may be off by rounding, as shares of the cycle.
_ROUNDING = 1e-13
# The same as shares of the distance of two positions.
COUNTING = FINEST * _ROUNDING
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
        Crank angles [rad], or displacements of a sliding input [m]. Those of whole hundredths of a degree are exact;
        between them go straight lines, which miss a curve f by 4e-9 f″ at most, and a jump by its height.
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
    shares = _shares(scene, np.asarray(at, float))
    finest = FINEST * getattr(scene.input, "revolutions", 1)
    intervals = np.arange(COARSEST, finest + 1, 2)[:, None]
    exact = np.abs(shares - np.rint(shares * intervals) / intervals).max(axis=1) <= _ROUNDING
    count = int(intervals[np.argmax(exact), 0]) if exact.any() else finest
    fields = list(names) or fields_at_uniform_speed(scene)
    machine = Machine(scene, fields=fields, positions=count)
    outcome = machine.evaluate({})
    unit, verdict = InputUnits.of(scene).q, Verdict(int(outcome.status[0]))
    known = machine.available_fields
    places = shares * count
    closed = has_cycle(scene)
    return Readings(
        "phi" if unit == "rad" else "q",
        np.asarray(at, float),
        {name: _read_off(outcome.fields[name][0], places, closed, known[name].units) for name in fields},
        {name: known[name].units for name in fields} | {"phi" if unit == "rad" else "q": unit},
        {name: known[name].long_name for name in fields} | {"phi": "crank angle", "q": "displacement of the input"},
        "" if verdict in (Verdict.OK, Verdict.NOT_FINITE) else verdict.sentence,
    )


def _read_off(row: np.ndarray, places: np.ndarray, closed: bool, units: str) -> np.ndarray:
    """Values of a row at places that count its entries from 0, a place beyond the last one of a closed row too."""
    with np.errstate(invalid="ignore"):
        return _between_entries(row, places, closed, units)


def _between_entries(row: np.ndarray, places: np.ndarray, closed: bool, units: str) -> np.ndarray:
    if closed:
        turned = row[-1] + (row[1] - row[0]) - row[0]
        row = np.append(row, row[0] + (2 * np.pi * np.rint(turned / (2 * np.pi)) if units == "rad" else 0.0))
    before = np.clip(np.floor(places + COUNTING).astype(int), 0, row.size - 2)
    share = places - before
    on_entry = np.abs(share - np.rint(share)) <= COUNTING
    between = row[before] + share * (row[before + 1] - row[before])
    return np.where(on_entry, row[before + np.rint(share).astype(int)], between)


def fields_at_uniform_speed(scene: Scene) -> list[str]:
    """Names of all fields of a scene but those of its regimes."""
    return [name for name in Machine(scene).available_fields if name.partition(".")[0] not in scene.regimes]


def _shares(scene: Scene, at: np.ndarray) -> np.ndarray:
    """Positions as shares of the cycle, or of the range of the input."""
    drive = scene.input
    if has_cycle(scene):
        return np.mod(at / (2 * np.pi * drive.revolutions), 1.0)
    shares = (at - drive.start) / (drive.stop - drive.start)
    if ((shares < -_ROUNDING) | (shares > 1 + _ROUNDING)).any():
        kind = "crank angle" if isinstance(drive, CrankInput) else "displacement"
        ends = f"input.start = {drive.start:g} and input.stop = {drive.stop:g} (SI)"
        raise InputError("--at", [(None, "", f"a {kind} lies outside the range of the input, between {ends}")])
    return np.clip(shares, 0.0, 1.0)


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
