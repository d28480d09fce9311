"""How all measurements of speed take processor time, and on which processor."""

import platform
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np


def seconds(run: Callable[[], object]) -> float:
    """Processor time of a run [s]."""
    start = time.process_time()
    run()
    return time.process_time() - start


def times_by_turns(runs: Sequence[Callable[[], object]], rounds: int, twice: bool = False) -> np.ndarray:
    """Processor times [s] of some runs by turns, (runs, rounds): what else the computer does falls on all.

    `twice`: each runs a first time unmeasured, as what another left in caches and freed would count for it.
    """
    times = np.empty((len(runs), rounds))
    for turn in range(rounds):
        for i, run in enumerate(runs):
            if twice:
                run()
            times[i, turn] = seconds(run)
    return times


def least_time(run: Callable[[], object], rounds: int = 5) -> float:
    """Processor time [s], the least of some rounds after a first one, which compiles."""
    run()
    return float(times_by_turns([run], rounds).min())


def processor() -> str:
    """Model of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
