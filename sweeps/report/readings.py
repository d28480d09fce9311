"""Quantities of one machine at single positions of its input."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine import (
    CrankInput,
    InputUnits,
    MovingMachine,
    Scene,
    Verdict,
    has_cycle,
)
from sweeps.text.engineer_units import quantity_text
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

# How far a place may be off by rounding, as a share of the range.
_ROUNDING = 1e-13


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
    fields = list(names) or list(machine.register.available_fields)
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


def readings_text(readings: Readings) -> str:
    """Readings in words and a table: a row for each quantity, a column for each place."""
    heads = [quantity_text(float(at), readings.units[readings.place]) for at in readings.at]
    rows = [["", *heads, ""]]
    for name, row in readings.values.items():
        cells = [quantity_text(float(value), readings.units[name]) for value in row]
        rows.append([name, *cells, readings.long_names[name]])
    return "\n".join([*([f"The machine as a whole: {readings.remark}"] if readings.remark else []), table(rows)])
