"""Governors in equilibrium: against virtual work with many digits."""

import math

import mpmath as mp
import numpy as np
import pytest
from each_case import refusals
from element_samples import results
from exact_governor import ExactGovernor, places
from governor_samples import HARTNELL, PORTER, PROELL, TABLE
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from engine import Scene, Verdict

EPS = np.finfo(float).eps
some = settings(max_examples=8)


def least_sleeve_force(exact, inner, outer):
    """The least force at the sleeve: at a stop, or where it neither rises nor falls."""
    angles = mp.linspace(inner, outer, 33)
    least = min(range(len(angles)), key=lambda i: exact.sleeve_force(angles[i]))
    low, high = angles[max(least - 1, 0)], angles[min(least + 1, len(angles) - 1)]

    def slope(angle):
        return mp.diff(exact.sleeve_force, angle)

    turns = slope(low) < 0 < slope(high)
    return exact.sleeve_force(mp.findroot(slope, (low, high), solver="anderson") if turns else angles[least])


def exact_results(governor, digits=40):
    """What the results are, with many digits, of a governor that is stable from stop to stop."""
    with mp.workdps(digits):
        exact = ExactGovernor(governor)
        inner, outer = exact.inner, exact.angle(governor["greatest_radius"])
        slow, fast = exact.speed(inner), exact.speed(outer)
        half = mp.findroot(lambda a: exact.lift(a) - exact.lift(outer) / 2, (inner + outer) / 2)
        friction = mp.mpf(governor.get("friction", 0.0))
        held = friction / least_sleeve_force(exact, inner, outer)
        # As many digits as the least friction in double precision takes beside 1.
        with mp.workdps(400):
            insensitivity = mp.sqrt(1 + held) - mp.sqrt(1 - held)
        effort = exact.sleeve_force(half) * mp.mpf(governor.get("speed_change", 0.01))
        return {
            "inner_speed": slow,
            "outer_speed": fast,
            "inner_force": exact.force(inner),
            "outer_force": exact.force(outer),
            "mean_speed": (slow + fast) / 2,
            "non_uniformity": 2 * (fast - slow) / (slow + fast),
            "sleeve_lift": exact.lift(outer),
            "sleeve_force": exact.sleeve_force(half),
            "insensitivity": insensitivity,
            "effort": effort,
            "power": 2 * effort**2 / exact.sleeve_stiffness(half),
            "least_speed_with_friction": slow * mp.sqrt(1 - friction / exact.sleeve_force(inner)),
            "greatest_speed_with_friction": fast * mp.sqrt(1 + friction / exact.sleeve_force(outer)),
        }, (exact, inner, outer)


def assert_within_figures(found, errors, exact):
    for name, value in exact.items():
        off = abs(float(mp.mpf(float(found[name][0])) - value))
        assert off <= errors[name][0], (name, found[name][0], value)
        # The figure isn't a blank cheque: some hundred roundings, but where digits cancel.
        if name not in ("non_uniformity", "power", "sleeve_lift"):
            assert errors[name][0] <= 1e-10 * abs(value), name


@st.composite
def arm_governors(draw):
    kind = draw(st.sampled_from(["watt_governor", "porter_governor", "proell_governor"]))
    upper = draw(st.floats(0.1, 0.5))
    top, bottom = (draw(st.floats(-0.2, 0.3)) * upper for _ in range(2))
    joints = [top + upper * math.sin(draw(st.floats(0.35, 0.6))), top + upper * math.sin(draw(st.floats(0.7, 1.0)))]
    lower = draw(st.floats(1.05, 2.0)) * max(abs(x - bottom) for x in joints)
    assume(min(joints) > 0.05 * upper)
    assume(min(x - bottom for x in joints) > 0.0)
    governor = {
        "type": kind,
        "ball_mass": draw(st.floats(0.1, 20.0)),
        "sleeve_mass": draw(st.floats(0.1, 100.0)),
        "upper_arm": upper,
        "lower_arm": lower,
        "upper_pivot": top,
        "lower_pivot": bottom,
        "preload": draw(st.floats(0.0, 1e3)),
        "stiffness": draw(st.floats(0.0, 1e5)),
        "least_radius": joints[0],
        "greatest_radius": joints[1],
        "friction": draw(st.floats(0.0, 3.0)),
    }
    if kind == "watt_governor":
        share = draw(st.floats(0.8, 1.4))
        governor |= {"ball_arm": share * upper, "least_radius": top + share * (joints[0] - top)}
        governor["greatest_radius"] = top + share * (joints[1] - top)
        assume(governor["least_radius"] > 0.02)
    if kind == "proell_governor":
        governor |= {"extension": draw(st.floats(0.1, 0.4)) * lower}
        governor["parallel_radius"] = bottom + (joints[0] - bottom) * draw(st.floats(0.5, 1.0))
        radii = [radius_of_ball(governor, x) for x in joints]
        assume(0 < radii[0] < radii[1])
        governor |= {"least_radius": radii[0], "greatest_radius": radii[1]}
    return governor, math.asin((joints[0] - top) / upper)


def radius_of_ball(governor, joint):
    lean = math.asin((joint - governor["lower_pivot"]) / governor["lower_arm"]) - math.asin(
        (governor["parallel_radius"] - governor["lower_pivot"]) / governor["lower_arm"]
    )
    return joint + governor["extension"] * math.sin(lean)


@some
@given(arm_governors())
def test_arms__speeds_and_forces_are_those_of_virtual_work(drawn):
    governor, _ = drawn
    found, errors, status = results(governor)
    assume(status[0] in (Verdict.OK, Verdict.UNSTABLE))
    if status[0] == Verdict.UNSTABLE:
        with mp.workdps(30):
            exact = ExactGovernor(governor, guess=drawn[1])
            end = exact.angle(governor["greatest_radius"])
            assert all(exact.margin(exact.inner + (end - exact.inner) * k / 4) < 0 for k in range(5))
        return
    assume(found["stable_from"][0] == pytest.approx(governor["least_radius"], rel=1e-12))
    assume(found["stable_to"][0] == pytest.approx(governor["greatest_radius"], rel=1e-12))
    exact, _ = exact_results(governor)
    assert_within_figures(found, errors, exact)


@some
@given(
    st.floats(0.05, 0.3), st.floats(0.05, 0.3), st.floats(0.05, 0.4), st.floats(-0.5, 0.2), st.floats(0.05, 0.6),
    st.floats(0.0, 50.0), st.floats(0.0, 1e3), st.floats(1e3, 1e5),
)  # fmt: skip
# At the inner stop the spring is slack, but for the rounding of the lift.
@example(0.125, 0.234375, 0.125, -0.25, 0.5, 0.0, 0.0, 23159.0)
def test_bell_cranks__speeds_and_forces_are_those_of_virtual_work(a, b, pivot, lean, more, sleeve, preload, stiffness):
    governor = {
        "type": "hartnell_governor", "ball_mass": 1.7, "sleeve_mass": sleeve, "ball_arm": a, "sleeve_arm": b,
        "pivot_radius": pivot, "stiffness": stiffness, "preload": preload, "friction": 1.0,
        "least_radius": pivot + a * math.sin(lean), "greatest_radius": pivot + a * math.sin(lean + more),
    }  # fmt: skip
    assume(governor["least_radius"] > 0.2 * pivot)
    found, errors, status = results(governor)
    assume(status[0] == Verdict.OK)
    assume(found["stable_from"][0] == governor["least_radius"])
    assume(found["stable_to"][0] == governor["greatest_radius"])
    exact, (it, inner, outer) = exact_results(governor)
    assert_within_figures(found, errors, exact)
    with mp.workdps(30):
        margins = [it.margin(inner + (outer - inner) * k / 8) for k in range(9)]
    assert found["least_stability"][0] <= float(min(margins)) + errors["least_stability"][0]


# Tables


def test_table_over_radius_and_over_lift__are_the_same_governor():
    lifts = [(r - 0.12) * 0.66 for r in TABLE["over_radius"]]
    by_lift = {key: value for key, value in TABLE.items() if key != "over_radius"} | {"over_lift": lifts}
    first, errors, _ = results(TABLE)
    second, _, _ = results(by_lift)
    for name, value in first.items():
        if name not in ("least_stability_radius",):
            assert abs(second[name][0] - value[0]) <= 4 * errors[name][0] + 1e-12 * abs(value[0]), name


def test_table_of_another_governor__gives_its_results():
    """A table as dense as that differs from the curve by the fourth power of the spacing."""
    spring = HARTNELL | {"gravity": 0.0}
    radii = np.linspace(0.11, 0.15, 41)
    force = 0.5 * (831.0 + 19.8e3 * (radii - 0.12) * 2 / 3) * 2 / 3
    table = TABLE | {"lift_ratio": 2 / 3, "over_radius": list(radii), "controlling_force": list(force)}
    found, _, _ = results(table)
    wanted, _, _ = results(spring)
    for name in ("inner_speed", "outer_speed", "non_uniformity", "least_stability", "sleeve_force", "sleeve_lift"):
        assert_allclose(found[name], wanted[name], rtol=1e-11, err_msg=name)


def test_table_at_its_last_row__has_the_slope_from_inside():
    # A straight table from the origin is isochronous up to both stops, which are its ends.
    table = TABLE | {"over_radius": [0.12, 0.1425], "controlling_force": [240.0, 285.0], "interpolation": "linear"}
    found, _, status = results(table)
    assert status[0] == Verdict.OK
    assert found["isochronous"][0] == 1


# Stable, isochronous, unstable


def spring_governor(preload_share, **changes):
    """Hartnell's governor without weight, its preload a share of the one that makes it isochronous."""
    return HARTNELL | {"gravity": 0.0, "preload": preload_share * 19.8e3 * 0.12 * 2 / 3} | changes


def test_preload_in_proportion_to_the_radius__is_isochronous():
    found, errors, status = results(spring_governor(1.0))
    assert status[0] == Verdict.OK
    assert found["isochronous"][0] == 1
    assert abs(found["non_uniformity"][0]) <= errors["non_uniformity"][0] < 1e-12
    assert abs(found["least_stability"][0]) <= errors["least_stability"][0] < 1e-12
    # ½ c (b/a)² r = m ω² r.
    assert_allclose(found["mean_speed"], math.sqrt(0.5 * 19.8e3 * (2 / 3) ** 2 / 2.5), rtol=64 * EPS)


@given(st.floats(0.0, 3.0))
@some
def test_preload__decides_about_stability(share):
    assume(abs(share - 1) > 1e-9)
    found, _, status = results(spring_governor(share))
    assert status[0] == (Verdict.OK if share < 1 else Verdict.UNSTABLE)
    if share > 1:
        assert all(np.isnan(column[0]) for column in found.values())


def test_stretch_that_is_stable__ends_where_the_margin_is_nought():
    governor = PROELL | {"least_radius": 0.15}
    found, errors, status = results(governor)
    assert status[0] == Verdict.OK
    assert found["least_stability"][0] < 0
    with mp.workdps(30):
        exact = ExactGovernor(governor)
        edge = mp.findroot(exact.margin, exact.angle(0.1646))
        radius = places(governor, edge)[0]
        assert abs(float(radius - mp.mpf(found["stable_from"][0]))) <= errors["stable_from"][0] < 1e-11
        assert abs(float(exact.speed(edge) - found["least_speed"][0])) <= errors["least_speed"][0]
    assert found["stable_to"][0] == pytest.approx(0.2, rel=1e-15)


def test_friction_beyond_what_holds_the_balls__jams():
    found, _, status = results(PORTER, friction=[0.0, 294.0, 295.0, 400.0])
    assert list(status) == [Verdict.OK, Verdict.OK, Verdict.JAMS, Verdict.JAMS]
    assert np.isnan(found["inner_speed"][2:]).all()


def test_geometry_that_is_impossible__gets_a_verdict():
    _, _, status = results(PORTER, upper_arm=[0.25, 0.2, 0.19, 0.1])
    # Arms of 200 mm lie at right angles to the axis at the outer stop.
    assert status[0] == Verdict.OK
    assert set(status[1:]) <= {Verdict.CANNOT_ASSEMBLE, Verdict.SINGULAR, Verdict.NOT_FINITE}
    assert list(results(PORTER, greatest_radius=[0.16, 0.15, 0.1])[2]) == [0, 3, 3]
    # Lower arms that lean inwards let the sleeve sink as the balls rise.
    assert results(PORTER | {"lower_pivot": 0.39})[2][0] == Verdict.SINGULAR
    # A slack spring doesn't hold the balls.
    assert results(HARTNELL | {"gravity": 0.0, "preload": -2000.0})[2][0] == Verdict.UNSTABLE


test_numbers_that_make_no_governor__are_refused = refusals(
    lambda governor, changes: Scene.model_validate({"elements": {"it": governor | changes}}),
    (PORTER, {"greatest_radius": 0.1}, r"greatest_radius = 100 mm is not above least_radius = 150 mm"),
    (TABLE, {"greatest_radius": 0.2}, "over_radius spans 100 mm to 150 mm … rows up to both stops"),
    (TABLE, {"over_lift": [0.0, 0.1, 0.2, 0.3]}, "over_radius or over_lift, one of the two"),
    (TABLE, {"over_radius": [0.1, 0.12, 0.11, 0.15]}, "row 3: over_radius is below that of row 2"),
    (HARTNELL, {"stiffness": 0.0}, "greater than 0"),
)
