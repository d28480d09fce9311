"""`where` means the same in [best], in [optimise], and as --where of show, plot and export."""

import csv
from pathlib import Path

import pytest
from commands import STUDY, done, refused
from slips import changed

from sweeps import read_study
from sweeps.pictures.sweep.result_pictures import sweep_data
from sweeps.report.sweep_result import SweepResult
from sweeps.study.search_task import task_of

# Cranks of 40, 60, 250 and 50 mm, each with rams of 50 and 100 kg; the stroke is twice the crank, 250 mm fail.
WHERE = {
    ("ram.stroke > 90 mm",): [2, 3, 6, 7],
    ("ram.stroke > 90 mm", "bodies.ram.mass < 60 kg"): [2, 6],
    ("ram.stroke > 90 mm and not input.length > 50 mm",): [6, 7],
    ("ram.stroke < 90 mm or bodies.ram.mass == 0.1 t", "input.length <= 5 cm"): [0, 1, 7],
    ("ram.stroke > 2 * input.length - 1 mm and input.speed < 100 rpm",): [0, 1, 2, 3, 6, 7],
    ("ram.stroke > 90 mm", "input.speed > 100 rpm"): [],
}


@pytest.mark.parametrize("where", WHERE)
def test_variants__are_the_same_wherever_a_condition_stands(where, press_result):
    options, result = [part for text in where for part in ("--where", text)], SweepResult(Path(press_result))
    assert result.select(where).tolist() == WHERE[where]
    shown = done("show", press_result, *options).splitlines()
    assert (
        sorted(int(line.split()[0]) for line in shown if line.split()[1:2] in (["40"], ["50"], ["60"])) == WHERE[where]
    )
    done("export", press_result, *options, "--to", "chosen.csv")
    with Path("chosen.csv").open(encoding="utf8") as file:
        rows = list(csv.reader(file))
    assert [int(float(row[0])) for row in rows[1:] if row[0].replace(".", "").isdigit()] == WHERE[where]
    data, _ = sweep_data(SweepResult(Path(press_result), where=where), ())
    assert data.candidates.nonzero()[0].tolist() == WHERE[where]
    text = changed(STUDY, "\"ram.stroke > '90 mm'\"", str(list(where)))
    Path("again.toml").write_text(text)
    study = read_study("again.toml")
    best = SweepResult(Path(press_result), where=study.best.where).best()
    assert (best in WHERE[where]) if WHERE[where] else best is None
    goal = '[optimise]\nminimise = "ram.stroke"\nwhere'
    Path("search.toml").write_text(changed(text.replace('[best]\nminimise = "excess_work"\n', ""), "where", goal))
    assert [condition.text for condition in task_of(read_study("search.toml")).conditions] == list(where)


def test_results_in_a_condition__are_computed_without_being_listed(press_folder):
    text = changed(STUDY, '["ram.stroke", "excess_work"]', '"excess_work"')
    Path("study.toml").write_text(
        changed(text, "\"ram.stroke > '90 mm'\"", '["B.y.max > 0 mm", "required_power < 1 MW"]')
    )
    assert read_study("study.toml").summaries == ("excess_work", "B.y.max", "required_power")


def test_best__may_be_a_parameter(press_folder):
    Path("study.toml").write_text(changed(STUDY, 'minimise = "excess_work"', 'maximise = "input.length"'))
    assert "maximum input.length where ram.stroke > '90 mm': 60 mm" in done(
        "run", "study.toml", "--no-plots", "--quiet"
    )
    read = changed(STUDY, 'minimise = "excess_work"', 'maximise = "input.length"').replace("[best]", "[optimise]")
    Path("search.toml").write_text(read)
    assert [objective.name for objective in task_of(read_study("search.toml")).objectives] == ["input.length"]


def test_plot_of_chosen_variants__says_what_they_meet(press_result):
    done("plot", press_result, "--where", "ram.stroke < 90 mm", "--out", "chosen.svg")
    assert Path("chosen.svg").exists()
    assert "where: write == instead of =" in refused("plot", press_result, "--where", "ram.stroke = 90 mm")


@pytest.mark.parametrize(
    "command",
    [
        ("plot", "press.toml"),
        ("export", "press.toml", "--to", "a.csv"),
        ("export", "r.h5", "--variant", "1", "--to", "a.csv"),
    ],
)
def test_condition_on_one_machine__is_refused(command, press_result):
    assert "--where: chooses variants of a whole result file" in refused(*command, "--where", "ram.stroke > 1 mm")
