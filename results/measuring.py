"""Processor time, type of processor and random variants, for all speed measurements."""

import platform
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from engine import scene_numbers


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


def sample(case: Any, variants: int, seed: int = 1) -> dict[str, np.ndarray]:
    """Random variants of a case, which has a `scene` and relative spreads by path, `varied`: uniform values by path."""
    rng, numbers = np.random.default_rng(seed), scene_numbers(case.scene)
    return {path: numbers[path].value * rng.uniform(1 - s, 1 + s, variants) for path, s in case.varied.items()}


def processor() -> str:
    """Model of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
