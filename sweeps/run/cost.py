"""Time and memory of a study, measured on some of its variants."""

import time
import tracemalloc
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine import ElementsAlone, Machine, Outcome, quantity_text, seconds_of_runs, threads
from sweeps.run.blocks import evaluate_variants, most_at_once
from sweeps.study.study import Study

# Time limit of the trials [s].
LONG_ENOUGH = 0.3
# Maximum trial variants; and the number for an accuracy.
MOST_TRIED, TRIED = 4096, 2048
# Repeat a trial if the study is this many times larger: at most a tenth of its time.
WORTH_TWO = 10
# Number of positions in a study from which trial variants are taken.
PLACES = 16


class Cost(NamedTuple):
    """Cost of a study.

    Attributes
    ----------
    seconds : float
        Per variant, compiled.
    motion_bytes : float
        Memory of its motion.
    tried : Outcome or None
        Outcome of spread-out variants, if an accuracy is requested.
    """

    seconds: float
    motion_bytes: float
    tried: Outcome | None = None


def probe(study: Study) -> Cost:
    """Cost of a study, measured on some variants; for long runs on elastic shafts, forecast."""
    forecast, machine = seconds_on_shafts(study), study.machine()
    if forecast > LONG_ENOUGH:
        return Cost(forecast, 0.0)
    if machine.has_regimes:
        size, most = min(16 * threads(), study.design.size), min(most_at_once(study), study.design.size)
        seconds = seconds_of_variant(study)
        values, drop = _spread(study, size)
        memory = _peak_memory(machine, {path: values[path] for path in study.paths}, drop)
        return Cost(seconds, memory * most / size)
    tried = None
    if study.accuracy is not None:
        values, drop = _spread(study, min(TRIED, study.design.size))
        tried = machine.evaluate({path: values[path] for path in study.paths}, drop if study.paths else None)
    return Cost(seconds_of_variant(study), 0.0, tried)


def seconds_of_variant(study: Study) -> float:
    """Time per variant, from growing samples of the whole study.

    Times vary, and large batches take less per variant.
    """
    most = min(most_at_once(study), study.design.size, MOST_TRIED)
    forecast = seconds_on_shafts(study)
    if forecast > LONG_ENOUGH:
        return forecast
    # Compile first; a variant that is dropped or fails early may miss some functions.
    _seconds_of(study, 1)
    count = min(4 * threads(), most)
    while True:
        seconds = _seconds_of(study, count)
        if seconds > LONG_ENOUGH and study.design.size > WORTH_TWO * count:
            # Repeat, as the first time may include compilation or other load.
            seconds = min(seconds, _seconds_of(study, count))
        if count == most or seconds > LONG_ENOUGH:
            return seconds / count
        count = min(8 * count, most)


def seconds_on_shafts(study: Study) -> float:
    """Forecast time per variant of runs on elastic shafts from their steps; 0 without any."""
    if isinstance(study.machine(), ElementsAlone):
        return 0.0
    values, drop = _spread(study, min(PLACES, study.design.size))
    return seconds_of_runs(study.machine(), {path: values[path][~drop] for path in study.paths})


def on_shafts_text(study: Study) -> str:
    """Forecast of long runs on elastic shafts, as text; "" if short."""
    seconds = seconds_on_shafts(study)
    if seconds <= LONG_ENOUGH:
        return ""
    each, whole = (quantity_text(float(f"{number:.2g}"), "s") for number in (seconds, seconds * study.design.size))
    return f"Runs on elastic shafts: about {each} per variant, {whole} in total (less on softer shafts)."


def _seconds_of(study: Study, count: int) -> float:
    """Time of some variants together."""
    chosen = _spread(study, count)
    start = time.perf_counter()
    evaluate_variants(study, *chosen)
    return time.perf_counter() - start


def _peak_memory(machine: Machine, values: Mapping[str, np.ndarray], drop: np.ndarray) -> int:
    """Peak memory of an evaluation [bytes]."""
    # Tracing slows the evaluation, so it isn't timed.
    tracemalloc.start()
    machine.evaluate(values, drop if values else None)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


def _spread(study: Study, count: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Parameters of variants spread evenly over a study, and which are dropped."""
    ends = np.linspace(0, count, min(PLACES, count) + 1).astype(int)
    widths = np.diff(ends)
    starts = np.linspace(0, study.design.size - widths.max(), widths.size).astype(np.int64)
    parts = [study.values(int(start), int(start + width)) for start, width in zip(starts, widths, strict=True)]
    values = {name: np.concatenate([part[name] for part, _ in parts]) for name in study.parameters}
    return values, np.concatenate([drop for _, drop in parts])
