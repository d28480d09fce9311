"""Runs that are interrupted, killed and taken up again; and how much memory they need."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from commands import ROOT
from press_sweeps import DISTINCT, GOOD, contents, run, study_of, text_of

from sweeps.report.sweep_result import SweepResult
from sweeps.run import runner
from sweeps.run.runner import run_study
from sweeps.store import StoreError, describe_result
from sweeps.study.study import read_study

# Going on


def counted(text: str, folder: Path, **options: bool) -> list[tuple[int, int]]:
    calls: list[tuple[int, int]] = []
    run_study(study_of(folder, text), folder / "study.h5", progress=lambda *call: calls.append(call), **options)
    return calls


class Stop(Exception):
    """Stands for whatever ends a run."""


def test_interrupted_run__goes_on_with_the_blocks_left(monkeypatch, tmp_path):
    whole = contents(run(tmp_path, DISTINCT, "whole"))
    monkeypatch.setattr(runner, "block_size", lambda study, machine: 40)

    def stop(done: int, before: int) -> None:
        if done == 80:
            raise Stop

    with pytest.raises(Stop):
        run_study(study_of(tmp_path, DISTINCT), tmp_path / "study.h5", progress=stop)
    assert not (tmp_path / "study.h5").exists()
    assert describe_result(tmp_path / "study.part.h5").blocks_done == 2
    assert counted(DISTINCT, tmp_path) == [(120, 80), (160, 80), (200, 80)]
    assert not (tmp_path / "study.part.h5").exists()
    again = contents(tmp_path / "study.h5")
    assert {k: v for k, v in again.items() if "block_done" not in k} == {
        k: v for k, v in whole.items() if "block_done" not in k
    }


def test_finished_run__is_left_alone(tmp_path):
    path = run(tmp_path, GOOD)
    before = path.read_bytes()
    assert counted(GOOD, tmp_path) == []
    assert path.read_bytes() == before
    assert counted(GOOD.replace("Which", "What"), tmp_path) == []


def test_restart__computes_everything_again(tmp_path):
    path = run(tmp_path, GOOD)
    before = contents(path)
    assert counted(GOOD, tmp_path, restart=True) == [(4, 0)]
    assert contents(path) == before


def test_changed_study__is_refused_and_the_difference_shown(tmp_path):
    path = run(tmp_path, GOOD)
    before = path.read_bytes()
    changed = GOOD.replace("'50 mm'", "'55 mm'")
    with pytest.raises(StoreError, match="of another study") as caught:
        counted(changed, tmp_path)
    for word in ("study hash", "-\"input.length\" = {values = ['40 mm', '50 mm']}", "'55 mm'", "--restart", "--out"):
        assert word in str(caught.value)
    assert path.read_bytes() == before
    assert counted(changed, tmp_path, restart=True) == [(4, 0)]
    assert SweepResult(path).columns["input.length"].tolist() == [0.04, 0.04, 0.055, 0.055]


# Real processes

# Blocks of some ten milliseconds, so that kills fall at all moments.
LONG = text_of(["40 mm"], ["1 kg"]).replace("values = ['40 mm']", 'from = "20 mm", to = "60 mm", count = 400000')


def start(folder: Path, *options: str) -> subprocess.Popen:
    command = [
        sys.executable,
        "-m",
        "sweeps",
        "run",
        "long.toml",
        "--out",
        "long.h5",
        "--no-plots",
        "--quiet",
        *options,
    ]
    return subprocess.Popen(
        command,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def blocks_done(folder: Path) -> int:
    part = folder / "long.part.h5"
    return describe_result(part).blocks_done if part.exists() else 0


def wait_for_blocks(process: subprocess.Popen, folder: Path, count: int) -> None:
    while process.poll() is None and blocks_done(folder) < count:
        time.sleep(0.003)


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory) -> dict:
    folder = tmp_path_factory.mktemp("uninterrupted")
    return contents(run(folder, LONG, "long"))


def test_killed_runs__go_on_to_the_same_bits(uninterrupted, tmp_path):
    study_of(tmp_path, LONG, "long")
    rng = np.random.default_rng(3)
    done, kills = 0, 0
    for _ in range(3):
        process = start(tmp_path)
        wait_for_blocks(process, tmp_path, done + int(rng.integers(1, 4)))
        time.sleep(rng.uniform(0, 0.03))
        process.kill()
        process.communicate()
        if (tmp_path / "long.h5").exists():
            break
        kills += 1
        assert blocks_done(tmp_path) >= done
        done = blocks_done(tmp_path)
    assert kills >= 2
    process = start(tmp_path, "--jobs", "1")
    output, errors = process.communicate()
    assert process.returncode == 0, errors
    assert "400000 variants" in output
    assert contents(tmp_path / "long.h5") == uninterrupted
    assert [p.name for p in tmp_path.glob("*.h5*")] == ["long.h5"]


def test_interrupt_from_the_keyboard__keeps_the_blocks_and_says_how_to_go_on(uninterrupted, tmp_path):
    study_of(tmp_path, LONG, "long")
    process = start(tmp_path)
    wait_for_blocks(process, tmp_path, 2)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate()
    assert process.returncode == 130
    assert "Interrupted" in errors
    assert "the same command goes on" in errors
    assert "Traceback" not in errors
    assert blocks_done(tmp_path) >= 2
    calls: list[tuple[int, int]] = []
    run_study(read_study(tmp_path / "long.toml"), tmp_path / "long.h5", progress=lambda *call: calls.append(call))
    assert calls[0][1] > 0
    assert contents(tmp_path / "long.h5") == uninterrupted


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
from sweeps.study.study import read_study
run_study(read_study(Path("big.toml")), Path("big.h5"))
print(peak())
"""


def test_many_variants__need_memory_for_a_block_only(tmp_path):
    text = text_of(["40 mm"], ["1 kg"], head="positions = 720\n")
    text = text.replace("values = ['40 mm']", 'from = "20 mm", to = "60 mm", count = 200000')
    study_of(tmp_path, text, "big")
    child = subprocess.run(
        [sys.executable, "-c", MEASURED],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert child.returncode == 0, child.stderr
    # All rows of reduced moments alone would take 200 000 × 720 × 8 bytes = 1.15 GB.
    assert int(child.stdout) < 1e9
    assert (SweepResult(tmp_path / "big.h5").columns["status"] == 0).all()
