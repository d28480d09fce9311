"""What a study will cost in time and memory, measured on some of its variants."""

import time
import tracemalloc
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine import Machine, Outcome, threads
from sweeps.run.runner import block_size, evaluate_block
from sweeps.study.study import Study

# Seconds after which no more variants are tried to see what motion costs.
LONG_ENOUGH = 3.0
# Variants that are tried to see what an accuracy takes.
TRIED = 2048


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


def probe(study: Study, machine: Machine) -> Cost:
    """Cost of a study, measured on some of its variants."""
    if machine.schedule is not None:
        return _probe_motion(study, machine)
    if study.accuracy is not None:
        return _probe_accuracy(study, machine)
    size = min(block_size(study, machine), 4096)
    buffer = machine.new_buffer(size)
    evaluate_block(study, machine, slice(0, size), buffer)
    start = time.perf_counter()
    evaluate_block(study, machine, slice(0, size), buffer)
    seconds = time.perf_counter() - start
    return Cost(seconds / size, 0.0)


def _probe_accuracy(study: Study, machine: Machine) -> Cost:
    """Cost of variants from all over the study, as many positions as each takes."""
    chosen = _spread(study, min(TRIED, study.design.size))
    tried = machine.evaluate(*chosen)
    start = time.perf_counter()
    machine.evaluate(*chosen)
    return Cost((time.perf_counter() - start) / tried.status.size, 0.0, tried)


def _probe_motion(study: Study, machine: Machine) -> Cost:
    """Cost by ever more variants from all over the study: each takes its own time, and many together less than one."""
    most = min(block_size(study, machine), study.design.size)
    size, spent = min(16 * threads(), most), 0.0
    machine.evaluate(*_spread(study, size))
    memory = _peak_memory(machine, *_spread(study, size)) * most / size
    while True:
        chosen = _spread(study, size)
        start = time.perf_counter()
        machine.evaluate(*chosen)
        seconds = time.perf_counter() - start
        spent += seconds
        if size == most or spent > LONG_ENOUGH:
            return Cost(seconds / size, memory)
        size = min(8 * size, most)


def _peak_memory(machine: Machine, values: Mapping[str, np.ndarray], drop: np.ndarray | None) -> int:
    """Bytes that an evaluation takes at most, all along."""
    # Counting slows an evaluation down, so it isn't one that is timed.
    tracemalloc.start()
    machine.evaluate(values, drop)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


def _spread(study: Study, count: int) -> tuple[dict[str, np.ndarray], np.ndarray | None]:
    """Numbers of so many variants evenly spread over a study, and which of them are dropped."""
    if not study.paths:
        return {}, None
    parts = [study.values(int(i), int(i) + 1) for i in np.linspace(0, study.design.size - 1, count)]
    return {p: np.concatenate([v[p] for v, _ in parts]) for p in study.paths}, np.concatenate([d for _, d in parts])
