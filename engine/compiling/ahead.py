"""Compile in other processes what this one needs next; all share the cache of machine code on disk."""

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
sys.path[:] = pickle.load(sys.stdin.buffer)
function, given = pickle.load(sys.stdin.buffer)
function(*given)
"""
# The processes, by the function that each compiles last.
_running: dict[Callable, subprocess.Popen] = {}


def compile_ahead(compiled: Callable, function: Callable, *given: object) -> None:
    """Call, in a separate process, a function that compiles another one, unless its machine code is in the cache.

    Without a second core, or a cache, nothing is done; this process then compiles when the code is needed.

    Parameters
    ----------
    compiled : callable
        What is compiled last.
    function : callable
        A module's.
    given : objects
        Its arguments, which can be pickled.
    """
    if compiled in _running or threads() == 1 or cache_folder() is None or is_kept(compiled):
        return
    with suppress(OSError):
        quiet = {"stdin": subprocess.PIPE, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
        child = _running[compiled] = subprocess.Popen([sys.executable, "-c", _CHILD], **quiet)
        atexit.register(child.kill)
        with child.stdin:
            child.stdin.write(pickle.dumps(sys.path) + pickle.dumps((function, given)))


def wait_until_compiled(compiled: Callable) -> None:
    """Wait until another process, if there is one, has put the machine code of a function into the cache."""
    if compiled in _running:
        _running[compiled].wait()
