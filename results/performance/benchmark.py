"""Speed and error of the engine against hand-written C++; writes performance.md.

    python results/performance/benchmark.py
    python results/performance/benchmark.py --before ../version-0.1

makes all tables; with the path of a checkout of version 0.1 the bundled studies are timed with it too. Needs g++ on the
path. Both sides of a contest run in this process, on one thread and on the same inputs, in turns: engine, C++, engine,
C++ … What is measured is processor time, which other users of the machine disturb less than the time of the clock.
"""

import argparse
import ctypes
import json
import math
import os
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

# An idle OpenMP thread would otherwise spin on the core that the other side needs in its turn.
os.environ["OMP_WAIT_POLICY"] = "passive"

import numpy as np
from machines import BASELINE_PATHS, CASES, all_numbers, sample

from engine import Machine, scene_numbers

HERE = Path(__file__).parent
# As many variants as `sweeps run` evaluates at once.
VARIANTS, POSITIONS, ROUNDS = 16_384, 720, 9
COMPILER = ["g++", "-std=c++17", "-O3", "-march=native", "-ffast-math", "-fopenmp", "-shared", "-fPIC"]
FIELDS = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment"]
STROKES = {"press": "ram.stroke", "four_bar": "rocker.swing", "six_bar": "lever.swing"}
SUMMARIES = ["required_drive_moment", "required_power", "excess_work"]
SUMMARIES += ["flywheel_excess_work", "flywheel_merzalov", "flywheel_wittenbauer", "speed_fluctuation"]
PAIRS = ["input", *(f"{group}.{pair}" for group in "gh" for pair in ("first", "inner", "second"))]
REACTIONS = [*(f"{pair}.reaction_{axis}" for pair in PAIRS for axis in "xy"), "input_moment_by_equilibrium"]
STUDIES = ("compressor", "four_stroke_engine", "jaw_crusher", "engine_bearings", "four_bar_counterweights")
STUDY_VARIANTS = 1000
# Truth, and how far the mean moments of both sides may differ where no load sets in: rounding.
TRUE_ACCURACY, AGREEMENT = 1e-12, 1e-10
MEMORY_VARIANTS, MEMORY_BLOCK = 200_000, 16_384

phi = np.arange(POSITIONS) * (2 * math.pi / POSITIONS)
cosines, sines, h = np.cos(phi), np.sin(phi), phi[1]


def asked(name: str) -> list[str]:
    """Summaries of a flywheel study of a machine, in the order of the C++."""
    return [*SUMMARIES, STROKES[name], "input_moment.peak"]


class Contest(NamedTuple):
    """Times of two sides in µs per variant, one of each per round."""

    case: str
    engine: np.ndarray
    rival: np.ndarray

    def row(self) -> str:
        """Line of the table."""
        ratios = self.engine / self.rival
        times = f"{np.median(self.engine):.2f} | {np.median(self.rival):.2f}"
        return f"| {self.case} | {times} | {np.median(ratios):.2f} | {ratios.min():.2f} – {ratios.max():.2f} |"


def contest(case: str, engine: Callable, rival: Callable) -> Contest:
    """Processor times of two sides in turns."""
    times = np.empty((2, ROUNDS))
    for turn in range(ROUNDS):
        for side, run in enumerate((engine, rival)):
            start = time.process_time()
            run()
            times[side, turn] = time.process_time() - start
    found = Contest(case, *(times * 1e6 / VARIANTS))
    print(found.row(), flush=True)
    return found


def require_agreement(case: str, found: np.ndarray, expected: np.ndarray, scale: np.ndarray) -> None:
    """Stop the benchmark where two sides computed different things."""
    worst = float(np.max(np.abs(found - expected) / scale))
    if not worst < AGREEMENT:
        raise SystemExit(f"{case}: the two sides differ by {worst:.1e} of their scale, more than {AGREEMENT:.0e}")


# The C++ baseline


def build_baseline(folder: str) -> ctypes.CDLL:
    """Compile the baseline."""
    library = Path(folder) / "baseline.so"
    subprocess.run([*COMPILER, "-o", library, HERE / "baseline.cpp"], check=True)
    baseline = ctypes.CDLL(str(library))
    baseline.use_threads(1)
    return baseline


def call(function: Callable, *arguments: object) -> Callable[[], None]:
    """The call of a C++ function with its arguments converted beforehand."""
    converted = []
    for a in arguments:
        if isinstance(a, np.ndarray):
            converted.append(a.ctypes.data_as(ctypes.c_void_p))
        else:
            converted.append(ctypes.c_double(a) if isinstance(a, float) else ctypes.c_int(a))

    def run(keep: tuple = arguments) -> None:
        function(*converted)

    return run


def baseline_inputs(name: str, varied: dict[str, np.ndarray]) -> tuple:
    numbers = all_numbers(CASES[name], varied, BASELINE_PATHS[name])
    return numbers, numbers.shape[1], VARIANTS, POSITIONS, cosines, sines


def geometry_and_loads(name: str) -> dict[str, np.ndarray]:
    case = CASES[name]
    return sample(case, {**case.geometry, **case.loads}, VARIANTS)


# The contests


class Errors(NamedTuple):
    """True errors of one side, relative, of all summaries (variants, summaries), and which its figures cover."""

    errors: np.ndarray
    covered: np.ndarray

    def cells(self) -> str:
        """Cells of the table: of the worst summary, the median and the greatest error; the share that is covered."""
        medians = np.median(self.errors, axis=0)
        return f"{medians.max():.1e} | {self.errors.max():.1e} | {100 * self.covered.mean():.2f} %"


def race_summaries(name: str, baseline: ctypes.CDLL) -> tuple[Contest, Errors, Errors]:
    """Summaries of a flywheel study, and how true both sides are."""
    varied, scene, names = geometry_and_loads(name), CASES[name].scene, asked(name)
    machine = Machine(scene, names, varied=varied)
    values, figures = np.zeros((2, VARIANTS, len(names)))
    constants = (float(h), scene.input.speed, scene.flywheel.speed_fluctuation)
    rival = call(getattr(baseline, f"{name}_summaries"), *baseline_inputs(name, varied), *constants, values, figures)
    outcome = machine.evaluate(varied)
    rival()
    truth = Machine(scene, names, varied=varied, accuracy=TRUE_ACCURACY).evaluate(varied)
    own, own_figures, true, doubt = (
        np.stack([side[s] for s in names], axis=1)
        for side in (outcome.summaries, outcome.errors, truth.summaries, truth.errors)
    )
    # The mean moment may vanish: it is measured by the excess work.
    scale = np.maximum(np.abs(true), true[:, 2:3] * np.array([s in SUMMARIES[:2] for s in names]))
    if name != "press":
        require_agreement(f"{name}, mean moment", own[:, 0], values[:, 0], scale[:, 0])
    found = contest(title(name), lambda: machine.evaluate(varied), rival)
    sides = []
    for side, side_figures in ((own, own_figures), (values, figures)):
        wrong = np.abs(side - true)
        sides.append(Errors(wrong / scale, wrong <= side_figures + doubt))
    return found, *sides


def race_fields(name: str, baseline: ctypes.CDLL) -> Contest:
    """I, dI/dφ and M kept at 720 positions."""
    varied = geometry_and_loads(name)
    machine = Machine(CASES[name].scene, fields=FIELDS, varied=varied, positions=POSITIONS)
    buffer, rows = machine.new_buffer(VARIANTS), np.zeros((3, VARIANTS, POSITIONS))
    buffer.fill(0)
    rival = call(getattr(baseline, f"{name}_fields"), *baseline_inputs(name, varied), *rows)
    machine.evaluate(varied, buffer=buffer)
    rival()
    require_agreement(name, buffer, rows, np.abs(rows).max(axis=2, keepdims=True))
    return contest(f"I, dI/dφ, M: {title(name)}", partial(machine.evaluate, varied, buffer=buffer), rival)


def cycle_time(name: str) -> float:
    """Time of the cycle's evaluation in the contest of fields, from which verdicts follow, in µs per variant."""
    # Not in version 0.1, which runs this script too.
    from engine.scene.scene import Numbers

    varied = geometry_and_loads(name)
    measuring = Machine(CASES[name].scene, fields=FIELDS, varied=varied, positions=POSITIONS)._measuring
    table = measuring.numbers(Numbers(scene_numbers(CASES[name].scene), varied), VARIANTS)
    measuring(table)
    times = []
    for _ in range(ROUNDS):
        start = time.process_time()
        measuring(table)
        times.append(time.process_time() - start)
    return float(np.median(times)) * 1e6 / VARIANTS


def race_reactions(baseline: ctypes.CDLL) -> Contest:
    """Reactions in all pairs of the six-bar, kept at 720 positions."""
    name, varied = "six_bar", geometry_and_loads("six_bar")
    scene = CASES[name].scene
    machine = Machine(scene, fields=REACTIONS, varied=varied, positions=POSITIONS)
    buffer, rows = machine.new_buffer(VARIANTS), np.zeros((len(REACTIONS), VARIANTS, POSITIONS))
    buffer.fill(0)
    rival = call(baseline.six_bar_reactions, *baseline_inputs(name, varied), scene.input.speed, rows)
    machine.evaluate(varied, buffer=buffer)
    rival()
    # Reactions of one pair may be small beside those of another.
    require_agreement("reactions", buffer, rows, np.abs(rows).max(axis=(0, 2), keepdims=True))
    return contest(f"reactions of all pairs: {title(name)}", partial(machine.evaluate, varied, buffer=buffer), rival)


# What runs in a child of its own: `--child WORD …` prints what it measured


def child_study(name: str) -> dict[str, float]:
    """A bundled study: processor time of a variant [µs], and until the first [s]; in version 0.1 too."""
    import sweeps
    from sweeps import read_study

    # Versions differ in the folders they keep their studies in.
    files = (Path(sweeps.__file__).parent / "studies").rglob(f"{name}.toml")
    study = read_study(next(path for path in files if path.parent.name != "scenes"))
    machine = study.machine()
    values, dropped = study.values(0, min(STUDY_VARIANTS, study.design.size))
    varied = {path: np.asarray(values[path])[~dropped] for path in study.paths}
    begin = time.process_time()
    outcome = machine.evaluate(varied)
    first = time.process_time() - begin
    times = []
    for _ in range(ROUNDS):
        begin = time.process_time()
        machine.evaluate(varied)
        times.append(time.process_time() - begin)
    good = outcome.status == 0
    figures = []
    for summary, column in outcome.summaries.items():
        if not summary.endswith("_at"):
            with np.errstate(all="ignore"):
                figures.append(np.nanmedian((outcome.errors[summary] / np.abs(column))[good]))
    figure = float(np.nanmax(figures))
    used = outcome.status.size
    return {"time": float(np.median(times)) / used * 1e6, "first": first, "variants": used, "figure": figure}


def child_memory() -> list[float]:
    """Many variants in blocks, summaries only: seconds, peak memory before and after [MB]."""
    case = CASES["four_bar"]
    machine = Machine(case.scene, asked("four_bar"), varied={**case.geometry, **case.loads})
    machine.evaluate(sample(case, {**case.geometry, **case.loads}, 100))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start, left = time.process_time(), MEMORY_VARIANTS
    while left:
        count = min(left, MEMORY_BLOCK)
        machine.evaluate(sample(case, {**case.geometry, **case.loads}, count))
        left -= count
    seconds = time.process_time() - start
    return [seconds, before / 1024, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024]


CHILDREN = {"study": child_study, "memory": child_memory}


def in_child(*words: str, sources: Path | None = None) -> object:
    """What a child measures, with sources of its own."""
    environment = dict(os.environ)
    root = (sources or HERE.parents[1]).resolve()
    environment["PYTHONPATH"] = str(root)
    command = [sys.executable, str(HERE / "benchmark.py"), "--child", *words]
    done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=root, check=False)
    if done.returncode:
        raise SystemExit(f"{' '.join(words)}: {done.stderr}")
    return json.loads(done.stdout.splitlines()[-1])


# The report


def title(name: str) -> str:
    return name.replace("_", "-")


def before_lines(before: Path | None) -> list[str]:
    """The bundled studies with this version and with version 0.1, in turns."""
    label = f"| study | variants | now [µs] |{' version 0.1 [µs] | ratio |' if before else ''} estimate now |"
    lines = [label + (" figure 0.1 |" if before else ""), "|---" * (7 if before else 4) + "|"]
    for name in STUDIES:
        here = [in_child("study", name) for _ in range(2)]
        now = min(run["time"] for run in here)
        cells = [name.replace("_", " "), f"{here[0]['variants']}", f"{now:.1f}"]
        if before:
            there = [in_child("study", name, sources=before) for _ in range(2)]
            then = min(run["time"] for run in there)
            cells += [f"{then:.1f}", f"{now / then:.2f}", f"{here[0]['figure']:.0e}", f"{there[0]['figure']:.0e}"]
        else:
            cells.append(f"{here[0]['figure']:.0e}")
        lines.append(f"| {' | '.join(cells)} |")
        print(lines[-1], flush=True)
    return [*lines, ""]


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def versions() -> str:
    found = [f"Python {platform.python_version()}"]
    found += [f"{package} {version(package)}" for package in ("numpy", "numba", "llvmlite")]
    compiler = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()
    return ", ".join([*found, f"g++ {compiler}"])


TEXT = """# Performance

Processor time on one thread, medians of {rounds} alternating runs in one process; ratios are medians of the runs'
pairs, with the least and the greatest. {variants} variants, lengths, masses and loads varied: each has a motion
of its own. The machine is shared with others (load {load:.1f} on {cores} cores when this was begun).

{processor}; {system}; {versions}.
C++: `{compiler}`. Made by `python results/performance/benchmark.py{option}`.

Ratios depend on the processor: on an Intel Xeon with AVX-512, at commit 8b705021, the engine took 0.56, 0.48 and 0.66
of the C++ time for the summaries, and 1.55, 1.27 and 1.21 of it for I, dI/dφ and M.

## Summaries of a flywheel study

{names}: each with its error estimate. The engine measures them on panels of each variant's own, the C++ at {positions}
equally spaced positions. Errors are against the engine at accuracy {accuracy:g}, the same method driven further
(`results/accuracy/calibration.md` has an independent truth), relative to the summary, of mean moment and power to the
excess work: of the summary that is worst the median over the variants and the greatest, and the share of all errors
that the error estimates cover.
"""


def report(before: Path | None) -> str:
    """All tables."""
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        baseline = build_baseline(folder)
        summaries = [race_summaries(name, baseline) for name in CASES]
        fields = [*(race_fields(name, baseline) for name in CASES), race_reactions(baseline)]
        cycles = ", ".join(f"{cycle_time(name):.2f} µs ({title(name)})" for name in CASES)
    words = TEXT.format(
        rounds=ROUNDS,
        variants=VARIANTS,
        load=load,
        cores=os.cpu_count(),
        processor=processor(),
        system=platform.system(),
        versions=versions(),
        compiler=" ".join(COMPILER[:6]),
        option=" --before CHECKOUT" if before else "",
        names=", ".join(f"`{name}`" for name in [*SUMMARIES, "input_moment.peak"]) + " and a stroke or swing",
        positions=POSITIONS,
        accuracy=TRUE_ACCURACY,
    )
    head = "engine [µs] | C++ [µs] | ratio | least – greatest |"
    lines = [words, f"| machine | {head}", "|---|---|---|---|---|", *(race.row() for race, _, _ in summaries), ""]
    lines += ["| machine | side | median error | greatest error | covered |", "|---|---|---|---|---|"]
    for race, ours, theirs in summaries:
        lines += [f"| {race.case} | engine | {ours.cells()} |", f"| | C++ | {theirs.cells()} |"]
    lines += ["", "## Kept fields", "", f"At {POSITIONS} positions; both sides agree to {AGREEMENT:g} of their scale."]
    lines += ["", f"| fields | {head}", "|---|---|---|---|---|", *(race.row() for race in fields), ""]
    lines += ["The engine's times hold the evaluation of each variant's cycle, from which its verdict follows:", cycles]
    lines += ["for I, dI/dφ and M. The C++ judges nothing and checks nothing.", ""]
    lines += ["## Bundled studies", "", STUDY_TEXT, "", *before_lines(before), "## Memory", ""]
    seconds, first, peak = in_child("memory")
    text = (
        f"{MEMORY_VARIANTS} variants of the four-bar's flywheel study in blocks of {MEMORY_BLOCK}: {seconds:.1f} s of"
    )
    lines += [f"{text} processor time, peak {peak:.0f} MB resident,"]
    return "\n".join([*lines, f"of which {first:.0f} MB before the first block (Python, NumPy, Numba).", ""])


STUDY_TEXT = (
    f"Up to the first {STUDY_VARIANTS} variants of each bundled study, all of its summaries; µs of processor time per\n"
    "variant, the lower of two processes' medians. `estimate`: relative error estimate of the summary that is worst,\n"
    "median over the variants."
)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--before", type=Path, metavar="CHECKOUT", help="checkout of version 0.1 to compare with")
    parser.add_argument("--child", nargs="+", help=argparse.SUPPRESS)
    options = parser.parse_args()
    # One processor is one thread, for this version and any other.
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    if options.child:
        print(json.dumps(CHILDREN[options.child[0]](*options.child[1:])))
    elif shutil.which("g++") is None:
        raise SystemExit("g++ isn't on the path: the baseline can't be compiled")
    else:
        (HERE / "performance.md").write_text(report(options.before), encoding="utf8")
        print(HERE / "performance.md")


if __name__ == "__main__":
    main()
