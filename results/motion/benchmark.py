"""Work and precision of machine motion: error of ω and t against time per variant; writes motion.md and motion.png.

Three machines run from a given speed over some revolutions, thousands of random variants each. All methods get the
same variants in this process and use two cores; the error is the greatest of all checked variants against a
reference in extended precision.

    python results/motion/benchmark.py

needs heyoka.py (pip install heyoka) and mpmath.
"""

import math
import multiprocessing
import platform
import time
from collections.abc import Callable
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import contextmanager
from importlib.metadata import version
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
from cases import CASES, Batch, Case, prepare, require_engine_agrees, sample
from fixed_steps import LANES
from matplotlib.figure import Figure
from ours import ours
from peers import HEYOKA_LANES, PEERS, Peer
from reference import reference

HERE = Path(__file__).parent
VARIANTS, CHECKED, CORES = 2048, 512, 2
ROUNDS, SECONDS = 3, 0.3
OUR_STEPS = (8, 16, 32, 64, 128, 256)
TARGETS = tuple(10.0**-k for k in range(4, 10))
QUANTITIES = ("ω", "t")
# Below this, rounding of float64 is what differs.
FLOOR = 1e-16
OURS = "this project"

Solver = Callable[[Case, dict[str, np.ndarray], int], tuple[np.ndarray, np.ndarray]]


class Run(NamedTuple):
    """A method at one setting: time per variant [s], greatest relative errors of ω and t."""

    setting: float
    seconds: float
    errors: tuple[float, float]


Curves = dict[str, list[Run]]


# Timing

_solve: Callable[[slice], np.ndarray]


def _solve_part(part: slice) -> np.ndarray:
    """What a forked process calls: the solver it was forked with."""
    return _solve(part)


@contextmanager
def on_both_cores(solve: Callable[[slice], np.ndarray], in_threads: bool):
    """The function that computes all variants, half of them on each core."""
    global _solve
    _solve = solve
    fork = multiprocessing.get_context("fork")
    pool: Executor = ThreadPoolExecutor(CORES) if in_threads else ProcessPoolExecutor(CORES, mp_context=fork)
    cuts = [VARIANTS * i // CORES for i in range(CORES + 1)]
    parts = [slice(*pair) for pair in pairwise(cuts)]
    with pool:
        yield lambda: np.concatenate(list(pool.map(_solve_part, parts)), axis=1)


def measure(compute: Callable[[], np.ndarray], setting: float, true: np.ndarray) -> Run:
    """Least time of the rounds that SECONDS allow, but no fewer than ROUNDS, after a first one, which compiles."""
    found, times = compute(), []
    while len(times) < ROUNDS or sum(times) < SECONDS:
        start = time.perf_counter()
        compute()
        times.append(time.perf_counter() - start)
    with np.errstate(invalid="ignore"):
        errors = np.abs(found[:, : true.shape[1]] / true - 1).max(axis=1)
    return Run(setting, min(times) / VARIANTS, (float(errors[0]), float(errors[1])))


def peer_runs(peer: Peer, case: Case, batch: Batch, true: np.ndarray) -> list[Run]:
    runs = []
    for setting in peer.settings:
        solve = peer.prepare(case, batch, setting)
        solve(slice(0, 1))
        with on_both_cores(solve, peer.in_threads) as compute:
            runs.append(measure(compute, setting, true))
    return runs


def our_runs(ours: Solver, case: Case, batch: Batch, true: np.ndarray) -> list[Run]:
    return [measure(lambda n=n: np.stack(ours(case, batch.varied, n)), n, true) for n in OUR_STEPS]


def race(case: Case, ours: Solver | None) -> Curves:
    """Curves of all methods for one machine."""
    require_engine_agrees(case)
    varied = sample(case, VARIANTS)
    batch = prepare(case, varied)
    share = CHECKED // CORES
    halves = [{path: values[i : i + share] for path, values in varied.items()} for i in range(0, CHECKED, share)]
    with ProcessPoolExecutor(CORES, mp_context=multiprocessing.get_context("fork")) as pool:
        true = np.concatenate(list(pool.map(reference, [case.name] * CORES, halves)), axis=1)
    curves: Curves = {}
    if ours is not None:
        curves[OURS] = our_runs(ours, case, batch, true)
    for peer in PEERS:
        curves[peer.name] = peer_runs(peer, case, batch, true)
        for run in curves[peer.name]:
            print(f"{case.name:13}{peer.name:20}{run.setting:9.3g}{run.seconds * 1e6:9.2f} µs", *run.errors, flush=True)
    return curves


# Reading the curves


def time_to_reach(runs: list[Run], quantity: int, target: float) -> float:
    """Time per variant at an error, along the straight lines of the log-log diagram; NaN where it isn't reached.

    Runs that another one of the same method beats in both time and error are left out. An error that even the
    coarsest run keeps costs what that run costs.
    """
    sound = sorted((run.seconds, max(run.errors[quantity], FLOOR)) for run in runs if run.errors[quantity] < math.inf)
    front: list[tuple[float, float]] = []
    for seconds, error in sound:
        if not front or error < front[-1][1]:
            front.append((seconds, error))
    if not front or front[-1][1] > target:
        return math.nan
    if front[0][1] <= target:
        return front[0][0]
    errors, times = np.log([e for _, e in front[::-1]]), np.log([s for s, _ in front[::-1]])
    return float(np.exp(np.interp(math.log(target), errors, times)))


def best_other(curves: Curves, quantity: int, target: float) -> float:
    """Least time of all methods but ours; NaN where none reaches the error."""
    times = [time_to_reach(runs, quantity, target) for name, runs in curves.items() if name != OURS]
    return min((t for t in times if not math.isnan(t)), default=math.nan)


# The report


def cell(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.3g}"


def time_table(curves: Curves, quantity: int) -> list[str]:
    """Microseconds per variant to reach each error; the least of the other methods over ours."""
    head = f"| µs a variant at an error of {QUANTITIES[quantity]} of | {' | '.join(f'{t:.0e}' for t in TARGETS)} |"
    lines = [head, "|---" * (1 + len(TARGETS)) + "|"]
    for name, runs in curves.items():
        times = [time_to_reach(runs, quantity, target) * 1e6 for target in TARGETS]
        lines.append(f"| {name} | {' | '.join(map(cell, times))} |")
    if OURS in curves:
        ratios = [best_other(curves, quantity, t) / time_to_reach(curves[OURS], quantity, t) for t in TARGETS]
        lines.append(f"| **best other / {OURS}** | {' | '.join(map(cell, ratios))} |")
    return [*lines, ""]


def run_table(curves: Curves) -> list[str]:
    lines = ["| method | tolerance or steps | µs a variant | error of ω | error of t |", "|---|---|---|---|---|"]
    for name, runs in curves.items():
        for run in runs:
            errors = " | ".join(f"{e:.1e}" for e in run.errors)
            lines.append(f"| {name} | {run.setting:g} | {run.seconds * 1e6:.2f} | {errors} |")
    return [*lines, ""]


def processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        return next(line.split(":")[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()


def report(results: dict[str, Curves]) -> str:
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", "heyoka"))
    lines = [
        "# Motion: error against time",
        "",
        f"{VARIANTS} random variants of each machine, on {CORES} cores; wall time per variant, the least of {ROUNDS}",
        f"or more runs. Errors are relative, the greatest of {CHECKED} variants, against heyoka.py in extended",
        "precision, which agrees with SciPy's DOP853 and, for one variant each of press and shaper, with mpmath",
        "at 30 digits to 1e-15. Every method starts anew at the angles where a force jumps, which are given to it.",
        "",
        f"heyoka.py: batch integrator, {HEYOKA_LANES} lanes. SciPy: all variants of a core as one system with compiled",
        "rates. RK4 in time, RK4 over φ: compiled, variant by variant. In lanes: compiled, vectorised over",
        f"{LANES} variants side by side; in the energy form, as heyoka.py and SciPy. All right-hand sides are written",
        "by hand for the machine.",
        "",
        f"{processor()}; {platform.system()}; Python {platform.python_version()}, {packages}.",
        "Remade by `python results/motion/benchmark.py`.",
        "",
        "![Error against time](motion.png)",
        "",
    ]
    for name, curves in results.items():
        case = CASES[name]
        lines += [f"## {case.title[0].upper()}{case.title[1:]}, {case.revolutions} revolutions", ""]
        lines += [*time_table(curves, 0), *time_table(curves, 1)]
    lines += ["## All runs", ""]
    for name, curves in results.items():
        lines += [f"### {CASES[name].title}", "", *run_table(curves)]
    return "\n".join(lines)


def draw(results: dict[str, Curves]) -> Figure:
    """One panel per machine and quantity."""
    figure = Figure(figsize=(11, 7), layout="constrained")
    axes = figure.subplots(len(QUANTITIES), len(results), sharex="col", sharey=True)
    for (name, curves), column in zip(results.items(), axes.T, strict=True):
        for quantity, ax in enumerate(column):
            for method, runs in curves.items():
                points = [(r.seconds * 1e6, max(r.errors[quantity], FLOOR)) for r in runs]
                wide = {"lw": 2.2, "color": "black", "zorder": 3} if method == OURS else {"lw": 1}
                ax.loglog(*zip(*points, strict=True), "o-", ms=3, label=method, **wide)
            ax.set(title=CASES[name].title if quantity == 0 else "", ylim=(FLOOR, 1e-1))
            ax.grid(alpha=0.3)
        column[-1].set_xlabel("time per variant [µs]")
    for quantity, ax in enumerate(axes[:, 0]):
        ax.set_ylabel(f"greatest relative error of {QUANTITIES[quantity]}")
    axes[0, 0].legend(fontsize=7)
    return figure


def benchmark(ours: Solver | None = None) -> None:
    """Run everything and write the report and its figure.

    Parameters
    ----------
    ours : callable, optional
        (case, values by path as from `sample`, steps per revolution) -> (ω, t) at the end, one of each per variant,
        on as many cores as the others.
    """
    results = {name: race(case, ours) for name, case in CASES.items()}
    (HERE / "motion.md").write_text(report(results), encoding="utf8")
    draw(results).savefig(HERE / "motion.png", dpi=150)
    print(report(results))


if __name__ == "__main__":
    benchmark(ours)
