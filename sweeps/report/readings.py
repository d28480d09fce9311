"""Quantities of one machine at given input positions."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

import engine
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

# Rounding tolerance of a position, as a share of the range.
_ROUNDING = 1e-13


class Readings(NamedTuple):
    """Values of quantities at some positions or times.

    Attributes
    ----------
    place : str
        Name of the coordinate: "phi", "q" or "time".
    at : ndarray (positions,)
        Positions or times [rad, m or s].
    values : dict of str to ndarray (positions,)
        SI.
    units, long_names : dict of str to str
        Including the coordinate.
    remark : str
        What is wrong with the machine as a whole, or "".
    further : tuple of str
        Fields that are only shown if all are requested.
    regimes : sequence of str
        Regime at each time; empty for positions.
    """

    place: str
    at: np.ndarray
    values: dict[str, np.ndarray]
    units: dict[str, str]
    long_names: dict[str, str]
    remark: str = ""
    further: tuple[str, ...] = ()
    regimes: Sequence[str] = ()


def readings_at(scene: engine.Scene, at: Sequence[float] | int, names: Sequence[str] = ()) -> Readings:
    """Fields of one machine at input positions.

    Parameters
    ----------
    scene : Scene
        With a mechanism.
    at : sequence of float, or int
        Crank angles [rad], or displacements of a sliding input [m]; or the number of positions spread over the cycle.
    names : sequence of str
        Fields (default: all at constant input speed).

    Raises
    ------
    InputError
        The scene has no mechanism, or a position is outside the input's range.
    AskError
        There is no such field, or the number of positions isn't allowed.
    """
    if scene.input is None:
        message = "the scene has only machine elements, which have no positions; `sweeps run` gives their numbers"
        raise InputError.of(scene.title or "scene", message)
    unit = engine.InputUnits.of(scene).q
    given = None if isinstance(at, int) else np.asarray(at, float)
    machine = engine.MovingMachine(scene, positions=at if given is None else _in_range(scene, given))
    known, place = machine.register.fields, "phi" if unit == "rad" else "q"
    fields = list(names) or list(machine.register.available_fields)
    verdict = machine.verdict(fields)
    remark = "" if verdict in (engine.Verdict.OK, engine.Verdict.NOT_FINITE) else verdict.sentence
    if verdict == engine.Verdict.CANNOT_ASSEMBLE:
        remark = assembled_text(machine.mechanics)
    return Readings(
        place,
        machine.q if given is None else given,
        {name: machine.without_rounding(name, row) for name, row in machine.fields(fields).items()},
        {name: known[name].units for name in fields} | {place: unit},
        {name: known[name].long_name for name in fields} | {"phi": "crank angle", "q": "input displacement"},
        remark,
        tuple(name for name in fields if known[name].rank == engine.Rank.FURTHER),
    )


def assembled_text(mechanics: engine.Mechanics) -> str:
    """Where a machine can be assembled, if not everywhere."""
    ranges, unit = engine.assembly_ranges(mechanics), engine.InputUnits.of(mechanics.scene).q
    if not ranges:
        return "can't be assembled at any input position: check lengths and modes"
    shown = ", ".join(f"{engine.quantity_text(r.start, unit)} … {engine.quantity_text(r.stop, unit)}" for r in ranges)
    return f"assembles only for input {shown}: give input.start and input.stop, or change the lengths"


def _in_range(scene: engine.Scene, at: np.ndarray) -> np.ndarray:
    """Positions within the cycle or the input's range."""
    drive = scene.input
    if scene.has_cycle:
        return np.mod(at, math.tau * drive.revolutions)
    shares = (at - drive.start) / (drive.stop - drive.start)
    if ((shares < -_ROUNDING) | (shares > 1 + _ROUNDING)).any():
        kind = "crank angle" if isinstance(drive, engine.CrankInput) else "displacement"
        unit = engine.InputUnits.of(scene).q
        start, stop = (engine.quantity_text(end, unit) for end in (drive.start, drive.stop))
        ends = f"input.start = {start} and input.stop = {stop}"
        raise InputError.of("--at", f"a {kind} is outside the input range, {ends}")
    return np.clip(at, *sorted((drive.start, drive.stop)))


def readings_text(readings: Readings, every: bool = True) -> str:
    """Readings as a table: a row per quantity, of all or only the main ones, a column per position."""
    heads = [engine.quantity_text(float(at), readings.units[readings.place]) for at in readings.at]
    rows = [["", *heads, ""], *([["regime", *readings.regimes, ""]] if len(readings.regimes) else [])]
    shown = {name: row for name, row in readings.values.items() if every or name not in readings.further}
    # A machine that fails as a whole leaves many undefined.
    known = {name: row for name, row in shown.items() if not readings.remark or np.isfinite(row).any()}
    for name, row in known.items():
        cells = [engine.quantity_text(float(value), readings.units[name]) for value in row]
        rows.append([name, *cells, readings.long_names[name]])
    remark = [f"The machine as a whole: {readings.remark}"] if readings.remark else []
    more, lost = len(readings.values) - len(shown), len(shown) - len(known)
    words = {"more with --all.": more, "more are undefined here.": lost}
    return "\n".join([*remark, table(rows), *(f"{count} {which}" for which, count in words.items() if count)])
