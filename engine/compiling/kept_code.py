"""Machine code cached on disk, in one folder of the user's cache for each digest of its sources.

Cached code is executed, so a file is trusted only if it belongs to the user, only the user may write to it and its
folder, and its content matches the digest stored before it. Other files are removed and compiled again. Where the cache
can't be written, every process compiles its own code.
"""

import gc
import hashlib
import logging
import os
import pickle
import shutil
import stat
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from pathlib import Path

from numba.core.base import BaseContext
from numba.core.caching import CompileResultCacheImpl, FunctionCache, IndexDataCacheFile, _CacheLocator
from numba.core.compiler import CompileResult
from numba.core.serialize import dumps
from numba.core.typing import Signature

from engine.compiling.sources import digest_of_module

_ONE_COMPILES = threading.Lock()

_UNUSED_FOR = 60 * 24 * 3600.0
_DIGEST = hashlib.sha256
_DIGEST_SIZE = _DIGEST().digest_size


@contextmanager
def compiling() -> Iterator[None]:
    """Hold the compile lock, so that one thread compiles at a time, and pause garbage collection.

    Numba makes millions of objects and keeps most of them: collecting among them takes a tenth of the compile time.
    """
    with _ONE_COMPILES:
        collects = gc.isenabled()
        gc.disable()
        try:
            yield
        finally:
            if collects:
                gc.enable()


def is_compiling() -> bool:
    """Whether some thread is compiling, or loading compiled code."""
    return _ONE_COMPILES.locked()


def cache_folder() -> Path | None:
    """Folder of machine code in the user's cache, created if missing; None if it can't be created or trusted."""
    home = os.environ.get("XDG_CACHE_HOME")
    try:
        folder = (Path(home) if home else Path.home() / ".cache") / "machine-sweeps"
        if not folder.exists():
            folder.parent.mkdir(parents=True, exist_ok=True)
            folder.mkdir(mode=0o700, exist_ok=True)
        found = folder.stat()
    except (OSError, RuntimeError) as error:
        _say_once(f"no cache of machine code can be made ({error})")
        return None
    if not stat.S_ISDIR(found.st_mode):
        _say_once(f"the cache of machine code, {folder}, is not a folder")
        return None
    if not _is_own(found):
        _say_once(f"the cache of machine code, {folder}, isn't used, as others may write to it")
        return None
    return folder


def _is_own(found: os.stat_result) -> bool:
    """Whether a file or folder belongs to the user and nobody else may write to it."""
    return not hasattr(os, "geteuid") or (found.st_uid == os.geteuid() and not found.st_mode & 0o022)


@cache
def folder_of(digest: str, within: Path) -> Path:
    """Return the folder of a digest, created if possible; its time of modification records its last use.

    Parameters
    ----------
    digest : str
    within : Path
        The cache folder.
    """
    folder = within / digest[:32]
    with suppress(OSError):
        if folder.exists() and not _is_own(folder.stat()):
            shutil.rmtree(folder, ignore_errors=True)
        if not folder.exists():
            _forget_unused(within)
            folder.mkdir(mode=0o700, exist_ok=True)
        os.utime(folder)
    return folder


def _forget_unused(within: Path) -> None:
    """Remove folders that no process has used for `_UNUSED_FOR` seconds."""
    for folder in within.iterdir():
        with suppress(OSError):
            if time.time() - folder.stat().st_mtime > _UNUSED_FOR:
                shutil.rmtree(folder, ignore_errors=True)


@cache
def _say_once(what: str) -> None:
    logging.getLogger("engine").warning("Machine code is compiled in every run: %s.", what)


def keep_compiled(function: Callable) -> None:
    """Make Numba cache the machine code of a function on disk, if there is a trusted cache."""
    if cache_folder() is not None:
        function._cache = _KeptFunction(function.py_func, function.targetoptions.get("_nrt", True))


def is_kept(function: Callable) -> bool:
    """Whether machine code of a function, for any types, is in the cache."""
    return Path(function._cache._cache_file._index_path).exists()


def kept_files(digest: str) -> "_VerifiedFiles | None":
    """Cache files of a printed function, by the digest of its sources; None if there is no trusted cache.

    Parameters
    ----------
    digest : str
    """
    within = cache_folder()
    return None if within is None else _VerifiedFiles(str(folder_of(digest, within)), "printed", None)


class _Place(_CacheLocator):
    """Location of a function's machine code: the folder of the digest of its sources."""

    def __init__(self, folder: Path, line: int) -> None:
        self._folder, self._line = folder, line

    @classmethod
    def from_function(cls, py_func: Callable, _: str) -> "_Place":
        digest = digest_of_module(py_func.__module__)
        return cls(folder_of(digest, cache_folder()), py_func.__code__.co_firstlineno)

    def ensure_cache_path(self) -> None:
        """Do nothing: a cache that can't be written fails in `_VerifiedFiles.save`."""

    def get_cache_path(self) -> str:
        return str(self._folder)

    def get_source_stamp(self) -> None:
        return None

    def get_disambiguator(self) -> str:
        return str(self._line)


class _Kept(CompileResultCacheImpl):
    _locator_classes = (_Place,)


class _KeptFunction(FunctionCache):
    _impl_class = _Kept

    def __init__(self, py_func: Callable, makes_arrays: bool) -> None:
        super().__init__(py_func)
        self._makes_arrays = makes_arrays
        self._cache_file = _VerifiedFiles(self._cache_path, self._impl.filename_base, None)

    def load_overload(self, sig: Signature, target_context: BaseContext) -> CompileResult | None:
        """Load the cached code for a signature.

        Numba itself first loads all that it can compile, which takes 0.2 s. Code needs none of it but the memory of
        arrays, if it makes any.
        """
        if self._makes_arrays:
            return super().load_overload(sig, target_context)
        return self._load_overload(sig, target_context)


class _VerifiedFiles(IndexDataCacheFile):
    """Numba's cache files of a function, each preceded by a digest of its content."""

    def save(self, key: tuple, data: object) -> None:
        # Two processes may give different entries the same file name, so each entry stores its key.
        try:
            super().save(key, (key, data))
        except OSError as error:
            _say_once(f"the cache in {Path(self._cache_path).parent} can't be written ({error.strerror})")

    def load(self, key: tuple) -> object:
        found = super().load(key)
        return found[1] if found and found[0] == key else None

    def _load_index(self) -> dict:
        return self._verified(self._index_path) or {}

    def _load_data(self, name: str) -> tuple | None:
        return self._verified(self._data_path(name))

    def _save_index(self, overloads: dict) -> None:
        self._write(self._index_path, overloads)

    def _save_data(self, name: str, data: tuple) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, content: object) -> None:
        payload = dumps(content)
        with self._open_for_write(path) as file:
            # Independent of the user's umask.
            os.chmod(file.name, 0o600)
            file.write(_DIGEST(payload).digest() + payload)

    def _verified(self, path: str) -> object:
        """Content of a file; None if it is missing, or damaged or not trusted, in which case it is removed."""
        try:
            with open(path, "rb") as file:
                trusted = all(map(_is_own, (os.stat(self._cache_path), os.fstat(file.fileno()))))
                content = file.read() if trusted else b""
        except OSError:
            return None
        payload = content[_DIGEST_SIZE:]
        if _DIGEST(payload).digest() == content[:_DIGEST_SIZE]:
            return pickle.loads(payload)
        with suppress(OSError):
            os.unlink(path)
        return None
