"""`sweeps compare`: two results beside each other."""

import os
from pathlib import Path

from commands import STUDY, done, refused, row, said
from press_texts import PRESS

from sweeps.report.answers import comparison as comparing
from sweeps.report.answers.comparison import comparison
from sweeps.report.recorded import result_file
from sweeps.report.sweep_result import SweepResult


def counts_of(text: str) -> str:
    """The part of a comparison that counts variants within their error estimates."""
    return text[text.index("Summaries, number of variants") :]


def test_result_beside_itself__agrees(press_result):
    answer = done("compare", press_result, press_result)
    assert "the same" in answer
    assert row(counts_of(answer), "excess_work")[1:3] == ["8", "0"]


def test_results_of_other_machines__differ_where_they_should(press_result):
    """A longer rod, and a mass more."""
    Path("press.toml").write_text(PRESS.replace("200 mm", "210 mm"))
    Path("study.toml").write_text(STUDY.replace('"100 kg"', '"100 kg", "150 kg"'))
    done("run", "study.toml", "--no-plots", "--quiet", "--out", "b.h5")
    answer = said("compare", press_result, "b.h5")
    assert answer.exit_code == 1
    assert "groups.slide.first.length: 200 mm and 210 mm" in answer.stdout
    assert "Variants: 8 and 12, 8 in common" in answer.stdout
    assert not set("[]{}") & set(answer.stdout)
    # In line, the stroke is twice the crank whatever the rod; the two longest cranks assemble with neither.
    assert row(counts_of(answer.stdout), "ram.stroke")[1:3] == ["8", "0"]
    assert row(counts_of(answer.stdout), "excess_work")[1:3] == ["2", "6"]


def test_same_variants_in_another_order__each_beside_itself(press_result, monkeypatch):
    one, other = SweepResult(Path(press_result)), SweepResult(Path(press_result))
    order = [5, 0, 7, 2, 1, 6, 3, 4]
    turned = {name: column[order].copy() for name, column in other.columns.items()}
    turned["ram.stroke"][2] *= 1.01
    turned["status"][4] = 2
    vars(other)["columns"] = turned
    turned["input.length"][7] *= 1.5
    for at_a_time, indexed in ((3, 100), (100, 100), (3, 5), (100, 1)):
        monkeypatch.setattr(result_file, "VARIANTS_AT_A_TIME", at_a_time)
        monkeypatch.setattr(comparing, "INDEXED", indexed)
        text = comparison(one, other).text
        assert "Variants: 8 and 8, 7 in common" in text
        assert "1 with another status, first variant 1: ok and singular" in text
        assert row(counts_of(text), "ram.stroke")[1:5] == ["6", "1", "variant", "7:"]
        assert row(counts_of(text), "excess_work")[1:3] == ["7", "0"]


def test_value_just_beyond_its_figure__is_outside(press_result):
    one, other = SweepResult(Path(press_result)), SweepResult(Path(press_result))
    changed = {name: column.copy() for name, column in other.columns.items()}
    figure = changed["ram.stroke_error"]
    # Both results have this figure, and rounding is let pass besides.
    changed["ram.stroke"][0] += 1.5 * figure[0]
    changed["ram.stroke"][1] += 3.0 * figure[1] + 1e-15
    vars(other)["columns"] = changed
    found = comparison(one, other)
    assert not found.agrees
    words = row(counts_of(found.text), "ram.stroke")
    assert words[1:3] == ["7", "1"]
    assert words[4] == "1:"


def test_results_without_a_variant_in_common__are_refused(press_result):
    done("run", "press.toml", "--no-plots", "--quiet", "--out", "b.h5")
    assert "nothing to compare" in refused("compare", press_result, "b.h5")
    assert "not a sweep result" in refused("compare", press_result, "press.toml")


def test_best_against_best__says_what_changed_by_how_many_per_cent(press_result):
    # In line, the stroke is twice the crank: 120 mm and 132 mm, ten per cent more.
    study = STUDY.replace('"40 mm", "60 mm", "250 mm", "50 mm"', '"40 mm", "66 mm"').replace("minimise", "maximise")
    Path("one.toml").write_text(study.replace("66 mm", "60 mm"))
    Path("two.toml").write_text("accuracy = 1e-6\n" + study)
    for name in ("one", "two"):
        done("run", f"{name}.toml", "--no-plots")
    answer = said("compare", "results/one.h5", "results/two.h5").stdout
    assert answer.startswith("Which crank does the least work?\nBest against best, variant ")
    assert "accuracy: not given and 1e-06\n" in answer
    best = answer[: answer.index("Scene and study")]
    assert row(best, "ram.stroke") == ["ram.stroke", "120", "mm", "132", "mm", "+10", "%"]
    assert row(best, "input.length") == ["input.length", "60", "mm", "66", "mm", "+10", "%"]
    # The same punching work.
    assert row(best, "excess_work")[-1] == "%"
    assert row(best, "bodies.ram.mass")[-1] == "kg"


def test_pictures_older_than_their_numbers__are_reported(press_folder):
    Path("results").mkdir()
    old = [Path("results") / name for name in ("study.html", "study_best.png", "study_b_best.png", "studying.png")]
    for file in (*old, Path("results/study_b.h5")):
        file.write_text("")
        os.utime(file, (0, 0))
    answer = said("run", "study.toml", "--no-plots")
    assert "Older than results/study.h5: study.html, study_best.png; `sweeps plot`" in answer.stderr
