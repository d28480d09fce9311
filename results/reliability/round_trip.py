"""Variants written as scenes and run again: every bundled study, and every template with varied numbers.

    python results/reliability/round_trip.py

Some variants of each are computed together, some of these are written as TOML, and each text is read and run as by a
user. All summaries and their error estimates are compared, as printed and to the last bit.
"""

import sys
import tempfile
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from engine import AskError, Machine, Verdict, made_ready, quantity_text, scene_numbers
from sweeps.study.bundled import bundled_studies
from sweeps.study.study import Study
from sweeps.study.study_reader import read_study
from sweeps.text.edited_text import edited_scene
from sweeps.text.templates import bundled_templates

# Variants computed together, number of them that are written, and relative variation of a template's numbers.
DRAWN, WRITTEN, VARIED_BY = 12, 2, 0.005


class Again(NamedTuple):
    """A summary of a variant, and of the scene written from it.

    Attributes
    ----------
    variant : int
    name : str
    own, again : float
    texts : tuple of str
        Both as printed with their error estimates.
    """

    variant: int
    name: str
    own: float
    again: float
    texts: tuple[str, str]

    @property
    def same(self) -> bool:
        """Whether they are the same to the last bit."""
        return self.own == self.again or (np.isnan(self.own) and np.isnan(self.again))


def drawn_values(study: Study, seed: int = 4) -> dict[str, np.ndarray]:
    """Numbers of some variants of a study that aren't dropped."""
    random, size = np.random.default_rng(seed), study.design.size
    drawn = np.sort(random.choice(size, min(DRAWN, size), replace=False))
    parts = [study.values(int(i), int(i) + 1) for i in drawn]
    kept = [values for values, dropped in parts if not dropped[0]]
    return {path: np.array([float(values[path][0]) for values in kept]) for path in study.paths}


def varied_values(study: Study, seed: int = 4) -> dict[str, np.ndarray]:
    """Values near those of a scene, for every second number that may vary."""
    random, found = np.random.default_rng(seed), {}
    for path, number in list(scene_numbers(study.scene).items())[::2]:
        # A wheel's width_ratio has an effect only for a mean rim.
        if number.choices or number.value == 0.0 or path.endswith("width_ratio"):
            continue
        try:
            if study.scene.input is not None:
                Machine(study.scene, varied=[path])
        except AskError:
            continue
        found[path] = number.value * random.uniform(1.0 - VARIED_BY, 1.0 + VARIED_BY, DRAWN)
    return found


def written_again(study: Study, values: Mapping[str, np.ndarray], folder: Path) -> Iterator[Again]:
    """Some variants of a study, written as scenes."""
    kinds = (study.positions, np.dtype(study.field_precision).type, study.accuracy)
    machine = made_ready(study.scene, study.summaries, study.fields, tuple(values), *kinds)
    together, quantities = machine.evaluate(values), machine.available_summaries
    for i in np.flatnonzero(together.status == Verdict.OK)[:WRITTEN]:
        to = folder / f"{study.name}_{i}.toml"
        own_values = {path: float(row[i]) for path, row in values.items()}
        to.write_text(edited_scene(study.scene, own_values, study.scene_text, folder), "utf8")
        asked = {"summaries": study.summaries, "fields": study.fields, "positions": study.positions}
        alone = replace(read_study(to), **asked, accuracy=study.accuracy).machine().evaluate({})
        assert alone.status[0] == Verdict.OK
        for name in study.summaries:
            own, again = together.summaries[name][i], alone.summaries[name][0]
            errors = together.errors[name][i], alone.errors[name][0]
            units = quantities[name].units
            texts = (quantity_text(own, units, errors[0]), quantity_text(again, units, errors[1]))
            yield Again(int(i), name, float(own), float(again), texts)


def all_studies() -> Iterator[tuple[Study, dict[str, np.ndarray]]]:
    """Bundled studies and templates, with the numbers of some variants of each."""
    for path in bundled_studies().values():
        study = read_study(path)
        yield study, drawn_values(study)
    for path in bundled_templates().values():
        study = read_study(path)
        yield study, varied_values(study)


def main() -> None:
    """Print a row for each study and template."""
    print("| | summaries | printed differently | other bits | maximum relative difference |")
    print("|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        for study, values in all_studies():
            begin = time.perf_counter()
            found = list(written_again(study, values, Path(folder)))
            other = [f for f in found if not f.same]
            printed = [f for f in found if f.texts[0] != f.texts[1]]
            worst = max((abs(f.again - f.own) / abs(f.own) for f in other if f.own), default=0.0)
            print(f"| {study.name} | {len(found)} | {len(printed)} | {len(other)} | {worst:.0e} |", flush=True)
            for f in printed:
                print(f"{study.name} {f}", file=sys.stderr)
            print(f"{study.name}: {time.perf_counter() - begin:.0f} s", file=sys.stderr, flush=True)


if __name__ == "__main__":
    main()
