"""Printed modules: load them, with each function compiled for its stated signature or read from the cache."""

import linecache
import sys
from functools import cache
from types import ModuleType

from engine.compiling.kept_code import PRINTED, compiling
from engine.compiling.sources import digest_of_text


def load_printed(text: str) -> ModuleType:
    """Load a module from its printed source; its functions are compiled, or read from the cache.

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
    # Lets tracebacks show the module's lines.
    linecache.cache[file] = (len(text), None, text.splitlines(keepends=True), file)
    exec(compile(text, file, "exec"), module.__dict__)
    return module
