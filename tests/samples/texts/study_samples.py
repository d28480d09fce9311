"""A study of a press as a text, and studies that vary something else of it."""

from pathlib import Path

from sweeps import Study, read_study

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
