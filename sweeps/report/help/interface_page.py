"""The Python interface, from the docstrings of the public names of `sweeps` and `engine`."""

import inspect
from collections.abc import Iterator

import engine
import sweeps


def interface_page() -> str:
    """Markdown text: each public name with its signature and docstring."""
    parts = ["# Python interface\n\n`from engine import Machine`, `import sweeps`; see the chapter on Python."]
    for package in (sweeps, engine):
        rooms: dict[str, list[str]] = {}
        others = []
        for name in sorted(package.__all__, key=str.lower):
            found = getattr(package, name)
            if inspect.isfunction(inspect.unwrap(found)) or (inspect.isclass(found) and found.__module__ != "builtins"):
                home = found.__module__.rpartition(".")[0]
                rooms.setdefault(home, []).append(_entry(name, found))
            else:
                others.append(f"`{name}`")
        for room, entries in sorted(rooms.items()):
            parts += [f"## {room}", *entries]
        parts += [f"Constants and types of `{package.__name__}`: {', '.join(others)}."] if others else []
    return "\n\n".join(parts)


def _entry(name: str, found: object) -> str:
    text = "\n\n".join([inspect.getdoc(found) or "", *(_methods(found) if inspect.isclass(found) else ())])
    return f"### {name}\n\n```text\n{name}{_signature(found)}\n\n{text}\n```"


def _methods(kind: type) -> Iterator[str]:
    """Public methods and properties of a class's own."""
    for name, method in dict(vars(kind)).items():
        function = method.fget if isinstance(method, property) else getattr(method, "__func__", method)
        if not name.startswith("_") and inspect.isfunction(function) and (described := inspect.getdoc(function)):
            signature = "" if isinstance(method, property) else _signature(function)
            yield f"{name}{signature}\n" + "\n".join(f"    {line}".rstrip() for line in described.splitlines())


def _signature(found: object) -> str:
    """Names of the parameters, with simple defaults."""
    if inspect.isclass(found) and issubclass(found, Exception | str):
        return ""
    simple = (str, int, float, tuple, type(None))
    parameters = inspect.signature(found).parameters
    given = {name: p.default for name, p in parameters.items() if name != "self"}
    return f"({', '.join(name if not isinstance(d, simple) else f'{name}={d!r}' for name, d in given.items())})"
