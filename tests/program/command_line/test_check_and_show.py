"""`sweeps check`, `sweeps show` and `sweeps export`: what they tell before a run and after it."""

import csv
import itertools
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from commands import STUDY, done, refused, said
from each_case import each
from press_texts import PRESS, slider_crank_text
from slips import changed

from engine import order_groups
from engine.scene.pairs import pairs
from sweeps import read_scene, read_study
from sweeps.pictures.sweep.result_pictures import sweep_data
from sweeps.report.check_report import structure_text
from sweeps.report.result_report import undecided_text
from sweeps.report.sweep_result import SweepResult
from sweeps.study.search_task import task_of
from sweeps.text.templates import bundled_templates, templates

# check


def test_check__tells_what_is_computed_and_what_it_costs_and_writes_nothing(press_folder):
    before = sorted(press_folder.rglob("*"))
    answer = said("check", "study.toml")
    assert answer.exit_code == 0
    assert answer.stderr == ""
    told = """Which crank?
group slide: RRP of rod and ram
W = 3n − 2p₁ = 3·3 − 2·4 = 1
assembles over the whole cycle
8 = input.length [4] × bodies.ram.mass [2]
Computed at adaptive positions
Skipped (not needed for the outputs)
acceleration
plus the program itself
free"""
    for words in told.splitlines():
        assert words in answer.stdout
    # In line, the stroke is twice the crank of 50 mm.
    assert any(line.split()[:2] == ["ram.stroke", "100"] for line in answer.stdout.splitlines())
    assert sorted(press_folder.rglob("*")) == before


@each("name", sorted(templates()))
def test_mobility__counts_every_pair_and_leaves_the_inputs(name):
    scene = read_scene(bundled_templates()[name])
    if scene.input is None:
        return
    told = structure_text(scene).splitlines()[-1]
    links, lower, higher, left = map(int, re.search(r"3·(\d+) − 2·(\d+)(?: − (\d+))? = (\d+)$", told).groups("0"))
    assert (links, lower) == (len(order_groups(scene).links), len(pairs(scene)))
    assert 3 * links - 2 * lower - higher == left == 1 + sum(second.drive == "own" for second in scene.inputs.values())


def test_fields_with_a_load_between_two_positions__are_warned_of(press_folder):
    # A blow over the last millimetre of the stroke: some 16° of the crank, between positions 45° apart.
    blow = """type = "table"
slider = "ram"
measured_from = "high end"
over_stroke = ["0.5 mm", "1 mm"]
force = ["100 kN", "100 kN"]
outside = "zero"
interpolation = "linear\""""
    text = PRESS.replace('type = "constant"', blow).replace('force = "100 kN"\nacts', "acts")
    Path("press.toml").write_text(text)
    Path("fields.toml").write_text('scene = "press.toml"\npositions = 8\n[outputs]\nfields = ["reduced_moment"]\n')
    for command in (["check"], ["run", "--no-plots", "--quiet"]):
        answer = done(*command, "fields.toml")
        assert "these fields peak between the kept positions" in answer


def test_check_of_a_machine_that_turns_in_part__names_the_ranges(press_folder):
    Path("press.toml").write_text(PRESS.replace('"50 mm"', '"250 mm"'))
    answer = done("check", "press.toml")
    # Upright guide: the rod of 200 mm reaches while |250 cos φ| < 200, from 36.87° to 143.13° and opposite.
    line = next(line for line in answer.splitlines() if "assembles only" in line)
    assert "36.9" in line
    assert "143.1" in line
    assert "input.start and input.stop" in line


def test_check_of_a_machine_that_nowhere_assembles__says_so(press_folder):
    text = PRESS.replace('guide = "way"}', 'guide = "way", offset = "2 m"}')
    Path("press.toml").write_text(text)
    answer = done("check", "press.toml")
    assert "can't be assembled at any input position" in answer
    # The crankpin is at x = 50 mm, the wrist pin would move along x = 2 m.
    gap = "joint A is 1950 mm from the line of joint B, its rod spans 200 mm"
    assert f"group slide fails first, at 0 °: {gap}" in answer
    # None of its numbers is known.
    assert "more with" not in said("run", "press.toml", "--no-plots").stdout


def test_check_of_a_governor__compiles_no_motion(press_folder, monkeypatch):
    monkeypatch.setattr("engine.elements.governors.governor.follow_changes", None)
    said("new", "governor")
    told = said("check", "governor.toml").stdout
    assert "governor.gain_margin  " in told
    assert "followed by `sweeps run`" in told


def test_check_source__shows_names_to_read(press_folder):
    answer = done("check", "study.toml", "--source")
    assert "\n; curves\n; All curves, over a panel.\n" in answer
    assert "call i32 @rrp_position." in answer
    assert "%rod_direction_x.1 = load double" in answer


def test_check_of_a_load_without_a_value__names_it_and_where(press_folder):
    # With the slide at 160 mm, crank of 50 mm and rod of 200 mm: cos φ = (160² + 50² − 200²)/(2·160·50), φ = 138.05°.
    load = 'force = "100 N * sqrt((ram.slide - 160 mm) / 1 m)"'
    Path("press.toml").write_text(f'{slider_crank_text()}[forces.push]\non = "B"\ntype = "formula"\n{load}\n')
    answer = done("check", "press.toml")
    assert "push.moment, the reduced moment of push, is infinite or undefined, first at 138.5 °" in answer


# show


def table_of(stdout: str) -> list[list[str]]:
    """Rows of the table of variants: below its two lines of heads."""
    lines = stdout.splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith("variant "))
    rows = itertools.takewhile(lambda line: line[:1].isdigit(), lines[first + 2 :])
    return [row.split() for row in rows]


def test_show__lists_what_meets_the_study_s_condition_the_best_first(press_result):
    answer = said("show", press_result)
    assert answer.exit_code == 0
    assert answer.stderr == ""
    assert re.fullmatch(r"Which crank\?: 8 variants, all done [-\d]+ [:\d]+ UTC", answer.stdout.splitlines()[0])
    assert [row[0] for row in table_of(answer.stdout)] == ["6", "7", "2", "3"]
    assert [row[1] for row in table_of(answer.stdout)] == ["50", "50", "60", "60"]
    assert "Answer: minimum excess_work" in answer.stdout


def test_show_variant__lists_its_numbers(press_result):
    lines = done("show", press_result, "--variant", "3").splitlines()
    assert lines[0] == "variant 3: ok"
    rows = {line.split()[0]: line.split()[1:4] for line in lines[1:]}
    assert rows["input.length"] == ["=", "60", "mm"]
    # In line, the stroke is twice the crank.
    assert rows["ram.stroke"] == ["→", "120", "mm"]
    assert "variant: 8 is not one of 0 … 7" in refused("show", press_result, "--variant", "8")


def test_two_bars_that_do_not_reach__are_told_with_distance_and_span(folder):
    # At 0° the crankpin is at (−345, 500) mm, C at (0, 800) mm: 345² + 300² = 457.19².
    Path("toggle.toml").write_text(
        """points = { O = { x = "-400 mm", y = "500 mm" }, C = { x = 0, y = "800 mm" } }
        input = { type = "crank", pivot = "O", pin = "A", length = "55 mm", speed = "60 rpm" }
        [groups.toggle]
        type = "RRR"
        inner = "B"
        first = { link = "rod", joint = "A", length = "34 mm" }
        second = { link = "upper", joint = "C", length = "300 mm" }"""
    )
    assert "at 0 °: joints A and C are 457.19 mm apart, its bars span 266 mm … 334 mm" in done("check", "toggle.toml")


def test_columns_of_one_machine__are_all_that_is_shown(press_folder):
    done("run", "press.toml", "--no-plots")
    answer = done("show", "results/press.h5", "--columns", "ram.stroke")
    assert answer.splitlines()[2:] == ["1 variant works:", "variant  ram.stroke", "         mm", "0        100"]


def test_show_where_sort_limit_and_columns__choose(press_result):
    answer = said("show", press_result, "--where", "bodies.ram.mass > '60 kg'", "--sort", "ram.stroke", "--descending")
    assert [row[0] for row in table_of(answer.stdout)] == ["3", "7", "1"]
    assert "3 variants meet the condition" in answer.stdout
    answer = said("show", press_result, "--where", "ram.stroke > 0", "--sort", "ram.stroke", "--limit", "2")
    assert [row[0] for row in table_of(answer.stdout)] == ["0", "1"]
    answer = said("show", press_result, "--columns", "excess_work, status")
    head = next(line for line in answer.stdout.splitlines() if line.startswith("variant "))
    assert head.split() == ["variant", "input.length", "bodies.ram.mass", "excess_work", "status"]


@each("count, words", [(0, ""), (1, "; 1 is undecided"), (2, "; 2 are undecided")])
def test_variants_that_an_estimate_leaves_open__are_counted(count, words):
    text = undecided_text(SimpleNamespace(undecided=lambda where: count), "stroke > 1")
    assert text == (f"{words} within error estimates" if words else "")


# `where` means the same in [best], in [optimise], and as --where of show, plot and export.


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
    lines = [line.split() for line in done("show", press_result, *options).splitlines()]
    assert sorted(int(line[0]) for line in lines if line[1:2] in (["40"], ["50"], ["60"])) == WHERE[where]
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
    where = '["B.y.max > 0 mm", "required_power < 1 MW"]'
    Path("study.toml").write_text(changed(text, "\"ram.stroke > '90 mm'\"", where))
    assert read_study("study.toml").summaries == ("excess_work", "B.y.max", "required_power")


def test_best__may_be_a_parameter(press_folder):
    text = changed(STUDY, 'minimise = "excess_work"', 'maximise = "input.length"')
    Path("study.toml").write_text(text)
    told = done("run", "study.toml", "--no-plots", "--quiet")
    assert "maximum input.length where ram.stroke > '90 mm': 60 mm" in told
    Path("search.toml").write_text(text.replace("[best]", "[optimise]"))
    assert [objective.name for objective in task_of(read_study("search.toml")).objectives] == ["input.length"]
