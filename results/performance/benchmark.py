"""Speed and error of the engine against hand-written C++; writes performance.md.

    python results/performance/benchmark.py

needs g++ on the path; `results/accuracy/coarse.py` times the bundled studies. Both sides of a contest run in this
process, on one thread and on the same inputs, in turns: engine, C++, engine, C++ … What is measured is processor time,
which other users of the machine disturb less than wall time.
"""

import ctypes
import math
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

# Otherwise an idle OpenMP thread would spin on the core while the other side runs.
os.environ["OMP_WAIT_POLICY"] = "passive"

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from machines import BASELINE_PATHS, CASES, all_numbers
from measuring import alternating_times, processor, sample

from engine import Machine, scene_numbers
from engine.scene.scene import Numbers

HERE = Path(__file__).parent
# The number of variants that `sweeps run` evaluates at once.
VARIANTS, POSITIONS, ROUNDS = 16_384, 720, 9
COMPILER = ["g++", "-std=c++17", "-O3", "-march=native", "-ffast-math", "-fopenmp", "-shared", "-fPIC"]
# GCC too prefers half the width on Intel's processors with AVX-512.
WIDE = "-mprefer-vector-width=512"
FIELDS = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment"]
STROKES = {"press": "ram.stroke", "four_bar": "rocker.swing", "six_bar": "lever.swing"}
SUMMARIES = ["required_drive_moment", "required_power", "excess_work"]
SUMMARIES += ["flywheel_excess_work", "flywheel_merzalov", "flywheel_wittenbauer", "speed_fluctuation"]
PAIRS = ["input", *(f"{group}.{pair}" for group in "gh" for pair in ("first", "inner", "second"))]
REACTIONS = [*(f"{pair}.reaction_{axis}" for pair in PAIRS for axis in "xy"), "input_moment_by_equilibrium"]
# Accuracy of the truth, and permitted difference of both sides, which is rounding.
TRUE_ACCURACY, AGREEMENT = 1e-12, 1e-10

phi = np.arange(POSITIONS) * (2 * math.pi / POSITIONS)
cosines, sines, h = np.cos(phi), np.sin(phi), phi[1]


def asked(name: str) -> list[str]:
    """Summaries of a flywheel study of a machine, in the order of the C++."""
    return [*SUMMARIES, STROKES[name], "input_moment.peak"]


class Contest(NamedTuple):
    """Times in µs per variant (sides, rounds): of the engine, of the C++ as usual and with vectors of 512 bits."""

    case: str
    times: np.ndarray

    def row(self) -> str:
        """Line of the table."""
        engine, *rivals = self.times
        cells = [f"{np.median(engine):.2f}"]
        for rival in rivals:
            ratios = engine / rival
            spread = f"({ratios.min():.2f} – {ratios.max():.2f})"
            cells += [f"{np.median(rival):.2f}", f"{np.median(ratios):.2f} {spread}"]
        return f"| {self.case} | {' | '.join(cells)} |"


def contest(case: str, engine: Callable, *rivals: Callable) -> Contest:
    """Processor times of all sides in turns."""
    found = Contest(case, alternating_times((engine, *rivals), ROUNDS) * 1e6 / VARIANTS)
    print(found.row(), flush=True)
    return found


def require_agreement(case: str, found: np.ndarray, expected: np.ndarray, scale: np.ndarray) -> None:
    """Stop the benchmark if the two sides computed different results."""
    worst = float(np.max(np.abs(found - expected) / scale))
    if not worst < AGREEMENT:
        raise SystemExit(f"{case}: the two sides differ by {worst:.1e} of their scale, more than {AGREEMENT:.0e}")


# The C++ baseline

Builds = list[ctypes.CDLL]


def build_baseline(folder: str, *options: str) -> ctypes.CDLL:
    """Compile the baseline."""
    library = Path(folder) / f"baseline{''.join(options)}.so"
    subprocess.run([*COMPILER, *options, "-o", library, HERE / "baseline.cpp"], check=True)
    baseline = ctypes.CDLL(str(library))
    baseline.use_threads(1)
    return baseline


def calls(builds: Builds, function: str, *arguments: object) -> list[Callable[[], None]]:
    """Calls of a C++ function in each build, with its arguments converted in advance."""
    converted = {np.ndarray: lambda a: a.ctypes, float: ctypes.c_double, int: ctypes.c_int}
    return [partial(getattr(build, function), *(converted[type(a)](a) for a in arguments)) for build in builds]


def baseline_inputs(name: str, varied: dict[str, np.ndarray]) -> tuple:
    numbers = all_numbers(CASES[name], varied, BASELINE_PATHS[name])
    return numbers, numbers.shape[1], VARIANTS, POSITIONS, cosines, sines


# The contests


class Errors(NamedTuple):
    """Relative true errors of one side (variants, summaries), and which of them its estimates cover."""

    errors: np.ndarray
    covered: np.ndarray

    def cells(self) -> str:
        """Cells of the table: median and maximum error of the worst summary, and the share covered."""
        medians = np.median(self.errors, axis=0)
        return f"{medians.max():.1e} | {self.errors.max():.1e} | {100 * self.covered.mean():.2f} %"


def race_summaries(name: str, builds: Builds) -> tuple[Contest, Errors, Errors]:
    """Summaries of a flywheel study, and the errors of both sides."""
    varied, scene, names = sample(CASES[name], VARIANTS), CASES[name].scene, asked(name)
    machine = Machine(scene, names, varied=varied)
    values, figures = np.zeros((2, VARIANTS, len(names)))
    constants = (float(h), scene.input.speed, scene.flywheel.speed_fluctuation)
    rivals = calls(builds, f"{name}_summaries", *baseline_inputs(name, varied), *constants, values, figures)
    outcome = machine.evaluate(varied)
    rivals[0]()
    truth = Machine(scene, names, varied=varied, accuracy=TRUE_ACCURACY).evaluate(varied)
    own, own_figures, true, uncertainty = (
        np.stack([side[s] for s in names], axis=1)
        for side in (outcome.summaries, outcome.errors, truth.summaries, truth.errors)
    )
    # The mean moment may vanish: its error is relative to the excess work.
    scale = np.maximum(np.abs(true), true[:, 2:3] * np.array([s in SUMMARIES[:2] for s in names]))
    if name != "press":
        require_agreement(f"{name}, mean moment", own[:, 0], values[:, 0], scale[:, 0])
    found = contest(title(name), lambda: machine.evaluate(varied), *rivals)
    sides = []
    for side, side_figures in ((own, own_figures), (values, figures)):
        wrong = np.abs(side - true)
        sides.append(Errors(wrong / scale, wrong <= side_figures + uncertainty))
    return found, *sides


def race_fields(words: str, name: str, fields: list[str], builds: Builds, *constants: float) -> Contest:
    """Fields of a machine kept at 720 positions."""
    varied = sample(CASES[name], VARIANTS)
    machine = Machine(CASES[name].scene, fields=fields, varied=varied, positions=POSITIONS)
    buffer, rows = machine.new_buffer(VARIANTS), np.zeros((len(fields), VARIANTS, POSITIONS))
    buffer.fill(0)
    function = f"{name}_{'reactions' if fields == REACTIONS else 'fields'}"
    rivals = calls(builds, function, *baseline_inputs(name, varied), *constants, rows)
    machine.evaluate(varied, buffer=buffer)
    rivals[0]()
    # Reactions of one pair may be small compared with those of another.
    over = (0, 2) if fields == REACTIONS else 2
    require_agreement(f"{words}, {name}", buffer, rows, np.abs(rows).max(axis=over, keepdims=True))
    return contest(f"{words}: {title(name)}", partial(machine.evaluate, varied, buffer=buffer), *rivals)


def cycle_time(name: str) -> float:
    """Time of the cycle's evaluation in the contest of fields, which determines verdicts, in µs per variant."""
    varied = sample(CASES[name], VARIANTS)
    measuring = Machine(CASES[name].scene, fields=FIELDS, varied=varied, positions=POSITIONS)._measuring
    table = measuring.numbers(Numbers(scene_numbers(CASES[name].scene), varied), VARIANTS)
    measuring(table)
    return float(np.median(alternating_times([partial(measuring, table)], ROUNDS))) * 1e6 / VARIANTS


# The report


def title(name: str) -> str:
    return name.replace("_", "-")


def versions() -> str:
    found = [f"Python {platform.python_version()}"]
    found += [f"{package} {version(package)}" for package in ("numpy", "numba", "llvmlite")]
    compiler = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()
    return ", ".join([*found, f"g++ {compiler}"])


TEXT = """# Performance

Processor time on one thread, medians of {rounds} alternating runs in one process; ratios are medians of the runs'
pairs, with minimum and maximum. {variants} variants with varied lengths, masses and loads, so
each has a different motion. The machine is shared with others (load {load:.1f} on {cores} cores at the start).

{processor}; {system}; {versions}.
C++: `{compiler}`, as usual, and with `{wide}`, as the engine's own code where the processor
has such vectors at full clock. Made by `python results/performance/benchmark.py`.

Ratios depend on the processor: on an AMD EPYC, at commit 799b45ca, the engine took 0.90, 0.79 and 0.85 of the
C++ time for the summaries, and 1.83, 1.25 and 1.14 of it for I, dI/dφ and M.

## Summaries of a flywheel study

{names}: each with its error estimate. The engine measures them on separate panels for each variant, the C++ at
{positions} equally spaced positions. Errors are against the engine at accuracy {accuracy:g}, the same method with a
smaller tolerance (`results/accuracy/calibration.md` has an independent truth), relative to the summary, or to the
excess work for mean moment and power. The table gives median and maximum over the variants for the worst summary, and
the share of all errors that the error estimates cover.
"""


def report() -> str:
    """All tables."""
    load = os.getloadavg()[0]
    with tempfile.TemporaryDirectory() as folder:
        builds = [build_baseline(folder), build_baseline(folder, WIDE)]
        summaries = [race_summaries(name, builds) for name in CASES]
        fields = [race_fields("I, dI/dφ, M", name, FIELDS, builds) for name in CASES]
        speed = CASES["six_bar"].scene.input.speed
        words = "reactions of all pairs"
        fields.append(race_fields(words, "six_bar", REACTIONS, builds, speed))
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
        wide=WIDE,
        names=", ".join(f"`{name}`" for name in [*SUMMARIES, "input_moment.peak"]) + " and a stroke or swing",
        positions=POSITIONS,
        accuracy=TRUE_ACCURACY,
    )
    head = "engine [µs] | C++ [µs] | ratio | C++ of 512 bits [µs] | ratio |"
    lines = [words, f"| machine | {head}", "|---|---|---|---|---|---|", *(race.row() for race, _, _ in summaries), ""]
    lines += ["| machine | side | median error | maximum error | covered |", "|---|---|---|---|---|"]
    for race, ours, theirs in summaries:
        lines += [f"| {race.case} | engine | {ours.cells()} |", f"| | C++ | {theirs.cells()} |"]
    lines += ["", "## Kept fields", "", f"At {POSITIONS} positions; both sides agree to {AGREEMENT:g} of their scale."]
    lines += ["", f"| fields | {head}", "|---|---|---|---|---|---|", *(race.row() for race in fields), ""]
    lines += ["The engine's times include the evaluation of each variant's cycle, which gives its verdict:", cycles]
    lines += ["for I, dI/dφ and M. The C++ computes no verdicts and makes no checks.", ""]
    return "\n".join(lines)


def main() -> None:
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    if shutil.which("g++") is None:
        raise SystemExit("g++ isn't on the path: the baseline can't be compiled")
    (HERE / "performance.md").write_text(report(), encoding="utf8")
    print(HERE / "performance.md")


if __name__ == "__main__":
    main()
