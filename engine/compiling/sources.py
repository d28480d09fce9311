"""Source files that compiled code depends on: a module with everything it imports from the engine.

Numba's own cache notices changes in the file of the cached function, but not in the files of the functions it calls.
Machine code is therefore cached in folders named by a digest of every source it can reach.
"""

import hashlib
import platform
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import llvmlite
import numba

from engine.compiling.printed_code import PrintedCode

_PACKAGE = "engine"
_ROOT = Path(__file__).parents[2]
_VERSIONS = f"{numba.__version__} {llvmlite.__version__} {platform.python_version()}"


@cache
def _files_of(module: str) -> tuple[Path, ...]:
    """Source file of a module; all files of a package, since a package loads its modules on use."""
    path = _ROOT.joinpath(*module.split("."))
    return tuple(path.rglob("*.py")) if path.is_dir() else tuple(p for p in (path.with_suffix(".py"),) if p.exists())


def _imported(text: str) -> Iterator[str]:
    """Engine modules that a source imports, found line by line; listing one too many does no harm."""
    for line in text.splitlines():
        match line.split(maxsplit=2):
            case ["from", module, names] if module == _PACKAGE:
                yield from (f"{_PACKAGE}.{name.strip()}" for name in names.removeprefix("import ").split(","))
            case ["from" | "import", module, *_] if module.startswith(f"{_PACKAGE}."):
                yield module


@cache
def _read(path: Path) -> str:
    return path.read_text(encoding="utf8")


@cache
def _imports_of(path: Path) -> tuple[str, ...]:
    return tuple(_imported(_read(path)))


@cache
def _reached(module: str) -> frozenset[Path]:
    """Source files of a module and of everything it imports, directly or indirectly."""
    found: set[Path] = set()
    pending = [module]
    while pending:
        new = set(_files_of(pending.pop())) - found
        found |= new
        for path in new:
            pending += _imports_of(path)
    return frozenset(found)


def _digest(paths: frozenset[Path], text: str = "") -> str:
    digest = hashlib.sha256(f"{_VERSIONS}\0{text}".encode())
    for path in sorted(paths):
        digest.update(f"\0{path.relative_to(_ROOT).as_posix()}\0{_read(path)}".encode())
    return digest.hexdigest()


@cache
def digest_of_module(module: str) -> str:
    """Digest of an engine module, of everything it imports from the engine, and of the compiler versions.

    Parameters
    ----------
    module : str
        A module outside the engine gets the digest of the whole engine.
    """
    return _digest(_reached(module)) if module.startswith(f"{_PACKAGE}.") else sources_digest()


@cache
def digest_of_printed(code: PrintedCode) -> str:
    """Digest of a printed function, of the sources of all that it calls, and of the compiler versions.

    Parameters
    ----------
    code : PrintedCode
    """
    called = (call.law.py_func.__module__ for call in code.calls)
    return _digest(frozenset().union(*map(_reached, called)), code.text)


@cache
def sources_digest(*others: str) -> str:
    """Digest of all sources of the engine and of other packages beside it, and of the compiler versions."""
    return _digest(frozenset(path for package in (_PACKAGE, *others) for path in (_ROOT / package).rglob("*.py")))
