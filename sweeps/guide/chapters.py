"""The chapters of the guide, shown in the terminal."""

from importlib.resources import files
from pathlib import Path

from engine import unknown_name_message
from sweeps.text.input_files import InputError
from sweeps.text.tables import table


def chapters() -> dict[str, str]:
    """Markdown text of each chapter, by name."""
    pages = Path(str(files("sweeps") / "guide")).rglob("*.md")
    return {page.stem: page.read_text("utf8") for page in sorted(pages, key=lambda page: page.stem)}


def chapters_text() -> str:
    """Names and titles of all chapters."""
    rows = [(name, text.partition("\n")[0].removeprefix("# ")) for name, text in chapters().items()]
    return "\n".join(["Chapters (`sweeps guide CHAPTER` shows one):", table(rows, "  ")])


def chapter_text(name: str) -> str:
    """Text of a chapter.

    Raises
    ------
    InputError
        There is no such chapter; the message lists them.
    """
    known = chapters()
    if name not in known:
        raise InputError("guide", [(None, "", unknown_name_message(name, known))])
    return known[name].rstrip()
