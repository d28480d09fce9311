"""Results of many variants: computed piece by piece as at once, drawn by variants chosen evenly, their cost."""

from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from press_sweeps import DISTINCT, study_of

from engine import Verdict
from sweeps import SweepResult, read_study, run_study
from sweeps.pictures.sweep import result_pictures
from sweeps.pictures.sweep.sweep_data import evenly_chosen
from sweeps.report.recorded import result_file
from sweeps.report.result_report import counts_text
from sweeps.run import cost
from sweeps.run.blocks import block_size
from sweeps.study.bundled import bundled_studies
from sweeps.text.templates import template_text


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    return run_study(read_study(bundled_studies()["screw_jack"]), tmp_path_factory.mktemp("many") / "jack.h5")


@pytest.fixture
def in_pieces(path, monkeypatch):
    monkeypatch.setattr(result_file, "VARIANTS_AT_A_TIME", 97)
    monkeypatch.setattr(result_file, "CHOSEN_AT_A_TIME", 5)
    return SweepResult(path)


def test_choosing_piece_by_piece__is_that_of_all_at_once(path, in_pieces):
    whole = SweepResult(path)
    columns, ok = whole.columns, whole.columns["status"] == Verdict.OK
    assert whole.file.variants > 3 * 97
    where, name = whole.goal.where, whole.goal.goal
    met = whole.candidates()
    assert 0 < met.sum() < ok.sum()
    assert in_pieces.count_meeting(where) == met.sum()
    for descending, sign in ((False, 1.0), (True, -1.0)):
        chosen = np.flatnonzero(met)
        expected = chosen[np.argsort(sign * columns[name][chosen], kind="stable")]
        for most in (None, 1, 5, 10_000):
            assert in_pieces.select(where, name, descending, most).tolist() == expected[:most].tolist()
    assert in_pieces.best() == np.flatnonzero(met)[np.argmin(whole.goal.sign * columns[name][met])]
    assert in_pieces.rivals(in_pieces.best()) == whole.rivals(whole.best())
    assert in_pieces.undecided(where) == whole.undecided(where)
    some = np.arange(1, met.size, 3)[::-1]
    assert in_pieces.candidates(some).tolist() == met[some].tolist()
    taken = in_pieces.taken(some)
    assert all(np.array_equal(taken[name], column[some], equal_nan=True) for name, column in columns.items())


def test_verdicts_piece_by_piece__are_told_as_those_of_all_at_once(tmp_path, monkeypatch):
    (tmp_path / "scene.toml").write_text(template_text("slider_crank"))
    study = 'scene = "scene.toml"\n[vary]\n'
    study += "free = { values = [1, 2, 3] }\n"
    study += '"groups.drive.first.length" = { from = "30 mm", to = "90 mm", count = 11 }\n'
    study += '"input.length" = { from = "40 mm", to = "80 mm", count = 9 }\n[outputs]\nsummaries = ["piston.stroke"]\n'
    study = f"""require = ["free < 2.5", "free * input.length < '132 mm'"]\n{study}"""
    (tmp_path / "study.toml").write_text(study)
    path = run_study(read_study(str(tmp_path / "study.toml")), tmp_path / "study.h5")
    whole = counts_text(SweepResult(path))
    # A rod shorter than the crank assembles up to where the crank's pin is farther from the way than the rod is long.
    columns = SweepResult(path).columns
    failed = columns["groups.drive.first.length"] < columns["input.length"]
    missed = np.array([columns["free"] > 2.5, columns["free"] * columns["input.length"] > 0.132])
    assert f"group drive: {(failed & ~missed.any(axis=0)).sum()}, first at " in whole
    alone = missed & (missed.sum(axis=0) == 1)
    for condition, fails, only in zip(("free < 2.5", "free * input.length"), missed, alone, strict=True):
        told = next(line for line in whole.splitlines() if line.strip().startswith(condition))
        assert told.endswith(f": {fails.sum()}, {only.sum()} only by this condition")
    counts = dict(zip(*np.unique(columns["status"], return_counts=True), strict=True))
    monkeypatch.setattr(result_file, "VARIANTS_AT_A_TIME", 7)
    result = SweepResult(path)
    assert counts_text(result) == whole
    assert result.verdict_counts == {Verdict(int(code)): count for code, count in counts.items()}
    for code in counts:
        assert result.first_with(Verdict(int(code))) == np.flatnonzero(columns["status"] == code)[0]
    assert result.first_with(Verdict.NOT_COMPUTED) is None


def test_picture_of_many__holds_the_best_among_variants_chosen_evenly(path, monkeypatch):
    result = SweepResult(path)
    best, goal = result.best(), result.goal.goal
    monkeypatch.setattr(result_pictures, "MOST_DRAWN", result.file.variants // 3)
    data, marked = result_pictures.sweep_data(result, (), best)
    assert data.chosen_of == result.file.variants > data.status.size
    assert data.arrays[goal][marked] == result.columns[goal][best]
    assert data.grid_parameters() == result_pictures.sweep_data(result, ())[0].grid_parameters()


@given(st.lists(st.integers(1, 40), min_size=1, max_size=4), st.integers(1, 5000), st.data())
def test_evenly_chosen__keeps_the_grid_its_ends_and_the_best(shape, most, data):
    count = int(np.prod(shape))
    best = data.draw(st.none() | st.integers(0, count - 1))
    smaller, variants = evenly_chosen(shape, best, most)
    assert np.prod(smaller) == variants.size
    assert (np.diff(variants) > 0).all()
    assert variants[0] == 0
    assert variants[-1] == count - 1
    assert best is None or best in variants
    # An axis has no fewer than its two ends, and one place more for the best.
    assert variants.size <= max(most, 2 ** len(shape)) * 1.5 ** len(shape)
    for along, places in zip(np.unravel_index(variants, shape), smaller, strict=True):
        assert len(set(along.tolist())) == places


COMPILING, EACH = 20.0, 1e-4
# Cranks from 20 mm on: the first of them, and with the longer ones all of the first variants tried.
DROPS = ("input.length > '20 mm'", "input.length > '59 mm'")


class Clock:
    """Seconds that evaluations are said to take: compiling once, where anything is computed, and so many each."""

    def __init__(self, each: float) -> None:
        self.now, self.each, self.compiled = 0.0, each, False

    def evaluate(self, study, values, drop) -> None:
        kept = drop.size - int(drop.sum())
        self.now += self.each * kept + (COMPILING if kept and not self.compiled else 0.0)
        self.compiled = self.compiled or kept > 0


@pytest.fixture
def clock(request, monkeypatch):
    found = Clock(request.param)
    monkeypatch.setattr(cost, "time", SimpleNamespace(perf_counter=lambda: found.now))
    monkeypatch.setattr(cost, "evaluate_variants", found.evaluate)
    return found


@pytest.mark.parametrize("clock", [EACH], indirect=True)
@pytest.mark.parametrize("drop", DROPS)
def test_variant__takes_what_it_takes_once_compiled_where_the_first_is_dropped(clock, drop, tmp_path):
    text = DISTINCT.replace("positions = 48", f'positions = 48\nrequire = ["{drop}"]')
    study = study_of(tmp_path, text.replace("count = 200", "count = 20000"))
    found = cost.seconds_of_variant(study)
    assert clock.compiled
    # No more than each; less by as many as are dropped.
    assert 0 < found <= EACH
    assert block_size(study, lambda: found) >= 1 / EACH


@pytest.mark.parametrize("clock", [2.0], indirect=True)
def test_trial__takes_a_tenth_of_a_study_at_most_besides_the_first_look(clock, tmp_path):
    study = study_of(tmp_path, DISTINCT)
    assert cost.seconds_of_variant(study) == pytest.approx(clock.each)
    assert clock.now - COMPILING <= clock.each * study.design.size * (1 / cost.WORTH_TWO + 0.1)
