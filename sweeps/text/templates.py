"""Scenes to start from."""

import tomllib
from importlib.resources import files
from pathlib import Path

from engine import unknown_name_message
from sweeps.text.input_files import InputError

TEMPLATES = Path(str(files("sweeps") / "templates"))


def bundled_templates() -> dict[str, Path]:
    """Template files by name; the folder of each is its subject."""
    return {path.stem: path for path in sorted(TEMPLATES.glob("*/*.toml"), key=lambda path: path.stem)}


def templates() -> dict[str, str]:
    """Titles of the templates, by name."""
    return {name: tomllib.loads(path.read_text(encoding="utf8"))["title"] for name, path in bundled_templates().items()}


def template_text(name: str) -> str:
    """Text of a template.

    Raises
    ------
    InputError
        There is no such template.
    """
    known = bundled_templates()
    if name not in known:
        raise InputError.of(name, unknown_name_message(name, known, "there is no such template"))
    return known[name].read_text(encoding="utf8")
