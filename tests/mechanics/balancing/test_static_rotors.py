"""Flat rotors balanced by one mass."""

import math

import pytest
from element_samples import DISC, element, one
from hypothesis import given, settings
from hypothesis import strategies as st

from engine import SceneError

sizes, angles = st.floats(1e-3, 1.0), st.floats(-3.1, 3.1)


@settings(max_examples=30)
@given(st.lists(st.tuples(sizes, sizes, angles), min_size=1, max_size=5), sizes)
def test_rotor_with_its_correction__is_balanced_within_its_figure(masses, radius):
    unbalances = {f"m{i}": dict(zip(("mass", "radius", "angle"), m, strict=True)) for i, m in enumerate(masses)}
    rotor = DISC | {"unbalances": unbalances, "correction_radius": radius}
    names = ("unbalance", "correction_mass", "correction_angle", "centrifugal_force", "eccentricity")
    unbalance, mass, angle, force, off = one(rotor, *names)
    assert force == pytest.approx(2500.0 * unbalance, rel=1e-12)
    assert off == pytest.approx(unbalance / 30.0, rel=1e-12)
    added = {"correction": {"mass": mass, "radius": radius, "angle": angle}} if mass else {}
    left = one(rotor | {"unbalances": unbalances | added}, "unbalance")[0]
    assert left <= 1e-14 * sum(m * r for m, r, _ in masses)


def test_masses_that_cancel__leave_nothing_and_no_direction():
    pair = {"a": {"mass": 1.0, "radius": 0.1, "angle": 0.7}, "b": {"mass": 1.0, "radius": 0.1, "angle": 0.7 + math.pi}}
    unbalance, angle = one(DISC | {"unbalances": pair}, "unbalance", "unbalance_angle")
    assert unbalance == 0.0
    assert math.isnan(angle)


def test_friction_on_knife_edges__without_a_mass_is_refused():
    with pytest.raises(SceneError, match="rolling_arm has no meaning without mass: give mass"):
        element({k: v for k, v in DISC.items() if k != "mass"})
