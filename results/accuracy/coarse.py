"""Cost of low accuracy on the bundled studies of whole cycles, relative to the default.

    python results/accuracy/coarse.py

writes coarse.md next to this file. All machines of a study run in one process, in turn, on one thread.
"""

import os
import sys
from functools import partial
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from measuring import alternating_times, processor

import sweeps
from engine import Machine
from engine.compiling.threads import set_threads
from sweeps import read_study

HERE, FOLDER = Path(__file__).parent, Path(sweeps.__file__).parent / "studies"
STUDIES = {
    "flywheels": ("crank_press", "compressor", "four_stroke_engine", "jaw_crusher", "shaper", "stirling_engine"),
    "balancing": ("four_bar_counterweights",),
    "friction": ("engine_bearings", "toggle_press"),
    "gears_and_cams": ("elliptical_quick_return", "valve_gear"),
    "linkages": ("geared_five_bar", "triad_dwell"),
}
ACCURACIES, TRUTH = (None, 1e-4, 1e-2), 1e-12
# As many variants as a machine evaluates at once in a sweep; a study with fewer repeats them.
VARIANTS, SLOW_VARIANTS, ROUNDS = 8192, 1024, 7
SLOW = "engine_bearings", "geared_five_bar", "valve_gear", "triad_dwell"
NOTHING = 1e-300


def row_of(folder: str, name: str) -> tuple[str, list[float]]:
    """Row of a study, and the cost of each accuracy relative to the default."""
    study = read_study(FOLDER / folder / f"{name}.toml")
    variants = SLOW_VARIANTS if name in SLOW else VARIANTS
    values, dropped = study.values(0, min(variants, study.design.size))
    varied = {path: np.resize(np.asarray(values[path])[~dropped], variants) for path in study.paths}
    made = [Machine(study.scene, study.summaries, (), study.paths, accuracy=a) for a in (*ACCURACIES, TRUTH)]
    *found, truth = (machine.evaluate(varied) for machine in made)
    runs = [partial(machine.evaluate, varied) for machine in made[:-1]]
    cost = np.median(alternating_times(runs, ROUNDS), axis=1) / truth.status.size * 1e6
    cells = [name.replace("_", " "), f"{cost[0]:.1f}"]
    for outcome, microseconds in zip(found[1:], cost[1:], strict=True):
        good, errors, covered = (outcome.status == 0) & (truth.status == 0), [], []
        for summary, value in outcome.summaries.items():
            exact, figures = truth.summaries[summary][good], outcome.errors[summary][good]
            off = np.abs(value[good] - exact)
            covered.append((off <= figures + truth.errors[summary][good])[np.isfinite(off)])
            if not summary.endswith("_at"):
                errors.append(np.nanpercentile(off / np.maximum(np.abs(exact), NOTHING), 99.0))
        share = 100.0 * np.concatenate(covered).mean()
        cells += [f"{microseconds:.1f}", f"{microseconds / cost[0]:.2f}", f"{max(errors):.0e}", f"{share:.2f} %"]
    return f"| {' | '.join(cells)} |", list(cost[1:] / cost[0])


TEXT = """# Cost of low accuracy

Processor time per variant, also relative to the default; true error against accuracy {truth:g}, relative to the value:
the 99 % quantile over the variants of the worst summary, without positions of extremes; and the share of errors of all
summaries that are within their estimates. Median relative times: {medians}.

{processor}, shared with others. Made by `python results/accuracy/coarse.py`.

| study | default [µs] | 1e-4 [µs] | relative | true error | covered | 1 % [µs] | relative | true error | covered |
|---|---|---|---|---|---|---|---|---|---|
"""


def main() -> None:
    """Measure and write the table."""
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    set_threads(1)
    rows, shares = zip(*(row_of(folder, name) for folder, names in STUDIES.items() for name in names), strict=True)
    medians = " and ".join(f"{share:.2f}" for share in np.median(shares, axis=0))
    (HERE / "coarse.md").write_text(
        TEXT.format(truth=TRUTH, medians=medians, processor=processor()) + "\n".join(rows) + "\n", encoding="utf8"
    )


if __name__ == "__main__":
    main()
