"""Faults done on purpose to runs, result files and the cache of machine code; writes `reliability.md` beside this file.

    python results/reliability/campaign.py --kills 40 --signals 40 --spoilt 200 --caches 6 --full 30

Each fault falls at a random moment or place, of a seed. A run counts as well when what it leaves behind, and what the
same command makes of it afterwards, is bit for bit what an undisturbed run gives; whatever a command says, it has to be
words and no traceback. Disks are small tmpfs mounts where these are allowed; else file sizes are limited.
"""

import argparse
import os
import platform
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from sweeps.__main__ import start
from sweeps.store import MappedResult, StoreError
from sweeps.text.templates import template_text

STUDY = """scene = "scene.toml"

[vary]
"input.length" = { from = "30 mm", to = "60 mm", count = 60000 }
"input.speed" = { values = ["200 rpm", "250 rpm", "300 rpm", "350 rpm"] }

[outputs]
summaries = ["piston.stroke", "required_power", "excess_work"]
fields = ["piston.slide"]

[best]
minimise = "required_power"
"""
HEAD = "positions = 24\n"
# What follows a signal is to be over within this [s]; the machine may be busy.
AT_ONCE = 1.0
# Python's own start, before the first line of the program, is not the program's [s].
PYTHON_S_START = 0.3


class Campaign:
    """The undisturbed run, and what came of the disturbed ones.

    Parameters
    ----------
    folder : Path
        Scratch folder.
    seed : int
    """

    def __init__(self, folder: Path, seed: int) -> None:
        self.folder, self.dice, self.rows, self.faults = folder, random.Random(seed), [], []
        (folder / "scene.toml").write_text(template_text("slider_crank"), encoding="utf8")
        (folder / "study.toml").write_text(HEAD + STUDY, encoding="utf8")
        small = STUDY.replace("count = 60000", "count = 150")
        (folder / "small.toml").write_text(HEAD + small, encoding="utf8")
        self.environment = {**os.environ, "XDG_CACHE_HOME": str(folder / "cache")}
        (folder / "cache").mkdir(exist_ok=True)
        self.command("run", "study.toml", "--no-plots", "--quiet", "--out", "reference.h5")
        start = time.monotonic()
        self.command("run", "study.toml", "--no-plots", "--quiet", "--out", "reference.h5", "--restart")
        self.whole = time.monotonic() - start
        self.reference = self.columns("reference.h5")

    def command(self, *arguments: str, **options: object) -> subprocess.CompletedProcess:
        """A command as a process, to its end."""
        return subprocess.run(self._line(*arguments), capture_output=True, text=True, **self._options(options))

    def forked(self, *arguments: str) -> subprocess.CompletedProcess:
        """A command in a fork of this process, which has everything loaded already."""
        paths = [self.folder / "fork.out", self.folder / "fork.err"]
        child = os.fork()
        if child == 0:
            os.chdir(self.folder)
            os.environ.update(self.environment)
            for number, path in enumerate(paths, 1):
                os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
            sys.argv = ["sweeps", *arguments]
            try:
                start()
            except SystemExit as ending:
                os._exit(ending.code or 0)
            except BaseException:
                traceback.print_exc()
                sys.stderr.flush()
            os._exit(99)
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        return subprocess.CompletedProcess(arguments, code, *(path.read_text(errors="replace") for path in paths))

    def started(self, *arguments: str) -> subprocess.Popen:
        """A command as a process that goes on."""
        pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
        return subprocess.Popen(self._line(*arguments), **pipes, **self._options({"preexec_fn": heeding}))

    def _line(self, *arguments: str) -> list[str]:
        return [sys.executable, "-m", "sweeps", *arguments]

    def _options(self, options: dict) -> dict:
        return {"cwd": self.folder, "env": self.environment} | options

    def columns(self, name: str) -> dict[str, np.ndarray]:
        """All columns of a file in memory."""
        return {key: np.array(values) for key, values in MappedResult(self.folder / name).columns.items()}

    def is_whole(self, name: str) -> bool:
        """Whether a finished file holds what the undisturbed run's does."""
        found = self.columns(name)
        return all(found[key].tobytes() == values.tobytes() for key, values in self.reference.items())

    def flagged_are_right(self, name: str) -> bool:
        """Whether all that an unfinished file calls done is what the undisturbed run has there."""
        part = MappedResult(self.folder / name)
        if part.damaged():
            return False
        blocks = [part.rows(int(i)) for i in np.flatnonzero(part.done)]
        names = self.reference
        return all(part.columns[key][rows].tobytes() == names[key][rows].tobytes() for rows in blocks for key in names)

    def note(self, fault: str, ways: Counter, wrong: list[str], more: str = "") -> None:
        """A row of the table."""
        told = ", ".join(f"{count} {way}" for way, count in sorted(ways.items(), key=lambda pair: -pair[1]))
        self.rows.append((fault, sum(ways.values()), told + (f"; {more}" if more else ""), len(wrong)))
        self.faults += [f"{fault}: {text}" for text in wrong]
        print(*self.rows[-1], *wrong[:3], sep=" | ", flush=True)

    def cleared(self, *names: str) -> None:
        """Remove what there is of some results."""
        for name in names:
            for path in self.folder.glob(f"{name}*"):
                path.unlink()


def heeding() -> None:
    """Heed Ctrl-C, which what is started in the background ignores."""
    signal.signal(signal.SIGINT, signal.default_int_handler)


def wordless(answer: subprocess.CompletedProcess) -> str:
    """What is wrong with how a command ended: a traceback, a crash, or nothing said of a failure; "" if nothing."""
    if "Traceback" in answer.stderr + answer.stdout or "Exception ignored" in answer.stderr:
        return f"traceback: {answer.stderr[-300:]}"
    if answer.returncode not in (0, 1, 2):
        return f"exit code {answer.returncode}"
    return "" if answer.returncode == 0 or answer.stderr else "failed without a word"


def kills(campaign: Campaign, count: int) -> None:
    """Runs killed again and again until they are through."""
    run, ways, wrong = ("run", "study.toml", "--no-plots", "--quiet", "--out", "k.h5"), Counter(), []
    for _ in range(count):
        process = campaign.started(*run)
        time.sleep(campaign.dice.uniform(0, campaign.whole))
        process.kill()
        process.communicate()
        if (campaign.folder / "k.h5").exists():
            ways["after the end"] += 1
            if not campaign.is_whole("k.h5"):
                wrong.append("finished file differs")
            campaign.cleared("k.")
        elif (campaign.folder / "k.part.h5").exists():
            ways["between blocks"] += 1
            if not campaign.flagged_are_right("k.part.h5"):
                wrong.append("a block flagged as done differs")
        else:
            ways["before the file"] += 1
    answer = campaign.command(*run)
    if wordless(answer) or not campaign.is_whole("k.h5"):
        wrong.append(f"the last run: {wordless(answer) or 'differs'}")
    campaign.cleared("k.")
    campaign.note("kill −9 while running", ways, wrong)


def signals(campaign: Campaign, count: int) -> None:
    """SIGINT and SIGTERM at random moments, from Python's own start to the last picture."""
    run, ways, wrong, slowest = ("run", "study.toml", "--out", "s.h5"), Counter(), [], 0.0
    for i in range(count):
        number, code = ((signal.SIGINT, 130), (signal.SIGTERM, 143))[i % 2]
        process = campaign.started(*run)
        after = campaign.dice.uniform(0, 1.5 * campaign.whole)
        time.sleep(after)
        alive = process.poll() is None
        begun = time.monotonic()
        process.send_signal(number)
        _, said = process.communicate()
        took = time.monotonic() - begun
        if not alive:
            ways["after the end"] += 1
        elif process.returncode == 0 and (campaign.folder / "s.h5").exists():
            ways["while Python ended, all done"] += 1
        elif process.returncode in (-number, 1) and after < PYTHON_S_START:
            ways["in Python's own start"] += 1
        else:
            slowest = max(slowest, took)
            ways[f"exit code {process.returncode}"] += 1
            told = [line for line in said.splitlines() if line.startswith("Interrupted: ")]
            if process.returncode != code or len(told) != 1 or "Traceback" in said or took > AT_ONCE:
                wrong.append(f"after {after:.2f} s: exit code {process.returncode} in {took:.2f} s: {said[-200:]!r}")
        if list(campaign.folder.glob(".*")):
            wrong.append("a draft is left")
        if (campaign.folder / "s.part.h5").exists() and not campaign.flagged_are_right("s.part.h5"):
            wrong.append("a block flagged as done differs")
        if (campaign.folder / "s.h5").exists():
            if not campaign.is_whole("s.h5"):
                wrong.append("finished file differs")
            campaign.cleared("s.", "s_")
    campaign.cleared("s.", "s_")
    campaign.note("SIGINT, SIGTERM", ways, wrong, f"longest from signal to end {slowest:.2f} s")


def spoil(path: Path, dice: random.Random) -> str:
    """Change some bytes of a file, or cut it off; return which of both."""
    content = bytearray(path.read_bytes())
    if dice.random() < 0.2:
        path.write_bytes(content[: dice.randrange(len(content))])
        return "cut off"
    # Tables of HDF5 lie at the beginning: half of the places are there.
    reach = len(content) if dice.random() < 0.5 else min(len(content), 60_000)
    for _ in range(dice.choice((1, 1, 8))):
        content[dice.randrange(reach)] ^= dice.randrange(1, 256)
    path.write_bytes(content)
    return "bytes changed"


def spoilt(campaign: Campaign, count: int) -> None:
    """Finished and unfinished files with bytes changed or cut off: told, and mended by the same command."""
    run = ("run", "small.toml", "--no-plots", "--quiet", "--out", "d.h5")
    campaign.command(*run)
    good = (campaign.folder / "d.h5").read_bytes()
    whole, reference = campaign.columns("d.h5"), campaign.reference
    campaign.reference = whole
    for name in ("d.h5", "d.part.h5"):
        ways, wrong = Counter(), []
        for _ in range(count // 2):
            campaign.cleared("d.")
            path = campaign.folder / name
            path.write_bytes(good)
            how = spoil(path, campaign.dice)
            shown, verified = campaign.forked("show", name), campaign.forked("verify", name)
            wrong += [f"{what}: {text}" for what, a in (("show", shown), ("verify", verified)) if (text := wordless(a))]
            if shown.returncode == 0:
                try:
                    found = campaign.columns(name)
                    # What is shown is of columns over variants; fields aren't looked at.
                    same = all(found[k].tobytes() == v.tobytes() for k, v in whole.items() if v.ndim == 1)
                except (StoreError, KeyError):
                    same = False
                if not same:
                    wrong.append(f"{how}: shown, though its numbers differ")
            answer = campaign.forked(*run)
            if text := wordless(answer):
                wrong.append(f"run: {text}")
            elif answer.returncode == 0 and not campaign.is_whole("d.h5"):
                wrong.append(f"{how}: run leaves other numbers")
            state = "told" if verified.returncode else "where nothing depends on it"
            mended = "mended" if answer.returncode == 0 else "refused in words"
            ways[f"{how}, {state}, {mended}"] += 1
        campaign.note(f"spoilt {'finished' if name == 'd.h5' else 'unfinished'} files", ways, wrong)
    campaign.reference = reference
    campaign.cleared("d.")


def caches(campaign: Campaign, count: int) -> None:
    """Files of machine code changed or cut off: made again, silently."""
    run, ways, wrong = ("run", "small.toml", "--no-plots", "--quiet", "--out", "c.h5", "--restart"), Counter(), []
    campaign.command(*run)
    whole = campaign.columns("c.h5")
    for _ in range(count):
        files = sorted(p for p in (campaign.folder / "cache").rglob("*") if p.is_file())
        for path in campaign.dice.sample(files, 3):
            ways[spoil(path, campaign.dice)] += 1
        answer = campaign.command(*run)
        found = campaign.columns("c.h5")
        if answer.returncode or answer.stderr or any(found[k].tobytes() != v.tobytes() for k, v in whole.items()):
            wrong.append(f"exit code {answer.returncode}: {answer.stderr[-300:]}")
    campaign.cleared("c.h5")
    campaign.note("spoilt machine code", ways, wrong)


@contextmanager
def small_disk(folder: Path, size: int, read_only: bool = False) -> Iterator[bool]:
    """A disk of so many bytes mounted on a folder; yields whether that is allowed here."""
    folder.mkdir(exist_ok=True)
    line = ["mount", "-t", "tmpfs", "-o", f"size={size}{',ro' if read_only else ''}", "none", str(folder)]
    allowed = subprocess.run(line, capture_output=True).returncode == 0
    try:
        yield allowed
    finally:
        if allowed:
            subprocess.run(["umount", str(folder)], check=True)


def limited(size: int) -> Callable[[], None]:
    """What limits the size of files in a child."""

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))

    return limit


def full_disks(campaign: Campaign, count: int) -> None:
    """Disks that are full sooner or later, or read-only, under results, pictures, exports and the cache."""
    campaign.command("run", "small.toml", "--no-plots", "--quiet", "--out", "f.h5")
    commands = [
        ("run", "small.toml", "--quiet", "--out", "disk/r.h5"),
        ("plot", "f.h5", "--out", "disk/p.png"),
        ("export", "f.h5", "--to", "disk/e.csv"),
        ("export", "scene.toml", "--to", "disk/s.svg"),
        ("animate", "scene.toml", "--frames", "6", "--out", "disk/a.gif"),
    ]
    ways, wrong = Counter(), []
    for i in range(count):
        command, size = commands[i % len(commands)], int(10 ** campaign.dice.uniform(3.6, 6.3))
        read_only = campaign.dice.random() < 0.2
        with small_disk(campaign.folder / "disk", max(size, 4096), read_only) as allowed:
            options = {} if allowed else {"preexec_fn": limited(size)}
            answer = campaign.command(*command, **options)
            what = "read-only" if read_only and allowed else ("full" if allowed else "file size limited")
            ways[f"{what}, {'told' if answer.returncode else 'enough room'}"] += 1
            if text := wordless(answer):
                wrong.append(f"{command[0]} {size}: {text}")
            left = [p.name for p in (campaign.folder / "disk").glob(".*")]
            if left:
                wrong.append(f"{command[0]}: drafts are left: {left}")
        shutil.rmtree(campaign.folder / "disk", ignore_errors=True)
    (campaign.folder / "full").mkdir(exist_ok=True)
    with small_disk(campaign.folder / "full", 40_960) as allowed:
        if allowed:
            elsewhere = {**campaign.environment, "XDG_CACHE_HOME": str(campaign.folder / "full")}
            answer = campaign.command("run", "small.toml", "--no-plots", "--quiet", "--out", "x.h5", env=elsewhere)
            said = answer.stderr.count("Machine code is compiled in every run")
            ways["full under the cache, told once" if said == 1 else "full under the cache"] += 1
            if answer.returncode or said != 1:
                wrong.append(f"cache on a full disk: {answer.stderr[-300:]}")
    campaign.cleared("f.h5", "x.h5")
    campaign.note("full and read-only disks", ways, wrong)


def main() -> None:
    """Do the faults and write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, usual in (("kills", 40), ("signals", 40), ("spoilt", 200), ("caches", 6), ("full", 30), ("seed", 1)):
        parser.add_argument(f"--{name}", type=int, default=usual)
    asked = parser.parse_args()
    line = " ".join(f"--{name} {value}" for name, value in vars(asked).items())
    begun = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="reliability-") as folder:
        campaign = Campaign(Path(folder), asked.seed)
        for kind, count in (
            (kills, asked.kills),
            (signals, asked.signals),
            (full_disks, asked.full),
            (spoilt, asked.spoilt),
            (caches, asked.caches),
        ):
            kind(campaign, count)
            minutes = (time.monotonic() - begun) / 60
            text = report(campaign, line, minutes)
            (Path(__file__).parent / "reliability.md").write_text(text, encoding="utf8")


def report(campaign: Campaign, line: str, minutes: float) -> str:
    """The table so far, and what went wrong."""
    rows = [f"| {fault} | {count} | {told} | {wrong} |" for fault, count, told, wrong in campaign.rows]
    wrong = [f"- {' '.join(text.split())}" for text in campaign.faults]
    return "\n".join(
        [
            "# Faults done on purpose",
            "",
            f"`python results/reliability/campaign.py {line}`; {minutes:.0f} minutes on {os.cpu_count()} cores,",
            f"{platform.system()} {platform.machine()}, Python {platform.python_version()}.",
            "",
            "A run counts as wrong when something flagged as done differs from an undisturbed run, the same command",
            "doesn't mend it or refuse in words, numbers that changed are shown, a draft stays, a signal isn't obeyed",
            f"within {AT_ONCE:g} s, or anything but words is said.",
            "",
            "| fault | times | what came of it | wrong |",
            "|---|---|---|---|",
            *rows,
            *(["", "What went wrong:", "", *wrong] if wrong else []),
            "",
        ]
    )


if __name__ == "__main__":
    main()
