"""What an accuracy costs on the bundled studies, against the number of equally spaced positions that reaches it.

Run it with ``python results/accuracy/asked.py``; it writes asked.md beside itself.

For each study and accuracy, some of its variants are evaluated with ``accuracy`` and with equally spaced positions,
twice as many again and again. Two numbers of positions are noted: the first whose error figures all are within the
accuracy, which a user would have to take, and the first whose true errors are. Truth is what 1e-11 gives.
Costs are CPU time, the least of three runs one after the other in one process.
"""

import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np

from engine import AccurateMachine, Machine, Outcome, Verdict
from engine.panels.accuracy import OF_ACCURACY, RELATIVE_ALREADY, excess, in_panels, peak_of
from sweeps.study.bundled import find_study
from sweeps.study.study import read_study

HERE = Path(__file__).parent
STUDIES = (
    "crank_press",
    "compressor",
    "four_stroke_engine",
    "jaw_crusher",
    "engine_bearings",
    "four_bar_counterweights",
)
ACCURACIES = (1e-2, 1e-3, 1e-4, 1e-6)
POSITIONS = (24, 48, 96, 192, 384, 768, 1536, 3072, 6144, 12_288, 24_576)
# Variants whose errors are looked at, and of a run whose time is taken; of many positions as many as this allows.
VARIANTS, TIMED, PLACES_TIMED, RUNS = 1024, 8192, 6_000_000, 3


class Row(NamedTuple):
    """One study at one accuracy: positions used (median, most), µs a variant, true error, and two uniform settings."""

    study: str
    accuracy: float
    used: tuple[float, float]
    cost: float
    error: float
    by_figure: tuple[str, float]
    by_truth: tuple[str, float]


def timed(evaluate: Callable[[], Outcome], variants: int) -> tuple[Outcome, float]:
    """Outcome, and the least CPU time of a variant [µs]."""
    outcome, least = evaluate(), np.inf
    for _ in range(RUNS):
        start = time.process_time()
        outcome = evaluate()
        least = min(least, time.process_time() - start)
    return outcome, 1e6 * least / variants


def true_error(found: Outcome, truth: Outcome) -> float:
    """Greatest error of any number of any variant, as a share of what accuracies are measured by."""
    worst, good = 0.0, (found.status == Verdict.OK) & (truth.status == Verdict.OK)
    for name, value in found.summaries.items():
        if name.endswith("_at") or name in OF_ACCURACY:
            continue
        exact = truth.summaries[name][good]
        size = 1.0 if name.endswith(RELATIVE_ALREADY) else np.abs(truth.summaries.get(peak_of(name), exact[:0]))
        size = np.abs(exact) if np.size(size) == 0 else (size if np.ndim(size) == 0 else size[good])
        with np.errstate(all="ignore"):
            share = np.abs(value[good] - exact) / size
        worst = max(worst, float(np.nanmax(share, initial=0.0)))
    return worst


def rows_of(name: str) -> list[Row]:
    """A study's rows."""
    study = read_study(find_study(name))

    def evaluated(machine: Machine | AccurateMachine, most: int) -> tuple[Outcome, float]:
        count = min(study.design.size, max(most, VARIANTS))
        values, drop = study.values(0, count)
        varied = {path: values[path] for path in study.paths}
        outcome, cost = timed(lambda: machine.evaluate(varied, drop), count)
        parts = ({n: v[:VARIANTS] for n, v in numbers.items()} for numbers in outcome[3:])
        return Outcome(*(a[:VARIANTS] for a in outcome[:3]), *parts), cost

    # The number of friction's passes is no quantity of the machine.
    names = [n for n in in_panels(study.scene, study.summaries) if n != "friction_passes"]

    def accurate(accuracy: float) -> tuple[Outcome, float]:
        machine = AccurateMachine(study.scene, [*names, *OF_ACCURACY], (), study.paths, accuracy)
        return evaluated(machine, TIMED)

    truth = accurate(1e-11)[0]
    uniform = {}
    for positions in POSITIONS:
        machine = Machine(study.scene, names, (), study.paths, positions)
        uniform[positions] = evaluated(machine, min(TIMED, PLACES_TIMED // positions))
    found = []
    for accuracy in ACCURACIES:
        outcome, cost = accurate(accuracy)
        used = outcome.summaries["positions_used"]
        choices = []
        for reaches in (
            lambda o, a: excess(o, a)[:, o.status == Verdict.OK].max(initial=0.0) <= 1.0,
            lambda o, a: true_error(o, truth) <= a,
        ):
            enough = [n for n in POSITIONS if reaches(uniform[n][0], accuracy)]
            number = enough[0] if enough else POSITIONS[-1]
            choices.append((str(number) if enough else f"> {number}", uniform[number][1]))
        both = (float(np.nanmedian(used)), float(np.nanmax(used)))
        found.append(Row(name, accuracy, both, cost, true_error(outcome, truth), *choices))
        print(found[-1], flush=True)
    return found


def table(rows: list[Row]) -> str:
    """The rows in Markdown."""
    lines = [
        "| study | accuracy | positions used, median (most) | µs | greatest true error | equally spaced, by their"
        " figures | × | equally spaced, by the truth | × |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for r in rows:
        cells = [r.study, f"{r.accuracy:g}", f"{r.used[0]:.0f} ({r.used[1]:.0f})", f"{r.cost:.1f}", f"{r.error:.0e}"]
        for number, cost in (r.by_figure, r.by_truth):
            beyond = "> " if number.startswith(">") else ""
            cells += [f"{number}: {cost:.1f} µs", f"{beyond}{cost / r.cost:.1f}"]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def main() -> None:
    """Measure all and write the table."""
    rows = [row for name in STUDIES for row in rows_of(name)]
    text = __doc__.split("\n\n")[2].replace("\n", " ")
    (HERE / "asked.md").write_text(
        "# What an accuracy costs\n\nMade by `python results/accuracy/asked.py`.\n\n"
        f'{text} × is how many times as much the equally spaced positions cost; "> 24576": even so many don\'t reach'
        f" it, and × is that of so many.\n\n{table(rows)}\n"
    )


if __name__ == "__main__":
    main()
