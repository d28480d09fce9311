"""Sweeps of a press beside a four-bar: their texts, their runs, and what a result file holds bit by bit."""

from collections.abc import Callable
from pathlib import Path

import h5py
from press_texts import slider_crank_text

from sweeps import Study, read_study, run_study

# A four-bar with a press beside it: the slider-crank's group comes second, and is the one to blame for most.
SCENE = f"""\
title = "Press with a rocker"

[points.D]
x = "260 mm"
y = "0 mm"

[groups.bars]
type = "RRR"
inner = "C"
first = {{link = "coupler", joint = "A", length = "250 mm"}}
second = {{link = "rocker", joint = "D", length = "150 mm"}}

{slider_crank_text(group="press")}
[bodies.ram]
link = "ram"
mass = "100 kg"

[bodies.rocker]
link = "rocker"
mass = "4 kg"
x = "70 mm"

[forces.punch]
type = "constant"
on = "B"
angle = "180 deg"
force = "100 kN"
acts = "against"

[flywheel]
speed_fluctuation = "1/10"
"""

# The same paths and the same questions in all studies of a kind: one kernel serves them all.
HEAD = 'title = "Which crank?"\nquestion = "How short?"\nscene = "scene.toml"\n'
ASKED = """
[outputs]
summaries = ["ram.stroke", "rocker.swing", "excess_work"]
"""
BEST = '\n[best]\nminimise = "excess_work"\nwhere = "ram.stroke > \'80 mm\'"\n'
FIELDS = ASKED + 'fields = ["ram.slide", "reduced_moment"]\n' + BEST
STROKE = '\n[outputs]\nsummaries = ["ram.stroke"]\n'
LISTS = """
[vary]
"input.length" = {values = LENGTHS}
"bodies.ram.mass" = {values = MASSES}
"""


def text_of(lengths: list[str], masses: list[str], asked: str = ASKED + BEST, head: str = "positions = 48\n") -> str:
    vary = LISTS.replace("LENGTHS", str(lengths)).replace("MASSES", str(masses))
    return HEAD + head + vary + asked


def many(count: int, asked: str = ASKED + BEST, head: str = "positions = 48\n") -> str:
    """A study of so many lengths of the crank."""
    text = text_of(["40 mm"], ["1 kg"], asked, head)
    return text.replace("values = ['40 mm']", f'from = "20 mm", to = "60 mm", count = {count}')


class Stop(Exception):
    """Stands for whatever ends a run."""


def stopping(at: int) -> Callable[..., None]:
    """Progress of a run that ends once so much is done."""

    def stop(done: int, before: int, words: str = "") -> None:
        if done >= at > before:
            raise Stop

    return stop


def study_of(folder: Path, text: str, name: str = "study") -> Study:
    (folder / "scene.toml").write_text(SCENE)
    (folder / f"{name}.toml").write_text(text)
    return read_study(folder / f"{name}.toml")


def run(folder: Path, text: str, name: str = "study") -> Path:
    return run_study(study_of(folder, text, name), folder / f"{name}.h5")


def contents(path: Path) -> dict[str, tuple[str, bytes]]:
    """Every dataset of a file, bit by bit."""
    found = {}

    def visit(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset):
            found[name] = (f"{item.dtype} {item.shape}", item[()].tobytes())

    with h5py.File(path, "r") as file:
        file.visititems(visit)
    return found


def numbers_in(path: Path) -> dict[str, tuple[str, bytes]]:
    """As `contents`, without how the variants fall into blocks."""
    return {name: value for name, value in contents(path).items() if not name.startswith("progress")}


# The same studies in several files: two variants of two numbers, and many of one.
GOOD = text_of(["40 mm", "50 mm"], ["50 kg", "100 kg"], FIELDS)

DISTINCT = many(200, FIELDS)
