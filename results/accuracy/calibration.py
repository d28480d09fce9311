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
from quantities import class_of, loads_of
from random_machines import Kind, Varied, kinds, machines, translated

from engine import Machine
from engine.compiling.threads import set_threads, threads

HERE = Path(__file__).parent
ACCURACIES = (None, 1e-3, 1e-6)
NEAR = ("slider-crank", "crank-rocker")
NOTHING = 5e-324
# Negligible shortfall of an estimate, relative to the quantity.
SLIGHT = 1e-12


# Distances of the machines from the origin, in turn [m]: as powers of 2 they are subtracted without rounding.
DISTANCES = (0.0, 2.0**10, 2.0**20)


class Found(NamedTuple):
    """Errors of all machines of a kind at one accuracy: each row is a summary of one machine.

    True errors and error estimates (`figures`) are relative; `doubts` are uncertainties of the reference.
    """

    kind: str
    near: bool
    accuracy: float | None
    names: list[str]
    variants: np.ndarray
    errors: np.ndarray
    figures: np.ndarray
    doubts: np.ndarray
    failed: int
    tail: float

    @property
    def beyond(self) -> np.ndarray:
        """Excess of each true error over its estimate."""
        return self.errors - self.doubts - self.figures


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


def compared(
    kind: Kind,
    varied: Varied,
    moved: np.ndarray,
    truths: list[dict[str, Truth]],
    accuracy: float | None,
    near: bool,
    tail: float,
) -> Found:
    """True errors and error estimates of a kind's summaries, without coordinates of moved machines."""
    # With a required fluctuation the speeds are given and have no error.
    sized = "flywheel_wittenbauer" in kind.asked
    asked = [name for name in kind.asked if not (sized and name.startswith("speed_"))]
    outcome = Machine(kind.scene, asked, (), list(varied), accuracy=accuracy).evaluate(varied)
    rows = []
    for k in np.flatnonzero(outcome.status == 0):
        for name in asked:
            truth, value = truths[k][name], outcome.summaries[name][k]
            scale = scale_of(truths[k], name, abs(varied["input.speed"][k]))
            error = truth.error(value, name.endswith("_at"))
            coordinate = moved[k] and name.rpartition(".")[0].endswith(".x") and not name.endswith("_at")
            if np.isfinite(error) and scale > 0.0 and not coordinate:
                rows.append((name, k, error / scale, outcome.errors[name][k] / scale, truth.doubt / scale))
    names, *columns = zip(*rows, strict=True)
    failed = int(np.count_nonzero(outcome.status))
    return Found(kind.name, near, accuracy, list(names), *(np.array(c) for c in columns), failed, tail)


def measured(index: int, count: int, near: bool) -> list[Found]:
    """One kind of machine under all accuracies."""
    set_threads(1)
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
    return [compared(kind, there, distance > 0.0, truths, accuracy, near, tail) for accuracy in ACCURACIES]


# The report


def _cell(errors: np.ndarray, figures: np.ndarray, doubts: np.ndarray) -> str:
    if not errors.size:
        return "–"
    rest = np.maximum(errors - doubts, 0.0)
    covered = 100.0 * np.count_nonzero(rest <= figures) / errors.size
    with np.errstate(over="ignore"):
        ratio = float(np.median(figures / np.maximum(rest, NOTHING)))
    return f"{covered:.2f} % ({ratio:.2g})" if ratio < 1e4 else f"{covered:.2f} % (> 1e4)"


def _columns(results: list[Found], near: bool) -> list[Found]:
    """Errors of all kinds together, for each accuracy."""
    found = []
    for accuracy in ACCURACIES:
        some = [r for r in results if r.near == near and r.accuracy == accuracy]
        names = [name for r in some for name in r.names]
        rows = [
            np.concatenate([getattr(r, part) for r in some]) for part in ("variants", "errors", "figures", "doubts")
        ]
        failed, tail = sum(r.failed for r in some), max(r.tail for r in some)
        found.append(Found("all", near, accuracy, names, *rows, failed, tail))
    return found


def table(results: list[Found], near: bool) -> list[str]:
    """Lines of the table of coverage by class of quantity."""
    columns = _columns(results, near)
    labels = ["default" if a is None else f"accuracy {a:g}" for a in ACCURACIES]
    lines = ["| | summaries | " + " | ".join(labels) + f" | too small by > {SLIGHT:g} | largest shortfall |"]
    lines.append("|---" * (len(labels) + 4) + "|")
    classes = [np.array([class_of(name) for name in column.names]) for column in columns]
    for one in sorted(set(classes[0])):
        cells = []
        for column, names in zip(columns, classes, strict=True):
            pick = names == one
            cells.append(_cell(column.errors[pick], column.figures[pick], column.doubts[pick]))
        cells += _shortfalls(columns[0].beyond[classes[0] == one])
        lines.append(f"| {one} | {np.count_nonzero(classes[0] == one)} | {' | '.join(cells)} |")
    cells = [_cell(column.errors, column.figures, column.doubts) for column in columns]
    cells += _shortfalls(columns[0].beyond)
    return [*lines, f"| **all** | {columns[0].errors.size} | {' | '.join(cells)} |", ""]


def _shortfalls(beyond: np.ndarray) -> list[str]:
    """Share of estimates that are too small by more than rounding, and the largest shortfall."""
    share = 100.0 * np.count_nonzero(beyond > SLIGHT) / beyond.size
    return [f"{share:.2f} %", f"{beyond.max():.1e}" if beyond.max() > 0.0 else "–"]


def uncovered(results: list[Found], count: int) -> list[str]:
    """Table lines of the largest true errors beyond their estimates, by default, without positions of extremes."""
    rows = {}
    for r in results:
        if r.accuracy is not None:
            continue
        for i in np.argsort(-r.beyond):
            if r.beyond[i] <= 0.0:
                break
            if r.names[i].endswith("_at"):
                continue
            row = rows.setdefault((r.kind, r.near, r.names[i]), [r.errors[i], r.figures[i], int(r.variants[i]), 0])
            row[3] += 1
    worst = sorted(rows.items(), key=lambda item: item[1][1] - item[1][0])[:count]
    return [
        f"| {kind}{', near a dead centre' if near else ''} | {name} | {k} | {error:.2g} | {figure:.2g} | {many} |"
        for (kind, near, name), (error, figure, k, many) in worst
    ]


def draw(results: list[Found]) -> Figure:
    """Estimates over true errors by default, for each kind of load."""
    figure = Figure(figsize=(12, 3.8), layout="constrained")
    axes = figure.subplots(1, 4, sharex=True, sharey=True)
    random = np.random.default_rng(0)
    shown = {loads: [r for r in results if not r.near and loads_of(r.kind) == loads] for loads in LOADS}
    shown["near dead centres"] = [r for r in results if r.near]
    for ax, (title, some) in zip(axes, shown.items(), strict=True):
        some = [r for r in some if r.accuracy is None]
        errors, figures = (np.concatenate([getattr(r, part) for r in some]) for part in ("errors", "figures"))
        pick = random.permutation(errors.size)[:4000]
        ax.scatter(np.maximum(errors[pick], 1e-20), np.maximum(figures[pick], 1e-20), s=3, alpha=0.3, lw=0)
        ax.plot([1e-20, 10], [1e-20, 10], "k", lw=0.8)
        ax.set(xscale="log", yscale="log", xlim=(5e-21, 3), ylim=(5e-21, 10), xlabel="true error, relative")
        ax.set_title(title)
        ax.grid(alpha=0.3)
    axes[0].set_ylabel("error estimate, relative")
    return figure


LOADS = ("smooth", "kinks", "jumps")
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
        found = list(pool.map(timed, *zip(*tasks, strict=True)))
    results = [r for some, _ in found for r in some]
    failed = [r for r in results if r.failed]
    words = "; ".join(f"{r.failed} of {r.kind}, accuracy {r.accuracy}" for r in failed)
    text = TEXT.format(
        machines=count * len(names),
        kinds=len(names),
        slight=SLIGHT,
        tail=max(r.tail for r in results if not r.near),
        near_tail=max(r.tail for r in results if r.near),
        near=count * len(NEAR),
        failed=f"Omitted, as the engine gave no result: {words}.\n" if failed else "",
        minutes=sum(seconds for _, seconds in found) / 60.0,
        system=f"{platform.machine()}, Python {platform.python_version()}",
    )
    lines = [text, "## Random machines", "", *table(results, near=False)]
    lines += ["## Near dead centres and change points", "", *table(results, near=True)]
    lines += ["## Largest shortfalls, by default", ""]
    rows = uncovered(results, 15)
    heading = ["Relative to the size of the quantity, without positions of extremes; `cases`: number of machines.", ""]
    heading += ["| machine | summary | variant | error | estimate | cases |", "|---|---|---|---|---|---|"]
    lines += [*heading, *rows, ""] if rows else ["None.", ""]
    (HERE / "calibration.md").write_text("\n".join(lines), encoding="utf8")
    draw(results).savefig(HERE / "calibration.png", dpi=110)
    print("\n".join(lines))


def timed(index: int, count: int, near: bool) -> tuple[list[Found], float]:
    """Result of `measured`, and its processor time."""
    begin = time.process_time()
    found = measured(index, count, near)
    print(f"{found[0].kind}{', near' if near else ''}: {time.process_time() - begin:.0f} s", flush=True)
    return found, time.process_time() - begin


if __name__ == "__main__":
    main()
