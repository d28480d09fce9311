"""A study of a press as a text, and studies that vary something else of it."""

from pathlib import Path

from sweeps import Study, read_study
from sweeps.study.bundled import bundled_studies

STUDY = """\
title = "Which crank?"
question = "How short may the crank be?"
scene = "press.toml"
positions = 48

[vary]
"input.length" = {from = "40 mm", to = "60 mm", count = 3}
bodies.ram.mass = {values = ["50 kg", "0.1 t"]}
reach = {values = [3, 4, 5]}

[derive]
"groups.slide.first.length" = "reach * input.length"

[outputs]
summaries = ["ram.stroke", "excess_work"]

[best]
minimise = "excess_work"
where = "ram.stroke > '90 mm'"
"""


def study_of(folder: Path, text: str) -> Study:
    (folder / "study.toml").write_text(text, encoding="utf8")
    return read_study(folder / "study.toml")


def varying(folder: Path, vary: str, rest: str = "") -> Study:
    return study_of(folder, f'scene = "press.toml"\n{rest}\n[vary]\n{vary}\n')


def coarser(name: str, replaced: dict[str, str], folder: Path) -> Study:
    """A bundled study with parts of its text replaced, so that it has fewer variants, written to a folder."""
    path = bundled_studies()[name]
    text = path.read_text(encoding="utf8").replace('"scenes/', f'"{path.parent.as_posix()}/scenes/')
    for old, new in replaced.items():
        assert old in text
        text = text.replace(old, new)
    return study_of(folder, text)
