"""Compile in a second process what this one needs next; both share the cache of machine code on disk."""

import atexit
import pickle
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress

from engine.compiling.kept_code import cache_folder, is_kept
from engine.compiling.threads import threads

# Takes over the search path of its parent: the working folder may hold modules of the same names.
_CHILD = """
import pickle, sys
sys.path[:], function, given = pickle.load(sys.stdin.buffer), *map(pickle.load, [sys.stdin.buffer] * 2)
function(given)
"""
_running: list[subprocess.Popen] = []


def compile_beside(function: Callable[[object], None], given: object, compiled: Callable) -> None:
    """Call a function that compiles another one in a second process, unless its machine code is in the cache.

    Without a second core, or a cache, nothing is done; this process then compiles when the code is needed.

    Parameters
    ----------
    function : callable
        A module's, called with `given`.
    given : object
        What can be pickled.
    compiled : callable
        What it compiles last.
    """
    if _running or threads() == 1 or cache_folder() is None or is_kept(compiled):
        return
    with suppress(OSError):
        quiet = {"stdin": subprocess.PIPE, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        child = subprocess.Popen([sys.executable, "-c", _CHILD], **quiet)
        atexit.register(child.kill)
        _running.append(child)
        with child.stdin:
            child.stdin.write(b"".join(map(pickle.dumps, (sys.path, function, given))))


def wait_for_compiling() -> None:
    """Wait until the second process, if there is one, has put its machine code into the cache."""
    while _running:
        _running.pop().wait()
