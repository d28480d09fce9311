"""What a study will cost in time and memory, measured on some of its variants."""

import time
import tracemalloc
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine import ElementsAlone, Machine, Outcome, threads
from sweeps.run.blocks import evaluate_variants, most_at_once
from sweeps.study.study import Study
from sweeps.text.engineer_units import quantity_text

# Seconds after which no more variants are tried to see what they cost.
LONG_ENOUGH = 0.3
# Variants that are tried at most; and to see what an accuracy takes.
MOST_TRIED, TRIED = 4096, 2048
# Variants that aren't worth a trial.
FEW = 8
# So many times what was tried, a study is worth trying it again: that takes a tenth of its time at most.
WORTH_TWO = 10
# Places of a study that tried variants are from.
PLACES = 16


class Cost(NamedTuple):
    """What a study costs.

    Attributes
    ----------
    seconds : float
        Of a variant, once compiled.
    motion_bytes : float
        Memory of its motion.
    tried : Outcome or None
        Of variants from all over the study, where an accuracy is asked.
    """

    seconds: float
    motion_bytes: float
    tried: Outcome | None = None


def probe(study: Study, machine: Machine | ElementsAlone) -> Cost:
    """Cost of a study, measured on some of its variants; of runs on elastic shafts that take long, forecast."""
    forecast = seconds_on_shafts(study, machine)
    if forecast > LONG_ENOUGH:
        return Cost(forecast, 0.0)
    if machine.schedule is not None:
        size, most = min(16 * threads(), study.design.size), min(most_at_once(study, machine), study.design.size)
        seconds = seconds_of_variant(study, machine)
        values, drop = _spread(study, size)
        memory = _peak_memory(machine, {path: values[path] for path in study.paths}, drop)
        return Cost(seconds, memory * most / size)
    tried = None
    if study.accuracy is not None:
        values, drop = _spread(study, min(TRIED, study.design.size))
        tried = machine.evaluate({path: values[path] for path in study.paths}, drop if study.paths else None)
    return Cost(seconds_of_variant(study, machine), 0.0, tried)


def seconds_of_variant(study: Study, machine: Machine | ElementsAlone) -> float:
    """What a variant takes, by ever more variants from all over the study.

    Each takes its own time, and many together less than one.
    """
    most = min(most_at_once(study, machine), study.design.size, MOST_TRIED)
    forecast = seconds_on_shafts(study, machine)
    if forecast > LONG_ENOUGH:
        return forecast
    # What isn't compiled yet is, or all but what the first variant, dropped or failing early, doesn't come to.
    _seconds_of(study, machine, 1)
    count = min(4 * threads(), most)
    while True:
        seconds = _seconds_of(study, machine, count)
        if seconds > LONG_ENOUGH and study.design.size > WORTH_TWO * count:
            # The rest may have been compiled meanwhile, or the processor been busy otherwise.
            seconds = min(seconds, _seconds_of(study, machine, count))
        if count == most or seconds > LONG_ENOUGH:
            return seconds / count
        count = min(8 * count, most)


def seconds_on_shafts(study: Study, machine: Machine | ElementsAlone) -> float:
    """What runs on elastic shafts take of a variant, by their steps, without following any to its end; 0 without."""
    if isinstance(machine, ElementsAlone):
        return 0.0
    values, drop = _spread(study, min(PLACES, study.design.size))
    return machine.seconds_on_shafts({path: values[path][~drop] for path in study.paths})


def on_shafts_text(study: Study, machine: Machine | ElementsAlone) -> str:
    """How long runs on elastic shafts will take, said before they begin; "" where they don't take long."""
    seconds = seconds_on_shafts(study, machine)
    if seconds <= LONG_ENOUGH:
        return ""
    each, whole = (quantity_text(float(f"{number:.2g}"), "s") for number in (seconds, seconds * study.design.size))
    return f"Runs on elastic shafts go step by step: about {each} a variant, {whole} in all; less on softer shafts."


def _seconds_of(study: Study, machine: Machine | ElementsAlone, count: int) -> float:
    """What so many variants take together."""
    chosen = _spread(study, count)
    start = time.perf_counter()
    evaluate_variants(study, machine, *chosen)
    return time.perf_counter() - start


def _peak_memory(machine: Machine, values: Mapping[str, np.ndarray], drop: np.ndarray) -> int:
    """Bytes that an evaluation takes at most, all along."""
    # Counting slows an evaluation down, so it isn't one that is timed.
    tracemalloc.start()
    machine.evaluate(values, drop if values else None)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


def _spread(study: Study, count: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
    """Numbers of so many variants, from places evenly spread over a study, and which of them are dropped."""
    ends = np.linspace(0, count, min(PLACES, count) + 1).astype(int)
    widths = np.diff(ends)
    starts = np.linspace(0, study.design.size - widths.max(), widths.size).astype(np.int64)
    parts = [study.values(int(start), int(start + width)) for start, width in zip(starts, widths, strict=True)]
    return {p: np.concatenate([v[p] for v, _ in parts]) for p in study.parameters}, np.concatenate(
        [d for _, d in parts]
    )
