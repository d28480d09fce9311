"""Field balancing of a rotor from a table of trial runs: correction weights, and the residual from noise.

Each row is a run: plane, trial weight, and the once-per-turn amplitude and phase of each sensor. One run has no weight.
For one plane amplitudes suffice, with the trial weight at three angles 120° apart.
"""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

import engine
from sweeps.text.csv_text import TableColumn, read_csv
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

PROBABILITY = 0.95
PHASE = "_phase"
OF_WEIGHTS = ("plane", "weight", "weight_angle")
# Tolerance of the 120° spacing in four runs [deg].
THIRD_OF_A_TURN = 0.5
HEADER = "plane, weight [g], weight_angle [deg], left [mm/s], left_phase [deg]"


class Runs(NamedTuple):
    """Trial runs from a table.

    Attributes
    ----------
    planes : tuple of int
        Plane number of each trial run.
    weights : ndarray of complex (trials,)
        Trial weights with their angles, in `weight_unit`.
    initial : ndarray of complex (readings,)
        Readings without a weight, in `unit`; real amplitudes if there are no phases.
    trials : ndarray of complex (trials, readings)
    names : tuple of str
        Names of the readings.
    phases : bool
        Whether phases were read.
    weight_unit, unit : str
    """

    planes: tuple[int, ...]
    weights: np.ndarray
    initial: np.ndarray
    trials: np.ndarray
    names: tuple[str, ...]
    phases: bool
    weight_unit: str
    unit: str


class Correction(NamedTuple):
    """Correction weights in each plane, at the radius of the trial weights.

    Attributes
    ----------
    planes : tuple of int
    weights : ndarray of complex (planes,)
        In the trial weights' unit.
    coefficients : ndarray of complex (readings, planes)
        Vibration per weight; for four runs its amplitude.
    left : ndarray (readings,)
        Residual amplitudes of a linear machine.
    radii : ndarray (planes,) or None
        95 % bound on each plane's residual unbalance from noise.
    """

    planes: tuple[int, ...]
    weights: np.ndarray
    coefficients: np.ndarray
    left: np.ndarray
    radii: np.ndarray | None


def read_runs(path: Path) -> Runs:
    """Trial runs of a CSV table.

    Parameters
    ----------
    path : Path
        Columns `plane`, `weight [g]`, `weight_angle [deg]`, and for each sensor NAME `NAME [mm/s]` and, except for four
        runs, `NAME_phase [deg]`; any units.

    Raises
    ------
    InputError
        Wrong columns, not exactly one run without a weight, or inconsistent units.
    """
    columns = read_csv(path)
    for key in OF_WEIGHTS:
        if key not in columns:
            message = f"no column {key!r}: the header is such as '{HEADER}', it has {', '.join(columns)}"
            raise InputError.of(str(path), message, 1)
    names = tuple(name for name in columns if name not in OF_WEIGHTS and not name.endswith(PHASE))
    phases = [name for name in names if f"{name}{PHASE}" in columns]
    if not names or phases not in ([], list(names)):
        raise InputError.of(str(path), "every sensor needs an amplitude NAME [mm/s] and a phase NAME_phase [deg]", 1)
    unit, weight_unit = _common_unit(path, columns, names), _common_unit(path, columns, ["weight"])
    weights = _polar(columns, "weight", "weight_angle")
    readings = np.stack([_polar(columns, n, f"{n}{PHASE}" if phases else None) for n in names], axis=-1)
    if (first := np.flatnonzero(weights == 0)).size != 1:
        raise InputError.of(str(path), f"exactly one run must have no trial weight (weight 0); there are {first.size}")
    trials = np.flatnonzero(weights)
    planes = np.array(columns["plane"].plain_numbers())[trials]
    if not (planes == np.round(planes)).all():
        raise InputError.of(str(path), "planes must be whole numbers, such as 1 and 2")
    numbers = tuple(int(plane) for plane in planes)
    return Runs(numbers, weights[trials], readings[first[0]], readings[trials], names, bool(phases), weight_unit, unit)


def correction_of(path: Path, runs: Runs, noise: str | None = None) -> Correction:
    """Compute the correction weights.

    Parameters
    ----------
    path : Path
        Source of the runs, for messages.
    runs : Runs
    noise : str, optional
        Standard deviation of a reading's real and imaginary part, such as "0.1 mm/s".

    Raises
    ------
    InputError
        A plane without a single trial run, sensors that can't separate the planes, or amplitudes that no linear
        machine gives.
    """
    return _by_coefficients(path, runs, noise) if runs.phases else _by_amplitudes(path, runs, noise)


def trial_runs_text(path: Path, noise: str | None = None, holes: int | None = None) -> str:
    """Report on the balance of a rotor from trial runs.

    Parameters
    ----------
    path : Path
        As for `read_runs`.
    noise : str, optional
        As for `correction_of`.
    holes : int, optional
        Number of equally spaced holes per plane, at the radius of the trial weights, the first at the mark.

    Raises
    ------
    InputError
        As for both; fewer than three holes.
    """
    runs = read_runs(path)
    found = correction_of(path, runs, noise)
    unit = runs.weight_unit
    columns = [
        ("plane", *(str(plane) for plane in found.planes)),
        ("add", *(f"{abs(weight):.4g} {unit}" for weight in found.weights)),
        ("at", *(degrees_text(weight) for weight in found.weights)),
    ]
    if holes is not None:
        columns.append((f"or in two of {holes} holes", *_in_holes(found.weights, holes, unit)))
    if found.radii is not None:
        columns.append(("residual from noise", *(f"{radius:.2g} {unit}" for radius in found.radii)))
    rows = list(zip(*columns, strict=True))
    per = f"{runs.unit} per {runs.weight_unit}".strip()
    effects = [("sensor", "initial", *(f"plane {plane}, {per}" for plane in found.planes), "left")]
    for name, first, row, left in zip(runs.names, runs.initial, found.coefficients, found.left, strict=True):
        shown = [f"{abs(c):.4g}" + (f" at {degrees_text(c)}" if runs.phases else "") for c in row]
        rest = f"{left:.2g}" if left > 1e-9 * abs(first) else "0"
        effects.append((name, f"{abs(first):.4g} {runs.unit}", *shown, f"{rest} {runs.unit}"))
    notes = ["Use the radius and angle convention of the trial weights, and remove the trial weights."]
    if holes is not None:
        notes.append("Hole 1 is at the mark; holes are numbered in the direction of the angles.")
    if found.radii is not None:
        notes.append(f"The residual unbalance from noise is below this bound with a probability of {PROBABILITY:.0%}.")
    return "\n".join([table(rows), "", table(effects), "", *notes])


def _in_holes(weights: np.ndarray, holes: int, unit: str) -> list[str]:
    """Each weight split between its two neighbouring holes, numbered from 1."""
    try:
        split = engine.split_on_neighbours(weights, holes)
    except engine.PatternError as error:
        raise InputError.of("--holes", str(error)) from None
    parts = zip(split.hole + 1, split.amount, split.next_hole + 1, split.next_amount, strict=True)
    return [f"{first:.4g} {unit} in {hole}, {second:.4g} {unit} in {beside}" for hole, first, beside, second in parts]


def _by_coefficients(path: Path, runs: Runs, noise: str | None) -> Correction:
    planes = tuple(sorted(set(runs.planes)))
    if len(planes) != len(runs.planes):
        raise InputError.of(str(path), "with phases each plane needs exactly one trial run")
    if len(planes) > len(runs.names):
        message = f"{len(planes)} planes need at least {len(planes)} sensors; there are {len(runs.names)}"
        raise InputError.of(str(path), message)
    order = np.argsort(runs.planes)
    weights = runs.weights[order]
    coefficients = engine.influence_coefficients(runs.initial, runs.trials[order], weights)
    found = engine.influence_correction(coefficients, runs.initial)
    if not np.isfinite(found).all():
        raise InputError.of(str(path), "the sensors can't separate the planes: move them, or omit a plane")
    radii = None
    if noise is not None:
        sigma = _noise(runs, noise)
        radii = engine.residual_confidence(coefficients, found, weights, sigma, PROBABILITY).radii
    return Correction(planes, found, coefficients, np.abs(runs.initial + coefficients @ found), radii)


def _by_amplitudes(path: Path, runs: Runs, noise: str | None) -> Correction:
    """One plane from four runs without phases."""
    needed = (
        "without phases: one plane, one sensor, and the same trial weight in three runs at angles 120 deg apart; "
        f"or give phases, NAME{PHASE} [deg]"
    )
    sizes, angles = np.abs(runs.weights), np.degrees(np.angle(runs.weights / runs.weights[:1]))
    # Start one degree early, so that rounding keeps the order.
    order = np.argsort((angles + 1.0) % 360.0)
    thirds = np.abs((angles[order] - (0.0, 120.0, 240.0) + 180) % 360 - 180) if order.size == 3 else np.full(1, np.inf)
    alike = np.ptp(sizes) <= 1e-9 * sizes[0]
    if len(set(runs.planes)) != 1 or len(runs.names) != 1 or not alike or thirds.max() > THIRD_OF_A_TURN:
        raise InputError.of(str(path), needed)
    if noise is not None:
        raise InputError.of(str(path), "--noise requires runs with phases")
    found = engine.four_runs(abs(runs.initial[0]), np.abs(runs.trials[order, 0]), sizes[0])
    if not np.isfinite(found.unbalance):
        message = "no linear machine gives these amplitudes: repeat the readings, or use a heavier trial weight"
        raise InputError.of(str(path), message)
    direction = runs.weights[0] / sizes[0]
    weight = -found.unbalance * direction
    return Correction((runs.planes[0],), np.array([weight]), np.array([[found.sensitivity]]), np.zeros(1), None)


def _polar(columns: dict[str, TableColumn], size: str, angle: str | None) -> np.ndarray:
    """Complex numbers from a column of amplitudes in its unit and one of angles."""
    sizes = np.array(columns[size].plain_numbers())
    if angle is None:
        return sizes.astype(complex)
    angles = replace(columns[angle], unit=columns[angle].unit or "deg")
    return sizes * np.exp(1j * np.array(angles.numbers("angle")))


def _common_unit(path: Path, columns: dict[str, TableColumn], names: Iterable[str]) -> str:
    units = {columns[name].unit for name in names}
    if len(units) > 1:
        raise InputError.of(str(path), f"all sensors must use one unit; these use {', '.join(sorted(units))}", 1)
    (unit,) = units
    try:
        engine.dimension_of_unit(unit or "1")
    except engine.UnitError as error:
        raise InputError.of(str(path), str(error), 1) from None
    return unit


def _noise(runs: Runs, noise: str) -> float:
    """The standard deviation in the unit of the readings."""
    try:
        (value, kind), (one, wanted) = engine.recognised(noise), engine.recognised(f"1 {runs.unit}".strip())
    except engine.UnitError as error:
        raise InputError.of("--noise", str(error)) from None
    if kind != wanted or not 0 < value < np.inf:
        raise InputError.of("--noise", f"{noise!r}: give it in the unit of the readings, '0.1 {runs.unit}'")
    return value / one


def degrees_text(number: complex) -> str:
    """Angle of a complex number, from 0° to 360°."""
    return f"{np.degrees(np.angle(number)) % 360:.1f}°"
