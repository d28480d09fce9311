"""Accuracy in a study's text: what `check` predicts, `run` keeps and tells, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from commands import done, refused

from sweeps import SweepResult
from sweeps.text.templates import bundled_templates

STUDY = """
scene = "scene.toml"
accuracy = {accuracy}

[vary]
"input.length" = {{ from = "40 mm", to = "190 mm", count = 4 }}

[outputs]
summaries = ["piston.stroke", "excess_work"]
"""


@pytest.fixture
def study(folder):
    Path("scene.toml").write_text(bundled_templates()["slider_crank"].read_text(encoding="utf8"), encoding="utf8")
    return lambda accuracy: Path("study.toml").write_text(STUDY.format(accuracy=accuracy), encoding="utf8")


def test_run__keeps_how_many_positions_each_variant_took(study):
    study('"1e-3 %"')
    predicted, answer = done("check", "study.toml"), done("run", "study.toml", "--no-plots", "--quiet")
    told = next(line for line in answer.splitlines() if line.startswith("accuracy 0.001 %"))
    # A check tries them all: it predicts what comes, with how many it tried.
    assert f"{told} (sample of " in predicted
    result = SweepResult(Path("results/study.h5"))
    good = result.columns["status"] == 0
    assert good.any()
    assert "reached by all" in told
    assert result.accuracy == 1e-5
    for column in ("piston.stroke", "excess_work"):
        assert (result.columns[f"{column}_error"][good] <= 1e-5 * result.columns[column][good]).all()
    used = result.columns["positions_used"][good]
    assert f"{used.min():.0f}" in told
    assert np.isnan(result.columns["positions_used"][~good]).all()
    assert "positions_used" in done("show", "results/study.h5", "--where", "accuracy_reached == 1", "--all")


@pytest.mark.parametrize(
    ("accuracy", "words"),
    [('"150 %"', "less than 1"), ("0", "greater than 0"), ('"0.1 mm"', "mm"), ('"fine"', "fine")],
)
def test_nonsense__is_explained(study, accuracy, words):
    study(accuracy)
    answer = refused("run", "study.toml")
    assert "study.toml, line 3: accuracy" in answer
    assert words in answer
