"""Whether answers at different accuracies agree within their error estimates: bundled scenes, random variants.

    python results/accuracy/consistency.py --seed 1

writes consistency.md next to this file. Every scene with a mechanism is asked for its default summaries, for others and
for statistics of fields drawn at random, with a few of its numbers varied together, at several accuracies.
"""

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np

sys.path.append(str(Path(__file__).parents[1]))
from measuring import processor

from engine import STATISTICS, AskError, Machine, Scene, scene_numbers
from sweeps import read_study
from sweeps.study.bundled import bundled_studies
from sweeps.study.default_summaries import default_summaries
from sweeps.text.templates import bundled_templates

HERE = Path(__file__).parent
ACCURACIES, TRUTH = (1e-3, 1e-6, None), 1e-12
VARIANTS, VARIED, OTHERS, FIELDS = 32, 4, 20, 20
# Largest factor by which a number is varied.
WIDE = 2.0
# Counts, measures of rounding, and how well a solution's start was known.
LEFT_OUT = ("disagreement", "residual", "positions_used", "implicit_steps", "accuracy_reached", "certificate")


def compared(scene: Scene, random: np.random.Generator) -> Iterator[tuple[float | None, str, np.ndarray]]:
    """Differences of answers at each accuracy from those at the finest, over the sum of both estimates."""
    numbers = {p: n for p, n in scene_numbers(scene).items() if n.dimension != "mode" and not n.choices}
    paths = random.choice(list(numbers), min(VARIED, len(numbers)), replace=False)
    varied = {path: (numbers[path].value or 1.0) * WIDE ** random.uniform(-1.0, 1.0, VARIANTS) for path in paths}
    machine, period = Machine(scene), 2.0 * np.pi * getattr(scene.input, "revolutions", 1)
    kinds = {
        OTHERS: machine.available_summaries,
        FIELDS: [f"{f}.{s}" for f in machine.available_fields for s in STATISTICS],
    }
    drawn = [name for count, names in kinds.items() for name in random.choice([*names], min(count, len(names)), False)]
    names = [
        name
        for name in dict.fromkeys([*default_summaries(machine), *drawn])
        if not any(word in name for word in LEFT_OUT)
    ]
    truth = Machine(scene, names, (), varied, accuracy=TRUTH).evaluate(varied)
    for accuracy in ACCURACIES:
        found = Machine(scene, names, (), varied, accuracy=accuracy).evaluate(varied)
        good = (found.status == 0) & (truth.status == 0)
        for name in names:
            off = np.abs(found.summaries[name] - truth.summaries[name])[good]
            if name.endswith("_at") and scene.has_cycle:
                # Positions recur.
                off = np.abs(off - np.round(off / period) * period)
            figures = (found.errors[name] + truth.errors[name])[good]
            ratio = off / np.maximum(figures, 1e-14 * np.abs(truth.summaries[name][good]))
            yield accuracy, name, ratio[np.isfinite(ratio)]


def report(seed: int) -> str:
    """The report: a table by accuracy, and what isn't covered."""
    random, found, left = np.random.default_rng(seed), {accuracy: [] for accuracy in ACCURACIES}, []
    for title, path in {**bundled_templates(), **bundled_studies()}.items():
        scene = read_study(path).scene
        if scene.input is None:
            continue
        try:
            for accuracy, name, ratio in compared(scene, random):
                found[accuracy].append(ratio)
                if (ratio > 1.0).any():
                    left.append(f"- {title}, {accuracy or 'default'}: `{name}`, {ratio.max():.2g} times")
        except AskError as error:
            left.append(f"- {title}: not asked ({error})")
    lines = ["| accuracy | answers compared | covered, % | largest difference over estimates |", "|---|---|---|---|"]
    for accuracy, ratios in found.items():
        every = np.concatenate(ratios)
        share = 100.0 * np.mean(every <= 1.0)
        lines.append(f"| {accuracy or 'default'} | {every.size} | {share:.4f} | {every.max():.2g} |")
    head = f"""# Answers at different accuracies

{VARIANTS} random variants of each bundled scene with a mechanism, up to {VARIED} numbers varied together by up to
{WIDE:.0f} times: default summaries, {OTHERS} others and {FIELDS} statistics of fields drawn at random, against
accuracy {TRUTH:.0e}. {processor()}. Made by `python results/accuracy/consistency.py --seed {seed}`.
"""
    return "\n".join(
        [head, *lines, "", "Not covered, with the largest difference over the estimates:", "", *(left or ["none"]), ""]
    )


def main() -> None:
    """Write the report."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    (HERE / "consistency.md").write_text(report(parser.parse_args().seed), encoding="utf8")


if __name__ == "__main__":
    main()
