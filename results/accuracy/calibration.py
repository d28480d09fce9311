"""Calibration of the error estimates: the share of true errors that they cover, and their ratio to them.

    python results/accuracy/calibration.py

writes calibration.md and calibration.png next to this file. The truth is independent of the engine: closed formulas of
each mechanism in extended precision (`closed_motion.py`, `closed_forces.py`), and summaries by Legendre series on
separate panels (`closed_cycle.py`, `closed_summaries.py`); `fifty_digits.md` compares them with mpmath.
"""

import argparse
import platform
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import numpy as np
from closed_cycle import Cycle
from closed_summaries import Summaries, Truth
from matplotlib.figure import Figure
from near_dead_centres import NearCycle, near_dead_centres
from quantities import LOADS, class_of
from random_machines import Kind, Varied, kinds, machines, translated

from engine import Machine
from engine.compiling.threads import set_threads, threads

HERE = Path(__file__).parent
# 0 stands for the default.
ACCURACIES = (0.0, 1e-3, 1e-6)
ALL = "**all**"
NEAR = ("slider-crank", "crank-rocker")
NOTHING = 5e-324
# Negligible shortfall of an estimate, relative to the quantity.
SLIGHT = 1e-12


# Distances of the machines from the origin, in turn [m]: as powers of 2 they are subtracted without rounding.
DISTANCES = (0.0, 2.0**10, 2.0**20)


# A summary of one machine at one accuracy, 0 for the default: true error and error estimate (`figure`), relative, and
# the uncertainty of the reference.
ROW = np.dtype(
    [("kind", "U32"), ("near", bool), ("accuracy", float), ("name", "U64"), ("variant", int)]
    + [(part, float) for part in ("error", "figure", "uncertainty")]
)


class Found(NamedTuple):
    """Rows of a kind of machine, words on those without a result, the references' last coefficients, time [s]."""

    rows: np.ndarray
    failed: list[str]
    tail: float
    seconds: float


def beyond(rows: np.ndarray) -> np.ndarray:
    """Excess of each true error over its estimate."""
    return rows["error"] - rows["uncertainty"] - rows["figure"]


def truths_of(kind: Kind, varied: Varied, near: bool) -> tuple[list[dict[str, Truth]], float]:
    """True summaries of each machine, and the largest remainder of the references' series at their last degrees."""
    found, tail = [], 0.0
    for k in range(varied["input.length"].size):
        numbers = {path: float(values[k]) for path, values in varied.items()}
        with np.errstate(all="ignore"):
            cycle = NearCycle(kind.scene, numbers) if near else Cycle(kind.scene, numbers)
            found.append(Summaries(cycle, set(kind.asked)).truths)
        tail = max(tail, *(curve.tail for curve in cycle.curves.values()))
    return found, tail


def scale_of(truths: dict[str, Truth], name: str, speed: float) -> float:
    """Reference size of an error: the peak of a field for its statistics, 1 for positions and differences."""
    field = name.rpartition(".")[0]
    if name.endswith(("_at", "_difference")):
        return 1.0
    if f"{field}.max" in truths:
        return _peak(truths, field)
    if name in ("required_drive_moment", "required_power"):
        # The mean of a moment may vanish.
        return _peak(truths, "reduced_moment") * (speed if name == "required_power" else 1.0)
    return truths[name].size


def _peak(truths: dict[str, Truth], field: str) -> float:
    return max(truths[f"{field}.min"].size, truths[f"{field}.max"].size)


def compared(kind: Kind, varied: Varied, moved: np.ndarray, truths: list[dict[str, Truth]], accuracy: float) -> tuple:
    """Rows of a kind from the name on, without coordinates of moved machines; and the number of failures."""
    # With a required fluctuation the speeds are given and have no error.
    sized = "flywheel_wittenbauer" in kind.asked
    asked = [name for name in kind.asked if not (sized and name.startswith("speed_"))]
    outcome = Machine(kind.scene, asked, (), list(varied), accuracy=accuracy or None).evaluate(varied)
    rows = []
    for k in np.flatnonzero(outcome.status == 0):
        for name in asked:
            truth, value = truths[k][name], outcome.summaries[name][k]
            scale = scale_of(truths[k], name, abs(varied["input.speed"][k]))
            error = truth.error(value, name.endswith("_at"))
            coordinate = moved[k] and name.rpartition(".")[0].endswith(".x") and not name.endswith("_at")
            if np.isfinite(error) and scale > 0.0 and not coordinate:
                rows.append((name, k, error / scale, outcome.errors[name][k] / scale, truth.uncertainty / scale))
    return rows, int(np.count_nonzero(outcome.status))


def measured(index: int, count: int, near: bool) -> Found:
    """One kind of machine under all accuracies."""
    begin = time.process_time()
    kind = kinds()[index]
    varied = machines(kind, count)
    if near:
        varied = near_dead_centres(kind, varied)
    distance = np.resize(DISTANCES, count)
    there = translated(kind.scene, varied, distance)
    # The same machines without the distance, with coordinates rounded as the engine gets them.
    moved = {path for path in there if there[path] is not varied.get(path)}
    here = {path: values - distance if path in moved else values for path, values in there.items()}
    truths, tail = truths_of(kind, here, near)
    rows, failed = [], []
    for accuracy in ACCURACIES:
        some, lost = compared(kind, there, distance > 0.0, truths, accuracy)
        rows += [(kind.name, near, accuracy, *row) for row in some]
        failed += [f"{lost} of {kind.name}, accuracy {accuracy or None}"] if lost else []
    found = Found(np.array(rows, ROW), failed, tail, time.process_time() - begin)
    print(f"{kind.name}{', near' if near else ''}: {found.seconds:.0f} s", flush=True)
    return found


# The report


def _cell(rows: np.ndarray) -> str:
    rest = np.maximum(rows["error"] - rows["uncertainty"], 0.0)
    covered = 100.0 * np.mean(rest <= rows["figure"])
    with np.errstate(over="ignore"):
        ratio = float(np.median(rows["figure"] / np.maximum(rest, NOTHING)))
    return f"{covered:.2f} % ({ratio:.2g})" if ratio < 1e4 else f"{covered:.2f} % (> 1e4)"


def table(rows: np.ndarray) -> list[str]:
    """Lines of the table of coverage by class of quantity."""
    labels = [f"accuracy {a:g}" if a else "default" for a in ACCURACIES]
    lines = ["| | summaries | " + " | ".join(labels) + f" | too small by > {SLIGHT:g} | largest shortfall |"]
    lines.append("|---" * (len(labels) + 4) + "|")
    classes = np.array([class_of(name) for name in rows["name"]])
    for title in (*sorted(set(classes)), ALL):
        own = rows[(classes == title) | (title == ALL)]
        cells = [_cell(own[own["accuracy"] == accuracy]) for accuracy in ACCURACIES]
        excess = beyond(own[own["accuracy"] == 0.0])
        cells.append(f"{100.0 * np.mean(excess > SLIGHT):.2f} %")
        cells.append(f"{excess.max():.1e}" if excess.max() > 0.0 else "–")
        lines.append(f"| {title} | {excess.size} | {' | '.join(cells)} |")
    return [*lines, ""]


def uncovered(rows: np.ndarray, count: int) -> list[str]:
    """Table lines of the largest true errors beyond their estimates, without positions of extremes."""
    rows = rows[(beyond(rows) > 0.0) & ~np.char.endswith(rows["name"], "_at")]
    rows = rows[np.argsort(-beyond(rows))]
    _, first, cases = np.unique(rows[["kind", "near", "name"]], return_index=True, return_counts=True)
    worst = np.argsort(first)[:count]
    return [
        f"| {row['kind']}{', near a dead centre' if row['near'] else ''} | {row['name']} | {row['variant']} | "
        f"{row['error']:.2g} | {row['figure']:.2g} | {many} |"
        for row, many in zip(rows[first[worst]], cases[worst], strict=True)
    ]


def draw(rows: np.ndarray) -> Figure:
    """Estimates over true errors, for each kind of load."""
    figure = Figure(figsize=(12, 3.8), layout="constrained")
    axes = figure.subplots(1, 4, sharex=True, sharey=True)
    random = np.random.default_rng(0)
    shown = {loads: rows[~rows["near"] & np.isin(rows["kind"], names)] for loads, names in LOADS.items()}
    shown["near dead centres"] = rows[rows["near"]]
    for ax, (title, some) in zip(axes, shown.items(), strict=True):
        some = random.permutation(some)[:4000]
        ax.scatter(np.maximum(some["error"], 1e-20), np.maximum(some["figure"], 1e-20), s=3, alpha=0.3, lw=0)
        ax.plot([1e-20, 10], [1e-20, 10], "k", lw=0.8)
        ax.set(xscale="log", yscale="log", xlim=(5e-21, 3), ylim=(5e-21, 10), xlabel="true error, relative")
        ax.set_title(title)
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("error estimate, relative")
    return figure


TEXT = """# Error estimates against true errors

{machines} random machines of {kinds} structures (`random_machines.py`), and {near} slider-cranks and crank-rockers
that come near a dead centre or a change point (`near_dead_centres.py`). Each cell gives the share of true errors
within their error estimates, and in brackets the median ratio of estimate to true error. `default` has no requested
accuracy; the other columns request one for every summary. The last two columns refer to the default: the share of
estimates that are too small by more than {slight:g} of the quantity, and the largest shortfall.

The truth comes from closed formulas in extended precision (80 bits) by another method; its own uncertainty is
subtracted from the errors. The last two coefficients of its series are at most {tail:.0e} of the largest (near dead
centres {near_tail:.0e}).
Errors are relative to the peak of the field, for statistics of fields; to the value, for others.
Two thirds of the machines are 1 km and 1000 km from the origin; coordinates of their points are omitted.
{failed}Made by `python results/accuracy/calibration.py`, in {minutes:.0f} minutes of processor time; {system}.

![Estimates against errors](calibration.png)
"""


def main() -> None:
    """Measure, write the tables and the picture."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--machines", type=int, default=100, help="of each kind")
    count = parser.parse_args().machines
    names = [kind.name for kind in kinds()]
    tasks = [(i, count, False) for i in range(len(names))] + [(names.index(name), count, True) for name in NEAR]
    with ProcessPoolExecutor(threads(), initializer=set_threads, initargs=(1,)) as pool:
        found = list(pool.map(measured, *zip(*tasks, strict=True)))
    rows = np.concatenate([one.rows for one in found])
    default, words = rows[rows["accuracy"] == 0.0], "; ".join(word for one in found for word in one.failed)
    text = TEXT.format(
        machines=count * len(names),
        kinds=len(names),
        slight=SLIGHT,
        tail=max(one.tail for one in found[: len(names)]),
        near_tail=max(one.tail for one in found[len(names) :]),
        near=count * len(NEAR),
        failed=f"Omitted, as the engine gave no result: {words}.\n" if words else "",
        minutes=sum(one.seconds for one in found) / 60.0,
        system=f"{platform.machine()}, Python {platform.python_version()}",
    )
    lines = [text, "## Random machines", "", *table(rows[~rows["near"]])]
    lines += ["## Near dead centres and change points", "", *table(rows[rows["near"]])]
    lines += ["## Largest shortfalls, by default", ""]
    worst = uncovered(default, 15)
    heading = ["Relative to the size of the quantity, without positions of extremes; `cases`: number of machines.", ""]
    heading += ["| machine | summary | variant | error | estimate | cases |", "|---|---|---|---|---|---|"]
    lines += [*heading, *worst, ""] if worst else ["None.", ""]
    (HERE / "calibration.md").write_text("\n".join(lines), encoding="utf8")
    draw(default).savefig(HERE / "calibration.png", dpi=110)
    print("\n".join(lines))


if __name__ == "__main__":
    main()
