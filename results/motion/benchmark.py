"""Work and precision of machine motion: error of ω and t against time per variant; writes motion.md and motion.png.

Three machines run from a given speed over some revolutions, thousands of random variants each. All methods get the
same variants in this process, on one core, in turn: in every round each of them runs once, so that other load on the
computer affects all. The results are ratios of times of the same round, the median of all rounds; the error is the
maximum over all checked variants against a reference in extended precision.

    python results/motion/benchmark.py

needs heyoka.py (pip install heyoka).
"""

import math
import platform
import sys
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

import numpy as np
from cases import CASES, Case, prepare, require_engine_agrees
from fixed_steps import LANES
from matplotlib.figure import Figure
from ours import ACCURACIES, OUR_RK4, OURS, OWN
from peers import HEYOKA_LANES, PEERS
from reference import reference

sys.path.append(str(Path(__file__).parents[1]))
from measuring import alternating_times, processor, sample

from engine.compiling.threads import set_threads

HERE = Path(__file__).parent
VARIANTS, CHECKED, ROUNDS = 2048, 128, 5
TARGETS = tuple(10.0**-k for k in range(4, 10))
QUANTITIES = ("ω", "t")
# Differences below this are rounding of float64.
FLOOR = 1e-16
BOUNDS = (
    "This project finds jumps, edges and motors for every variant; the other methods have them written by hand.",
    "In a run of the press at 1e-4 the steps take a quarter to a third of the time, its cycle and jumps a fifth,",
    "Python and NumPy half.",
)
ELSEWHERE = (
    "Ratios depend on the processor: on an AMD EPYC, at commit 0a892ce1, those of heyoka.py were",
    "2.1 … 2.5, 0.86 … 1 and 1 … 1.4.",
)
HEYOKA, BY_HAND = "heyoka.py batch", "RK8 over φ, lanes"


class Run(NamedTuple):
    """A method at one setting: time per variant in each round [s], maximum relative errors of ω and t."""

    setting: float
    seconds: np.ndarray
    errors: list[float]


Curves = dict[str, list[Run]]


# Timing


def race(case: Case) -> Curves:
    """Curves of all methods for one machine."""
    require_engine_agrees(case)
    varied = sample(case, VARIANTS)
    true = reference(case.name, {path: values[:CHECKED] for path, values in varied.items()})
    batch, methods = prepare(case, varied), [(peer, setting) for peer in (*OWN, *PEERS) for setting in peer.settings]
    runs = [partial(peer.prepare(case, batch, setting), slice(0, VARIANTS)) for peer, setting in methods]
    with np.errstate(invalid="ignore"):
        # The first time compiles.
        errors = [np.abs(run()[:, :CHECKED] / true - 1).max(axis=1).tolist() for run in runs]
    times = alternating_times(runs, ROUNDS, twice=True) / VARIANTS
    curves: Curves = {}
    for (peer, setting), own, worst in zip(methods, times, errors, strict=True):
        curves.setdefault(peer.name, []).append(Run(setting, own, worst))
        print(f"{case.name:13}{peer.name:20}{setting:9.3g}{np.median(own) * 1e6:9.2f} µs", *worst, flush=True)
    return curves


# Reading the curves


def time_to_reach(runs: list[Run], quantity: int, target: float, which: int) -> float:
    """Time per variant at an error in one round, along the straight lines of the log-log diagram; NaN if not reached.

    Runs that another one of the same method beats in both time and error are left out. An error that even the
    coarsest run keeps costs what that run costs.
    """
    sound = sorted(
        (run.seconds[which], max(run.errors[quantity], FLOOR)) for run in runs if np.isfinite(run.errors).all()
    )
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


def ratio(curves: Curves, method: str, quantity: int, target: float) -> float:
    """Time of a method to reach an error, relative to this project, the median of the rounds."""
    pairs = [[time_to_reach(curves[name], quantity, target, r) for r in range(ROUNDS)] for name in (method, OURS)]
    return float(np.median(np.divide(*pairs)))


# The report


def cell(value: float) -> str:
    return "–" if math.isnan(value) else f"{value:.3g}"


def ratio_table(curves: Curves, quantity: int) -> list[str]:
    """Times of all methods to reach each error, over ours."""
    head = f"| time over ours at an error of {QUANTITIES[quantity]} of | {' | '.join(f'{t:.0e}' for t in TARGETS)} |"
    lines = [head, "|---" * (1 + len(TARGETS)) + "|"]
    for name in curves:
        if name != OURS:
            lines.append(f"| {name} | {' | '.join(cell(ratio(curves, name, quantity, t)) for t in TARGETS)} |")
    return [*lines, ""]


def run_table(curves: Curves) -> list[str]:
    """Error of every run, and its time over that of ours at the middle one of its accuracies."""
    middle = curves[OURS][len(ACCURACIES) // 2].seconds
    lines = [
        f"| method | accuracy, tolerance or steps | time over ours at {ACCURACIES[len(ACCURACIES) // 2]:g} "
        "| error of ω | error of t |",
        "|---|---|---|---|---|",
    ]
    for name, runs in curves.items():
        for run in runs:
            errors = " | ".join(f"{e:.1e}" for e in run.errors)
            lines.append(f"| {name} | {run.setting:g} | {np.median(run.seconds / middle):.3g} | {errors} |")
    return [*lines, ""]


def report(results: dict[str, Curves]) -> str:
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", "heyoka"))
    lines = [
        "# Motion: error against time",
        "",
        f"{VARIANTS} random variants of each machine, on one core. All methods run in turn, {ROUNDS} rounds. The",
        "tables give ratios of processor times of the same round, the median of the rounds: above 1 this project",
        "is faster.",
        f"Errors are relative, the maximum of {CHECKED} variants, against heyoka.py in extended precision, which",
        "agrees with SciPy's DOP853 and, for one variant each of press and shaper, with mpmath at 30 digits to 1e-15.",
        "Every other method restarts at the angles where a force jumps, which are given to it; this project finds",
        "them, within its time.",
        "",
        "This project: `accuracy` of a study from 10 % to 1e-8; each number has an error estimate: the errors",
        'of steps are propagated to the end. This project, rk4: a run with `method = "rk4"`, by its steps per turn,',
        f"also with error estimates. heyoka.py: batch integrator, {HEYOKA_LANES} lanes. SciPy: all variants as one",
        "system with compiled rates. In lanes: compiled, vectorised over",
        f"{LANES} variants side by side; in the energy form, as heyoka.py and SciPy. All their right-hand sides are",
        "written by hand for the machine.",
        "",
        f"{processor()}; {platform.system()}; Python {platform.python_version()}, {packages}.",
        "Remade by `python results/motion/benchmark.py`. Cost of regimes: [regimes.md](regimes.md); honesty of",
        "their error estimates: [honesty.md](honesty.md).",
        "",
        "![Error against time](motion.png)",
        "",
        *summary(results),
        *BOUNDS,
        "",
        *ELSEWHERE,
        "",
    ]
    for name, curves in results.items():
        case = CASES[name]
        lines += [f"## {case.title[0].upper()}{case.title[1:]}, {case.revolutions} revolutions", ""]
        lines += [*ratio_table(curves, 0), *ratio_table(curves, 1)]
    lines += ["## All runs", ""]
    for name, curves in results.items():
        lines += [f"### {CASES[name].title}", "", *run_table(curves)]
    return "\n".join(line.rstrip() for line in lines)


def summary(results: dict[str, Curves]) -> list[str]:
    """Summary of the tables: minimum and maximum ratio of each machine against some methods."""
    lines = ["| minimum … maximum ratio, ω and t | " + " | ".join(CASES[name].title for name in results) + " |"]
    lines.append("|---" * (1 + len(results)) + "|")
    for method in (HEYOKA, BY_HAND, OUR_RK4):
        cells = []
        for curves in results.values():
            found = [ratio(curves, method, quantity, t) for quantity in range(len(QUANTITIES)) for t in TARGETS]
            known = [one for one in found if not math.isnan(one)]
            cells.append(f"{min(known):.2g} … {max(known):.2g}" if known else "–")
        lines.append(f"| {method} | {' | '.join(cells)} |")
    return [*lines, ""]


def draw(results: dict[str, Curves]) -> Figure:
    """One panel per machine and quantity."""
    figure = Figure(figsize=(11, 7), layout="constrained")
    axes = figure.subplots(len(QUANTITIES), len(results), sharex="col", sharey=True)
    for (name, curves), column in zip(results.items(), axes.T, strict=True):
        for quantity, ax in enumerate(column):
            for method, runs in curves.items():
                middle = curves[OURS][len(ACCURACIES) // 2].seconds
                points = [(np.median(r.seconds / middle), max(r.errors[quantity], FLOOR)) for r in runs]
                wide = {"lw": 2.2, "color": "black", "zorder": 3} if method == OURS else {"lw": 1}
                wide |= {"color": "black", "ls": ":"} if method == OUR_RK4 else {}
                ax.loglog(*zip(*points, strict=True), "o-", ms=3, label=method, **wide)
            ax.set(title=CASES[name].title if quantity == 0 else "", ylim=(FLOOR, 1e-1))
            ax.grid(alpha=0.3)
        column[-1].set_xlabel(f"time, over ours at {ACCURACIES[len(ACCURACIES) // 2]:g}")
    for quantity, ax in enumerate(axes[:, 0]):
        ax.set_ylabel(f"maximum relative error of {QUANTITIES[quantity]}")
    axes[0, 0].legend(fontsize=7)
    return figure


def main() -> None:
    """Run everything and write the report and its figure."""
    set_threads(1)
    results = {name: race(case) for name, case in CASES.items()}
    (HERE / "motion.md").write_text(report(results) + "\n", encoding="utf8")
    draw(results).savefig(HERE / "motion.png", dpi=150)
    print(report(results))


if __name__ == "__main__":
    main()
