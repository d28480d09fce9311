"""Studies on a real cluster of processes: the same files, bit for bit, as one machine writes."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import cluster_jobs
import dask
import h5py
import psutil
import pytest
import searches
from cluster_jobs import crew_on
from commands import ROOT, done, refused, said
from long_runs import AGAIN, blocks_done, start, wait_for_blocks
from press_sweeps import DISTINCT, GOOD, Stop, contents, run, stopping, study_of

from sweeps.optimising.search_runner import optimise_study
from sweeps.run import runner
from sweeps.run.cluster.cluster_errors import ClusterError, UnfinishedError
from sweeps.run.cluster.connecting import connected
from sweeps.run.cluster.crew import UNDER_WAY
from sweeps.run.cluster.limits import ClusterLimits
from sweeps.run.cluster.on_workers import time_variant
from sweeps.run.runner import layout_of, run_study
from sweeps.store import MappedResult
from sweeps.store.creating import write_final_text
from sweeps.study.bundled import STUDIES
from sweeps.study.study_reader import read_study


@pytest.fixture(scope="module")
def client():
    with connected("local:2") as client:
        yield client


@pytest.fixture(autouse=True)
def blocks_of_forty(monkeypatch):
    monkeypatch.setattr(runner, "block_size", lambda *_: 40)


def without_its_end(path: Path) -> bytes:
    """A file's bytes, but for when it was finished and by whom."""
    copy = path.with_suffix(".copy")
    shutil.copyfile(path, copy)
    with h5py.File(copy, "r+") as file:
        for name in ("finished", "outcome"):
            write_final_text(file, name, "")
    return copy.read_bytes()


def test_sweep__is_byte_for_byte_that_of_one_machine(client, tmp_path):
    alone = run(tmp_path, DISTINCT, "alone")
    (tmp_path / "on").mkdir()
    calls = []
    study = study_of(tmp_path / "on", DISTINCT, "alone")
    path = run_study(study, tmp_path / "on" / "alone.h5", progress=lambda *c: calls.append(c), client=client)
    assert calls == [(0, 0), (40, 0), (80, 0), (120, 0), (160, 0), (200, 0)]
    assert without_its_end(path) == without_its_end(alone)
    outcome = MappedResult(path).attributes["outcome"]
    assert re.fullmatch(r"computed by 2 workers, \d+ threads; processors: \S+ \(2\)", outcome)
    done("verify", str(path))
    # Nothing left to do: nobody is asked.
    assert run_study(study, path, client=None) == path


def test_study_with_files_in_other_folders__is_that_of_one_machine(client, tmp_path, monkeypatch):
    shutil.copytree(STUDIES / "flywheels" / "scenes", tmp_path / "machines" / "presses" / "driven")
    shutil.copytree(STUDIES / "tables", tmp_path / "machines" / "tables")
    folder, elsewhere = tmp_path / "studies", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    text = (STUDIES / "flywheels" / "crank_press.toml").read_text().replace('"scenes/', '"../machines/presses/driven/')
    text = text.replace("positions =", 'variants = "presses.csv"\npositions =', 1)
    text = re.sub(r'^"(input.speed|forces.punching.scale)" = .*\n', "", text, flags=re.M)
    (folder / "press.toml").write_text(re.sub(r"count = \d+", "count = 2", text))
    (folder / "presses.csv").write_text("input.speed [rpm],forces.punching.scale\n30,1\n40,0.75\n60,0.5\n")
    monkeypatch.chdir(elsewhere)
    alone = run_study(read_study("../studies/press.toml"), "alone.h5")
    study = read_study("../studies/press.toml")
    shutil.rmtree(tmp_path / "machines")
    shutil.rmtree(folder)
    path = run_study(study, "on.h5", client=client)
    assert contents(path) == contents(alone)
    assert MappedResult(path).variants == 12


def test_edited_study__is_extended_as_on_one_machine(client, tmp_path):
    edited = GOOD.replace("'40 mm', '50 mm'", "'40 mm', '45 mm', '50 mm', '900 mm'")
    edited = edited.replace('"excess_work"]', '"excess_work", "ram.slide.max"]')
    found = {}
    for name, on in (("alone", None), ("on", client)):
        folder = tmp_path / name
        folder.mkdir()
        run_study(study_of(folder, GOOD), folder / "study.h5", client=on)
        told = []
        path = run_study(study_of(folder, edited), folder / "study.h5", client=on, tell=told.append)
        assert told == []
        found[name] = contents(path)
    assert found["on"] == found["alone"]


@pytest.mark.parametrize("first", ["on", "alone"])
def test_interrupted_run__goes_on_with_or_without_the_cluster(first, client, tmp_path):
    whole = contents(run(tmp_path, DISTINCT, "whole"))
    here = {"on": client, "alone": None}
    with pytest.raises(Stop):
        run_study(study_of(tmp_path, DISTINCT), tmp_path / "study.h5", progress=stopping(80), client=here.pop(first))
    assert MappedResult(tmp_path / "study.part.h5").done.sum() == 2
    calls = []
    (other,) = here.values()
    study = study_of(tmp_path, DISTINCT)
    run_study(study, tmp_path / "study.h5", progress=lambda *call: calls.append(call), client=other)
    assert calls == [(80, 80), (120, 80), (160, 80), (200, 80)]
    assert contents(tmp_path / "study.h5") == whole


def test_search__is_that_of_one_machine(client, folder):
    asked = searches.ONE.replace("population = 10", "population = 40").replace("generations = 12", "generations = 4")
    study = searches.study_of(folder, asked)
    alone = optimise_study(study, folder / "alone.h5")
    path = optimise_study(study, folder / "on.h5", client=client)
    assert contents(path) == contents(alone)
    assert "; computed by 2 workers" in MappedResult(path).attributes["outcome"]
    address = client.scheduler.address
    done("optimise", "study.toml", "--no-plots", "--out", "told.h5", "--cluster", address)
    assert contents(Path("told.h5")) == contents(alone)


# What is under way


@pytest.fixture
def crew(client, tmp_path):
    with crew_on(client, study_of(tmp_path, GOOD)) as crew:
        yield crew


def test_jobs__are_taken_only_as_they_are_needed(crew):
    taken, most, found = 0, 0, {}

    def jobs():
        nonlocal taken
        for number in range(50):
            taken += 1
            yield number, (number,)

    for number, result in crew.results(cluster_jobs.squared, jobs()):
        found[number] = result
        most = max(most, taken - len(found))
    assert found == {number: number**2 for number in range(50)}
    assert most <= UNDER_WAY * 2


def test_job_that_fails__is_given_up_and_the_others_are_not(crew):
    found = dict(crew.results(cluster_jobs.squared_but_one, ((n, (n,)) for n in range(8))))
    assert found == {n: n**2 for n in range(8) if n != 3}
    assert crew.failures == {3: "ArithmeticError: three is refused"}


def test_workers_started_anew_under_their_addresses__get_the_study_again(client, crew):
    crew.assemble()
    client.run(cluster_jobs.forget)
    found = dict(crew.results(time_variant, ((n, ()) for n in range(5))))
    assert (sorted(found), crew.failures) == ([0, 1, 2, 3, 4], {})


# Commands


@pytest.mark.parametrize(
    ("rates", "least", "seconds"),
    [((100.0, 1e3, 1e3), "workers", 1e-2), ((1e6, 1e3, 1e4), "network", 1.1e-3), ((1e6, 1e4, 1e3), "disk", 1.1e-3)],
)
def test_limits__count_fetching_and_writing_one_after_the_other(rates, least, seconds):
    limits = ClusterLimits(*rates)
    assert limits.least == least
    assert limits.seconds == pytest.approx(seconds, rel=1e-12)


def test_commands__compute_on_the_cluster(client, press_folder):
    address = client.scheduler.address
    answer = said("check", "study.toml", "--cluster", address)
    assert answer.exit_code == 0, answer.output
    told = answer.output.partition("\nCluster\n")[2]
    kinds = r"  workers: \S+ variants a second\n  network: \S+ variants a second\n  disk: \S+ variants a second\n"
    assert re.fullmatch(rf"  2 workers, .*\n{kinds}  bottleneck: (workers|network|disk); about \S+ s\n", told)
    assert sorted(path.name for path in press_folder.iterdir()) == ["press.toml", "study.toml"]
    done("run", "study.toml", "--no-plots", "--cluster", address)
    done("run", "study.toml", "--no-plots", "--out", "alone.h5")
    assert contents(Path("results/study.h5")) == contents(Path("alone.h5"))


def test_command_whose_block_fails__tells_it_and_ends_with_1(client, folder, monkeypatch):
    study_of(folder, DISTINCT)
    arguments = ("run", "study.toml", "--no-plots", "--cluster", client.scheduler.address)
    with monkeypatch.context() as patch:
        patch.setattr("sweeps.run.cluster.on_workers.compute_block", cluster_jobs.block_but_one)
        answer = said(*arguments)
    part = Path("results/study.part.h5")
    assert answer.exit_code == 1
    assert answer.stderr == (
        "Error: variants 80 … 119 couldn't be computed (ArithmeticError: this block is refused). The others are kept "
        f"in {part}; repeat the command to retry.\n"
    )
    assert MappedResult(part).done.sum() == 4
    done(*arguments)
    assert contents(Path("results/study.h5")) == contents(run(folder, DISTINCT, "alone"))


def test_wrong_addresses__are_told_in_a_sentence(press_folder, monkeypatch):
    monkeypatch.setattr("sweeps.run.cluster.connecting.PATIENCE", 0.5)

    def told(*arguments: str) -> str:
        message = refused("run", "study.toml", *arguments)
        assert message.count("\n") == 1
        return message

    assert "no Dask scheduler answers at tcp://127.0.0.1:9 (" in told("--cluster", "tcp://127.0.0.1:9")
    assert "no Dask scheduler answers at foo://x (unknown address scheme" in told("--cluster", "foo://x")
    assert "write local:8" in told("--cluster", "local")
    assert "dask worker --nthreads 8" in told("--cluster", "tcp://127.0.0.1:9", "--jobs", "2")
    monkeypatch.setitem(sys.modules, "distributed", None)
    assert "pip install 'machine-sweeps[cluster]'" in told("--cluster", "local:2")


def test_no_worker_fits__is_refused(client, tmp_path, monkeypatch):
    study = study_of(tmp_path, GOOD)
    other = {"numba": "0.1"}
    found = runner.crew_of(client, study, layout_of(study), print)
    from sweeps.run.cluster import on_workers

    own = on_workers.own_greeting()
    monkeypatch.setattr(on_workers, "own_greeting", lambda: own._replace(versions=own.versions | other))
    with (
        found as crew,
        pytest.raises(ClusterError, match=r"it has numba .*, this machine has 0\.1; install the same version there"),
    ):
        crew.assemble()


# Workers, clients and schedulers that are killed, and workers that aren't ours: nothing that is done is lost.


HERE = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path])}
QUIET = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


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
        shutil.copytree(ROOT / package, other / package)
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
