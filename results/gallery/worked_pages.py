"""Run the worked pages of the guide; remake their pictures and shown outputs: `python results/gallery/worked_pages.py`.

A worked page writes files (a block ```` ```toml FILE ````, appended if FILE exists; its tables replace earlier ones),
draws pictures by Python (```` ```python FILE ````) and shows commands with their output (```` ```console ````). In an
output, a line `…` stands for any lines, `…` within a line for any text. Pages of the tutorial are run in one folder,
one after the other; any other page starts with the compressor of the tutorial.
"""

import difflib
import re
import shlex
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import chdir
from pathlib import Path
from typing import NamedTuple

from click.testing import CliRunner

from sweeps.cli import main

GUIDE = Path(__file__).parents[2] / "sweeps" / "guide"
PICTURES = GUIDE / "pictures"
STEPS = ("machine", "flywheel", "sweep", "bearings", "motor", "report")
TUTORIAL = tuple(GUIDE / "tutorial" / f"{step}.md" for step in STEPS)
# The steps that a page outside the tutorial builds upon.
BASIS = TUTORIAL[:2]
BLOCK = re.compile(r"^```(\w+)(?: (\S+))?\n(.*?)^```$", re.M | re.S)
DECIMALS = re.compile(r"-?\d+\.\d{3,}")
PICTURE = re.compile(r"!\[[^\]]*\]\((?:\.\./)?pictures/([^)]+)\)")


class Difference(NamedTuple):
    """A command whose output isn't the one shown."""

    command: str
    shown: str
    real: str


def blocks(text: str) -> Iterator[re.Match]:
    """Blocks of a page that are written or run."""
    return (found for found in BLOCK.finditer(text) if found[1] == "console" or "." in (found[2] or ""))


def write_files(page: Path, folder: Path) -> None:
    """Write the files of a page without running its commands."""
    for found in blocks(page.read_text("utf8")):
        if found[1] not in ("console", "python"):
            append(folder / found[2], found[3])


def append(path: Path, text: str) -> None:
    """Append a block to a file; its tables replace those already there."""
    before = f"{path.read_text('utf8')}\n" if path.exists() else ""
    for table in re.findall(r"^\[.*\]$", text, re.M):
        before = re.sub(rf"^{re.escape(table)}.*?(?=^\[|\Z)", "", before, flags=re.M | re.S)
    path.write_text(before + text, "utf8")


def commands(body: str) -> list[tuple[str, str]]:
    """Commands of a console block, each with the output shown."""
    parts = re.split(r"^\$ (.*)\n", body, flags=re.M)[1:]
    return list(zip(parts[::2], parts[1::2], strict=True))


def output_of(command: str, shown: str) -> str:
    """Run a command; it may fail only if an error is shown, or if `compare` finds differences."""
    words = shlex.split(command)
    if words[0] == "cp":
        shutil.copy(*words[1:])
        return ""
    result = CliRunner().invoke(main, words[1:])
    if result.exception and not isinstance(result.exception, SystemExit):
        raise result.exception
    if result.exit_code and shown and "Error: " not in shown and words[1] != "compare":
        raise ValueError(f"{command}\n{result.output}")
    return "".join(f"{line.rstrip()}\n" for line in result.output.splitlines())


def matches(shown: str, real: str) -> bool:
    """Whether an output matches the one shown, in which `…` stands for any text."""
    lines = (
        "(?:.*\n)*?" if line.strip() == "…" else re.escape(line).replace("…", ".*?") + "\n"
        for line in shown.splitlines()
    )
    return re.fullmatch("".join(lines), real) is not None


def renewed(shown: str, real: str) -> str:
    """An output reduced to the lines shown before; all of it if nothing was shown."""
    if matches(shown, real) or not shown.strip():
        return shown if shown.strip() else real
    left, lines = real.splitlines(), []
    for line in shown.splitlines():
        found = difflib.get_close_matches(line, left, 1, 0.3)
        if line.strip() == "…" or not found:
            lines += ["…"] if line.strip() == "…" else []
            continue
        left = left[left.index(found[0]) + 1 :]
        lines.append(line if "…" in line and matches(line, f"{found[0]}\n") else found[0])
    return "".join(f"{line}\n" for line in lines)


def run_page(page: Path, folder: Path) -> list[Difference]:
    """Write the files of a page and run its commands in a folder; return the outputs that differ."""
    differences = []
    with chdir(folder):
        for found in blocks(page.read_text("utf8")):
            if found[1] == "python":
                exec(compile(found[3], page.name, "exec"), {})
            elif found[1] != "console":
                append(Path(found[2]), found[3])
            for command, shown in commands(found[3]) if found[1] == "console" else ():
                real = output_of(command, shown)
                if not matches(shown, real):
                    differences.append(Difference(command, shown, real))
    return differences


def pictures(page: Path) -> list[str]:
    """Pictures on a page, by the subject of the guide that they are kept under, and their names."""
    return PICTURE.findall(page.read_text("utf8"))


def small(svg: str) -> str:
    """An SVG text with coordinates of two decimals, without metadata."""
    svg = re.sub(r" *<metadata>.*?</metadata>\n", "", svg, flags=re.S)
    return re.sub(r' (d|x|y|points|transform)="[^"]*"', lambda found: DECIMALS.sub(rounded, found[0]), svg)


def rounded(number: re.Match) -> str:
    """A number with two decimals at most."""
    return f"{float(number[0]):.2f}".rstrip("0").rstrip(".")


def remake(page: Path, folder: Path) -> None:
    """Run a page, write its outputs anew and copy its pictures."""
    for command, shown, real in run_page(page, folder):
        old = f"$ {command}\n{shown}"
        text = page.read_text("utf8")
        if old not in text:
            raise ValueError(f"{page}: no block {old!r}")
        page.write_text(text.replace(old, f"$ {command}\n{renewed(shown, real)}", 1), "utf8")
    for name in pictures(page):
        if (made := folder / Path(name).name).exists():
            (PICTURES / name).write_text(small(made.read_text("utf8")), "utf8")


def other_pages() -> list[Path]:
    """Worked pages outside the tutorial."""
    pages = (page for page in sorted(GUIDE.rglob("*.md")) if page not in TUTORIAL)
    return [page for page in pages if "```console" in page.read_text("utf8")]


def folder_for(page: Path, folder: Path) -> Path:
    """A new folder in which a page outside the tutorial is run."""
    (own := folder / "pages" / page.stem).mkdir(parents=True)
    for step in BASIS:
        write_files(step, own)
    return own


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as scratch:
        for page in TUTORIAL:
            remake(page, Path(scratch))
        for page in other_pages():
            remake(page, folder_for(page, Path(scratch)))
