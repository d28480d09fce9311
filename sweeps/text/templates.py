"""Scenes to start from."""

import tomllib
from importlib.resources import files
from pathlib import Path

from engine import unknown_name_message
from sweeps.text.input_files import InputError

TEMPLATES = Path(str(files("sweeps") / "templates"))


def templates() -> dict[str, str]:
    """Titles of the templates, by name."""
    return {p.stem: tomllib.loads(p.read_text(encoding="utf8"))["title"] for p in sorted(TEMPLATES.glob("*.toml"))}


def template_text(name: str) -> str:
    """Text of a template.

    Raises
    ------
    InputError
        There is no such template.
    """
    known = templates()
    if name not in known:
        raise InputError(name, [(None, "", f"there is no such template. {unknown_name_message(name, known)}")])
    return (TEMPLATES / f"{name}.toml").read_text(encoding="utf8")
