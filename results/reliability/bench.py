"""Commands to disturb, in forks of one process that has everything loaded, and their undisturbed results.

A fork starts at the program's first line, without Python's start and the imports, which take 3 s.
"""

import importlib
import os
import random
import signal
import subprocess
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from mutations import load_program

from sweeps.__main__ import start
from sweeps.run import runner
from sweeps.run.cluster.crew import Crew
from sweeps.store import MappedResult, Store, StoreError
from sweeps.store.layout import CHANGING
from sweeps.text.templates import template_text

# Studies here take about a second: number of blocks of each, instead of one or two.
BLOCKS = 12
_SWEEP = """scene = "scene.toml"
positions = 24

[vary]
"input.length" = {{ from = "30 mm", to = "60 mm", count = {count} }}
"input.speed" = {{ values = ["200 rpm", "250 rpm", "300 rpm", "350 rpm"] }}

[outputs]
summaries = ["piston.stroke", "required_power", "excess_work"]
{more}

[best]
minimise = "required_power"
"""
FIELDS = 'fields = ["piston.slide"]'
_SEARCH = """scene = "scene.toml"
positions = 24

[vary]
"input.length" = { from = "30 mm", to = "60 mm", count = 50 }
"groups.drive.first.length" = { from = "150 mm", to = "300 mm", count = 50 }

[outputs]
summaries = ["piston.stroke", "required_power", "excess_work"]

[optimise]
minimise = ["excess_work"]
where = ["piston.stroke >= '80 mm'"]
population = 400
generations = 24
"""
_MOTION = """scene = "motor.toml"
positions = 24

[vary]
"flywheel.inertia" = { from = "1 kg m2", to = "4 kg m2", count = 240 }

[outputs]
summaries = ["start.time", "start.motor_moment_peak"]
"""
_MOTOR = """
[moments.motor]
type = "induction_motor"
on = "crank"
power = "11 kW"
synchronous_speed = "310 rpm"
rated_speed = "300 rpm"
breakdown_ratio = 2.5
starting_ratio = 2.2

[regimes.start]
type = "run"
off = ["delivery"]
speed = "280 rpm"
"""


class Ended(NamedTuple):
    """How a command ended.

    Attributes
    ----------
    code : int
        Exit code, −n for signal n.
    out, err : str
        Its output.
    cpu : float
        Total processor time [s].
    """

    code: int
    out: str
    err: str
    cpu: float

    @property
    def fault(self) -> str:
        """A traceback, a crash, or a failure without a message; "" for none of these."""
        if "Traceback" in self.err + self.out or "Exception ignored" in self.err:
            return f"traceback: {self.err[-300:]}"
        if self.code not in (0, 1, 2):
            return f"exit code {self.code}: {self.err[-200:]}"
        return "" if self.code == 0 or self.err else "failed without a message"

    @property
    def failure(self) -> str:
        """Its fault or the end of its message if it failed; "" if not."""
        return self.fault or (self.err[-200:] if self.code else "")


class Child:
    """A running command, as a fork or a separate process."""

    def __init__(self, pid: int, paths: list[Path]) -> None:
        self.pid, self._paths = pid, paths

    @property
    def alive(self) -> bool:
        """Whether it hasn't ended yet."""
        return os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOWAIT | os.WNOHANG) is None

    @property
    def listens(self) -> bool:
        """Whether it has reached the first line of the program, and handles SIGTERM or ignores it at its end."""
        text = Path(f"/proc/{self.pid}/status").read_text()
        masks = [int(line.split()[1], 16) for line in text.splitlines() if line.startswith(("SigCgt", "SigIgn"))]
        return any(mask >> (signal.SIGTERM - 1) & 1 for mask in masks)

    @property
    def cpu(self) -> float:
        """Processor time so far [s]."""
        fields = Path(f"/proc/{self.pid}/stat").read_text().rpartition(")")[2].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def end(self) -> Ended:
        """Wait for its end."""
        _, status, usage = os.wait4(self.pid, 0)
        # If killed at once, it may not have opened its files.
        said = [path.read_text(errors="replace") if path.exists() else "" for path in self._paths]
        for path in self._paths:
            path.unlink(missing_ok=True)
        return Ended(os.waitstatus_to_exitcode(status), *said, usage.ru_utime + usage.ru_stime)


class Job(NamedTuple):
    """A command that makes a file, and can resume it.

    Attributes
    ----------
    name : str
    arguments : tuple of str
    result, part : str
        The file made, and its name until it is finished.
    """

    name: str
    arguments: tuple[str, ...]
    result: str
    part: str


class Bench:
    """A folder with studies, results of undisturbed runs, and a tally of the outcomes of disturbed ones.

    Parameters
    ----------
    folder : Path
        Scratch folder.
    seed : int
    note : callable
        Called with the fault, its outcome and the failure, "" for none.
    """

    def __init__(self, folder: Path, seed: int, note: Callable[[str, str, str], None]) -> None:
        self.folder, self.dice, self.note = folder, random.Random(seed), note
        self.most: Counter = Counter()
        self.environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache"), "HOME": str(folder / "home")}
        for name in ("cache", "home", "said", "work"):
            (folder / name).mkdir(mode=0o700)
        self.work, self._written, self._cluster, self._count = folder / "work", folder / "written", None, 0
        scene = template_text("slider_crank")
        texts = {
            "scene.toml": scene,
            "motor.toml": scene.replace("\n[flywheel]\n", '\n[flywheel]\ninertia = "2 kg m2"\n') + _MOTOR,
            "sweep.toml": _SWEEP.format(count=60_000, more=""),
            "fields.toml": _SWEEP.format(count=40_000, more=FIELDS),
            "small.toml": _SWEEP.format(count=150, more=FIELDS),
            "search.toml": _SEARCH,
            "motion.toml": _MOTION,
        }
        for name, text in texts.items():
            (self.work / name).write_text(text, encoding="utf8")
        self._load()
        self.whole: dict[str, float] = {}
        self.held: dict[str, dict[str, bytes]] = {}

    def _load(self) -> None:
        load_program()
        for name in ("matplotlib.pyplot", "matplotlib.backends.backend_agg", "scipy.optimize", "distributed"):
            importlib.import_module(name)
        runner.block_size = lambda study, seconds: (
            20_000 if getattr(seconds, "__func__", None) is Crew.seconds else max(study.design.size // BLOCKS, 1)
        )
        write = Store.write

        def noted(store: Store, i: int, arrays: dict[str, np.ndarray]) -> None:
            with open(self._written, "a") as file:
                file.write(f"{store.part.name} {i}\n")
            write(store, i, arrays)

        Store.write = noted

    # Commands

    def begin(
        self, *arguments: str, prepare: Callable[[], None] = lambda: None, environment: dict | None = None
    ) -> Child:
        """A command in a fork of this process."""
        self._count += 1
        paths = [self.folder / "said" / f"{self._count}.{kind}" for kind in ("out", "err")]
        child = os.fork()
        if child:
            return Child(child, paths)
        try:
            # Background processes and their children ignore Ctrl-C.
            signal.signal(signal.SIGINT, signal.default_int_handler)
            os.chdir(self.work)
            os.environ.clear()
            os.environ.update(environment or self.environment)
            for number, path in enumerate(paths, 1):
                os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600), number)
            sys.argv = ["sweeps", *arguments]
            prepare()
            start()
            os._exit(0)
        except SystemExit as ending:
            code = ending.code or 0
            sys.stdout.flush()
            os._exit(code)
        except BaseException:
            traceback.print_exc()
            sys.stderr.flush()
        finally:
            os._exit(99)

    def process(self, *arguments: str) -> Child:
        """A command as a separate process, from Python's start on."""
        self._count += 1
        paths = [self.folder / "said" / f"{self._count}.{kind}" for kind in ("out", "err")]
        with open(paths[0], "w") as out, open(paths[1], "w") as err:
            line = [sys.executable, "-m", "sweeps", *arguments]
            heeding = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.default_int_handler)}
            options = {"cwd": self.work, "env": self.environment, "stdout": out, "stderr": err, **heeding}
            started = subprocess.Popen(line, **options)
        # `Child` waits for it by its process id.
        started.returncode = 0
        return Child(started.pid, paths)

    def command(self, *arguments: str, **options: object) -> Ended:
        """A command in a fork, to its end."""
        return self.begin(*arguments, **options).end()

    def ready(self, job: Job) -> None:
        """Run a job undisturbed, once to compile and once for its time, and keep its result."""
        if job.name in self.whole:
            return
        for _ in range(2):
            self.clear(job)
            begun = time.monotonic()
            ended = self.command(*job.arguments)
            self.whole[job.name] = time.monotonic() - begun
            if ended.code:
                raise RuntimeError(f"{job.name}: {ended.err}")
        self.held[job.name] = self.contents(job.result)
        self.clear(job)

    def cluster(self) -> str:
        """Address of a cluster of two workers, started at the first call."""
        if self._cluster is None:
            code = "import sys; from distributed import LocalCluster\nif __name__ == '__main__':\n"
            code += "    cluster = LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None)\n"
            code += "    print(cluster.scheduler_address, flush=True)\n    sys.stdin.read()\n"
            (self.folder / "cluster.py").write_text(code)
            line = [sys.executable, str(self.folder / "cluster.py")]
            pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
            self._cluster = subprocess.Popen(line, cwd=self.folder, env=self.environment, text=True, **pipes)
            self._address = self._cluster.stdout.readline().strip()
        return self._address

    def close(self) -> None:
        """End the cluster, if there is one."""
        if self._cluster is not None:
            self._cluster.stdin.close()
            self._cluster.wait()

    # Files

    def contents(self, name: str) -> dict[str, bytes]:
        """Bytes of all columns and texts of a result file, except its time of completion; all of another file."""
        path = self.work / name
        if not name.endswith(".h5"):
            return {"": path.read_bytes()}
        file = MappedResult(path)
        texts = {k: str(v).encode() for k, v in file.attributes.items() if k not in CHANGING}
        return texts | {key: np.array(values).tobytes() for key, values in file.columns.items()}

    def is_whole(self, job: Job) -> bool:
        """Whether a finished file equals that of the undisturbed job."""
        try:
            return self.contents(job.result) == self.held[job.name]
        except (StoreError, OSError, KeyError):
            return False

    def is_left_right(self, job: Job) -> bool:
        """Whether all blocks flagged as done in an unfinished file are intact and equal those of the whole file."""
        part = MappedResult(self.work / job.part)
        if part.damaged():
            return False
        if job.name == "search":
            # The blocks of the candidates' file differ from those of the finished one.
            return True
        blocks = [part.rows(int(i)) for i in np.flatnonzero(part.done)]
        for name in (*part.flat, *part.fields):
            column = part.columns[name]
            whole = np.frombuffer(self.held[job.name][name], column.dtype).reshape(column.shape)
            if any(column[rows].tobytes() != whole[rows].tobytes() for rows in blocks):
                return False
        return True

    def done(self, job: Job) -> set[int]:
        """Numbers of the blocks flagged as done in an unfinished file."""
        path = self.work / job.part
        return set(np.flatnonzero(MappedResult(path).done).tolist()) if path.exists() else set()

    def written(self, job: Job) -> set[int]:
        """Numbers of the blocks written since the last time."""
        lines = self._written.read_text().splitlines() if self._written.exists() else []
        self._written.unlink(missing_ok=True)
        pairs = [line.rpartition(" ") for line in lines]
        return {int(number) for name, _, number in pairs if name == Path(job.part).name}

    def computed_twice(self, job: Job, before: set[int]) -> list[str]:
        """Blocks written since the last time although they were done `before`, as a failure."""
        again = self.written(job) & before
        return [f"blocks computed twice: {sorted(again)}"] if again else []

    def resumed(self, job: Job, **options: object) -> list[str]:
        """Resume a job to its end, and remove its files; what went wrong."""
        before, _ = self.done(job), self.written(job)
        ended = self.command(*job.arguments, **options)
        wrong = self.computed_twice(job, before)
        if ended.failure:
            wrong.append(f"resumed: {ended.failure}")
        elif not self.is_whole(job):
            wrong.append("the resumed file differs")
        self.clear(job)
        return wrong

    def clear(self, job: Job) -> None:
        """Remove a job's files, including drafts and pictures."""
        stem = Path(job.result).stem
        for path in [*self.work.glob(f"{stem}[._]*"), *self.work.glob(".*")]:
            if path.is_file():
                path.unlink()


def jobs(bench: Bench) -> dict[str, Callable[[], Job]]:
    """The commands to disturb, by name; those on a cluster start one."""
    usual = ("--no-plots", "--quiet")

    def run(name: str, study: str, *more: str, verb: str = "run", part: str = "part") -> Callable[[], Job]:
        line = (verb, f"{study}.toml", *usual, *more, "--out", f"of_{name}.h5")
        return lambda: Job(name, line, f"of_{name}.h5", f"of_{name}.{part}.h5")

    def paged() -> Job:
        source = Job("small", ("run", "small.toml", *usual, "--out", "paged.h5"), "paged.h5", "paged.part.h5")
        if not (bench.work / "paged.h5").exists() and bench.command(*source.arguments).code:
            raise RuntimeError("the study to be reported has failed")
        return Job("report", ("report", "paged.h5", "--out", "report.html"), "report.html", "report.part.h5")

    return {
        "run": run("run", "sweep"),
        "kept fields": run("kept", "fields"),
        "motion": run("motion", "motion"),
        "accuracy": run("accuracy", "sweep", "--accuracy", "0.01 %"),
        "search": run("search", "search", verb="optimise", part="candidates.part"),
        "report": paged,
        "cluster": lambda: run("cluster", "sweep", "--cluster", bench.cluster())(),
    }
