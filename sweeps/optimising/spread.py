"""Spread of results from tolerances: Monte Carlo, and to first order."""

from collections.abc import Mapping

import numpy as np
from scipy.special import ndtri

from engine import Verdict, made_ready
from sweeps.store import Column
from sweeps.study.search_task import SearchTask
from sweeps.study.sensitivity import Tolerance
from sweeps.study.study_content import ReadyMachine
from sweeps.study.unit_points import sobol_points
from sweeps.text.conditions import met_by

# Samples per candidate: the spread is accurate to about 3 %.
DRAWN = 512
# Step for slopes, as a share of the tolerance.
STEP = 1e-2
# Candidates evaluated together, to bound memory.
TOGETHER = 64


def spread_columns(task: SearchTask) -> list[Column]:
    """Columns filled by `spreads`; none without tolerances."""
    if not task.tolerances:
        return []
    found = [Column("tolerance_misses", "fraction of toleranced machines that fail or miss a condition", "1")]
    for name in task.study.summaries:
        quantity = task.study.machine().available_summaries[name]
        words = f"standard deviation from tolerances: {quantity.long_name}"
        found.append(Column(f"{name}.tolerance", words, quantity.units))
        found.append(Column(f"{name}.tolerance_first_order", f"{words}, to first order", quantity.units))
    return found


def spreads(task: SearchTask, columns: Mapping[str, np.ndarray], chosen: np.ndarray) -> dict[str, np.ndarray]:
    """Standard deviations of all summaries from tolerances, for some candidates.

    Derived numbers don't follow a toleranced one: each part is made separately. Monte Carlo draws scrambled Sobol'
    points; to first order the variances (∂f/∂p σ)² add up, with slopes by central differences.

    Parameters
    ----------
    task : SearchTask
    columns : mapping of str to ndarray (candidates,)
    chosen : ndarray of int
        Numbers of the candidates.

    Returns
    -------
    dict of str to ndarray (candidates,)
        As for `spread_columns`; NaN for other candidates.
    """
    if not task.tolerances:
        return {}
    size, study = columns["status"].size, task.study
    paths = tuple(dict.fromkeys([*study.paths, *(t.path for t in task.tolerances)]))
    machine = made_ready(study.scene, study.summaries, (), paths, study.positions, np.dtype(study.field_precision).type)
    found = {column.name: np.full(size, np.nan) for column in spread_columns(task)}
    for start in range(0, chosen.size, TOGETHER):
        some = chosen[start : start + TOGETHER]
        made = {name: values[some] for name, values in columns.items()}
        for name, values in _spread(task, machine, made).items():
            found[name][some] = values
    return found


def _spread(task: SearchTask, machine: ReadyMachine, made: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Columns of `spreads` for one batch."""
    off = np.vstack([_drawn(task.tolerances, task.seed), _moved(task.tolerances)])
    fixed, count = task.study.fixed, made["status"].size
    nominal = {path: np.broadcast_to(made.get(path, fixed[path]), (count,)) for path in machine.varied}
    values = {path: np.repeat(row, len(off)) for path, row in nominal.items()}
    for tolerance, column in zip(task.tolerances, off.T, strict=True):
        values[tolerance.path] = values[tolerance.path] + np.tile(column, count)
    outcome = machine.evaluate(values)
    made = {name: np.repeat(column, len(off)) for name, column in made.items()}
    errors = {f"{name}_error": error for name, error in outcome.errors.items()}
    known = task.study.requirements.known(made | values | outcome.summaries | errors)
    met = met_by((*task.study.require, *task.conditions), *known, outcome.status.size)
    misses = ~met | (outcome.status != Verdict.OK)
    found = {"tolerance_misses": misses.reshape(count, -1)[:, :DRAWN].mean(axis=1)}
    for name in task.study.summaries:
        table = outcome.summaries[name].reshape(count, -1)
        drawn, moved = table[:, :DRAWN], table[:, DRAWN:].reshape(count, -1, 2)
        slopes = (moved[:, :, 0] - moved[:, :, 1]) / (2 * STEP * np.array([t.half_width for t in task.tolerances]))
        deviations = np.array([t.deviation for t in task.tolerances])
        found[f"{name}.tolerance"] = _deviation(drawn)
        found[f"{name}.tolerance_first_order"] = np.sqrt(((slopes * deviations) ** 2).sum(axis=1))
    return found


def _deviation(drawn: np.ndarray) -> np.ndarray:
    """Standard deviation of the defined values in each row."""
    there = np.isfinite(drawn)
    count = np.maximum(there.sum(axis=1), 1)
    # Relative to the first defined value, so that constants have no spread from rounding.
    first = drawn[np.arange(len(drawn)), there.argmax(axis=1)]
    apart = np.where(there, drawn - first[:, None], 0.0)
    square = np.where(there, apart - (apart.sum(axis=1) / count)[:, None], 0.0) ** 2
    return np.where(there.any(axis=1), np.sqrt(square.sum(axis=1) / count), np.nan)


def _drawn(tolerances: tuple[Tolerance, ...], seed: int) -> np.ndarray:
    """Deviations of the sampled machines (DRAWN, tolerances)."""
    # Half a unit in the last place keeps normal deviations finite.
    unit = sobol_points(seed, DRAWN, len(tolerances), np.arange(DRAWN)) + 2.0**-31
    return np.column_stack(
        [
            t.deviation * ndtri(u) if t.distribution == "normal" else t.half_width * (2 * u - 1)
            for t, u in zip(tolerances, unit.T, strict=True)
        ]
    )


def _moved(tolerances: tuple[Tolerance, ...]) -> np.ndarray:
    """Deviations with one number moved up or down (2 tolerances, tolerances)."""
    steps = STEP * np.diag([t.half_width for t in tolerances])
    return np.stack([steps, -steps], axis=1).reshape(-1, len(tolerances))
