"""Triads that come near to a dead centre: their positions and error estimates."""

from pathlib import Path

import numpy as np
import pytest

from engine import Machine, Verdict
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates

CAMPAIGN = Path(__file__).parents[3] / "results" / "groups"
# With 0.11 m two modes meet.
LONG_CRANK = 0.1075


@pytest.fixture
def campaigns(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.syspath_prepend(str(CAMPAIGN))
    import exact_triads
    import mode_campaign
    import triad_estimates

    return exact_triads, mode_campaign, triad_estimates


def test_template_with_a_long_crank__has_the_positions_of_50_digits(campaigns):
    exact_triads, mode_campaign, _ = campaigns
    scene = read_scene(bundled_templates()["triad"])
    fields = ["plate.angle", "lower.angle"]
    machine = Machine(scene, ["group_of_plate.transmission.min"], fields, ["input.length"])
    outcome = machine.evaluate({"input.length": np.array([LONG_CRANK])})
    assert outcome.status[0] == Verdict.OK
    assert outcome.summaries["group_of_plate.transmission.min"][0] < 0.03
    paths = [f"points.{name}.{axis}" for name in "BCDPQ" for axis in "xy"]
    paths += [f"links.{name}.length" for name in ("rod", "lower", "upper")]
    numbers = {path: np.array([machine._limits[path].value]) for path in paths} | {"input.length": [LONG_CRANK]}
    triad = mode_campaign.exact_triad(numbers, 0)
    own = np.array(
        [part for name in fields for part in (np.cos(outcome.fields[name][0]), np.sin(outcome.fields[name][0]))]
    )
    start = mode_campaign.pose_of(triad, {"plate": tuple(own[:2, 0]), "lower": tuple(own[2:, 0])})
    path = exact_triads.followed_exactly(triad, start, machine.positions)
    exact = mode_campaign.directions_of(triad, path, "lower")[:-1]
    assert np.abs(own.T - exact).max() < 1e-13


def test_triads_near_dead_centres__errors_are_within_their_estimates(campaigns):
    *_, estimates = campaigns
    found = estimates.compared(8, 40, 2, None)
    for name, (error, estimate, *_) in found.items():
        assert (error <= estimate).all(), name
