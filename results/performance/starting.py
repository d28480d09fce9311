"""Cost of starting: first runs, repeats, single commands, new kinds of groups; writes starting.md.

    python results/performance/starting.py

Commands run one after another, each in a separate process, in an empty folder and with a cache of machine code that
is empty at first. A machine's first answer is timed within its process, after the imports.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

HERE, ROOT = Path(__file__).parent, Path(__file__).parents[2]
# Load per core, without that of the commands, below which the machine counts as quiet.
QUIET = 0.25
SIX_BAR, FOUR_BAR, WHITWORTH = (
    f"{ROOT}/sweeps/templates/linkages/{name}.toml" for name in ("watt_six_bar", "four_bar", "whitworth")
)
SWEEPS = ["-m", "sweeps"]
RUN = [*SWEEPS, "run", "crank_press", "--quiet"]
# Commands, in order, and the limits of their processor time and wall time [s].
COMMANDS = {
    "`sweeps run crank_press` in an empty cache": (RUN, 12.0, 8.0),
    "the same again": ([*RUN, "--restart"], 2.0, 2.0),
    "after a number is edited": ([*RUN, "--restart", "--set", "bodies.ram_body.mass=300 kg"], 2.0, 2.0),
    "`sweeps run four_bar.toml`, a new structure": ([*SWEEPS, "run", FOUR_BAR, "--quiet"], 3.5, 3.5),
    "`sweeps check watt_six_bar.toml`, a new structure": ([*SWEEPS, "check", SIX_BAR], 1.5, 1.5),
    "`sweeps check watt_six_bar.toml` again": ([*SWEEPS, "check", SIX_BAR], 1.5, 1.5),
    "`sweeps plot whitworth.toml`, a new structure": ([*SWEEPS, "plot", WHITWORTH, "--out", "p.png"], 1.5, 1.5),
    "`sweeps show results/crank_press.h5`": ([*SWEEPS, "show", "results/crank_press.h5"], 1.5, 1.5),
    "`sweeps --help`": ([*SWEEPS, "--help"], None, None),
    "`from engine import Machine`": (["-c", "from engine import Machine"], None, None),
}
# First answers of machines, in order: template or study, summaries, limit [s].
MACHINES = {
    "a triad": ("triad", ["plate.swing"], 2.0),
    "a first cam": ("valve_gear", ["valve.stroke"], 2.0),
    "unloaded arcs of a machine that has run": ("crank_press", ["input.unloaded_arc_of_frame"], 1.5),
    "averages of a machine that has run": ("crank_press", ["input.reaction.mean"], 1.5),
    "extremes of a machine that has run": ("crank_press", ["input.reaction.max"], 1.5),
}
FIRST_ANSWER = """
import sys, time
from engine import Machine
from sweeps import read_study
from sweeps.study.bundled import bundled_studies
from sweeps.text.templates import bundled_templates
scene = read_study({**bundled_templates(), **bundled_studies()}[sys.argv[1]]).scene
begin = time.process_time(), time.perf_counter()
Machine(scene, sys.argv[2:]).evaluate({})
print(time.process_time() - begin[0], time.perf_counter() - begin[1])
"""


class Start(NamedTuple):
    """Processor time and wall time [s], and the load of the machine before."""

    processor: float
    wall: float
    load: float

    def row(self, label: str, limits: tuple[float | None, float | None]) -> str:
        """Row of a table."""
        cells = [f"{used:.1f}" + (f" (≤ {most:g})" if most else "") for used, most in zip(self, limits, strict=False)]
        return f"| {label} | {' | '.join(cells)} | {self.load:.1f} |"


def started(*words: str, cache: str) -> tuple[Start, str]:
    """A Python process with its output."""
    variables = {"XDG_CACHE_HOME": cache, "PYTHONPYCACHEPREFIX": f"{cache}/bytecode", "PYTHONPATH": str(ROOT)}
    kept = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    load, begin, before = os.getloadavg()[0], time.perf_counter(), resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [sys.executable, *words], env=kept | variables, cwd=cache, capture_output=True, text=True, check=False
    )
    wall, after = time.perf_counter() - begin, resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        raise SystemExit(f"{' '.join(words)}: {done.stderr}")
    return Start(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, wall, load), done.stdout


def rows() -> list[str]:
    """All starts, in order."""
    found = []

    def add(label: str, start: Start, *limits: float | None) -> None:
        found.append(start.row(label, limits))
        print(found[-1], flush=True)

    with tempfile.TemporaryDirectory() as cache:
        for label, (words, *limits) in COMMANDS.items():
            add(label, started(*words, cache=cache)[0], *limits)
        for label, (name, summaries, limit) in MACHINES.items():
            start, said = started("-c", FIRST_ANSWER, name, *summaries, cache=cache)
            add(label, Start(*map(float, said.split()), start.load), limit, limit)
    return found


def main() -> None:
    load, cores = os.getloadavg()[0], os.cpu_count()
    state = "quiet" if load < QUIET * cores else "busy: wall times are those of a shared machine"
    head = f"# Starting\n\n{cores} cores, load {load:.1f} at the start ({state}). In brackets: the target.\n"
    table = ["| start | processor time [s] | wall time [s] | load before |", "|---|---|---|---|", *rows()]
    made = "\nMade by `python results/performance/starting.py`.\n"
    (HERE / "starting.md").write_text("\n".join([head, *table, made]), encoding="utf8")
    print(HERE / "starting.md")


if __name__ == "__main__":
    main()
