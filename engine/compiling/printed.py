"""Printed modules: written to the cache, imported, compiled by the signatures that their functions state."""

import importlib.util
import os
import sys
from functools import cache
from pathlib import Path
from types import ModuleType

from engine.compiling.kept_code import BROKEN, cache_folder, compiling, empty_cache, folder_of
from engine.compiling.sources import digest_of_text


def load_printed(text: str) -> ModuleType:
    """Module of a printed source; its functions are compiled with it, or loaded from the cache.

    Parameters
    ----------
    text : str
        Source of the module.
    """
    with compiling():
        try:
            return _load(text)
        except BROKEN:
            empty_cache()
            return _load(text)


@cache
def _load(text: str) -> ModuleType:
    path = _written(text)
    name = f"engine_printed_{path.parent.name}"
    spec = importlib.util.spec_from_file_location(name, path)
    module = importlib.util.module_from_spec(spec)
    sys.modules[name] = module
    spec.loader.exec_module(module)
    return module


def _written(text: str) -> Path:
    """The file of a printed source, written where it isn't there."""
    path = folder_of(digest_of_text(text), cache_folder()) / "printed.py"
    if not path.exists() or path.read_text(encoding="utf8", errors="replace") != text:
        path.parent.mkdir(parents=True, exist_ok=True)
        draft = path.with_suffix(f".{os.getpid()}.tmp")
        draft.write_text(text, encoding="utf8")
        os.replace(draft, path)
    return path
