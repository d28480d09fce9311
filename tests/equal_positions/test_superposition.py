"""Variants that share their kinematics: summed from the bases of one shape, equal to each evaluated whole."""

import numpy as np
import pytest

import engine.equal_positions.shared_shapes
from engine import Verdict
from engine.equal_positions.rows_machine import RowsMachine as Machine
from sweeps.study.bundled import bundled_studies
from sweeps.study.study import read_study

ASKED = [
    "mean_useful_moment",
    "required_drive_moment",
    "excess_work",
    "flywheel_excess_work",
    "flywheel_merzalov",
    "flywheel_wittenbauer",
    "speed_fluctuation",
]


def loads_of(scene, variants):
    """Masses, drags and scales of forces, each varied by a factor of its own."""
    numbers = engine.scene_numbers(scene)
    paths = [p for p in numbers if p.endswith((".mass", ".scale", "_body.inertia", "friction.moment", ".bore"))]
    random = np.random.default_rng(5)
    return {p: numbers[p].value * random.uniform(0.5, 1.5, variants) for p in paths}


@pytest.mark.parametrize("name", ["crank_press", "compressor", "shaper"])
@pytest.mark.parametrize("fields", [[], ["reduced_moment", "work"]])
def test_flywheel__is_the_same_summed_and_whole(name, fields, monkeypatch):
    scene = read_study(bundled_studies()[name]).scene
    varied = loads_of(scene, 24)
    machines = [Machine(scene, ASKED, fields, varied, positions=240) for _ in range(2)]
    summed = machines[0].evaluate(varied)
    monkeypatch.setattr(engine.equal_positions.shared_shapes, "WORTH_SHARING", 1e9)
    whole = machines[1].evaluate(varied)
    assert (machines[0].forms_used, machines[1].forms_used) == ({"factorised"}, {"whole"})
    assert (summed.status == Verdict.OK).all()
    for key in ASKED:
        # 240 positions, up to ten terms, added in another order: 240·10 rounding errors of the largest work at most;
        # differences of energies near each other lose two digits more.
        scale = np.abs(whole.summaries[key]).max()
        np.testing.assert_allclose(summed.summaries[key], whole.summaries[key], rtol=0, atol=2400e2 * 2.2e-16 * scale)
        # Jumps of several loads add up by magnitude in the sum, as squares in the whole: never a smaller figure.
        assert (summed.errors[key] >= whole.errors[key] * (1 - 1e-6)).all()
    for key in fields:
        scale = np.abs(whole.fields[key]).max()
        np.testing.assert_allclose(summed.fields[key], whole.fields[key], rtol=0, atol=2400 * 2.2e-16 * scale)
