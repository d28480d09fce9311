"""Parts of a search: margins of conditions, coordinates, refusals, fronts, what the command says, the picture."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from commands import done, said
from each_case import each
from hypothesis import given, settings
from hypothesis import strategies as st
from searches import CRANK, NEAREST, RANGES, ROD, SCENE, TWO, searched, study_of
from slips import cases

from engine.parts.formulas.expressions import parse
from sweeps import InputError, SweepResult, read_study, run_study
from sweeps.optimising.optimum import choices, front
from sweeps.optimising.pareto import pareto_front
from sweeps.optimising.trials import Trials
from sweeps.page.digest import Digest
from sweeps.pictures.sweep.front_picture import front_picture
from sweeps.pictures.sweep.result_pictures import result_pictures, sweep_data
from sweeps.study.sampling import Columns, Design, Listed, Sampled, Steps
from sweeps.study.search_task import task_of
from sweeps.study.search_variables import Variables
from sweeps.text.conditions import Condition


def test_margin__is_the_share_by_which_a_limit_is_missed():
    values = {"a": np.array([1.0, 2.0, 3.0, np.nan, 0.0]), "b": 2.0}
    # (a − b) / (|a| + |b|), undefined at worst.
    shares = Condition(parse("a <= b")).margins(values, {}, 5)
    np.testing.assert_allclose(shares, [[-1 / 3, 0, 1 / 5, 1, -1]], atol=1e-14)
    both = Condition(parse("a <= b and a > 1")).margins(values, {}, 5)
    np.testing.assert_allclose(both[1], [0, -1 / 3, -1 / 2, 1, 1], atol=1e-14)
    # |a − b| / (|a| + |b|), but for the limit: a slope everywhere.
    narrow = Condition(parse("abs(a - b) <= 1e-9")).margins(values, {}, 5)
    np.testing.assert_allclose(narrow, [[1 / 3, 0, 1 / 5, 1, 1]], atol=1e-9)


# Coordinates

DESIGN = Design(
    (
        Steps("a", 3.0, -1.0, 4),
        Listed("b", [5.0, 7.0, 9.0]),
        Sampled(("c", "d"), (1.0, 0.0), (100.0, 8.0), 16, "latin", 0, (True, False)),
        Columns(("e", "f"), ((1.0, 2.0), (10.0, 20.0))),
        Steps("g", 1e-3, 1e3, 5, True),
    )
)


@settings(max_examples=100)
@given(st.lists(st.floats(0, 1), min_size=6, max_size=6))
def test_coordinates__and_values_lead_to_each_other(place):
    variables = Variables.of(DESIGN)
    values = {n: float(v[0]) for n, v in variables.values(np.array([place])).items()}
    again = variables.values(variables.coordinates(values)[None])
    for name, value in values.items():
        # A logarithm of up to 14, there and back: 14 roundings of 1e-16, and those of a difference of size 4.
        assert again[name][0] == pytest.approx(value, rel=1e-14, abs=1e-15), name


# Texts that are refused

LISTED = '[vary]\n"input.length" = {values = ["40 mm", "50 mm"]}\n'
VARY = {"": RANGES, "lists": LISTED, "nothing": ""}
# Name | what is asked of the search | what varies, ranges where nothing is said | more of the study | message.
REFUSED = cases(r"""
nothing to search for | population = 20 |  |  | line 9: optimise: no objective: give minimise or
unknown output | minimise = "wheel_mas" |  |  | line 10: optimise.minimise: 'wheel_mas' is not a summary of this
dimension | minimise = "ram.stroke + excess_work" |  |  | optimise.minimise: adds a moment or energy to a length
no number | minimise = "ram.stroke < 1" |  |  | is a condition; a number is needed here
no condition | minimise = "ram.stroke"\nwhere = "excess_work" |  |  | compares nothing; a condition such as
nothing varies | minimise = "ram.stroke" | nothing |  | vary: nothing varies; give ranges
lists and local | minimise = "ram.stroke"\nmethod = "local" | lists
    |  | optimise.method: 'local' needs ranges, but only lists vary: give low and high, or use 'differential
one for NSGA-II | minimise = "ram.stroke"\nmethod = "NSGA-II" |  |  | 'NSGA-II' needs several objectives
two for evolution | minimise = ["ram.stroke", "excess_work"]\nmethod = "differential evolution"
    |  |  | needs one objective, but there are 2: use 'NSGA-II', or combine them
population | minimise = "ram.stroke"\npopulation = 4 |  |  | optimise.population: must be at least 8, got 4
start outside | minimise = "ram.stroke"\nstart = {"input.length" = "90 mm"}
    |  |  | optimise.start.input.length: 90 mm is not allowed by vary.input.length; allowed: 30 mm to 80 mm
start not listed | minimise = "ram.stroke"\nstart = {"input.length" = "45 mm"} | lists |  | allowed: 40 mm, 50 mm
start unknown | minimise = "ram.stroke"\nstart = {"input.lenght" = 1} |  |  | did you mean 'input.length'?
start without unit | minimise = "ram.stroke"\nstart = {"input.length" = 0.04} |  |  | optimise.start.input.
tolerance zero | minimise = "ram.stroke" |  | [tolerances]\n"input.length" = {plus_minus = "0 mm"}\n
    | '0 mm': a tolerance must be greater than 0, such as '0.1 mm'
""")


@each("name", REFUSED)
def test_text__is_refused_with_key_and_mend(name, tmp_path):
    asked, vary, rest, words = REFUSED[name]
    with pytest.raises(InputError) as refusal:
        task_of(study_of(tmp_path, asked, vary=VARY[vary], rest=rest))
    assert words in str(refusal.value)
    assert str(refusal.value).startswith("study.toml, line ") or name == "nothing varies"


def test_all_problems__are_told_at_once(tmp_path):
    asked = 'minimise = ["a_b", "ram.stroke"]\nwhere = "c_d < 1"\nmethod = "local"'
    with pytest.raises(InputError) as refusal:
        study_of(tmp_path, asked)
    assert len(refusal.value.problems) == 3


def test_missing_library__is_named_and_nothing_is_left_behind(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "pymoo.algorithms.moo.nsga2", None)
    monkeypatch.delitem(sys.modules, "sweeps.optimising.genetic", raising=False)
    with pytest.raises(InputError, match=r"'NSGA-II' needs pymoo: pip install 'machine-sweeps\[optimise\]'"):
        searched(tmp_path, TWO)
    assert not list(tmp_path.glob("*.h5"))


# The command


ASKED = f'minimise = "{NEAREST}"\nwhere = "ram.stroke <= \'90 mm\'"\npopulation = 10\ngenerations = 8'


def test_command__tells_the_best_what_holds_it_and_its_files(folder):
    study_of(folder, ASKED)
    answer = done("optimise", "study.toml", "--no-plots", "--quiet")
    assert "Answer: minimum objective_1 where ram.stroke <= '90 mm': " in answer
    assert "on the limit of: ram.stroke <= '90 mm'" in answer
    assert "differential evolution, seed 0: " in answer
    assert "results/study_optimised.h5" in answer
    shown = said("show", "results/study_optimised.h5", "--columns", "ram.stroke", "--limit", "2").stdout
    assert answer.split("Warning")[0].split("Answer")[1] in shown
    done("export", "results/study_optimised.h5", "--to", "best.toml")
    # Twice the crank, to the clearance of 1e-9 and seven digits or so of text.
    assert read_study("best.toml").scene.input.length == pytest.approx(0.045, rel=1e-6)


def test_command__shows_a_front_from_its_first_objective_on(folder):
    study_of(folder, TWO.replace("= 40\n", "= 12\n"))
    answer = done("optimise", "study.toml", "--out", "f.h5", "--quiet")
    assert "Chosen from the front:" in answer
    assert "NSGA-II, seed 0: 144 candidates, 12 generations, " in answer
    assert Path("f.png").exists()
    shown = said("show", "f.h5", "--columns", "objective_1", "--limit", "3").stdout
    result = SweepResult(Path("f.h5"))
    table = shown.split("the first 3:\n")[1].splitlines()
    assert [int(line.split()[0]) for line in table[2:5]] == front(result)[:3].tolist()
    knee = choices(result)[-1].variant
    assert f"f_{knee}" in said("export", "f.h5", "--to", "knee.svg").stdout


# The picture


def test_picture__shows_the_front_and_its_chosen_machines_to_one_scale(tmp_path):
    result = searched(tmp_path, TWO)
    figure = front_picture(result, sweep_data(result, ())[0])
    top, *machines = figure.axes
    chosen = choices(result)
    assert len(machines) == len(chosen) == 3
    assert [t.get_text() for t in top.texts] == ["A", "B", "C"]
    assert {ax.get_xlim() for ax in machines} == {machines[0].get_xlim()}
    assert {ax.get_ylim() for ax in machines} == {machines[0].get_ylim()}
    told = [ax.get_title().split("\n") for ax in machines]
    assert all(len({lines[-k] for lines in told}) > 1 for k in range(1, len(result.varied) + 1))
    drawn = next(line for line in top.lines if line.get_label() == "Pareto front")
    assert "mm²" in top.get_xlabel()
    np.testing.assert_allclose(drawn.get_xdata(), 1e6 * result.columns["objective_1"][front(result)], rtol=1e-15)
    assert result_pictures(result, tmp_path / "again.png") == [tmp_path / "again.png"]


# Conditions on what is derived

BY_ROUNDING = """
title = "Offset"
scene = "press.toml"
positions = 48
require = ["groups.slide.second.offset <= '0 mm'"]

[vary]
"input.length" = {values = ["40 mm", "50 mm", "60 mm"]}

[derive]
"groups.slide.second.offset" = "3 * input.length - '150 mm'"

[outputs]
summaries = ["ram.stroke"]
"""


def test_parameter_that_misses_a_limit_by_the_rounding_of_its_derivation__meets_it_for_every_judge(tmp_path):
    """3 · 0.05 − 0.15 is 2.8e-17: by its own rounding that isn't 0, by those of what it follows from it is."""
    (tmp_path / "press.toml").write_text(SCENE)
    limit = "groups.slide.second.offset <= '0 mm'"
    aim = f'[best]\nmaximise = "ram.stroke"\nwhere = "{limit}"\n'
    (tmp_path / "study.toml").write_text(BY_ROUNDING + aim)
    study = read_study(tmp_path / "study.toml")
    values, dropped = study.values(0, 3)
    assert 0.0 < values["groups.slide.second.offset"][1] < 1e-16
    assert dropped.tolist() == [False, False, True]
    result = SweepResult(run_study(study, tmp_path / "r.h5"))
    assert result.best() == 1
    digest = Digest(result.path)
    assert digest.meets[digest.shown == 1]
    # A limit of 0 has no relative distance.
    assert math.isnan(digest.prices[0].margin)
    search = "[optimise]\nmaximise = 'ram.stroke'\n"
    (tmp_path / "search.toml").write_text(BY_ROUNDING + f'{search}where = "{limit}"\n')
    trials = Trials(task_of(read_study(tmp_path / "search.toml")))
    assert trials.judged(trials.columns({CRANK: np.array([0.04, 0.05, 0.06])}, 3, drop=False)).met.tolist() == [1, 1, 0]


def test_machines_within_tolerances__on_a_limit_that_the_tolerance_leaves_alone_meet_it(tmp_path):
    """The stroke of a crank in line is twice the crank's length whatever the rod's is, but for the rod's rounding."""
    rest = f'[tolerances]\n"{ROD}" = {{plus_minus = "0.5 mm"}}\n'
    vary = f'[vary]\n"{CRANK}" = {{values = ["50 mm"]}}\n"{ROD}" = {{low = "15 m", high = "40 m"}}\n'
    asked = "minimise = \"excess_work\"\nwhere = \"ram.stroke >= '100 mm' and ram.stroke <= '100 mm'\"\n"
    result = searched(tmp_path, f"{asked}population = 8\ngenerations = 2", vary=vary, rest=rest)
    assert result.columns["tolerance_misses"][result.best()] == 0


def brute_force_front(costs):
    with np.errstate(invalid="ignore"):
        better = (costs[:, None] <= costs[None]).all(axis=2) & (costs[:, None] < costs[None]).any(axis=2)
    return ~better.any(axis=0) & ~np.isnan(costs).any(axis=1)


@settings(max_examples=60)
@given(st.data())
def test_pareto_front__as_by_comparing_all_pairs(data):
    objectives = data.draw(st.integers(1, 4))
    # Few different numbers, so that there are ties, doubles and two kinds of zero.
    number = st.sampled_from([-2.0, -1.0, -0.0, 0.0, 0.5, 1.0, 3.0, math.inf, -math.inf, math.nan])
    rows = data.draw(st.lists(st.lists(number, min_size=objectives, max_size=objectives), max_size=40))
    costs = np.array(rows).reshape(-1, objectives)
    assert pareto_front(costs).tolist() == brute_force_front(costs).tolist()
