"""Commands as they are given and answered, and the study of a press to give them on."""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from sweeps.cli import main

ROOT = Path(__file__).parents[3]

STUDY = """\
title = "Which crank?"
question = "Which crank does the least work?"
scene = "press.toml"
positions = 48

[vary]
"input.length" = {values = ["40 mm", "60 mm", "250 mm", "50 mm"]}
"bodies.ram.mass" = {values = ["50 kg", "100 kg"]}

[outputs]
summaries = ["ram.stroke", "excess_work"]

[best]
minimise = "excess_work"
where = "ram.stroke > '90 mm'"
"""

# Commands that write a file each, in every format.
WRITES = [
    ("export", "press.toml", "--to", "out.csv"),
    ("export", "press.toml", "--to", "out.json"),
    ("export", "press.toml", "--to", "out.mat"),
    ("export", "press.toml", "--to", "out.parquet"),
    ("export", "press.toml", "--overwrite", "--to", "out.toml"),
    ("export", "press.toml", "--to", "out.svg"),
    ("export", "press.toml", "--to", "out.dxf"),
    ("plot", "press.toml", "--out", "out.png"),
    ("plot", "press.toml", "--out", "out.pdf"),
    ("animate", "press.toml", "--frames", "4", "--out", "out.gif"),
    ("new", "rotor", "--out", "out.toml"),
    ("report", "press.toml", "--out", "out.html"),
]


def said(*arguments: str) -> Result:
    """A command's answer; it never ends in an exception of its own."""
    answer = CliRunner().invoke(main, arguments)
    assert answer.exception is None or isinstance(answer.exception, SystemExit), answer.exception
    return answer


def done(*arguments: str) -> str:
    """What a command says on standard output when it succeeds."""
    answer = said(*arguments)
    assert answer.exit_code == 0, answer.output
    return answer.stdout


def refused(*arguments: str) -> str:
    """What a command says on standard error when it refuses."""
    answer = said(*arguments)
    assert answer.exit_code == 2, answer.output
    assert answer.stderr
    assert "Traceback" not in answer.output
    return answer.stderr


def leave_pictures_blank(patch: pytest.MonkeyPatch) -> None:
    """Write files of pictures without what is drawn, which tests of pictures look at."""
    patch.setattr("sweeps.pictures.style._lettered", lambda figure: None)
    patch.setattr("sweeps.pictures.style.Sheet.savefig", lambda figure, file, **given: file.write(b"<svg/>"))


def row(text: str, name: str) -> list[str]:
    """Words of the line that begins with a name."""
    return next(line.split() for line in text.splitlines() if line.split()[:1] == [name])


def ran(*line: str, **options: object) -> subprocess.CompletedProcess:
    """Python as a process of its own, with pipes for its output."""
    found = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run([sys.executable, *line], env=found, capture_output=True, text=True, **options)


def python(*arguments: str, **options: object) -> subprocess.CompletedProcess:
    """A command as a process of its own."""
    return ran("-m", "sweeps", *arguments, **options)
