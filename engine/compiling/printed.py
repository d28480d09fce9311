"""Printed modules: their functions are compiled by the signatures that they state, or loaded from the cache."""

import linecache
import sys
from functools import cache
from types import ModuleType

from engine.compiling.kept_code import PRINTED, compiling
from engine.compiling.sources import digest_of_text


def load_printed(text: str) -> ModuleType:
    """Module of a printed source; its functions are compiled with it, or loaded from the cache.

    Parameters
    ----------
    text : str
        Source of the module.
    """
    with compiling():
        return _load(text)


@cache
def _load(text: str) -> ModuleType:
    name = f"{PRINTED}{digest_of_text(text)[:32]}"
    file = f"<{name}>"
    module = ModuleType(name)
    module.__file__ = file
    sys.modules[name] = module
    # So that a traceback can show its lines.
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), module.__dict__)
    return module
