"""Disks that are full or read-only, no home, a clock set back, and several processes on one cache or one result."""

import datetime
import os
import resource
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from pathlib import Path

from bench import Bench, Ended, Job, jobs

_YEAR = 3.15e7


@contextmanager
def small_disk(folder: Path, size: int, read_only: bool = False) -> Iterator[tuple[bool, Callable[[], None]]]:
    """A disk of `size` bytes on a folder; yields whether mounting is allowed, and what else limits a command."""
    folder.mkdir(exist_ok=True)
    line = ["mount", "-t", "tmpfs", "-o", f"size={size},mode=700{',ro' if read_only else ''}", "none", str(folder)]
    allowed = subprocess.run(line, capture_output=True).returncode == 0
    try:
        yield allowed, (lambda: None) if allowed else partial(_limit, size)
    finally:
        if allowed:
            subprocess.run(["umount", str(folder)], check=True)
        shutil.rmtree(folder, ignore_errors=True)


def _limit(size: int) -> None:
    signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


def full_disk(bench: Bench) -> None:
    """A command that writes to a disk that fills up or is read-only."""
    if not (bench.work / "full.h5").exists():
        bench.command("run", "small.toml", "--no-plots", "--quiet", "--out", "full.h5")
    commands = (
        ("run", "small.toml", "--quiet", "--out", "disk/r.h5"),
        ("run", "fields.toml", "--quiet", "--no-plots", "--out", "disk/k.h5"),
        ("optimise", "search.toml", "--quiet", "--no-plots", "--out", "disk/o.h5"),
        ("plot", "full.h5", "--out", "disk/p.png"),
        ("report", "full.h5", "--out", "disk/p.html"),
        ("export", "full.h5", "--to", "disk/e.csv"),
        ("export", "scene.toml", "--to", "disk/s.svg"),
        ("export", "scene.toml", "--to", "disk/s.dxf"),
        ("animate", "scene.toml", "--frames", "6", "--out", "disk/a.gif"),
        ("new", "rotor", "--out", "disk/new.toml"),
    )
    command = bench.dice.choice(commands)
    size, read_only = max(int(10 ** bench.dice.uniform(3.6, 6.8)), 4096), bench.dice.random() < 0.2
    wrong = []
    with small_disk(bench.work / "disk", size, read_only) as (allowed, limit):
        ended = bench.command(*command, prepare=limit)
        kind = "read-only" if read_only and allowed else ("full" if allowed else "file size limited")
        wrong += [f"{command[0]} {size}: {ended.fault}"] if ended.fault else []
        left = [path.name for path in (bench.work / "disk").glob(".*")]
        wrong += [f"{command[0]}: drafts are left: {left}"] if left else []
    bench.note("full and read-only disks", f"{kind}, {'reported' if ended.code else 'enough space'}", "; ".join(wrong))


def room_again(bench: Bench) -> None:
    """A sweep on a disk that fills up, resumed when there is space again: nothing is lost."""
    job = jobs(bench)["kept fields"]()
    bench.ready(job)
    size = bench.dice.randrange(200_000, 30_000_000)
    wrong, told = [], 0
    with small_disk(bench.work / "disk", size) as (allowed, limit):
        line = tuple(word.replace("of_kept", "disk/of_kept") for word in job.arguments)
        moved = Job(job.name, line, f"disk/{job.result}", f"disk/{job.part}")
        for _ in range(2):
            ended = bench.command(*line, prepare=limit)
            told += ended.code != 0
            wrong += [ended.fault] if ended.fault else []
        if (bench.work / moved.part).exists() and not bench.is_left_right(moved):
            wrong.append("a block flagged as done differs")
        if allowed:
            subprocess.run(["mount", "-o", "remount,size=200M", str(bench.work / "disk")], check=True)
        ended = bench.command(*line)
        if ended.code or not bench.is_whole(moved):
            wrong.append(f"with space again: {ended.err[-200:] or 'differs'}")
    bench.note(
        "a disk that fills up, then has space again",
        "reported twice" if told == 2 else "enough space",
        "; ".join(wrong),
    )


def cache_refused(bench: Bench) -> None:
    """No space or permission for machine code, or no home: the run continues, with at most one message."""
    job = Job("small", ("run", "small.toml", "--no-plots", "--quiet", "--out", "refused.h5"), "refused.h5", "")
    environment, way = dict(bench.environment), bench.dice.choice(("full", "read-only", "no home", "home read-only"))
    with small_disk(bench.folder / "elsewhere", 40_960, read_only="read-only" in way) as (allowed, _):
        if way == "no home":
            for name in ("HOME", "XDG_CACHE_HOME"):
                environment.pop(name)
            # Without HOME the system's user list would give the real home of the user who runs this.
            environment["HOME"] = str(bench.folder / "nowhere")
        elif way == "home read-only":
            environment.pop("XDG_CACHE_HOME")
            environment["HOME"] = str(bench.folder / "elsewhere")
        else:
            environment["XDG_CACHE_HOME"] = str(bench.folder / "elsewhere")
        ended = bench.command(*job.arguments, environment=environment)
        said = ended.err.count("Machine code is compiled in every run")
    wrong = ended.failure
    if not wrong and allowed and way != "no home" and said != 1:
        wrong = f"reported {said} times: {ended.err[-200:]}"
    shutil.rmtree(bench.folder / "nowhere", ignore_errors=True)
    bench.clear(job)
    bench.note("no folder for machine code", way, wrong and f"{way}: {wrong}")


def _set_back() -> None:
    now = time.time

    class Back(datetime.datetime):
        @classmethod
        def now(cls, tz: datetime.tzinfo | None = None) -> datetime.datetime:
            return super().now(tz) - datetime.timedelta(seconds=_YEAR)

    time.time, datetime.datetime = (lambda: now() - _YEAR), Back


def clock_set_back(bench: Bench) -> None:
    """A run killed and resumed with the clock set back by a year, so that all files are from the future."""
    name = bench.dice.choice(("run", "kept fields", "search"))
    job = jobs(bench)[name]()
    bench.ready(job)
    child = bench.begin(*job.arguments)
    time.sleep(bench.dice.uniform(0.3, 1.0) * bench.whole[job.name])
    os.kill(child.pid, signal.SIGKILL)
    child.end()
    for path in (*bench.work.iterdir(), *(bench.folder / "cache").rglob("*")):
        os.utime(path, (time.time() + _YEAR,) * 2)
    wrong = bench.resumed(job, prepare=_set_back)
    bench.note("clock set back, files of the future", "resumed", "; ".join(wrong))


def together(bench: Bench) -> None:
    """Two or four processes at once on one result: one writes it, the others report that or find it finished."""
    name, count = bench.dice.choice(("run", "kept fields", "search")), bench.dice.choice((2, 4))
    job = jobs(bench)[name]()
    bench.ready(job)
    children = []
    for _ in range(count):
        children.append(bench.begin(*job.arguments))
        time.sleep(bench.dice.choice((0.0, 0.0, 0.3)))
    ends = [child.end() for child in children]
    wrong = _ends(ends)
    if not any(end.code == 0 for end in ends):
        wrong.append(f"none wrote it: {' | '.join(end.err[-200:] for end in ends)}")
    elif not bench.is_whole(job):
        wrong.append("the file differs")
    bench.clear(job)
    bench.note(f"{count} processes on one result", f"{sum(end.code == 0 for end in ends)} complete", "; ".join(wrong))


def empty_cache(bench: Bench) -> None:
    """Two or four processes at once that compile the same code into an empty cache."""
    count = bench.dice.choice((2, 4))
    other = bench.folder / "empty"
    other.mkdir(mode=0o700)
    environment = bench.environment | {"XDG_CACHE_HOME": str(other)}
    made = [Job("small", (), f"of_empty{i}.h5", "") for i in range(count)]
    line = ("run", "small.toml", "--no-plots", "--quiet", "--out")
    ends = [child.end() for child in [bench.begin(*line, job.result, environment=environment) for job in made]]
    wrong = _ends(ends)
    if "small" not in bench.held:
        bench.held["small"] = bench.contents(made[0].result)
    wrong += [] if all(end.code == 0 for end in ends) and all(map(bench.is_whole, made)) else ["a file differs"]
    if list(other.rglob("*.tmp*")):
        wrong.append("drafts of machine code are left")
    for job in made:
        bench.clear(job)
    shutil.rmtree(other)
    bench.note(f"{count} processes on an empty cache", "all complete", "; ".join(wrong))


def _ends(ends: list[Ended]) -> list[str]:
    return [end.fault for end in ends if end.fault]
