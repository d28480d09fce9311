"""Who can make whom run programs: strangers on this machine, workers, and whoever holds no certificate."""

import os
import pickle
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

import dask
import psutil
import pytest
from cluster_attack import Bomb
from cluster_jobs import crew_on
from commands import ROOT, refused, said
from distributed import Client, LocalCluster, Security
from press_sweeps import DISTINCT, contents, run, study_of
from test_cluster_runs import HERE, address_in, processes, scheduler_on, worker_in, worker_of

from sweeps.run.cluster.cluster_errors import ClusterError
from sweeps.run.cluster.connecting import connected

SAMPLES = ROOT / "tests" / "samples" / "texts"
AS_ROOT = hasattr(os, "geteuid") and os.geteuid() == 0


def listening_ports() -> list[str]:
    """Ports on which this process and its children answer."""
    here = psutil.Process()
    processes = [here, *here.children(recursive=True)]
    found = [connection for process in processes for connection in process.net_connections()]
    return [str(connection.laddr.port) for connection in found if connection.status == psutil.CONN_LISTEN]


def attacked(ports: list[str], mark: Path, seconds: float = 1.0) -> list[str]:
    """Ports that answered a stranger in time, another user where that can be had; what workers ran leaves MARK."""
    mark.parent.chmod(0o777)
    line = [sys.executable, str(SAMPLES / "cluster_attack.py"), str(mark), str(seconds), *ports]
    environment = {**HERE, "PYTHONPATH": os.pathsep.join([str(SAMPLES), HERE["PYTHONPATH"]]), "HOME": str(mark.parent)}
    done = subprocess.run(line, env=environment, cwd="/", capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return done.stdout.split()


@pytest.fixture
def open_folder(tmp_path_factory):
    """A folder that another user reaches."""
    folder = tmp_path_factory.mktemp("open")
    for parent in (folder, folder.parent, folder.parent.parent):
        if AS_ROOT:
            parent.chmod(0o755)
    return folder


def test_local_workers__answer_nobody_else(open_folder):
    mark = open_folder / "mark"
    before = set(listening_ports())
    with connected("local:2") as client:
        assert client.submit(sum, (1, 2)).result() == 3
        ports = [port for port in listening_ports() if port not in before]
        assert len(ports) >= 3
        assert attacked(ports, mark) == []
    assert not mark.exists()
    assert dask.config.get("distributed.comm.tls.client.key", None) is None


LOOKED_FOR = "__import__('importlib.util').util.find_spec('planted')"


def test_local_workers__load_modules_from_no_shared_folder(tmp_path, monkeypatch):
    """Python looks for modules in Dask's folder first, and in the usual one anybody can leave some."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    shared = tmp_path / "dask-scratch-space"
    shared.mkdir()
    shared.chmod(0o777)
    (shared / "planted.py").write_text("")
    with connected("local:1") as client:
        assert [path.stat().st_mode & 0o777 for path in tmp_path.iterdir() if path != shared] == [0o700]
        assert eval(LOOKED_FOR) is None
        assert client.submit(eval, LOOKED_FOR).result() is None
    assert list(tmp_path.iterdir()) == [shared]
    assert [path.name for path in shared.iterdir()] == ["planted.py"]


def test_attack__succeeds_where_nothing_is_encrypted(open_folder, monkeypatch):
    """Otherwise the test above would prove nothing."""
    mark = open_folder / "mark"
    monkeypatch.syspath_prepend(str(SAMPLES))
    with (
        LocalCluster(n_workers=1, threads_per_worker=1, protocol="tcp", dashboard_address="127.0.0.1:0") as cluster,
        Client(cluster) as client,
    ):
        client.wait_for_workers(1)
        ports = [cluster.workers[0].worker_address.rpartition(":")[2]]
        # Patient: a busy machine is slow to carry out what is asked.
        assert attacked(ports, mark, 60.0) == ports
    assert mark.read_text().startswith("here\n")


PRELOAD = """
from cluster_attack import Bomb
from distributed.protocol import to_serialize

async def dask_setup(worker):
    answers = iter([ANSWERS])
    worker.handlers["run"] = lambda **asked: next(answers)
"""
# A pickled result, a pickled error, no greeting, another kind of answer.
ANSWERS = (
    '{"status": "OK", "result": to_serialize(Bomb(MARK))}',
    '{"status": "error", "exception": to_serialize(Bomb(MARK)), "exception_text": "no"}',
    '{"status": "OK", "result": to_serialize("[7]")}',
    '{"status": "OK", "result": 7}',
)


def test_greeting__is_not_unpickled(tmp_path):
    mark, preload = tmp_path / "mark", tmp_path / "stranger.py"
    # Unpickled here, the bomb goes off.
    pickle.loads(pickle.dumps(Bomb(str(mark))))
    mark.unlink()
    preload.write_text(PRELOAD.replace("ANSWERS", ", ".join(ANSWERS).replace("MARK", repr(str(mark)))))
    # The scheduler knows nothing of the class.
    found = {**HERE, "PYTHONPATH": os.pathsep.join([str(SAMPLES), HERE["PYTHONPATH"]])}
    words = r"the cluster has no usable worker: .*another version of machine-sweeps"
    with worker_in(tmp_path, "--preload", str(preload), env=found) as client:
        for _ in ANSWERS:
            with crew_on(client, study_of(tmp_path, DISTINCT)) as crew, pytest.raises(ClusterError, match=words):
                crew.assemble()
    assert not mark.exists()


@contextmanager
def certified(folder: Path):
    """A scheduler and a worker that take only those who hold a certificate; settings for who holds it."""
    made = Security.temporary()
    texts = {"ca": made.tls_ca_file, "cert": made.tls_client_cert, "key": made.tls_client_key}
    for name, text in texts.items():
        (folder / name).write_text(text)
    options = ["--tls-ca-file", "ca", "--tls-cert", "cert", "--tls-key", "key"]
    scheduler = [*scheduler_on(folder), "--protocol", "tls", *options]
    with processes(scheduler, cwd=folder), processes([*worker_of(address_in(folder)), *options], cwd=folder):
        client = {f"distributed.comm.tls.client.{name}": str(folder / name) for name in ("cert", "key")}
        yield client | {"distributed.comm.tls.ca-file": str(folder / "ca")}


def test_certificates__let_in_whoever_holds_them(folder, monkeypatch):
    study_of(folder, DISTINCT)
    with certified(folder) as settings:
        address = address_in(folder)
        assert address.startswith("tls://")
        command = ("run", "study.toml", "--no-plots", "--cluster", address)
        assert "needs tls:// and certificates" in refused(*command)
        own = Security.temporary()
        holder = "distributed.comm.tls.client"
        foreign = {f"{holder}.{part}": getattr(own, f"tls_client_{part}") for part in ("cert", "key")}
        with dask.config.set(foreign | {"distributed.comm.tls.ca-file": own.tls_ca_file}):
            monkeypatch.setattr("sweeps.run.cluster.connecting.PATIENCE", 2)
            assert "no Dask scheduler answers" in refused(*command)
        with dask.config.set(settings):
            answer = said(*command)
        assert answer.exit_code == 0, answer.output
    assert contents(Path("results/study.h5")) == contents(run(folder, DISTINCT, "alone"))


def test_help__says_who_is_trusted():
    for command in ("run", "optimise", "check"):
        words = " ".join(said(command, "--help").stdout.split())
        assert "tls://" in words
        assert "they can run programs as you" in words
