"""The chapters of the guide, shown in the terminal."""

import tomllib
from importlib.resources import files
from pathlib import Path

from engine import unknown_name_message
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

GUIDE = Path(str(files("sweeps") / "guide"))
# Folders of the guide in reading order, each with its chapters.
SUBJECTS: dict[str, list[str]] = tomllib.loads((GUIDE / "contents.toml").read_text("utf8"))
# Subject and names of the generated pages.
REFERENCE = "reference"
GENERATED = ("commands", "keys", "quantities", "verdicts", "units", "interface")


def chapters() -> dict[str, str]:
    """Markdown text of each chapter, by name, in reading order."""
    pages = [(name, GUIDE / subject / f"{name}.md") for subject, names in SUBJECTS.items() for name in names]
    return {name: page.read_text("utf8") for name, page in pages}


def chapters_text() -> str:
    """Names and titles of all chapters, by subject, and the names of the reference pages."""
    texts, parts = chapters(), ["Chapters (`sweeps guide CHAPTER` shows one, `sweeps guide --web` all in a browser):"]
    for subject, names in SUBJECTS.items():
        parts += [f"  {subject}"] if subject else []
        rows = [(name, texts[name].partition("\n")[0].removeprefix("# ")) for name in names]
        parts.append(table(rows, "    " if subject else "  "))
    return "\n".join([*parts, f"  {REFERENCE}", f"    {', '.join(GENERATED)}"])


def chapter_text(name: str) -> str:
    """Text of a chapter.

    Raises
    ------
    InputError
        There is no such chapter; the message lists them.
    """
    known = chapters()
    if name not in known:
        raise InputError.of("guide", unknown_name_message(name, (*known, *GENERATED)))
    return known[name].rstrip()
