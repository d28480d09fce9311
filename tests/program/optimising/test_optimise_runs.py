"""Searches as runs: interrupted ones, files, tolerances of what was found, batches."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from press_sweeps import Stop, stopping
from press_sweeps import contents as datasets
from searches import CRANK, NEAREST, ONE, ROD, TWO, best_of, searched, study_of

from engine import Machine
from sweeps import StoreError, Study, SweepResult, read_study, run_study
from sweeps.optimising import search_runner, searching
from sweeps.optimising.search_runner import optimise_study
from sweeps.store import MappedResult
from sweeps.study.search_task import task_of


def contents(path: Path) -> dict[str, object]:
    """Every dataset and text of a file, bit by bit."""
    with h5py.File(path, "r") as file:
        return datasets(path) | {name: str(value) for name, value in file.attrs.items() if name != "finished"}


def interrupted(study: Study, path: Path) -> None:
    """A search that is ended after its first generation."""
    with pytest.raises(Stop):
        optimise_study(study, path, progress=stopping(1))


@pytest.mark.parametrize("compute", [run_study, optimise_study])
def test_folder_that_cannot_be_made__store_error(compute, tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="file/sub: can't be made: Not a directory"):
        compute(study_of(tmp_path, ONE), tmp_path / "file" / "sub" / "out.h5")


# Interruptions


@pytest.mark.parametrize("asked", [ONE, TWO.replace("= 40\n", "= 12\n")], ids=["evolution", "NSGA-II"])
def test_interrupted_search__ends_as_an_uninterrupted_one(asked, tmp_path):
    rest = '[tolerances]\n"input.length" = "0.1 mm"\n'
    study = study_of(tmp_path, asked, rest=rest)
    whole = optimise_study(study, tmp_path / "whole.h5")
    path, told = tmp_path / "parts.h5", []
    for stop in (3, 7):

        def progress(done: int, before: int, words: str, stop: int = stop) -> None:
            told.append((done, before))
            stopping(stop)(done, before)

        with pytest.raises(Stop):
            optimise_study(study, path, progress=progress)
        assert MappedResult(tmp_path / "parts.candidates.part.h5").done.sum() == stop
        assert not path.exists()
    optimise_study(study, path)
    assert told == [(0, 0), (1, 0), (2, 0), (3, 0), (3, 3), (4, 3), (5, 3), (6, 3), (7, 3)]
    assert contents(path) == contents(whole)
    assert sorted(p.name for p in tmp_path.glob("parts*")) == ["parts.h5"]


def test_search_interrupted_in_its_last_phase__doesn_t_repeat_its_generations(tmp_path, monkeypatch):
    study, path = study_of(tmp_path, ONE), tmp_path / "r.h5"
    whole = contents(optimise_study(study, tmp_path / "whole.h5"))

    def stop(*arguments: object) -> None:
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("sweeps.optimising.search_runner.refine", stop)
        with pytest.raises(KeyboardInterrupt):
            optimise_study(study, path)
    calls = []
    optimise_study(study, path, progress=lambda done, before, words: calls.append((done, before)))
    assert len(calls) == 1
    assert calls[0][0] == calls[0][1] > 1
    assert contents(path) == whole
    assert sorted(p.name for p in tmp_path.glob("r.*")) == ["r.h5"]


def test_spoilt_candidates__are_computed_again(tmp_path):
    study, path = study_of(tmp_path, ONE), tmp_path / "r.h5"
    whole = contents(optimise_study(study, tmp_path / "whole.h5"))
    interrupted(study, path)
    with h5py.File(tmp_path / "r.candidates.part.h5", "r+") as file:
        file[CRANK][3] += 1e-6
    told = []
    optimise_study(study, path, tell=told.append)
    assert "was damaged" in told[0]
    assert contents(path) == whole


def test_candidates_of_another_way__are_refused(tmp_path, monkeypatch):
    study, path = study_of(tmp_path, ONE), tmp_path / "r.h5"
    interrupted(study, path)
    first = searching.first_generation
    with monkeypatch.context() as patch:
        patch.setattr(searching, "first_generation", lambda task: first(task) * 0.999)
        with pytest.raises(StoreError, match=r"generation 0 would differ.*--restart"):
            optimise_study(study, path)
    optimise_study(study, path, restart=True)
    assert best_of(SweepResult(path))["status"] == 0


def test_finished_search__is_left_alone_and_kept_when_another_is_made(tmp_path):
    study, path = study_of(tmp_path, ONE), tmp_path / "r.h5"
    optimise_study(study, path)
    before = path.read_bytes()
    optimise_study(study, path)
    assert path.read_bytes() == before
    changed, told = study_of(tmp_path, ONE.replace("= 12", "= 13")), []
    optimise_study(changed, path, tell=told.append)
    assert (tmp_path / "r.previous.h5").read_bytes() == before
    assert told == [f"The previous {path} is kept as {tmp_path / 'r.previous.h5'}."]
    optimise_study(study, path, replace_former=True)
    assert sorted(p.name for p in tmp_path.glob("r.*")) == ["r.h5", "r.previous.h5"]
    assert contents(path) == contents(tmp_path / "r.previous.h5")


def test_same_search_in_another_process__may_finish_first_and_has_the_candidates_alone(tmp_path, monkeypatch):
    study, path = study_of(tmp_path, ONE), tmp_path / "r.h5"
    whole = optimise_study(study, tmp_path / "whole.h5").read_bytes()
    refined = search_runner._refined

    def meanwhile(*given: object) -> object:
        monkeypatch.undo()
        path.write_bytes(whole)
        with pytest.raises(StoreError, match="another sweep is writing"):
            optimise_study(study, path, restart=True)
        return refined(*given)

    monkeypatch.setattr(search_runner, "_refined", meanwhile)
    optimise_study(study, path)
    assert path.read_bytes() == whole
    assert sorted(p.name for p in tmp_path.glob("r.*")) == ["r.h5"]


def test_every_word_of_a_search__makes_another_one(tmp_path):
    words = [ONE, f"{ONE}seed = 1", ONE.replace("3 *", "4 *"), ONE.replace("minimise", "maximise")]
    words += [ONE.replace("= 10", "= 11"), ONE.replace("= 12", "= 11"), f'{ONE}start = {{"input.length" = "40 mm"}}']
    found = {task_of(study_of(tmp_path, asked)).digest for asked in words}
    found |= {task_of(study_of(tmp_path, ONE, rest=f"[tolerances]\n{CRANK} = '{t} mm'")).digest for t in (1, 2)}
    assert len(found) == len(words) + 2


def test_interrupted_sweep_of_the_same_name__is_spared(tmp_path):
    study = study_of(tmp_path, ONE)
    with pytest.raises(Stop):
        run_study(study, tmp_path / "r.h5", progress=stopping(1))
    before = contents(tmp_path / "r.part.h5")
    optimise_study(study, tmp_path / "r.h5")
    assert contents(tmp_path / "r.1.part.h5") == before


# Tolerances


def test_tolerances__spread_a_stroke_by_twice_the_crank(tmp_path):
    rest = """
[tolerances]
"input.length" = "0.3 mm"
"groups.slide.first.length" = {plus_minus = "1 mm", distribution = "normal"}
"bodies.ram.mass" = {plus_minus = "3 kg", distribution = "normal"}
"""
    asked = f'minimise = "{NEAREST}"\nwhere = "excess_work >= \'0 J\'"\npopulation = 10\ngenerations = 10'
    result = searched(tmp_path, asked, rest=rest)
    c, best = result.columns, result.best()
    # Uniform within ± a: a / √3. The rod's length and the masses don't enter the stroke.
    exact = 2 * 0.0003 / np.sqrt(3)
    assert c["ram.stroke.tolerance_first_order"][best] == pytest.approx(exact, rel=1e-9)
    # 512 Sobol' points: the variance of the midpoints of as many strata is off by 512⁻² of itself, scrambling adds
    # about 512^-1.5.
    assert c["ram.stroke.tolerance"][best] == pytest.approx(exact, rel=1e-3)
    assert c["tolerance_misses"][best] == 0
    others = np.delete(np.arange(c["front"].size), best)
    assert np.isnan(c["ram.stroke.tolerance"][others]).all()
    random = np.random.default_rng(1)
    count = 20_000
    built = {
        CRANK: c[CRANK][best] + random.uniform(-0.0003, 0.0003, count),
        ROD: c[ROD][best] + random.normal(0, 0.001 / 3, count),
        "bodies.ram.mass": 100 + random.normal(0, 1, count),
    }
    machine = Machine(task_of(read_study(tmp_path / "study.toml")).study.scene, ["excess_work"], (), built, 72)
    spread = machine.evaluate(built).summaries["excess_work"].std()
    # The standard deviation of 20 000 draws is known to 1 / √40 000; three of that, and 1 % for the Sobol' points.
    assert c["excess_work.tolerance"][best] == pytest.approx(spread, rel=0.025)
    assert c["excess_work.tolerance_first_order"][best] == pytest.approx(spread, rel=0.025)


def test_machines_within_tolerances__that_miss_a_condition_are_counted(tmp_path):
    rest = '[tolerances]\n"input.length" = {plus_minus = "0.1 mm", distribution = "normal"}\n'
    asked = 'maximise = "ram.stroke"\nwhere = "ram.stroke <= \'100 mm\'"\npopulation = 10\ngenerations = 10'
    result = searched(tmp_path, asked, rest=rest)
    best = result.best()
    # On the limit, half of the machines lie beyond it.
    assert result.columns["tolerance_misses"][best] == pytest.approx(0.5, abs=0.01)
    # Of a normal distribution the tails of the 512th part at each end are drawn by one point each.
    assert result.columns["ram.stroke.tolerance"][best] == pytest.approx(0.0002 / 3, rel=0.01)


# Speed


def test_a_generation__is_one_batch(tmp_path, monkeypatch):
    sizes = []
    evaluate = Machine.evaluate

    def counted(self, varied, drop=None, buffer=None):
        sizes.append(next(iter(varied.values())).size)
        return evaluate(self, varied, drop, buffer)

    study = study_of(tmp_path, ONE.replace("= 12", "= 4"))
    monkeypatch.setattr(Machine, "evaluate", counted)
    optimise_study(study, tmp_path / "r.h5")
    assert sizes[:4] == [10] * 4
    # Going downhill: a place with one neighbour up and one down for each range.
    assert set(sizes[4:]) == {5}


def test_a_large_generation__is_evaluated_in_pieces_to_the_same_end(tmp_path, monkeypatch):
    study = study_of(tmp_path, ONE.replace("= 12", "= 4"))
    whole = optimise_study(study, tmp_path / "whole.h5")
    monkeypatch.setattr("sweeps.run.blocks.most_at_once", lambda study: 4)
    assert contents(optimise_study(study, tmp_path / "pieces.h5")) == contents(whole)
