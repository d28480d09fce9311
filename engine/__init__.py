"""Planar machines: kinematics, reduced inertia and moments, flywheels; one variant or millions, with error figures.

All that others use of this package is imported from here: `from engine import Scene, Machine`. The names stand in
`__init__.pyi`, with the modules they come from; a module is loaded when the first of its names is used, so that
`import engine` costs next to nothing and Numba is loaded only for what computes.
"""

import ast
from importlib import import_module
from pathlib import Path


def _offered() -> dict[str, tuple[str, str]]:
    """Module, and name in it, of every name that the stub beside this file lists."""
    stub = ast.parse(Path(__file__).with_suffix(".pyi").read_text(encoding="utf8"))
    return {
        alias.asname or alias.name: (node.module, alias.name)
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }


_OFFERED = _offered()
__all__ = sorted(_OFFERED)


def __getattr__(name: str) -> object:
    if name == "__version__":
        return import_module("importlib.metadata").version("machine-sweeps")
    if name not in _OFFERED:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    module, own = _OFFERED[name]
    value = getattr(import_module(module), own)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
