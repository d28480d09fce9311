"""Workers, clients and schedulers that are killed, and workers that aren't ours: nothing that is done is lost."""

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import cluster_jobs
import dask
import psutil
import pytest
from cluster_jobs import crew_on
from commands import ROOT
from long_runs import AGAIN, blocks_done, start, wait_for_blocks
from press_sweeps import DISTINCT, contents, run, study_of

from sweeps.run import runner
from sweeps.run.cluster.cluster_errors import ClusterError, UnfinishedError
from sweeps.run.cluster.connecting import connected
from sweeps.run.runner import run_study
from sweeps.store import MappedResult

HERE = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


@pytest.fixture
def blocks_of_forty(monkeypatch):
    monkeypatch.setattr(runner, "block_size", lambda *_: 40)


@contextmanager
def processes(*commands: list[str], env: dict[str, str] = HERE, cwd: Path | None = None):
    """Programs of Dask that run meanwhile."""
    with ExitStack() as stack:
        found = []
        for command in commands:
            found.append(subprocess.Popen([sys.executable, "-m", *command], env=env, cwd=cwd, **QUIET))
            stack.callback(found[-1].wait)
            stack.callback(found[-1].kill)
        yield found


def scheduler_on(folder: Path) -> list[str]:
    told = ["--scheduler-file", str(folder / "scheduler.json")]
    return ["distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", *told]


def worker_of(address: str, *options: str) -> list[str]:
    return ["distributed.cli.dask_worker", address, "--nthreads", "1", "--no-dashboard", "--no-nanny", *options]


def address_in(folder: Path) -> str:
    path = folder / "scheduler.json"
    while True:
        try:
            return json.loads(path.read_text())["address"]
        except (OSError, ValueError):
            time.sleep(0.05)


@contextmanager
def worker_in(folder: Path, *options: str, **program: object):
    """A client of a scheduler with one worker, which may have a program of its own."""
    with (
        processes(scheduler_on(folder)),
        processes(worker_of(address_in(folder), *options), **program),
        connected(address_in(folder)) as client,
    ):
        client.wait_for_workers(1)
        yield client


@contextmanager
def cluster_of_two():
    """Workers, any death of which makes Dask give up what was under way there."""
    with dask.config.set({"distributed.scheduler.allowed-failures": 0}), connected("local:2") as client:
        yield client


@pytest.mark.usefixtures("blocks_of_forty")
def test_job_that_kills_its_workers__is_given_up_and_a_block_that_does_once_leaves_the_same_bits(tmp_path, monkeypatch):
    whole = contents(run(tmp_path, DISTINCT, "alone"))
    monkeypatch.setenv("CLUSTER_TEST_NOTE", str(tmp_path / "killed"))
    with cluster_of_two() as client:
        with crew_on(client, study_of(tmp_path, DISTINCT)) as crew:
            found = dict(crew.results(cluster_jobs.squared_by_survivors, ((n, (n,)) for n in range(6))))
            assert found == {n: n**2 for n in range(6) if n != 3}
            assert list(crew.failures) == [3]
        monkeypatch.setattr("sweeps.run.cluster.on_workers.compute_block", cluster_jobs.block_killing_once)
        client.cluster.scheduler.allowed_failures = 3
        path = run_study(study_of(tmp_path, DISTINCT), tmp_path / "study.h5", client=client)
    assert (tmp_path / "killed").exists()
    assert contents(path) == whole


@pytest.mark.usefixtures("blocks_of_forty")
def test_lost_scheduler__is_told_and_the_run_goes_on_without_it(tmp_path, monkeypatch):
    whole = contents(run(tmp_path, DISTINCT, "alone"))
    monkeypatch.setattr("sweeps.run.cluster.on_workers.compute_block", cluster_jobs.slow_block)
    with processes(scheduler_on(tmp_path)) as (scheduler,):
        address = address_in(tmp_path)

        def kill(done: int, before: int) -> None:
            if done == 80:
                scheduler.kill()

        with (
            processes(worker_of(address)),
            connected(address) as client,
            pytest.raises(UnfinishedError, match="the connection to the Dask scheduler is lost"),
        ):
            run_study(study_of(tmp_path, DISTINCT), tmp_path / "study.h5", progress=kill, client=client)
    assert MappedResult(tmp_path / "study.part.h5").done.sum() == 2
    assert contents(run_study(study_of(tmp_path, DISTINCT), tmp_path / "study.h5")) == whole


def test_worker_with_other_sources__is_left_out(tmp_path):
    other = tmp_path / "other"
    for package in ("engine", "sweeps"):
        shutil.copytree(ROOT / package, other / package, ignore=shutil.ignore_patterns("__pycache__"))
    with (other / "sweeps" / "run" / "blocks.py").open("a") as file:
        file.write("# Another version.\n")
    strangers = {**os.environ, "PYTHONPATH": str(other)}
    told = []
    with worker_in(tmp_path, cwd=other, env=strangers) as client:
        with (
            crew_on(client, study_of(tmp_path, DISTINCT)) as crew,
            pytest.raises(ClusterError, match=r"it has machine-sweeps .*, this machine has"),
        ):
            crew.assemble()
        with processes(worker_of(address_in(tmp_path))):
            client.wait_for_workers(2)
            study = study_of(tmp_path, DISTINCT)
            path = run_study(study, tmp_path / "study.h5", client=client, tell=told.append)
    assert len(told) == 1
    assert told[0].startswith("Excluded: worker tcp://127.0.0.1:")
    assert MappedResult(path).attributes["outcome"].startswith("computed by 1 worker, 1 thread")


def test_worker_without_the_program__is_told_what_to_install(tmp_path):
    empty = tmp_path / "empty"
    empty.mkdir()
    (empty / "sweeps.py").write_text('raise ModuleNotFoundError("No module named \'sweeps\'", name="sweeps")\n')
    with (
        worker_in(tmp_path, cwd=empty, env={**os.environ, "PYTHONPATH": str(empty)}) as client,
        crew_on(client, study_of(tmp_path, DISTINCT)) as crew,
        pytest.raises(ClusterError, match="it has no sweeps; pip install 'machine-sweeps"),
    ):
        crew.assemble()


# Clients


@pytest.mark.parametrize(("number", "code"), [(signal.SIGKILL, -9), (signal.SIGINT, 130)])
def test_client_that_ends__leaves_what_goes_on(number, code, tmp_path):
    on_two = ("--cluster", "local:2")
    with start(tmp_path, *on_two) as process:
        wait_for_blocks(process, tmp_path, 2)
        workers = psutil.Process(process.pid).children(recursive=True)
        if number == signal.SIGINT:
            # From a terminal it reaches all of them.
            os.killpg(process.pid, number)
        else:
            process.send_signal(number)
        _, errors = process.communicate()
    assert len(workers) >= 2
    assert psutil.wait_procs(workers, timeout=60)[1] == []
    assert process.returncode == code
    if code > 0:
        assert errors.endswith(f"are done and kept; resume with: sweeps {' '.join(AGAIN + on_two)}\n")
        assert errors.count("\n") == 1
    assert blocks_done(tmp_path) >= 2
