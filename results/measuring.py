"""Processor time and type of processor, for all speed measurements."""

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


def alternating_times(runs: Sequence[Callable[[], object]], rounds: int, twice: bool = False) -> np.ndarray:
    """Processor times [s] of some runs in turn, (runs, rounds), so that other load on the computer affects all.

    `twice`: each first runs unmeasured, so that caches and memory left by another don't count.
    """
    times = np.empty((len(runs), rounds))
    for turn in range(rounds):
        for i, run in enumerate(runs):
            if twice:
                run()
            times[i, turn] = seconds(run)
    return times


def least_time(run: Callable[[], object], rounds: int = 5) -> float:
    """Minimum processor time [s] of some rounds after a first one, which compiles."""
    run()
    return float(alternating_times([run], rounds).min())


def processor() -> str:
    """Model of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
