"""A rotor as an element of a scene: its results against its masses in space, its errors, its plan."""

import math

import mpmath
import numpy as np
import pytest
from each_case import refusals
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from engine import ElementsAlone, Scene, Verdict
from sweeps.pictures.elements.element_pictures import element_sheet
from sweeps.study.bundled import STUDIES
from sweeps.text.scene_text import read_scene

EPS = np.finfo(float).eps


def rotor_of(**changes):
    """A rotor with three masses and two planes without holes."""
    rotor = {
        "type": "rotor",
        "mass": 100.0,
        "speed": 150.0,
        "centre": 0.4,
        "first_bearing": 0.0,
        "second_bearing": 1.0,
        "unbalances": {
            "a": {"mass": 0.1, "radius": 0.3, "angle": 0.3, "position": 0.2},
            "b": {"mass": 0.2, "radius": 0.2, "angle": 2.0, "position": 0.7},
            "c": {"mass": 0.05, "radius": 0.1, "angle": -1.0, "position": 1.2},
        },
        "planes": {"left": {"position": 0.25, "radius": 0.3}, "right": {"position": 0.75, "radius": 0.25}},
    }
    return rotor | changes


def planes_with(**keys):
    return {name: plane | keys for name, plane in rotor_of()["planes"].items()}


def element(**changes):
    return Scene.model_validate({"elements": {"fan": rotor_of(**changes)}}).elements["fan"]


def results(varied=None, **changes):
    scene = Scene.model_validate({"elements": {"fan": rotor_of(**changes)}})
    asked = list(ElementsAlone(scene).available_summaries)
    outcome = ElementsAlone(scene, asked, varied=list(varied or ())).evaluate(dict(varied or {}))
    return {k.removeprefix("fan."): v for k, v in outcome.summaries.items()}, outcome


def in_space(masses, speed, first, second):
    """Turning bearing forces of point masses (mass, radius, angle, position), by moments about each bearing."""
    pulls = [(m * r * speed**2 * complex(math.cos(a), math.sin(a)), z) for m, r, a, z in masses]
    at_second = sum(f * (z - first) for f, z in pulls) / (second - first)
    return sum(f for f, _ in pulls) - at_second, at_second


def own_masses():
    return [tuple(u[k] for k in ("mass", "radius", "angle", "position")) for u in rotor_of()["unbalances"].values()]


def added_masses(found, planes):
    return [(found[f"{n}.mass"][0], p["radius"], found[f"{n}.angle"][0], p["position"]) for n, p in planes.items()]


sizes, places = st.floats(-6, 3).map(lambda e: 10.0**e), st.floats(-3, 3)


@settings(max_examples=25)
@given(
    st.lists(st.tuples(sizes, sizes, st.floats(-10, 10), places), min_size=1, max_size=8),
    st.lists(places, min_size=1, max_size=4),
    places,
    st.floats(0.05, 5),
    st.floats(-0.5, 1.5),
)
def test_rotor__bearings_carry_its_masses_and_its_weight_and_nothing_turning_when_corrected(
    masses, planes, first, span, centre
):
    assume(len(planes) == 1 or np.ptp(planes) > 1e-3)
    assume(len(set(planes)) == len(planes))
    keys = ("mass", "radius", "angle", "position")
    unbalances = {f"m{i}": dict(zip(keys, mass, strict=True)) for i, mass in enumerate(masses)}
    corrected = {f"p{i}": {"position": plane, "radius": 0.3} for i, plane in enumerate(planes)}
    at = {"first_bearing": first, "second_bearing": first + span, "centre": first + centre * span}
    found, outcome = results(unbalances=unbalances, planes=corrected, **at)
    assert outcome.status[0] == Verdict.OK
    before = in_space(masses, 150.0, first, first + span)
    added = added_masses(found, corrected)
    after = in_space(masses + added, 150.0, first, first + span)
    # Roundings of all that pulls, by the arms about the bearings.
    pull = 150.0**2 * sum(abs(m * r) * (1 + (abs(z) + abs(first)) / span) for m, r, _, z in masses + added)
    forces = [[found[f"{b}_force_{word}"][0] for b in ("first", "second")] for word in ("before", "after")]
    assert forces[0] == pytest.approx(np.abs(before), abs=100 * EPS * pull)
    assert forces[1] == pytest.approx(np.abs(after), abs=100 * EPS * pull)
    # One plane takes the force and leaves a couple.
    assert np.abs(sum(after) if len(planes) == 1 else after).max() <= 100 * EPS * pull
    weight = 100 * 9.80665 * np.abs([1 - centre, centre])
    peaks = [found[f"{b}_peak_before"][0] for b in ("first", "second")]
    assert peaks == pytest.approx(forces[0] + weight, rel=1e-12, abs=100 * EPS * (pull + weight.sum() / span))


@pytest.mark.parametrize(("holes", "used"), [(12, 2), (9, 1), (8, 3), (2, 3)])
def test_rotor__whole_pieces_in_holes_leave_what_their_masses_leave(holes, used):
    planes = planes_with(holes=holes, piece=0.02, first_hole=0.1, used=used)
    found, _ = results(planes=planes)
    added = []
    for name, plane in planes.items():
        pieces = [found[f"{name}.pieces_{k}"][0] for k in range(1, used + 1)]
        at = [found[f"{name}.hole_{k}"][0] for k in range(1, used + 1)]
        assert sum(pieces) == found[f"{name}.pieces"][0]
        assert [p > 0 for p in pieces] == [hole > 0 for hole in at]
        added += [
            (0.02 * p, plane["radius"], 0.1 + math.tau * (hole - 1) / holes, plane["position"])
            for p, hole in zip(pieces, at, strict=True)
        ]
    after = in_space(own_masses() + added, 150.0, 0.0, 1.0)
    # Roundings of forces of some hundred newtons.
    assert [found[f"{b}_force_after"][0] for b in ("first", "second")] == pytest.approx(np.abs(after), abs=1e-11)
    assert found["correction_mass"][0] == pytest.approx(sum(mass for mass, *_ in added), rel=8 * EPS)


def test_rotor__quality_is_the_grade_whose_tolerances_just_hold_it():
    found, _ = results(planes=planes_with(holes=8, piece=0.05))
    shares = 0.6, 0.4
    for word in ("before", "after"):
        forces = [found[f"{b}_force_{word}"][0] for b in ("first", "second")]
        needed = max(f / 150.0**2 / s for f, s in zip(forces, shares, strict=True)) * 150.0 / 100.0
        assert found[f"quality_{word}"][0] == pytest.approx(needed, rel=1e-13)
        grades = [0.0004, 0.001, 0.0025, 0.0063, 0.016, 0.04, 0.1, 0.25, 0.63, 1.6, 4.0]
        assert found[f"grade_{word}"][0] == pytest.approx(next(g for g in grades if g >= needed), rel=4 * EPS)
    # G 6.3: 0.0063 m/s · 100 kg/(150 rad/s).
    assert found["permissible_unbalance"][0] == pytest.approx(0.0042, rel=4 * EPS)


@pytest.mark.parametrize(("centre", "mass_error", "angle_error"), [(0.1, 0.1, 0.2), (0.9, 0.1, 0.2), (0.9, 0.0, 0.3)])
def test_rotor__quality_at_worst_adds_what_each_bearing_feels_of_each_error(centre, mass_error, angle_error):
    planes = planes_with(mass_error=mass_error, angle_error=angle_error)
    found, _ = results(planes=planes, centre=centre)
    felt = sum(np.abs(in_space([added], 150.0, 0.0, 1.0)) for added in added_masses(found, planes))
    # Nothing remains without errors; the bearing nearer to the centre of mass has 0.7 of the tolerance.
    share = abs((1.0 + mass_error) * np.exp(1j * angle_error) - 1.0)
    shares = np.array([0.7, 0.3] if centre < 0.5 else [0.3, 0.7])
    worst = (share * felt / 150.0**2 / shares).max() * 150.0 / 100.0
    assert found["quality_at_worst"][0] == pytest.approx(worst, rel=1e-12)


def test_rotor__error_allowance_is_the_error_at_which_the_grade_is_just_held():
    planes = planes_with(holes=24, piece=0.03)
    allowance = results(planes=planes)[0]["error_allowance"][0]
    assert 0 < allowance < 1
    # A mass error alone of that share leaves the same share of the correction.
    held = results(planes=planes_with(holes=24, piece=0.03, mass_error=allowance))[0]
    assert held["quality_at_worst"][0] == pytest.approx(0.0063, rel=1e-12)
    # One plane in a bearing's own leaves the other as it is, beyond its tolerance: no error makes up for that.
    found, outcome = results(planes={"left": {"position": 0.0, "radius": 0.3}})
    assert outcome.status == Verdict.OK
    assert np.isnan(found["error_allowance"])


def test_rotor__error_figures_cover_the_rounding_of_what_should_be_nothing():
    found, outcome = results()
    for name in ("first_force_after", "second_force_after", "quality_after"):
        assert 0 < found[name][0] <= outcome.errors[f"fan.{name}"][0]
    assert 0 < outcome.errors["fan.single_plane"][0] < 1e-12


def test_rotor__error_figures_hold_for_unlike_planes_and_far_positions():
    """Against 40 digits: radii in a ratio up to 1000, rotors far from the origin, masses near a bearing."""
    rng, count = np.random.default_rng(1), 60
    away, close = 10.0 ** rng.uniform(-3, 3, count) * (rng.random(count) < 0.7), 10.0 ** rng.uniform(-4, 0, count)
    numbers = {f"unbalances.{u}.position": away + close * rng.uniform(-1, 2, count) for u in "abc"}
    numbers |= {key: away + rng.uniform(-1, 2, count) for key in ("centre", "planes.left.position")}
    numbers["first_bearing"], numbers["second_bearing"] = away, away + 1.0
    numbers["planes.right.position"] = numbers["planes.left.position"] + 10.0 ** rng.uniform(-2, 0, count)
    numbers |= {f"planes.{plane}.radius": 10.0 ** rng.uniform(-3, 0, count) for plane in ("left", "right")}
    paths = {f"elements.fan.{key}": values for key, values in numbers.items()}
    found, outcome = results(paths)
    assert (outcome.status == Verdict.OK).all()
    with mpmath.workdps(40):
        parts = [
            (mpmath.mpf(m) * mpmath.mpf(r) * mpmath.expj(a), f"unbalances.{u}")
            for u, (m, r, a, _) in zip("abc", own_masses(), strict=True)
        ]
        for k in range(count):
            n = {key: mpmath.mpf(float(values[k])) for key, values in numbers.items()}

            def moment(plane, n=n):
                return sum(u * (n[f"{at}.position"] - plane) for u, at in parts)

            left, right = (n[f"planes.{plane}.position"] for plane in ("left", "right"))
            true = {"left.mass": abs(moment(right)) / (right - left) / n["planes.left.radius"]}
            true["right.mass"] = abs(moment(left)) / (right - left) / n["planes.right.radius"]
            true["second_force_before"] = (
                abs(moment(n["first_bearing"])) / (n["second_bearing"] - n["first_bearing"]) * 150**2
            )
            true |= {"couple": abs(moment(n["centre"])), "quality_after": 0, "second_force_after": 0}
            true["single_plane"] = mpmath.re(moment(0) / sum(u for u, _ in parts))
            for name, value in true.items():
                off = float(abs(mpmath.mpf(float(found[name][k])) - value))
                assert off <= outcome.errors[f"fan.{name}"][k], (name, k)


def test_rotor__without_what_a_result_needs_does_not_offer_it():
    def offered(**keys):
        return set(ElementsAlone(Scene.model_validate({"elements": {"fan": rotor_of(**keys)}})).available_summaries)

    assert offered(rolling_arm=1e-5) - offered() == {"fan.knife_edge_unbalance", "fan.knife_edge_angle"}
    with_holes = offered(planes=planes_with(holes=8, piece=0.01))
    kinds = ("pieces", "hole_1", "pieces_1", "hole_2", "pieces_2")
    assert with_holes - offered() == {f"fan.{plane}.{kind}" for plane in ("left", "right") for kind in kinds}
    assert results(rolling_arm=1e-5)[0]["knife_edge_unbalance"][0] == pytest.approx(100 * 1e-5)


def test_rotor__heavy_side_rests_where_rolling_friction_holds_it():
    found, outcome = results(rolling_arm=1e-5)
    angle, error = found["knife_edge_angle"][0], outcome.errors["fan.knife_edge_angle"][0]
    # D sin(theta) = m k.
    assert found["unbalance"][0] * math.sin(angle) == pytest.approx(100 * 1e-5, rel=1e-14)
    assert 0 < error < 1e-13
    assert results(rolling_arm=1.0)[0]["knife_edge_angle"][0] == math.pi


def test_rotor__moves_planes_into_one_place_is_not_finite():
    paths = {"elements.fan.planes.left.position": np.array([0.25, 0.75])}
    assert results(paths)[1].status.tolist() == [Verdict.OK, Verdict.NOT_FINITE]


test_rotor__that_cannot_be_is_refused_in_words = refusals(
    lambda changes: element(**changes),
    ({"second_bearing": 0.0}, "first_bearing and second_bearing coincide"),
    ({"planes": {}}, "planes"),
    ({"planes": planes_with(position=0.5)}, "planes left, right coincide; move one"),
    ({"planes": planes_with(holes=12)}, "holes and piece belong together: give both, or neither"),
    ({"planes": planes_with(holes=7.5, piece=0.01)}, "holes = 7.5: give a whole number"),
    ({"planes": planes_with(holes=200, piece=0.01, most=9, used=3)}, "200 holes with up to 9 pieces in 3"),
)


# The plan


def test_plan__shows_masses_corrections_and_what_the_bearings_feel():
    rotor = read_scene(STUDIES / "balancing" / "scenes" / "fan_rotor.toml").elements["fan"]
    found = rotor.values(rotor.own_numbers())
    polygon, moments, bars = element_sheet(rotor, "Fan").axes
    names = [line.get_label() for line in polygon.lines if len(line.get_xdata()) == 2]
    assert names == ["left_disc", "right_disc", "coupling", "left, added", "right, added", "resultant before"]
    masses, factors = rotor.unbalances.values(), {"g·mm": 1e6, "kg·mm": 1e3, "kg·m²": 1.0}
    for axes, first in ((polygon, None), (moments, rotor.planes["left"].position)):
        arms = [1.0 if first is None else u.position - first for u in masses]
        total = sum(u.mass * u.radius * np.exp(1j * u.angle) * arm for u, arm in zip(masses, arms, strict=True))
        total *= factors[axes.get_xlabel().removeprefix("x, ")]
        before = next(line for line in axes.lines if line.get_label() == "resultant before").get_xydata()
        assert before[1] == pytest.approx([total.real, total.imag], abs=1e-12 * abs(total))
    heights = np.array([bar.get_height() for bar in bars.patches]).reshape(3, 2)
    forces = [[found[f"{b}_force_{word}"][0] for b in ("first", "second")] for word in ("before", "after")]
    assert heights[:2] / heights[0, 0] == pytest.approx(np.array(forces) / forces[0][0])
