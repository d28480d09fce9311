"""Part files, results and machine code changed, cut off, emptied or garbled: reported and repaired, or harmless."""

import os
import shutil
import signal
import time
from pathlib import Path
from random import Random

import numpy as np
from bench import Bench, Job, jobs

from sweeps.store import MappedResult, StoreError


def spoil(path: Path, dice: Random) -> str:
    """Damage a file; return the kind of damage."""
    content = bytearray(path.read_bytes())
    way = dice.choice(("bytes changed", "bytes changed", "bytes changed", "cut off", "emptied", "garbled"))
    if way == "cut off":
        del content[dice.randrange(len(content) + 1) :]
    elif way == "emptied":
        content.clear()
    elif content:
        # HDF5's tables are at the start of a file: half of the damage is there.
        reach = len(content) if dice.random() < 0.5 else min(len(content), 60_000)
        if way == "garbled":
            start = dice.randrange(reach)
            length = min(int(10 ** dice.uniform(1, 5)), len(content) - start)
            content[start : start + length] = dice.randbytes(length)
        else:
            for _ in range(dice.choice((1, 1, 8))):
                content[dice.randrange(reach)] ^= dice.randrange(1, 256)
    path.write_bytes(content)
    return way


def _small(bench: Bench) -> Job:
    line = ("run", "small.toml", "--no-plots", "--quiet", "--out", "spoilt.h5")
    job = Job("small", line, "spoilt.h5", "spoilt.part.h5")
    if job.name not in bench.whole:
        bench.ready(job)
        bench.command(*line)
        bench.good = (bench.work / job.result).read_bytes()
        bench.command("export", job.result, "--to", "good.csv")
        bench.clear(job)
    return job


def damage(bench: Bench) -> None:
    """A finished or unfinished result is damaged and read by some command, and its study run again."""
    job, wrong = _small(bench), []
    name = bench.dice.choice((job.result, job.part))
    path = bench.work / name
    path.write_bytes(bench.good)
    how = spoil(path, bench.dice)
    looks = {
        "show": ("show", name),
        "export": ("export", name, "--to", "of_export.csv"),
        "plot": ("plot", name, "--out", "of_plot.png"),
        "report": ("report", name, "--out", "of_page.html"),
        "compare": ("compare", name, name),
    }
    what = bench.dice.choice(("show", "show", "export", "export", "export", *looks))
    looked, verified = bench.command(*looks[what]), bench.command("verify", name)
    wrong += [f"{w}: {ended.fault}" for w, ended in ((what, looked), ("verify", verified)) if ended.fault]
    if looked.code == 0 and not _is_good(bench, job, name, what):
        wrong.append(f"{how}: {what} gives numbers that differ")
    again = bench.command(*job.arguments)
    if again.fault:
        wrong.append(f"run: {again.fault}")
    elif again.code == 0 and not _has_numbers(bench, job):
        wrong.append(f"{how}: run leaves other numbers")
    told = "reported" if verified.code else "without effect"
    mended = "repaired" if again.code == 0 else "refused with a message"
    kind = "finished" if name == job.result else "unfinished"
    bench.clear(job)
    for left in bench.work.glob("of_[epl]*"):
        left.unlink()
    bench.note(f"damaged {kind} files", f"{told}, {mended}", "; ".join(wrong and [how, *wrong]))


def _is_good(bench: Bench, job: Job, name: str, what: str) -> bool:
    """Whether the numbers shown of a file are those of the undamaged one."""
    if what == "export":
        return (bench.work / "of_export.csv").read_bytes() == (bench.work / "good.csv").read_bytes()
    try:
        columns, good = MappedResult(bench.work / name).columns, bench.held[job.name]
        # Other commands show columns over variants; fields aren't compared.
        return all(np.array(c).tobytes() == good[key] for key, c in columns.items() if np.ndim(c) == 1 and key in good)
    except (StoreError, OSError, KeyError):
        return False


def _has_numbers(bench: Bench, job: Job) -> bool:
    """Whether a file's columns equal the undamaged ones; damaged texts that were reported may stay."""
    columns, good = MappedResult(bench.work / job.result).columns, bench.held[job.name]
    return all(np.array(values).tobytes() == good[key] for key, values in columns.items())


def spoil_cache(bench: Bench) -> None:
    """One to three files of machine code are damaged: recompiled silently, with the same numbers."""
    job, wrong = _small(bench), ""
    files = sorted(path for path in (bench.folder / "cache").rglob("*") if path.is_file())
    chosen = bench.dice.sample(files, bench.dice.choice((1, 1, 3)))
    ways = {spoil(path, bench.dice) for path in chosen}
    ended = bench.command(*job.arguments)
    if ended.code or ended.err:
        wrong = f"exit code {ended.code}: {ended.err[-300:]}"
    elif not bench.is_whole(job):
        wrong = "numbers differ"
    bench.clear(job)
    bench.note("damaged machine code", "recompiled or not needed", wrong and f"{sorted(ways)}: {wrong}")


def damage_search(bench: Bench) -> None:
    """The candidates of an unfinished search are damaged: it ends with the same result, or refuses to resume."""
    job, kept = jobs(bench)["search"](), bench.folder / "candidates.h5"
    bench.ready(job)
    if not kept.exists():
        child = bench.begin(*job.arguments)
        while len(bench.done(job)) < 6:
            time.sleep(0.01)
        os.kill(child.pid, signal.SIGKILL)
        child.end()
        shutil.copyfile(bench.work / job.part, kept)
    shutil.copyfile(kept, bench.work / job.part)
    how = spoil(bench.work / job.part, bench.dice)
    ended = bench.command(*job.arguments)
    wrong = ended.fault or ("" if ended.code or bench.is_whole(job) else "the search ends elsewhere")
    bench.clear(job)
    way = "refused with a message" if ended.code else "repaired"
    bench.note("damaged candidates of a search", way, wrong and f"{how}: {wrong}")
