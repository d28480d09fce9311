"""Driving axles of locomotives: balance weights, tractive effort, swaying couple and hammer blow."""

import math

import numpy as np
import pytest
from element_samples import figures, one, solved
from hypothesis import given, settings
from hypothesis import strategies as st

EPS = np.finfo(float).eps
few = settings(max_examples=25)
# Khurmi & Gupta, Theory of Machines, chapter 22: the inside cylinder locomotive with cylinders 0.7 m and wheels 1.5 m
# apart, cranks at a right angle, two thirds of the reciprocating masses balanced, 300 rpm.
INSIDE = {
    "type": "locomotive",
    "cylinder_spacing": 0.7,
    "wheel_spacing": 1.5,
    "stroke": 0.6,
    "rotating_mass": 150.0,
    "reciprocating_mass": 180.0,
    "balance_radius": 0.6,
    "speed": 10 * math.pi,
}
GREATEST = ("tractive_variation", "swaying_couple", "left_hammer_blow", "right_hammer_blow")


@pytest.mark.parametrize("cylinders", [3, 4])
def test_evenly_spaced_throws__vary_the_traction_by_rounding_only(cylinders):
    ((variation, error),) = figures(INSIDE | {"cylinders": cylinders}, "tractive_variation")
    assert variation <= error < 1e-10


@few
@given(
    st.integers(1, 4),
    st.floats(0.2, 3.0),
    st.floats(0.5, 2.5),
    st.floats(-3.0, 3.0),
    st.floats(0.0, 300.0),
    st.floats(0.0, 1.5),
    st.floats(0.0, 1.0),
)
def test_masses_one_by_one__give_forces_at_every_angle(cylinders, apart, track, between, rotating, s, c):
    """All masses of the axle as they turn, in the planes they are in, by their moments about either wheel."""
    sizes = {"cylinder_spacing": apart, "wheel_spacing": track, "throw_angle": between, "rotating_mass": rotating}
    element = INSIDE | sizes | {"cylinders": cylinders, "balanced_rotating": s, "balanced_reciprocating": c}
    names = ["left_balance_mass", "right_balance_mass", "left_balance_angle", "right_balance_angle", "tractive_force"]
    names += ["swaying_moment", "left_rail_force", "right_rail_force", "primary_force", *GREATEST]
    phis = np.arange(0.0, 6.3, 0.7)
    found = {n: value for n, (value, _) in solved(element | {"crank_angle": 0.0}, *names, crank_angle=phis).items()}
    square, unit = (10 * math.pi) ** 2, (180.0 + rotating) * 4 * 0.3 * (10 * math.pi) ** 2
    places = [(k - (cylinders - 1) / 2) * apart for k in range(cylinders)]
    throws = [phis + k * between for k in range(cylinders)]
    # mass × radius, place, angle; whether it acts upright.
    turning = [((rotating * 0.3), y, a, True) for y, a in zip(places, throws, strict=True)]
    turning += [((180.0 * 0.3), y, a, False) for y, a in zip(places, throws, strict=True)]
    for side, y in (("left", -track / 2), ("right", track / 2)):
        weight, angle = found[f"{side}_balance_mass"][0] * 0.6, found[f"{side}_balance_angle"][0]
        turning.append((weight, y, phis + angle, True))
    along = square * sum(u * np.cos(a) for u, _, a, _ in turning)
    sway = square * sum(u * y * np.cos(a) for u, y, a, _ in turning)
    up = square * sum(u * np.sin(a) for u, _, a, upright in turning if upright)
    roll = square * sum(u * y * np.sin(a) for u, y, a, upright in turning if upright)
    arm = 1 + 2 * apart / track
    # Some hundred roundings of all terms together, with the arms by which wheels' planes enlarge them.
    close = {"rel": 0, "abs": 300 * EPS * unit * arm * max(1.0, apart, track) * 4}
    assert found["tractive_force"] == pytest.approx(along, **close)
    assert found["swaying_moment"] == pytest.approx(sway, **close)
    assert found["right_rail_force"] == pytest.approx(up / 2 + roll / track, **close)
    assert found["left_rail_force"] == pytest.approx(up / 2 - roll / track, **close)
    left_over = (1 - s) * rotating + (1 - c) * 180.0
    assert found["primary_force"] == pytest.approx(left_over * 0.3 * square * np.cos(phis), **close)
    for greatest, curve in zip(GREATEST, (along, sway, up / 2 - roll / track, up / 2 + roll / track), strict=True):
        assert found[greatest][0] >= np.abs(curve).max() - close["abs"]


def test_wheel__lifts_off_at_its_speed():
    element = INSIDE | {"wheel_load": 30e3}
    (speed,) = one(element, "lift_off_speed")
    load, blow = one(element, "least_wheel_load", "left_hammer_blow", speed=speed)
    assert blow == pytest.approx(30e3, rel=1e-13)
    assert load == pytest.approx(0.0, abs=1e-8)
