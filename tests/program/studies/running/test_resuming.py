"""Runs that are interrupted, killed and taken up again; and how much memory they need."""

import signal
from pathlib import Path

import h5py
import numpy as np
import pytest
from commands import ran
from long_runs import AGAIN, COUNT, LONG, blocks_done, start, wait_for_blocks
from press_sweeps import DISTINCT, GOOD, SCENE, Stop, contents, many, numbers_in, run, stopping, study_of

from sweeps import SweepResult, read_study, run_study
from sweeps.run import blocks, reuse, runner
from sweeps.store import MappedResult, read_columns

# Going on


def counted(text: str, folder: Path, **options: bool) -> list[tuple[int, int]]:
    calls: list[tuple[int, int]] = []
    run_study(study_of(folder, text), folder / "study.h5", progress=lambda *call: calls.append(call), **options)
    return calls


def test_interrupted_run__goes_on_with_the_blocks_left(monkeypatch, tmp_path):
    whole = numbers_in(run(tmp_path, DISTINCT, "whole"))
    monkeypatch.setattr(runner, "block_size", lambda *_: 40)
    with pytest.raises(Stop):
        run_study(study_of(tmp_path, DISTINCT), tmp_path / "study.h5", progress=stopping(80))
    assert not (tmp_path / "study.h5").exists()
    assert MappedResult(tmp_path / "study.part.h5").done.sum() == 2
    assert counted(DISTINCT, tmp_path) == [(80, 80), (120, 80), (160, 80), (200, 80)]
    assert not (tmp_path / "study.part.h5").exists()
    assert numbers_in(tmp_path / "study.h5") == whole


def test_restart__computes_everything_again(tmp_path):
    path = run(tmp_path, GOOD)
    before = contents(path)
    assert counted(GOOD, tmp_path, restart=True) == [(0, 0), (4, 0)]
    assert contents(path) == before


def evaluated(monkeypatch, study_text: str, folder: Path, **options: object) -> tuple[int, list[str]]:
    """How many variants a run evaluates, and what it tells."""
    count, told = 0, []
    real = reuse.evaluate_variants

    def counting(study, values, drop, *rest):
        nonlocal count
        count += int((~drop).sum())
        return real(study, values, drop, *rest)

    with monkeypatch.context() as patch:
        patch.setattr(reuse, "evaluate_variants", counting)
        patch.setattr(blocks, "evaluate_variants", counting)
        run_study(study_of(folder, study_text), folder / "study.h5", tell=told.append, **options)
    return count, told


def same_numbers(path: Path, text: str, folder: Path) -> None:
    """A file holds what a run from nothing gives, to its error estimates."""
    (folder / "anew").mkdir()
    whole, found = SweepResult(run(folder / "anew", text)), SweepResult(path)
    assert found.columns.keys() == whole.columns.keys()
    for name, values in whole.columns.items():
        error = np.nan_to_num(whole.columns.get(f"{name}_error", 0.0))
        if not name.endswith("_error"):
            assert np.isclose(found.columns[name], values, rtol=0, atol=2 * error, equal_nan=True).all(), name
    for name in whole.fields:
        some, all_of_it = read_columns(path, [name])[name], read_columns(whole.path, [name])[name]
        np.testing.assert_allclose(some, all_of_it, rtol=1e-12, atol=1e-12 * np.nanmax(np.abs(all_of_it)))


ADDED = {
    "variants": (GOOD.replace("'40 mm', '50 mm'", "'40 mm', '45 mm', '50 mm', '900 mm'"), 4),
    "a summary": (GOOD.replace('"excess_work"]', '"excess_work", "ram.slide.max"]'), 4),
    "a field": (GOOD.replace('fields = ["ram.slide"', 'fields = ["ram.slide", "reduced_inertia"'), 4),
}


@pytest.mark.parametrize("what", ADDED)
def test_added_variants_and_outputs__alone_are_computed(what, monkeypatch, tmp_path):
    path = run(tmp_path, GOOD)
    before = SweepResult(path).columns
    text, new = ADDED[what]
    count, told = evaluated(monkeypatch, text, tmp_path)
    assert (count, told) == (new, [])
    assert [p.name for p in tmp_path.glob("*.h5")] == ["study.h5"]
    after = SweepResult(path).columns
    kept = np.isin(after["input.length"], before["input.length"])
    assert all(np.isin(values, after[name][kept]).all() for name, values in before.items() if name != "status_at")
    same_numbers(path, text, tmp_path)


def test_variants_left_out__keep_the_former_file(monkeypatch, tmp_path):
    path = run(tmp_path, GOOD)
    before = path.read_bytes()
    text = GOOD.replace("'40 mm', '50 mm'", "'50 mm'")
    assert evaluated(monkeypatch, text, tmp_path) == (
        0,
        [f"The previous {path} is kept as {tmp_path / 'study.previous.h5'}."],
    )
    assert (tmp_path / "study.previous.h5").read_bytes() == before
    assert SweepResult(path).columns["input.length"].tolist() == [0.05, 0.05]
    same_numbers(path, text, tmp_path)


def test_other_conditions__compute_only_what_they_let_in(monkeypatch, tmp_path):
    light = "require = [\"bodies.ram.mass < '90 kg'\"]\npositions = 48\n"
    path = run(tmp_path, GOOD.replace("positions = 48\n", light))
    assert evaluated(monkeypatch, GOOD, tmp_path)[0] == 2
    same_numbers(path, GOOD, tmp_path)


@pytest.mark.parametrize("replaced", [False, True])
def test_edited_scene__runs_again_and_the_former_file_is_kept_or_replaced(replaced, monkeypatch, tmp_path):
    path = run(tmp_path, GOOD)
    before = path.read_bytes()
    edited = SCENE.replace('mass = "4 kg"', 'mass = "5 kg"')
    monkeypatch.setattr("press_sweeps.SCENE", edited)
    count, told = evaluated(monkeypatch, GOOD, tmp_path, replace_former=replaced)
    assert count == 4
    assert "hash" not in " ".join(told)
    if replaced:
        assert [p.name for p in tmp_path.glob("*.h5")] == ["study.h5"]
    else:
        assert (tmp_path / "study.previous.h5").read_bytes() == before
        assert len(told) == 1


def test_interrupted_run_then_edited__takes_over_what_is_done(monkeypatch, tmp_path):
    monkeypatch.setattr(runner, "block_size", lambda *_: 40)
    with pytest.raises(Stop):
        run_study(study_of(tmp_path, DISTINCT), tmp_path / "study.h5", progress=stopping(80))
    longer = DISTINCT.replace("['1 kg']", "['1 kg', '2 kg']")
    count, told = evaluated(monkeypatch, longer, tmp_path)
    assert count == 400 - 80
    assert len(told) == 1
    assert "renamed to" in told[0]
    assert [p.name for p in tmp_path.glob("*.h5")] == ["study.h5"]
    same_numbers(tmp_path / "study.h5", longer, tmp_path)


def test_damaged_block__alone_is_computed_again(monkeypatch, tmp_path):
    monkeypatch.setattr(runner, "block_size", lambda *_: 40)
    path = run(tmp_path, DISTINCT)
    whole = contents(path)
    with h5py.File(path, "r") as file:
        at = file["ram.slide"].id.get_offset() + 8 * 48 * 90
    content = bytearray(path.read_bytes())
    content[at] ^= 1
    path.write_bytes(content)
    count, told = evaluated(monkeypatch, DISTINCT, tmp_path)
    assert count == 40
    assert "variants 80 … 119 are recomputed" in told[0]
    assert contents(path) == whole
    assert [p.name for p in tmp_path.glob("*.h5")] == ["study.h5"]


def test_file_of_another_version__stands_while_nothing_is_to_be_computed(monkeypatch, tmp_path):
    path = run(tmp_path, GOOD)
    monkeypatch.setattr("sweeps.study.study_record.sources_digest", lambda: "another")
    count, told = evaluated(monkeypatch, GOOD.replace("How", "But how"), tmp_path)
    assert count == 0
    assert "was made by machine-sweeps" in told[0]
    assert "its numbers are valid" in told[0]
    assert SweepResult(path).question == "But how short?"
    count, told = evaluated(monkeypatch, ADDED["variants"][0], tmp_path)
    assert count == 8
    assert (tmp_path / "study.previous.h5").exists()


# Real processes


def test_killed_and_interrupted_run__goes_on_to_the_same_bits_and_says_how(tmp_path):
    """Other signals end the program alike: `test_interruption.py`."""
    process = start(tmp_path)
    wait_for_blocks(process, tmp_path, 2)
    process.kill()
    process.communicate()
    killed_at = blocks_done(tmp_path)
    process = start(tmp_path)
    wait_for_blocks(process, tmp_path, killed_at + 2)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate()
    assert process.returncode == 130
    assert errors.startswith("Interrupted: ")
    assert errors.endswith(f" of {COUNT} variants are done and kept; resume with: sweeps {' '.join(AGAIN)}\n")
    assert errors.count("\n") == 1
    assert blocks_done(tmp_path) >= killed_at + 2 >= 4
    calls: list[tuple[int, int]] = []
    run_study(read_study(tmp_path / "long.toml"), tmp_path / "long.h5", progress=lambda *call: calls.append(call))
    assert calls[0][1] > 0
    assert [p.name for p in tmp_path.glob("*.h5*")] == ["long.h5"]
    (tmp_path / "whole").mkdir()
    assert numbers_in(tmp_path / "long.h5") == numbers_in(run(tmp_path / "whole", LONG, "long"))


MEASURED = """
import resource
from pathlib import Path

def peak():
    # Linux hands the parent's own peak on to a child's ru_maxrss; VmHWM is the child's alone.
    status = Path("/proc/self/status")
    if status.exists():
        line = next(line for line in status.read_text().splitlines() if line.startswith("VmHWM"))
        return int(line.split()[1]) * 1024
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

from sweeps.run.runner import run_study
from sweeps.study.study_reader import read_study
run_study(read_study(Path("big.toml")), Path("big.h5"))
print(peak())
"""


def test_many_variants__need_memory_for_a_block_only(tmp_path):
    study_of(tmp_path, many(200_000, head="positions = 720\n"), "big")
    child = ran("-c", MEASURED, cwd=tmp_path)
    assert child.returncode == 0, child.stderr
    # All rows of reduced moments alone would take 200 000 × 720 × 8 bytes = 1.15 GB.
    assert int(child.stdout) < 1e9
    assert (SweepResult(tmp_path / "big.h5").columns["status"] == 0).all()
