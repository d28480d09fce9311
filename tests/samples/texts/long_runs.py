"""A run that lasts long enough to be ended in mid-work, as a process of its own."""

import os
import subprocess
import sys
import time
from pathlib import Path

from commands import ROOT
from press_sweeps import many, study_of

from sweeps.store import MappedResult

# Blocks of some ten milliseconds, so that kills fall at all moments.
COUNT = 300_000
LONG = many(COUNT)
AGAIN = ("run", "long.toml", "--out", "long.h5", "--no-plots", "--quiet")


def start(folder: Path, *options: str) -> subprocess.Popen:
    study_of(folder, LONG, "long")
    line = [sys.executable, "-m", "sweeps", *AGAIN, *options]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE}
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
    return subprocess.Popen(line, cwd=folder, env=env, text=True, start_new_session=True, **pipes)


def blocks_done(folder: Path) -> int:
    part = folder / "long.part.h5"
    return MappedResult(part).done.sum() if part.exists() else 0


def wait_for_blocks(process: subprocess.Popen, folder: Path, count: int) -> None:
    while process.poll() is None and blocks_done(folder) < count:
        time.sleep(0.003)
