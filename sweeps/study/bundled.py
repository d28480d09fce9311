"""Bundled studies, and finding a study by name."""

import tomllib
from importlib.resources import files
from pathlib import Path

from engine import unknown_name_message
from sweeps.text.input_files import LARGEST_TEXT, InputError, check_file

STUDIES = Path(str(files("sweeps") / "studies"))


def bundled_studies() -> dict[str, Path]:
    """Bundled studies by name; the folder of each is its subject."""
    return {path.stem: path for path in sorted(STUDIES.glob("*/*.toml"), key=lambda path: path.stem)}


def questions() -> dict[str, str]:
    """The question of each bundled study, by name."""
    return {name: tomllib.loads(path.read_text("utf8"))["question"] for name, path in bundled_studies().items()}


def find_study(name: str) -> Path:
    """Path of a study: a file, or the name of a bundled one.

    Raises
    ------
    InputError
        There is neither.
    """
    path = Path(name)
    check_file(path, LARGEST_TEXT)
    if path.is_file():
        return path
    if path.is_dir():
        raise InputError.of(name, "is a folder; give a study or a scene (.toml), or a bundled study's name")
    known = bundled_studies()
    if name in known:
        return known[name]
    words = "there is no such file"
    if (text := path.with_name(f"{path.name}.toml")).is_file():
        words = f"{words}; did you mean {str(text)!r}?"
    elif not path.suffix:
        words = unknown_name_message(name, known, f"{words}, and no bundled study of that name")
    raise InputError.of(name, words)
