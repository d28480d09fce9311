"""Threads: work cut into pieces, each piece on a thread.

Compiled functions run without Python's lock, in Python threads, each over its own range of variants. Numba's own
parallel loops would take several times as long to compile, abort when two threads enter them, and not survive a fork.
"""

import os
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from itertools import pairwise

PIECES_PER_THREAD = 8

# Whether the work on this thread is already one of several pieces.
_here = threading.local()
_settings = {"threads": 0}


def threads() -> int:
    """Threads that compiled functions use: as set, or all cores that this process may use."""
    if _settings["threads"]:
        return _settings["threads"]
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def set_threads(count: int) -> None:
    """Set how many threads compiled functions use; 0 for all cores. Results don't depend on it.

    Parameters
    ----------
    count : int
    """
    _settings["threads"] = count


def pieces_of(count: int) -> list[tuple[int, int]]:
    """Ranges that some items of work are cut into; one on a thread whose work is such a piece itself.

    Parameters
    ----------
    count : int
        How many items there are.
    """
    workers = threads()
    alone = workers == 1 or getattr(_here, "alone", False)
    pieces = min(count, 1 if alone else workers * PIECES_PER_THREAD)
    return list(pairwise(i * count // pieces for i in range(pieces + 1))) if pieces else []


def on_all_threads(function: Callable, pieces: Sequence) -> list:
    """Call a function for every piece of some work, on all threads; what it calls stays on the thread it is on.

    Parameters
    ----------
    function : callable
    pieces : sequence

    Returns
    -------
    list
        What the function returned, in the order of the pieces.
    """
    workers = threads()
    if workers == 1 or len(pieces) <= 1 or getattr(_here, "alone", False):
        return [function(piece) for piece in pieces]

    def alone(piece: object) -> object:
        _here.alone = True
        try:
            return function(piece)
        finally:
            _here.alone = False

    return list(_pool(workers).map(alone, pieces))


@cache
def _pool(workers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers, thread_name_prefix="engine")


if hasattr(os, "register_at_fork"):
    # Threads don't come along into a forked process.
    os.register_at_fork(after_in_child=_pool.cache_clear)
