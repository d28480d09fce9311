"""The chapters of the guide, shown in the terminal."""

from importlib.resources import files
from pathlib import Path

from engine import unknown_name_message
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

# Folders of the guide in reading order, each with its chapters.
SUBJECTS = {
    "tutorial": ("machine", "flywheel", "sweep", "bearings", "motor", "report"),
    "mechanisms": ("structure", "kinematics", "links", "inputs", "cams", "gears", "synthesis", "elements"),
    "dynamics": (
        *("reduction", "flywheels", "forces", "formulas", "motion", "couplings"),
        *("balancing", "governors", "elastic"),
    ),
    "studies": ("study", "searching", "results", "numbers", "warnings", "words", "python", "cluster"),
    "": ("developers",),
}
# Subject and names of the generated pages.
REFERENCE = "reference"
GENERATED = ("commands", "keys", "quantities", "verdicts", "units", "interface")


def chapters() -> dict[str, str]:
    """Markdown text of each chapter, by name, in reading order."""
    guide = Path(str(files("sweeps") / "guide"))
    return {
        name: (guide / subject / f"{name}.md").read_text("utf8")
        for subject, names in SUBJECTS.items()
        for name in names
    }


def title_of(text: str) -> str:
    """Title of a chapter."""
    return text.partition("\n")[0].removeprefix("# ")


def chapters_text() -> str:
    """Names and titles of all chapters, by subject, and the names of the reference pages."""
    texts, parts = chapters(), ["Chapters (`sweeps guide CHAPTER` shows one, `sweeps guide --web` all in a browser):"]
    for subject, names in SUBJECTS.items():
        parts += [f"  {subject}"] if subject else []
        parts.append(table([(name, title_of(texts[name])) for name in names], "    " if subject else "  "))
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
