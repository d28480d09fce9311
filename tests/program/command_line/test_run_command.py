"""`sweeps run`: what is said, where the result goes, interrupts, exit codes, and the accuracy required."""

import itertools
import time
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from commands import STUDY, done, said

from engine import Mechanics
from sweeps import SweepResult
from sweeps.run.progress import ProgressBar
from sweeps.store import variants_kept
from sweeps.text.interruption import farewell

# Tests of pictures look at what is drawn.
pytestmark = pytest.mark.usefixtures("blank_pictures")


def test_run__tells_counts_blame_answer_and_files(press_folder):
    answer = said("run", "study.toml", "--no-plots")
    assert answer.exit_code == 0
    lines = answer.stdout.splitlines()
    assert lines[0] == "Which crank?: 8 variants"
    assert any(line.split()[:2] == ["6", "ok"] for line in lines)
    assert any(line.startswith("2") and "can't be assembled" in line and "lengthen" in line for line in lines)
    assert any("group slide: 2" in line for line in lines)
    assert "Which crank does the least work?" in lines
    assert any(line.startswith("Answer: minimum excess_work where ram.stroke > '90 mm':") for line in lines)
    assert any(line.split() == ["input.length", "=", "50", "mm"] for line in lines)
    assert lines[-1].strip() == str(Path("results/study.h5"))
    assert answer.stderr == ""
    assert SweepResult(Path("results/study.h5")).best() == 6


def test_run_with_pictures__builds_one_machine_and_draws_what_is_older(press_folder, monkeypatch):
    built, build = [], Mechanics.__init__

    def noted(self, *arguments, **options):
        built.append(self)
        build(self, *arguments, **options)

    monkeypatch.setattr(Mechanics, "__init__", noted)
    listed = done("run", "study.toml").partition("Files")[2].splitlines()[1:]
    assert len(built) == 1
    pictures = [Path(line.strip()) for line in listed if line.endswith(".png")]
    assert [path.name for path in pictures if path.name.endswith("_best_diagrams.png")]
    assert len(pictures) == 3
    before = {path: path.stat().st_mtime_ns for path in pictures}
    again = done("run", "study.toml").partition("Files")[2].splitlines()[1:]
    assert sorted(again) == sorted(listed)
    assert {path: path.stat().st_mtime_ns for path in pictures} == before
    # What an interruption leaves.
    Path("results/study.png").unlink()
    done("run", "study.toml")
    assert all(path.stat().st_mtime_ns > before[path] for path in pictures)


def test_run_with_another_question__answers_that_one(press_result):
    Path("study.toml").write_text(STUDY.replace("minimise", "maximise"))
    before = SweepResult(Path(press_result)).best()
    answer = said("run", "study.toml", "--no-plots", "--out", press_result)
    assert "Answer: maximum excess_work" in answer.stdout
    assert "Answer: maximum excess_work" in said("show", press_result).stdout
    assert SweepResult(Path(press_result)).best() != before


def test_run_without_candidates__says_so_and_has_an_exit_code_of_its_own(press_folder):
    Path("study.toml").write_text(STUDY.replace('"40 mm", "60 mm", "250 mm", "50 mm"', '"250 mm"'))
    answer = said("run", "study.toml", "--no-plots", "--replace")
    assert answer.exit_code == 1
    assert "can't be assembled" in answer.stdout
    assert "No variant" in answer.stdout


def interrupted(after: int) -> str:
    """What a run stopped after so many variants, in blocks of three, says on the way out."""
    words = []
    update = ProgressBar.update

    def stop(self: ProgressBar, done: int, *more: int) -> None:
        update(self, done, *more)
        if done >= after:
            words.append(farewell())
            raise KeyboardInterrupt

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("sweeps.run.runner.block_size", lambda *_: 3)
        patch.setattr("sweeps.run.progress.ProgressBar.update", stop)
        patch.setattr("sys.argv", ["sweeps", "run", "study.toml", "--restart", "--no-plots", "--out", "my r.h5"])
        assert said("run", "study.toml", "--no-plots", "--out", "r.h5").exit_code == 1
    return words[0]


def test_interrupt__counts_what_an_earlier_run_left(press_folder):
    assert "Interrupted: 6 of 8 variants" in interrupted(6)
    assert said("show", "r.part.h5").stdout.startswith("Which crank?: 6 of 8 variants done; run the study again")
    # Of the same study, before the file is checked; of an edited one, before any of it is copied; and in between.
    bar = ProgressBar(8, True, kept=variants_kept(Path("r.h5")))
    assert bar.kept_text() == "the 6 of the earlier run are kept"
    Path("study.toml").write_text(STUDY.replace('"50 kg", "100 kg"', '"50 kg", "100 kg", "60 kg"'))
    assert "Interrupted: the 6 of the earlier run are kept; resume" in interrupted(0)
    assert "Interrupted: 3 of 12 variants are done, and the 6 of the earlier run are kept" in interrupted(3)
    assert variants_kept(Path("nothing.h5")) == 0


class Clock:
    """Time that a test sets, for the progress and its bar."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.now = 1000.0
        monkeypatch.setattr("sweeps.run.progress.time.monotonic", lambda: self.now)


@pytest.mark.parametrize("before", [0, 400])
def test_time_left__is_that_of_what_follows_the_first_part(before, monkeypatch, capsys):
    """Which may have waited for workers to start and to compile, here for ten minutes."""
    clock = Clock(monkeypatch)
    bar = ProgressBar(10_000, quiet=False)
    bar.update(before, before)
    clock.now += 600
    bar.update(before + 10, before)
    assert capsys.readouterr().err == ""
    clock.now += 40
    bar.update(before + 410, before)
    left = (10_000 - before - 410) / 10
    assert f"10 per second, {left:.0f} s left" in capsys.readouterr().err


REQUIRE = """require = [
  "bodies.ram.mass < '90 kg'",
  "input.length <= '60 mm'",
]
"""


def test_what_each_condition_drops__is_told_by_check_run_and_show(press_folder):
    Path("study.toml").write_text(STUDY.replace("positions", f"{REQUIRE}positions"))
    # Of 4 lengths × 2 masses: one mass in four lengths, one length in two masses; one variant fails both.
    counts = [
        "bodies.ram.mass < '90 kg': 4, 3 only by this condition",
        "input.length <= '60 mm': 2, 1 only by this condition",
    ]
    checked = said("check", "study.toml").stdout
    assert "required, 5 of 8 dropped:" in checked
    assert all(line in checked for line in counts)
    ran, shown = said("run", "study.toml", "--no-plots", "--out", "r.h5").stdout, said("show", "r.h5").stdout
    for text in (ran, shown):
        lines = [line.strip() for line in text.splitlines()]
        dropped = next(i for i, line in enumerate(lines) if "dropped by a constraint" in line)
        assert lines[dropped].startswith("5 ")
        assert lines[dropped + 1 : dropped + 3] == counts
        # Failures of groups are told apart from what is dropped.
        assert "group slide" not in text


def test_what_each_condition_drops__is_a_share_by_a_sample_where_variants_are_many(press_folder, monkeypatch):
    from sweeps.report import check_report as report

    monkeypatch.setattr(report, "MOST_COUNTED", 64)
    monkeypatch.setattr(report, "SAMPLED", 64)
    monkeypatch.setattr(report, "PLACES", 16)
    vary = '"input.length" = {from = "40 mm", to = "60 mm", count = 4001}'
    start, end = STUDY.index('"input.length"'), STUDY.index("[outputs]")
    text = STUDY[:start] + vary + "\n" + STUDY[end:]
    Path("study.toml").write_text(text.replace("positions", "require = [\"input.length > '45 mm'\"]\npositions"))
    lines = said("check", "study.toml").stdout.splitlines()
    every = next(i for i, line in enumerate(lines) if "required," in line)
    # All are dropped by the one condition.
    for line in lines[every : every + 2]:
        share = float(line.split("about ")[1].split(" %")[0])
        # Sixteen samples evenly taken: the border lies within one of them.
        assert abs(share - 25) <= 100 / 15


def test_progress_into_a_pipe__is_plain_lines_now_and_then(press_folder, monkeypatch):
    ticks = itertools.count(0.0, 40.0)
    clock = SimpleNamespace(monotonic=lambda: next(ticks), perf_counter=time.perf_counter)
    monkeypatch.setattr("sweeps.run.progress.time", clock)
    monkeypatch.setattr("sweeps.run.runner.block_size", lambda *_: 2)
    answer = said("run", "study.toml", "--no-plots")
    lines = answer.stderr.splitlines()
    # The first part is compiled before it is computed, and says nothing of what is left.
    assert len(lines) == 3
    assert lines[0].startswith("4 of 8 variants, ")
    assert lines[0].endswith(" s left")
    assert "\r" not in answer.stderr
    assert said("run", "study.toml", "--no-plots", "--restart", "--quiet").stderr == ""


def test_run_of_a_finished_study__says_that_nothing_was_computed(press_result):
    again = said("run", "study.toml", "--no-plots", "--out", press_result)
    assert again.exit_code == 0
    assert again.stderr == f"{press_result} is complete: nothing was computed. --restart recomputes it.\n"
    assert "Which crank does the least work?" in again.stdout


def test_study_that_is_changed_again_and_again__keeps_one_previous_result(press_result):
    for mass in (55, 60):
        Path("study.toml").write_text(STUDY.replace('"50 kg"', f'"{mass} kg"'))
        answer = said("run", "study.toml", "--no-plots", "--out", press_result)
        assert answer.exit_code == 0
    result = Path(press_result)
    assert answer.stderr == f"The previous {press_result} is kept as {result.with_suffix('.previous.h5')}.\n"
    assert sorted(path.name for path in result.parent.glob("*.h5")) == [result.name, f"{result.stem}.previous.h5"]
    assert SweepResult(result.with_suffix(".previous.h5")).columns["bodies.ram.mass"][0] == 55


ACCURATE = """
scene = "scene.toml"
accuracy = "1e-3 %"

[vary]
"input.length" = "40 mm to 190 mm, 4"

[outputs]
summaries = ["piston.stroke", "excess_work"]
"""


def test_run__keeps_how_many_positions_each_variant_took(folder):
    done("new", "slider_crank", "--out", "scene.toml")
    Path("study.toml").write_text(ACCURATE)
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
