"""Searching a study: optima against brute force, closed forms and the conditions of Karush, Kuhn and Tucker."""

import numpy as np
import pytest
from searches import CRANK, HEAD, NEAREST, ROD, TWO, best_of, searched, study_of

from engine import Machine, Verdict, in_text
from sweeps import Study, SweepResult, read_study
from sweeps.optimising.optimum import choices, front, is_front, met, objectives, optimum_text
from sweeps.optimising.search_runner import optimise_study

# One objective


@pytest.mark.parametrize("method", ["differential evolution", "local"])
def test_optimum_inside__is_that_of_the_closed_form(method, tmp_path):
    result = searched(tmp_path, f'minimise = "{NEAREST}"\nmethod = "{method}"\npopulation = 20')
    best = best_of(result)
    # Slopes are found with steps of 1e-4 of the ranges, exactly for a parabola but for rounding.
    assert best[CRANK] == pytest.approx(0.048, abs=1e-6)
    assert best[ROD] == pytest.approx(0.233, abs=1e-6)
    assert "inside all ranges and conditions" in optimum_text(result)


@pytest.mark.parametrize("method", ["differential evolution", "local"])
def test_optimum_on_a_condition__is_the_foot_of_the_perpendicular(method, tmp_path):
    # rod ≥ 6 crank: from (48, 233) mm onto the line rod = 6 crank; by Lagrange's multiplier.
    asked = f'minimise = "{NEAREST}"\nwhere = "groups.slide.first.length >= 3 * ram.stroke"\nmethod = "{method}"'
    result = searched(tmp_path, asked + "\npopulation = 20")
    best, along = best_of(result), (0.048 + 6 * 0.233) / 37
    # The search keeps 1e-9 of the sizes clear of the limit, 3e-10 m here, beside the stroke's error estimate; along the
    # line a parabola is flat, and its steps end where they change the cost by 1e-12 of what it was at the start.
    assert best[CRANK] == pytest.approx(along, abs=2e-6)
    assert best[ROD] == pytest.approx(6 * along, abs=2e-6)
    assert 0 <= best[ROD] - 6 * best[CRANK] - 3 * best["ram.stroke_error"] < 1e-8
    assert "on the limit of: groups.slide.first.length >= 3 * ram.stroke" in optimum_text(result)


def brute(study: Study, cranks: np.ndarray, rods: np.ndarray, names: list[str]) -> dict[str, np.ndarray]:
    """Summaries on a grid (cranks, rods)."""
    crank, rod = (grid.ravel() for grid in np.meshgrid(cranks, rods, indexing="ij"))
    outcome = Machine(study.scene, names, varied=[CRANK, ROD], positions=72).evaluate({CRANK: crank, ROD: rod})
    assert (outcome.status == Verdict.OK).all()
    return {name: values.reshape(cranks.size, rods.size) for name, values in outcome.summaries.items()}


# A longer rod saves flywheel, but less and less: with a price on its length there is an optimum inside.
FLYWHEEL = """
minimise = "flywheel_excess_work + '7 kg' * '1 m' * groups.slide.first.length"
where = ["ram.stroke >= '90 mm'", "slide.transmission_angle >= '60 deg'"]
population = 30
"""


@pytest.fixture(scope="module")
def flywheel(tmp_path_factory) -> tuple[Study, SweepResult]:
    folder = tmp_path_factory.mktemp("flywheel")
    return study_of(folder, FLYWHEEL), searched(folder, FLYWHEEL)


def test_optimum__is_no_worse_than_brute_force_and_no_better_than_its_grid_allows(flywheel):
    study, result = flywheel
    cranks, rods = np.linspace(0.03, 0.08, 201), np.linspace(0.15, 0.4, 201)
    grid = brute(study, cranks, rods, ["ram.stroke", "flywheel_excess_work"])
    costs = grid["flywheel_excess_work"] + 7 * rods
    best = best_of(result)
    # What is met for sure keeps clear of a limit by its error estimate.
    allowed = grid["ram.stroke"] >= 0.09 + best["ram.stroke_error"]
    least = costs[allowed].min()
    # Between the grid's points the cost can't fall by more than its steepest steps along both axes.
    room = np.abs(np.diff(costs, axis=0)).max() + np.abs(np.diff(costs, axis=1)).max()
    # The search keeps 1e-9 clear of the limits.
    assert least - room <= best["objective_1"] <= least * (1 + 1e-8)
    assert best["ram.stroke"] >= 0.09 + best["ram.stroke_error"]


def test_optimum__meets_the_conditions_of_karush_kuhn_and_tucker(flywheel):
    study, result = flywheel
    best, names = best_of(result), ["ram.stroke", "flywheel_excess_work"]

    def gradients(step: float) -> dict[str, np.ndarray]:
        crank, rod = best[CRANK] + step * np.array([-1, 0, 1]), best[ROD] + step * np.array([-1, 0, 1])
        grid = brute(study, crank, rod, names)
        grid["cost"] = grid["flywheel_excess_work"] + 7 * rod
        return {n: np.array([g[2, 1] - g[0, 1], g[1, 2] - g[1, 0]]) / (2 * step) for n, g in grid.items()}

    # Richardson's extrapolation of central differences, with steps other than the search's own.
    fine, coarse = gradients(2e-5), gradients(4e-5)
    slopes = {name: (4 * fine[name] - coarse[name]) / 3 for name in fine}
    # On the limit of the stroke, and on no other: so the cost must rise with the crank, not with the rod.
    assert 0 <= best["ram.stroke"] - best["ram.stroke_error"] - 0.09 < 1e-9
    assert 0.151 < best[ROD] < 0.399
    assert np.degrees(best["slide.transmission_angle"]) > 61
    multiplier = slopes["cost"][0] / slopes["ram.stroke"][0]
    residual = slopes["cost"] - multiplier * slopes["ram.stroke"]
    assert multiplier > 0
    # The steps end where they change a cost of 130 by 1e-12 of it: over a curvature of 80 kg or so, 2 √(80 · 1.3e-10).
    assert abs(residual[1]) < 3e-4


def test_condition_of_the_study__holds_and_is_reached(tmp_path):
    head = f"{HEAD}require = [\"input.length <= '45 mm'\"]\n"
    result = searched(tmp_path, 'maximise = "ram.stroke"\npopulation = 20', head=head)
    # Twice the crank, less the clearance of 1e-9 of both sides' sum.
    assert 0.09 * (1 - 3e-9) <= best_of(result)["ram.stroke"] <= 0.09
    assert "on the limit of: input.length <= '45 mm'" in optimum_text(result)
    columns = result.columns
    assert (columns["status"][columns[CRANK] > 0.045] == Verdict.DROPPED).all()
    assert (columns["front"] > 0).sum() == 1


SIZES = """
[vary]
"input.length" = {choose = "R40", low = "30 mm", high = "80 mm"}
"groups.slide.first.length" = {choose = "R40", low = "150 mm", high = "400 mm"}
"bodies.ram.mass" = {choose = ["20 kg", "40 kg", "60 kg", "80 kg", "100 kg", "120 kg", "140 kg", "160 kg", "180 kg"]}
"""


# Crank, rod and mass. The condition ties all three together: in the second the next best differs by three masses.
@pytest.mark.parametrize("wanted", [("50 mm", "205 mm", "66 kg"), ("48.445 mm", "194.564 mm", "101.061 kg")])
def test_chosen_sizes__give_the_best_of_all_combinations(wanted, tmp_path):
    crank, rod, mass = wanted
    goal = f"(ram.stroke / 2 - '{crank}')**2 + 0.1 * (groups.slide.first.length - '{rod}')**2"
    goal += f" + ((bodies.ram.mass - '{mass}') * '0.02 mm/kg')**2"
    where = "groups.slide.first.length >= 2 * ram.stroke + bodies.ram.mass * '0.2 mm/kg'"
    asked = f'minimise = "{goal}"\nwhere = "{where}"\npopulation = 12\nseed = 1'
    result = searched(tmp_path, asked, vary=SIZES)
    every = read_study(tmp_path / "study.toml").design
    r, rods, m = (np.array(column) for column in every.values(0, every.size).values())
    apart = (r - in_text(crank, "length"), rods - in_text(rod, "length"), m - in_text(mass, "mass"))
    costs = apart[0] ** 2 + 0.1 * apart[1] ** 2 + (2e-5 * apart[2]) ** 2
    costs[rods < 4 * r + 2e-4 * m - 1e-12] = np.inf
    found, best = best_of(result), int(np.argmin(costs))
    assert result.columns["status"].size < every.size / 3
    assert [found[name] for name in (CRANK, ROD, "bodies.ram.mass")] == [r[best], rods[best], m[best]]


def test_chosen_size__is_taken_with_the_best_of_a_range_and_reported_at_its_end(tmp_path):
    vary = (
        SIZES.replace("R40", "R20", 1).split('"groups')[0]
        + '"groups.slide.first.length" = {low = "150 mm", high = "400 mm"}\n'
    )
    wanted = "minimise = \"(groups.slide.first.length - 4 * ram.stroke)**2 - '0.1 mm' * ram.stroke\""
    result = searched(tmp_path, wanted + "\npopulation = 20", vary=vary)
    found = best_of(result)
    assert found[CRANK] in {0.0315, 0.0355, 0.04, 0.045, 0.05, 0.056, 0.063, 0.071, 0.08}
    assert found[CRANK] == 0.05
    assert found[ROD] == pytest.approx(0.4, rel=1e-6)
    assert result.ranges[CRANK] == (0.0315, 0.08)


def test_best_of_a_study__is_searched_for_without_words_of_its_own(tmp_path):
    best = '[best]\nmaximise = "ram.stroke"\nwhere = "ram.stroke <= \'100 mm\'"\n'
    result = searched(tmp_path, "population = 20", rest=best)
    assert result.goal == read_study(tmp_path / "study.toml").best
    best = best_of(result)
    assert best["ram.stroke"] + best["ram.stroke_error"] == pytest.approx(0.1, rel=3e-9)


def test_equality__is_not_told_as_a_limit(tmp_path):
    vary = (
        '[vary]\n"bodies.ram.mass" = {values = ["50 kg", "90 kg"]}\n"input.length" = {low = "30 mm", high = "80 mm"}\n'
    )
    asked = "minimise = \"ram.stroke\"\nwhere = \"bodies.ram.mass == '90 kg' and ram.stroke >= '70 mm'\""
    asked += "\npopulation = 20"
    result = searched(tmp_path, asked, vary=vary)
    assert best_of(result)["bodies.ram.mass"] == 90.0
    lines = [line for line in optimum_text(result).splitlines() if line.startswith("on the limit")]
    assert lines == ["on the limit of: ram.stroke >= '70 mm'"]


def test_nothing_that_meets_the_conditions__is_said(tmp_path):
    asked = 'minimise = "ram.stroke"\nwhere = "ram.stroke < \'10 mm\'"\npopulation = 8\ngenerations = 3'
    result = searched(tmp_path, asked)
    assert not result.columns["front"].any()
    assert result.best() is None
    assert "No candidate meets all conditions." in optimum_text(result)
    local = asked.replace("generations", 'method = "local"\ngenerations')
    for condition in ("ram.stroke < '10 mm'", "ram.stroke == '90 mm'"):
        study = study_of(tmp_path, local.replace("ram.stroke < '10 mm'", condition))
        answer = optimum_text(SweepResult(optimise_study(study, tmp_path / "l.h5", restart=True)))
        assert "No candidate meets" in answer
        assert "found no feasible candidate" in answer
        assert "write A == B as abs(A - B) <= TOLERANCE" in answer


@pytest.mark.parametrize("goals", ['"ram.stroke"', '["ram.stroke", "excess_work"]'], ids=["evolution", "NSGA-II"])
def test_narrow_conditions__are_found_by_missing_them_less_and_less(goals, tmp_path):
    # Two millionths of the ranges: no candidate of 2000 drawn at random would be likely to meet them.
    conditions = ["abs(ram.stroke - '71.3 mm') <= '0.05 mm'", "abs(groups.slide.first.length - '222.2 mm') <= '0.2 mm'"]
    result = searched(tmp_path, f"minimise = {goals}\nwhere = {conditions}\npopulation = 20")
    meets = met(result)
    assert not meets[:20].any()
    least = result.columns["ram.stroke"][meets].min()
    # Going downhill leads to the limit; NSGA-II somewhere between both.
    assert least == pytest.approx(0.07125, rel=1e-6) or ("[" in goals and 0.07125 <= least <= 0.07135)


def test_scene_as_it_is__is_the_first_candidate_and_start_replaces_it(tmp_path):
    asked = 'minimise = "ram.stroke"\npopulation = 8\ngenerations = 2'
    first = {name: searched(tmp_path, asked).columns[name][0] for name in (CRANK, ROD)}
    assert first == pytest.approx({CRANK: 0.05, ROD: 0.2}, rel=1e-15)
    given = asked + '\nstart = {"input.length" = "70 mm", "groups.slide.first.length" = "0.3 m"}'
    path = optimise_study(study_of(tmp_path, given), tmp_path / "given.h5")
    columns = SweepResult(path).columns
    assert {CRANK: columns[CRANK][0], ROD: columns[ROD][0]} == pytest.approx({CRANK: 0.07, ROD: 0.3}, rel=1e-15)


def test_objective__carries_the_error_figures_of_its_summaries(flywheel):
    _, result = flywheel
    c = result.columns
    ok = c["status"] == Verdict.OK
    np.testing.assert_allclose(c["objective_1"][ok], c["flywheel_excess_work"][ok] + 7 * c[ROD][ok], rtol=4e-16)
    # A sum of two numbers of some 100, rounded.
    np.testing.assert_allclose(c["objective_1_error"][ok], c["flywheel_excess_work_error"][ok], rtol=0, atol=2e-13)
    assert result.units["objective_1"] == "kg m2"
    assert result.long_names["objective_1"] == "flywheel_excess_work + '7 kg' * '1 m' * groups.slide.first.length"


# Several objectives


@pytest.fixture(scope="module")
def two(tmp_path_factory) -> SweepResult:
    return searched(tmp_path_factory.mktemp("two"), TWO)


def test_front__is_that_of_two_distances(two):
    # Nearest to two points at once are those of the line between them: f1 = (d t)², f2 = (d (1 − t))².
    there = front(two)
    a, b = (two.columns[f"objective_{k}"][there] for k in (1, 2))
    distance = np.hypot(0.02, 0.1)
    assert is_front(two)
    assert there.size >= 30
    # Of a population of 40 along the front, within two hundredths of its length.
    assert np.abs(np.sqrt(a) + np.sqrt(b) - distance).max() < 0.02 * distance
    assert np.sqrt(a).min() < 0.02 * distance
    assert np.sqrt(b).min() < 0.02 * distance
    assert np.diff(np.sort(np.sqrt(a))).max() < 0.15 * distance


def test_front__is_numbered_from_the_least_first_objective_and_nothing_surpasses_it(two):
    there, c = front(two), two.columns
    assert c["front"][there].tolist() == list(range(1, there.size + 1))
    costs = np.column_stack([c["objective_1"], c["objective_2"]])
    assert (np.diff(costs[there, 0]) > 0).all()
    for point in costs[there]:
        assert not ((costs <= point).all(axis=1) & (costs < point).any(axis=1) & met(two)).any()


def test_choices__are_the_ends_and_the_knee(two):
    # The front is symmetric, √f1 + √f2 = d: its knee is where both are equal.
    chosen = {choice.why: choice.variant for choice in choices(two)}
    assert list(chosen) == ["minimum objective_1", "minimum objective_2", "knee"]
    a, b = (np.sqrt(two.columns[f"objective_{k}"][chosen["knee"]]) for k in (1, 2))
    assert abs(a - b) < 0.15 * (a + b)
    assert [name for name, _ in objectives(two)] == ["objective_1", "objective_2"]
    assert "knee" in optimum_text(two)


def test_generations__are_as_large_as_asked_without_twins(two):
    c = two.columns
    assert np.bincount(c["generation"]).tolist() == [40] * 40
    rows = np.column_stack([c[CRANK], c[ROD]])
    assert len(np.unique(rows[c["generation"] > 0], axis=0)) > 0.98 * 39 * 40


def test_few_entries_of_lists__are_all_tried_and_none_twice(tmp_path):
    vary = '[vary]\n"input.length" = {values = ["40 mm", "50 mm", "60 mm"]}\n'
    vary += '"groups.slide.first.length" = {values = ["200 mm", "210 mm", "220 mm", "230 mm"]}\n'
    asked = 'minimise = "ram.stroke"\nmaximise = "groups.slide.first.length"\npopulation = 8\ngenerations = 10'
    result = searched(tmp_path, asked, vary=vary)
    rows = list(zip(result.columns[CRANK], result.columns[ROD], strict=True))
    assert len(set(rows)) == 12
    # Of twelve machines at most four are no twins of the eight that live on: the generations after the first are short.
    assert len(rows) <= 8 + 9 * 4
    for k in range(1, 10):
        born = [row for row, generation in zip(rows, result.columns["generation"], strict=True) if generation == k]
        assert len(set(born)) == len(born)
    assert (result.columns["status"] == Verdict.OK).all()
    assert [rows[k] for k in front(result)] == [(0.04, 0.23)]
