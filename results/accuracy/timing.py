"""Time that a machine takes for a variant."""

import time

import numpy as np

from engine import Machine

ROUNDS = 5


def microseconds(machine: Machine, varied: dict[str, np.ndarray]) -> float:
    """Time of a variant [µs], the median of several rounds after one that compiles."""
    machine.evaluate(varied)
    rounds = []
    for _ in range(ROUNDS):
        begin = time.thread_time()
        machine.evaluate(varied)
        rounds.append(time.thread_time() - begin)
    return float(np.median(rounds)) / next(iter(varied.values())).size * 1e6
