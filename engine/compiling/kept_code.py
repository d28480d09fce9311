"""Machine code kept on disk: in the user's cache, in a folder of its own for each digest of its sources."""

import gc
import os
import pickle
import shutil
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from numba import config

from engine.compiling.sources import digest_of_module

_ONE_COMPILES = threading.Lock()
# What a file that is cut short or overwritten gives when it is read.
BROKEN = (EOFError, pickle.UnpicklingError)

_UNUSED_FOR = 60 * 24 * 3600.0


@contextmanager
def compiling() -> Iterator[None]:
    """While one thread compiles, and no other; garbage isn't looked for.

    Numba makes millions of objects and keeps most: looking through them again and again takes a tenth of the time.
    """
    with _ONE_COMPILES:
        collects = gc.isenabled()
        gc.disable()
        try:
            yield
        finally:
            if collects:
                gc.enable()


def cache_folder() -> Path:
    """Folder for machine code: the user's cache, or a temporary one where that can't be written."""
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


@cache
def folder_of(digest: str, within: Path) -> Path:
    """The folder of a digest, made if it isn't there, and marked as used.

    Parameters
    ----------
    digest : str
    within : Path
        The cache.
    """
    folder = within / digest[:32]
    if not folder.exists():
        _forget_unused(within)
    with suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        os.utime(folder)
    return folder


def _forget_unused(within: Path) -> None:
    """Remove what no process has used for a long time."""
    for folder in within.iterdir():
        with suppress(OSError):
            if time.time() - folder.stat().st_mtime > _UNUSED_FOR:
                shutil.rmtree(folder, ignore_errors=True)


def keep_compiled(function: Callable) -> None:
    """Let Numba keep the machine code of a function, so that only what is new is compiled.

    Numba asks for the folder when caching is switched on.
    """
    before = config.CACHE_DIR
    try:
        config.CACHE_DIR = str(folder_of(digest_of_module(function.py_func.__module__), cache_folder()))
        function.enable_caching()
    except (OSError, RuntimeError):
        # Nowhere to keep it: it is compiled in every process.
        return
    finally:
        config.CACHE_DIR = before


def empty_cache() -> None:
    """Throw away all machine code that is kept, leaving its folders: some of it is broken."""
    for path in cache_folder().rglob("*"):
        if path.is_file():
            with suppress(OSError):
                path.unlink()
