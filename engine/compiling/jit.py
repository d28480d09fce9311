"""How the mechanics is compiled: one decorator for scalar functions, one set of floating-point rules, one cache.

Numba's own cache notices a change only in the file that holds the cached function, not in the files whose
functions it calls. A generated kernel therefore lives in a folder named by a digest of everything that goes
into it: its text, all sources of this package, and the versions of the compilers.
"""

import hashlib
import importlib.util
import os
import pickle
import platform
import shutil
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from functools import cache, wraps
from itertools import pairwise
from pathlib import Path
from types import ModuleType

import llvmlite
import numba
from numba import config, njit

# `nnan` and `ninf` are left out on purpose: a NaN must survive from the position that can't be assembled
# to the status of the variant. `reassoc` lets sums over positions be vectorised.
FLOATING_POINT_RULES = frozenset({"contract", "arcp", "nsz", "reassoc"})

# Kernels run without Python's lock, in Python threads, each over its own range of variants. Numba's own parallel
# loops would take several times as long to compile, abort when two threads enter them, and not survive a fork.
KERNEL_OPTIONS = {
    "error_model": "numpy",
    "fastmath": set(FLOATING_POINT_RULES),
    "nogil": True,
    "cache": True,
}

PIECES_PER_THREAD = 8
UNUSED_FOR = 60 * 24 * 3600.0

COMPILING = threading.Lock()
# Whether the work on this thread is already one of several pieces.
_here = threading.local()
_settings = {"threads": 0}


def threads() -> int:
    """Threads that kernels use: as set, or all cores that this process may use."""
    if _settings["threads"]:
        return _settings["threads"]
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def set_threads(count: int) -> None:
    """Set how many threads kernels use; 0 for all cores. Results don't depend on it.

    Parameters
    ----------
    count : int
    """
    _settings["threads"] = count


def scalar(function: Callable) -> Callable:
    """Compile a scalar function of the mechanics; it is compiled into whatever kernel calls it.

    Division by zero gives infinity or NaN, as in NumPy, and never raises. It is inlined always: whether a first run
    or one from the cache, results are the same to the last bit.
    """
    compiled = njit(error_model="numpy", fastmath=set(FLOATING_POINT_RULES), forceinline=True, no_cfunc_wrapper=True)(
        function
    )
    keep_compiled(compiled)
    return compiled


def routine(function: Callable) -> Callable:
    """Compile a function too large to be inlined wherever it is called; otherwise as of `scalar`.

    Said explicitly: what isn't said is taken over from the function that calls this one first.
    """
    compiled = njit(error_model="numpy", fastmath=set(FLOATING_POINT_RULES), forceinline=False, no_cfunc_wrapper=True)(
        function
    )
    keep_compiled(compiled)
    return compiled


def keep_compiled(function: Callable) -> None:
    """Let Numba keep the machine code of a function in the folder of this package's sources.

    A new structure then compiles only its own kernel. Numba asks for the folder when caching is switched on.
    """
    before = config.CACHE_DIR
    try:
        config.CACHE_DIR = str(_functions_folder())
        function.enable_caching()
    except (OSError, RuntimeError):
        # Nowhere to keep it: it is compiled in every process.
        return
    finally:
        config.CACHE_DIR = before


def _functions_folder() -> Path:
    return cache_folder() / sources_digest()[:32]


@cache
def sources_digest() -> str:
    """Digest of this package's sources and of the compilers' versions."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parents[1].rglob("*.py")):
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    digest.update(f"{numba.__version__} {llvmlite.__version__} {platform.python_version()}".encode())
    return digest.hexdigest()


def cache_folder() -> Path:
    """Folder for generated kernels: the user's cache, or a temporary one where that can't be written."""
    home = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = (Path(home) if home else Path.home() / ".cache") / "machine-sweeps"
        folder.mkdir(parents=True, exist_ok=True)
        if os.access(folder, os.W_OK):
            return folder
    except (OSError, RuntimeError):
        pass
    return _temporary_folder()


@cache
def _temporary_folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="machine-sweeps-"))


def _kernel_folder(text: str) -> Path:
    digest = hashlib.sha256(f"{sources_digest()}\0{text}".encode()).hexdigest()
    return cache_folder() / digest[:32]


def _forget_unused() -> None:
    """Remove kernels that no process has loaded for a long time."""
    for folder in cache_folder().iterdir():
        if time.time() - folder.stat().st_mtime > UNUSED_FOR:
            shutil.rmtree(folder, ignore_errors=True)


@cache
def load_kernel(text: str) -> ModuleType:
    """Module of a generated source, compiled on the first call of its functions and cached on disk.

    Parameters
    ----------
    text : str
        Source of the module.
    """
    folder = _kernel_folder(text)
    path = folder / "kernel.py"
    if not path.exists() or path.read_text(encoding="utf8", errors="replace") != text:
        _forget_unused()
        folder.mkdir(parents=True, exist_ok=True)
        draft = folder / f"kernel.{os.getpid()}.tmp"
        draft.write_text(text, encoding="utf8")
        os.replace(draft, path)
    for used in (folder, _functions_folder()):
        with suppress(OSError):
            os.utime(used)
    name = f"engine_kernel_{folder.name}"
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def compiled(text: str, function: str, *arguments: object) -> Callable:
    """Function of a generated source, compiled for the types of its arguments.

    Parameters
    ----------
    text : str
        Source of the module.
    function : str
        Its function.
    *arguments
        Arguments of a call without effect; a broken cache is thrown away and the call made once more.
    """
    with COMPILING:
        try:
            getattr(load_kernel(text), function)(*arguments)
        except (EOFError, pickle.UnpicklingError):
            load_kernel.cache_clear()
            shutil.rmtree(_kernel_folder(text), ignore_errors=True)
            shutil.rmtree(_functions_folder(), ignore_errors=True)
            getattr(load_kernel(text), function)(*arguments)
        return getattr(load_kernel(text), function)


def load_compiled(text: str) -> ModuleType:
    """Module of a generated source whose functions state their signatures: they are compiled with it, or loaded.

    Parameters
    ----------
    text : str
        Source of the module.
    """
    with COMPILING:
        try:
            return load_kernel(text)
        except (EOFError, pickle.UnpicklingError):
            shutil.rmtree(_kernel_folder(text), ignore_errors=True)
            shutil.rmtree(_functions_folder(), ignore_errors=True)
            return load_kernel(text)


@cache
def _pool(workers: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(workers, thread_name_prefix="kernel")


if hasattr(os, "register_at_fork"):
    # Threads don't come along into a forked process.
    os.register_at_fork(after_in_child=_pool.cache_clear)


def run_kernel(text: str, function: str, count: int, *arguments: object) -> None:
    """Run a function of a generated source over a range 0 … count − 1, in pieces on all threads.

    Parameters
    ----------
    text : str
        Source of the module.
    function : str
        Its function; its first two arguments are the range it works on.
    count : int
        Length of the whole range.
    *arguments
        Passed on after the range.
    """
    run_pieces(compiled(text, function, 0, 0, *arguments), count, arguments)


def over_variants(function: Callable) -> Callable:
    """Compile a function over a range of variants; called with their number, it runs in pieces on all threads.

    Its first two parameters are the range it works on; the caller gives the length of the whole range instead.
    """
    kernel = njit(**{**KERNEL_OPTIONS, "cache": False})(function)
    keep_compiled(kernel)

    @wraps(function)
    def run(count: int, *arguments: object) -> None:
        with COMPILING:
            kernel(0, 0, *arguments)
        run_pieces(kernel, count, arguments)

    return run


def pieces_of(count: int) -> int:
    """Into how many pieces to cut so many items of work; one on a thread that has such a piece itself."""
    workers = threads()
    if workers == 1 or getattr(_here, "alone", False):
        return min(count, 1)
    return min(count, workers * PIECES_PER_THREAD)


def on_all_threads(function: Callable, pieces: Sequence) -> list:
    """Call a function for every piece of some work, on all threads; kernels within stay on the thread they are on.

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


def run_pieces(kernel: Callable, count: int, arguments: tuple) -> None:
    """Run a compiled function over a range 0 … count − 1, in pieces on all threads.

    Parameters
    ----------
    kernel : callable
        Its first two arguments are the range it works on.
    count : int
        Length of the whole range.
    arguments : tuple
        Passed on after the range.
    """
    pieces = pieces_of(count)
    if pieces <= 1:
        kernel(0, count, *arguments)
        return
    cuts = [i * count // pieces for i in range(pieces + 1)]
    pool = _pool(threads())
    for done in [pool.submit(kernel, a, b, *arguments) for a, b in pairwise(cuts)]:
        done.result()
