"""Planar machines: kinematics, reduced inertia and moments, flywheels; one variant or millions, with error estimates.

The public names are imported from here: `from engine import Scene, Machine`. `__init__.pyi` lists them with the modules
they come from; a module is loaded when the first of its names is used, so that `import engine` costs next to nothing
and Numba is loaded only for computations.
"""

import ast
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType


def door(file: str, names: dict[str, object]) -> tuple[list[str], Callable[[str], object]]:
    """The names that a package offers, and its `__getattr__`, which loads a module with the first of its names.

    Parameters
    ----------
    file : str
        Path of the package's `__init__.py`; the stub next to it lists the names and their modules.
    names : dict of str to object
        The package's globals, which cache the loaded names; they get the `__dir__` that lists all.
    """
    stub = ast.parse(Path(file).with_suffix(".pyi").read_text(encoding="utf8"))
    homes = {
        alias.asname or alias.name: (node.module, alias.name)
        for node in stub.body
        if isinstance(node, ast.ImportFrom)
        for alias in node.names
    }

    def load(name: str) -> object:
        if name == "__version__":
            return import_module("importlib.metadata").version("machine-sweeps")
        if name not in homes:
            raise AttributeError(f"module {names['__name__']!r} has no attribute {name!r}")
        module, own = homes[name]
        names[name] = getattr(import_module(module), own)
        return names[name]

    offered = sorted(homes)
    names["__dir__"] = lambda: offered
    return offered, load


def on_use(room: str) -> Callable[[str], ModuleType]:
    """The `__getattr__` of a package that loads each of its modules with the first use of a name in it.

    Modules that few machines need are used by full name, `mechanism.higher_pairs.cam_motion.add_cam`, after the
    package alone is imported, `from engine import mechanism`: that import loads nothing, and the module is loaded for
    the first scene with a cam. Modules that most machines need are imported by name as usual.

    Parameters
    ----------
    room : str
        Name of the package.
    """

    def load(name: str) -> ModuleType:
        module = f"{room}.{name}"
        if not name.startswith("_"):
            try:
                return import_module(module)
            except ModuleNotFoundError as missing:
                if missing.name != module:
                    raise
        raise AttributeError(f"module {room!r} has no attribute {name!r}")

    return load


__all__, __getattr__ = door(__file__, globals())
