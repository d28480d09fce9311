"""Work cut into pieces and spread over threads.

Compiled functions run without Python's lock, in Python threads, each over its own range of variants. Numba's own
parallel loops would take several times as long to compile, abort when entered by two threads, and not survive a fork.
"""

import os
import threading
from collections.abc import Callable, Hashable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import cache, lru_cache, wraps
from itertools import pairwise

PIECES_PER_THREAD = 8
# Scratch memory of the latest calls that a thread keeps.
KEPT = 8

# `alone` marks a thread that is already working on one of several pieces.
_here = threading.local()
_settings = {"threads": 0}


def threads() -> int:
    """Number of threads that compiled functions use: the number set, or all cores available to this process."""
    if _settings["threads"]:
        return _settings["threads"]
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def set_threads(count: int) -> None:
    """Set the number of threads that compiled functions use. Results don't depend on it.

    Parameters
    ----------
    count : int
        0 for all cores.
    """
    _settings["threads"] = count


def pieces_of(count: int) -> list[tuple[int, int]]:
    """Cut a number of items into ranges (begin, end) for all threads; one range within a piece of other work.

    Parameters
    ----------
    count : int
        Number of items.
    """
    workers = threads()
    alone = workers == 1 or getattr(_here, "alone", False)
    pieces = min(count, 1 if alone else workers * PIECES_PER_THREAD)
    return list(pairwise(i * count // pieces for i in range(pieces + 1))) if pieces else []


def on_all_threads(function: Callable, pieces: Sequence) -> list:
    """Call a function for each piece of work, on all threads; calls nested in a piece stay on its thread.

    Parameters
    ----------
    function : callable
        Takes a piece.
    pieces : sequence

    Returns
    -------
    list
        Return values in the order of the pieces.
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


def kept_by_thread(make: Callable) -> Callable:
    """Scratch memory that a thread uses again in its later calls with the same arguments, and no other thread does.

    Parameters
    ----------
    make : callable
        Takes arguments that can be hashed; allocates the memory.
    """
    mine = threading.local()

    @wraps(make)
    def kept(*arguments: Hashable) -> object:
        if not hasattr(mine, "make"):
            mine.make = lru_cache(KEPT)(make)
        return mine.make(*arguments)

    return kept


@cache
def _pool(workers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers, thread_name_prefix="engine")


if hasattr(os, "register_at_fork"):
    # A forked process doesn't inherit its parent's threads.
    os.register_at_fork(after_in_child=_pool.cache_clear)
