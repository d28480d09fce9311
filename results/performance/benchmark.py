"""Speed of the engine against hand-written C++ and against pylinkage, and its memory; writes performance.md.

Every contest runs in this process, on the same inputs and into memory that has been touched, both sides with the
same number of threads, in turns: engine, rival, engine, rival … Outputs are compared before the clock starts.

    python results/performance/benchmark.py

needs g++ on the path; pylinkage (pip install pylinkage) is left out where it isn't installed.
"""

import argparse
import ctypes
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
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import NamedTuple

# An idle OpenMP thread would otherwise spin on the core that the other side needs in its turn.
os.environ["OMP_WAIT_POLICY"] = "passive"

import numpy as np
from machines import BASELINE_PATHS, CASES, Case, all_numbers, sample

import engine.equal_positions.shared_shapes
from engine import Machine, scene_numbers
from engine.compiling.jit import set_threads, threads
from sweeps.study.bundled import bundled_studies
from sweeps.study.study import read_study

HERE = Path(__file__).parent
VARIANTS, POSITIONS, ROUNDS = 20_000, 720, 9
COMPILER = ["g++", "-std=c++17", "-O3", "-march=native", "-ffast-math", "-fopenmp", "-shared", "-fPIC"]
FIELDS = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment"]
SUMMARIES = ["required_drive_moment", "excess_work"]
SUMMARIES += ["flywheel_excess_work", "flywheel_merzalov", "flywheel_wittenbauer"]
PAIRS = ["input", *(f"{group}.{pair}" for group in "gh" for pair in ("first", "inner", "second"))]
REACTIONS = [*(f"{pair}.reaction_{axis}" for pair in PAIRS for axis in "xy"), "input_moment_by_equilibrium"]
MEMORY_VARIANTS, MEMORY_BLOCK = 1_000_000, 16_384
PYLINKAGE_SHARE = 10
AGREEMENT = 1e-11

phi = np.arange(POSITIONS) * (2 * math.pi / POSITIONS)
cosines, sines, h = np.cos(phi), np.sin(phi), phi[1]


class Contest(NamedTuple):
    """Times of two sides in ns per position, one of each per round, and the ratio that is asked for."""

    case: str
    first: np.ndarray
    second: np.ndarray
    goal: str

    def row(self) -> str:
        """Line of the table."""
        ratios = self.first / self.second
        middle = np.median(self.first) / np.median(self.second)
        times = f"{np.median(self.first):.2f} | {np.median(self.second):.2f}"
        extent = f"{quotient(ratios.min())} – {quotient(ratios.max())}"
        return f"| {self.case} | {times} | {quotient(middle)} | {extent} | {self.goal} |"


def quotient(value: float) -> str:
    """A ratio, small ones as one over a number."""
    return f"{value:.2f}" if value > 0.1 else f"1/{1 / value:.0f}"


def contest(
    case: str,
    first: Callable,
    second: Callable,
    goal: str,
    shares: tuple[int, int] = (1, 1),
    clock: Callable[[], float] = time.perf_counter,
) -> Contest:
    """Time two sides in turns; `shares` says that a side evaluates only one in so many of the variants."""
    times = np.empty((2, ROUNDS))
    for turn in range(ROUNDS):
        for side, run in enumerate((first, second)):
            start = clock()
            run()
            times[side, turn] = clock() - start
    times *= 1e9 / (VARIANTS * POSITIONS) * np.array(shares)[:, None]
    found = Contest(case, *times, goal)
    print(found.row(), flush=True)
    return found


def require_agreement(case: str, found: np.ndarray, expected: np.ndarray, scale: np.ndarray) -> None:
    """Stop the benchmark where two sides computed different things."""
    worst = float(np.max(np.abs(found - expected) / scale))
    if not worst < AGREEMENT:
        raise SystemExit(f"{case}: the two sides differ by {worst:.1e} of their scale, more than {AGREEMENT:.0e}")


# The C++ baseline


def build_baseline(folder: str) -> ctypes.CDLL:
    """Compile the baseline; it uses as many threads as the engine."""
    library = Path(folder) / "baseline.so"
    subprocess.run([*COMPILER, "-o", library, HERE / "baseline.cpp"], check=True)
    baseline = ctypes.CDLL(str(library))
    baseline.use_threads(threads())
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


# The cases


def race_fields(name: str, baseline: ctypes.CDLL, clock: Callable[[], float] = time.perf_counter) -> Contest:
    varied = geometry_and_loads(name)
    machine = Machine(CASES[name].scene, fields=FIELDS, varied=varied, positions=POSITIONS)
    buffer, rows = machine.new_buffer(VARIANTS), np.zeros((3, VARIANTS, POSITIONS))
    buffer.fill(0)
    rival = call(getattr(baseline, f"{name}_fields"), *baseline_inputs(name, varied), *rows)
    machine.evaluate(varied, buffer=buffer)
    rival()
    require_agreement(name, buffer, rows, np.abs(rows).max(axis=2, keepdims=True))
    run = partial(machine.evaluate, varied, buffer=buffer)
    return contest(f"I, dI/dφ, M: {title(name)}", run, rival, "≤ 1.1", clock=clock)


def race_summaries(name: str, baseline: ctypes.CDLL) -> Contest:
    varied = geometry_and_loads(name)
    scene = CASES[name].scene
    machine = Machine(scene, summaries=SUMMARIES, varied=varied, positions=POSITIONS)
    values, errors = np.zeros((2, VARIANTS, len(SUMMARIES)))
    constants = (float(h), scene.input.speed, scene.flywheel.speed_fluctuation)
    rival = call(getattr(baseline, f"{name}_summaries"), *baseline_inputs(name, varied), *constants, values, errors)
    outcome = machine.evaluate(varied)
    rival()
    found, figures = (np.stack([side[s] for s in SUMMARIES], axis=1) for side in (outcome.summaries, outcome.errors))
    # The mean moment may vanish: it is measured by the excess work.
    scale = np.maximum(np.abs(values), values[:, 1:2])
    require_agreement(name, found, values, scale)
    require_agreement(f"{name}, error figures", figures, errors, scale)
    return contest(f"flywheel sizes: {title(name)}", lambda: machine.evaluate(varied), rival, "≤ 1.3")


def race_reactions(baseline: ctypes.CDLL, clock: Callable[[], float] = time.perf_counter) -> Contest:
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
    run = partial(machine.evaluate, varied, buffer=buffer)
    return contest(f"reactions of all pairs: {title(name)}", run, rival, "≤ 1.2", clock=clock)


def positions_machine() -> tuple[Machine, dict[str, np.ndarray]]:
    case = CASES["four_bar"]
    varied = sample(case, case.geometry, VARIANTS)
    return Machine(case.scene, fields=["B.x", "B.y"], varied=varied, positions=POSITIONS), varied


def race_positions(baseline: ctypes.CDLL) -> Contest:
    machine, varied = positions_machine()
    buffer, rows = machine.new_buffer(VARIANTS), np.zeros((2, VARIANTS, POSITIONS))
    buffer.fill(0)
    rival = call(baseline.four_bar_positions, *baseline_inputs("four_bar", varied), *rows)
    machine.evaluate(varied, buffer=buffer)
    rival()
    require_agreement("positions", buffer, rows, np.abs(rows).max(axis=2, keepdims=True))
    return contest("x, y of one point: four-bar", lambda: machine.evaluate(varied, buffer=buffer), rival, "–")


def race_pylinkage() -> Contest:
    """One in PYLINKAGE_SHARE of the variants: it keeps the paths of all joints, and is slow."""
    from pylinkage.actuators import Crank
    from pylinkage.components import Ground
    from pylinkage.dyads import RRRDyad
    from pylinkage.population import Ensemble
    from pylinkage.simulation import Linkage

    machine, varied = positions_machine()
    buffer = machine.new_buffer(VARIANTS)
    machine.evaluate(varied, buffer=buffer)
    o, d = Ground(0.0, 0.0), Ground(0.22, 0.01)
    crank = Crank(anchor=o, radius=0.05, angular_velocity=2 * math.pi / POSITIONS)
    rocker = RRRDyad(anchor1=crank.output, anchor2=d, distance1=0.2, distance2=0.15)
    lengths = np.stack([values[::PYLINKAGE_SHARE] for values in varied.values()], axis=1)
    start = np.array([[0.0, 0.0], [0.22, 0.01], [0.05, 0.0], [0.15, 0.15]])
    ensemble = Ensemble(Linkage([o, d, crank, rocker]), lengths, np.tile(start, (len(lengths), 1, 1)))
    # Its first position is one step after the start; its crank is turned on by rounded steps.
    path = ensemble.simulate(POSITIONS, 1.0, store=False)[:, :, 3]
    ours = np.roll(np.stack([buffer[0], buffer[1]], axis=2)[::PYLINKAGE_SHARE], -1, axis=1)
    require_agreement("pylinkage", ours, path, np.abs(path).max())
    return contest(
        "x, y of one point: four-bar",
        lambda: machine.evaluate(varied, buffer=buffer),
        lambda: ensemble.simulate(POSITIONS, 1.0, store=False),
        "≤ 1/250",
        (1, PYLINKAGE_SHARE),
    )


def bundled_case(name: str) -> Case:
    """A bundled machine, its masses and the scales of its forces varied."""
    scene = read_study(bundled_studies()[name]).scene
    loads = [path for path in scene_numbers(scene) if path.endswith((".mass", ".scale", "moments.friction.moment"))]
    return Case(scene, {}, dict.fromkeys(loads, 0.2))


def race_factorised(name: str, case: Case, asked: dict[str, list[str]], what: str) -> Contest:
    """Only masses and loads vary: as the engine chooses, against every variant evaluated whole."""
    varied = sample(case, case.loads, VARIANTS)
    chosen, whole = (Machine(case.scene, varied=varied, positions=POSITIONS, **asked) for _ in range(2))
    buffer, rows = chosen.new_buffer(VARIANTS), whole.new_buffer(VARIANTS)
    usual = engine.equal_positions.shared_shapes.WORTH_SHARING

    def run_whole() -> object:
        engine.equal_positions.shared_shapes.WORTH_SHARING = VARIANTS
        outcome = whole.evaluate(varied, buffer=rows)
        engine.equal_positions.shared_shapes.WORTH_SHARING = usual
        return outcome

    first, second = chosen.evaluate(varied, buffer=buffer), run_whole()
    if (chosen.forms_used, whole.forms_used) != ({"factorised"}, {"whole"}):
        raise SystemExit(f"{name}: the forms used are {chosen.forms_used} and {whole.forms_used}")
    if len(buffer):
        require_agreement(name, buffer, rows, np.abs(rows).max(axis=2, keepdims=True))
    for key, values in second.summaries.items():
        scale = np.maximum(np.abs(values), np.abs(second.summaries["excess_work"]))
        require_agreement(f"{name}, {key}", first.summaries[key], values, scale)
    return contest(f"{what}: {title(name)}", lambda: chosen.evaluate(varied, buffer=buffer), run_whole, "≤ 1/5")


def measure_memory() -> None:
    """Run in a child: many variants in blocks, summaries only; prints seconds and peak memory before and after."""
    case = CASES["four_bar"]
    machine = Machine(case.scene, summaries=SUMMARIES, varied={**case.geometry, **case.loads}, positions=POSITIONS)
    machine.evaluate(sample(case, {**case.geometry, **case.loads}, 100))
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    start, left = time.perf_counter(), MEMORY_VARIANTS
    while left:
        count = min(left, MEMORY_BLOCK)
        machine.evaluate(sample(case, {**case.geometry, **case.loads}, count))
        left -= count
    seconds = time.perf_counter() - start
    print(seconds, before / 1024, resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)


# The report


def title(name: str) -> str:
    return name.replace("_", "-")


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def versions() -> str:
    found = [f"Python {platform.python_version()}"]
    for package in ("numpy", "numba", "llvmlite", "pylinkage"):
        try:
            found.append(f"{package} {version(package)}")
        except PackageNotFoundError:
            found.append(f"{package} not installed")
    compiler = subprocess.run(["g++", "-dumpfullversion"], capture_output=True, text=True, check=True).stdout.strip()
    return ", ".join([*found, f"g++ {compiler}"])


def table(first: str, second: str, contests: list[Contest]) -> list[str]:
    head = f"| case | {first} [ns] | {second} [ns] | ratio | least – greatest | goal |"
    return [head, "|---|---|---|---|---|---|", *(c.row() for c in contests), ""]


def report(groups: list[tuple[str, str, str, list[Contest]]], memory: str) -> str:
    lines = [
        "# Performance",
        "",
        f"{VARIANTS} variants × {POSITIONS} positions, float64, {threads()} threads on both sides. Times are wall",
        f"times per position, medians of {ROUNDS} alternating runs; the ratio is that of the medians, with the least",
        "and greatest of the runs' pairs. Outputs agree to 1e-11 of their scale.",
        "",
        f"{processor()}, {threads()} cores; {platform.system()}; {versions()}.",
        f"C++: `{' '.join(COMPILER[:6])}`. Remade by `python results/performance/benchmark.py`.",
        "",
    ]
    for heading, first, second, contests in groups:
        lines += [f"## {heading}", "", *table(first, second, contests)]
    return "\n".join([*lines, "## Memory", "", memory, ""])


def memory_line() -> str:
    child = [sys.executable, str(Path(__file__)), "--memory"]
    text = subprocess.run(child, capture_output=True, text=True, check=True).stdout
    seconds, before, peak = (float(word) for word in text.split())
    return (
        f"{MEMORY_VARIANTS} variants × {POSITIONS} positions of the four-bar, flywheel sizes with their error figures, "
        f"in blocks of {MEMORY_BLOCK}: {seconds:.1f} s, peak {peak:.0f} MB resident, of which {before:.0f} MB "
        "before the first block (Python, NumPy, Numba)."
    )


def main() -> None:
    # The peak of a child begins with what its parent holds, so this comes before anything large.
    memory = memory_line()
    with tempfile.TemporaryDirectory() as folder:
        baseline = build_baseline(folder)
        fields = [race_fields(name, baseline) for name in CASES]
        summaries = [race_summaries(name, baseline) for name in CASES]
        reactions = [race_reactions(baseline)]
        positions = [race_positions(baseline)]
        set_threads(1)
        baseline.use_threads(1)
        alone = [race_fields(name, baseline, time.process_time) for name in CASES]
        alone.append(race_reactions(baseline, time.process_time))
        set_threads(0)
    factorised = [race_factorised(name, case, {"fields": FIELDS}, "I, dI/dφ, M") for name, case in CASES.items()]
    cases = CASES | {name: bundled_case(name) for name in ("crank_press", "four_stroke_engine", "compressor")}
    factorised += [race_factorised(n, c, {"summaries": SUMMARIES}, "flywheel sizes") for n, c in cases.items()]
    groups = [
        ("Engine and hand-written C++", "engine", "C++", fields + summaries + reactions + positions),
        (
            "The same fields on one thread, CPU time, which other users of the machine disturb less",
            "engine",
            "C++",
            alone,
        ),
        ("Only masses and loads vary", "factorised", "whole", factorised),
    ]
    try:
        version("pylinkage")
    except PackageNotFoundError:
        print("pylinkage isn't installed; its comparison is left out")
    else:
        groups.insert(2, ("Engine and pylinkage", "engine", "pylinkage", [race_pylinkage()]))
    (HERE / "performance.md").write_text(report(groups, memory), encoding="utf8")
    print(HERE / "performance.md")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--memory", action="store_true", help="measure memory only (the benchmark calls itself so)")
    if parser.parse_args().memory:
        measure_memory()
    elif shutil.which("g++") is None:
        raise SystemExit("g++ isn't on the path: the baseline can't be compiled")
    else:
        main()
