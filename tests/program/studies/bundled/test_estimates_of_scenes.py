"""Error estimates of bundled scenes, compared with the same variants at a tighter accuracy.

Every length, mass, load and speed is changed by up to 12 % at random. Summaries are those whose curves bend, tie or
turn sharply: friction and forces between teeth that bend with the sign of what they transmit, directions of forces that
nearly vanish, ends of a swing in each of two revolutions, directions beside ±180°.
"""

import math

import numpy as np
import pytest

from engine import Machine, scene_numbers
from sweeps import read_scene
from sweeps.study.bundled import STUDIES

VARIANTS = 64
FINE = 1e-12
DIMENSIONS = ("length", "mass", "inertia", "force", "moment", "pressure", "angular_speed", "stiffness")
CASES = {
    "friction/scenes/engine_bearings": """mechanical_efficiency drive.first.friction_work
    drive.first.load_direction_of_crank drive.inner.reaction_along.rms""",
    "linkages/scenes/geared_five_bar": "second.radial_force.mean rods.inner.reaction_direction.min_at",
    "gears_and_cams/scenes/elliptical_wheels": """input.reaction_across.rms drive.first.load_direction_of_rod
    drive.first.reaction_direction.min_at drive.first.reaction_direction.max drive.first.reaction_direction.range""",
    "governors/scenes/governed_set": "rod.swing_high_at rod.swing_low_at drive.inner.reaction_direction.max_at",
}


def varied_numbers(scene):
    """All numbers of a kind that may be any, varied at random."""
    rng, numbers = np.random.default_rng(5), scene_numbers(scene)
    chosen = {p: n for p, n in numbers.items() if n.dimension in DIMENSIONS and n.value and "ratio" not in p}
    chosen = {p: n for p, n in chosen.items() if not p.startswith(("regimes", "near"))}
    return {path: n.value * (1.0 + 0.12 * rng.uniform(-1.0, 1.0, VARIANTS)) for path, n in chosen.items()}


@pytest.mark.parametrize("name", CASES)
def test_estimates__cover_what_a_tighter_accuracy_changes(name):
    scene, names = read_scene(STUDIES / f"{name}.toml").model_copy(update={"elements": {}}), CASES[name].split()
    varied, cycle = varied_numbers(scene), 2.0 * math.pi * scene.input.revolutions
    found = [Machine(scene, names, (), list(varied), accuracy=a).evaluate(varied) for a in (FINE, None, 1e-3, 1e-6)]
    works = np.all([o.status == 0 for o in found], axis=0)
    assert works.sum() > VARIANTS / 2
    missed = {}
    for outcome in found[1:]:
        for summary in names:
            # Neither result is exact: both estimates count. A cycle's first and last position are one.
            allowed = outcome.errors[summary] + found[0].errors[summary]
            off = abs(outcome.summaries[summary] - found[0].summaries[summary])
            off = np.minimum(off, abs(cycle - off)) if summary.endswith("_at") else off
            missed[summary] = missed.get(summary, 0) + int((off > allowed)[works].sum())
    assert missed == dict.fromkeys(names, 0)
