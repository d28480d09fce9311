"""Friction in pairs as nodes against closed forms, the law of energy, and a dense non-linear solution.

ROUNDINGS: reactions are sums of some ten products and quotients of numbers of their own size, each good to EPS; near
jamming the error grows with the reciprocal of the margin.
"""

import math
from itertools import pairwise

import numpy as np
import pytest
from drawn_machines import geared_five_bar, sliding_input
from loaded_machines import asked, loaded
from machines import chain, crank, frame, on, prp, rpr, slider_crank
from numpy.polynomial import chebyshev
from reaction_graphs import ReactionValues, in_all_pairs
from rubbing import with_friction
from rubbing_machines import Q, R, by_friction_circles, press, yoke

from engine.graph.nodes import Graph
from engine.laws.friction.coefficients import NEW, STATIC_AND_KINETIC, WORN_IN, stribeck
from engine.laws.friction.guides import overhung_drive, vee_friction
from engine.laws.friction.inclines import wedge_drive, wedge_withdraw
from engine.laws.friction.journals import friction_circle
from engine.mechanism.input_motion import InputMotion
from engine.scene.pairs import pairs

EPS = np.finfo(float).eps
ROUNDINGS = 100

# Crank and rocker, with a slider hung on the rocker.
RANDOM = in_all_pairs(loaded(chain(0, 2, True), 0), 0, 0.3)


def places(of: ReactionValues, count: int = 8) -> np.ndarray:
    return np.random.default_rng(count).uniform(of.values.first, of.values.last, count)


# Whole machines


# RRR and RRP; RRP and RPR; RPP and PRP; a shaft in its pivot; a sliding input.
MACHINES = [chain(0, 2, True), chain(1, 2, True), chain(3, 1, True)]
MACHINES += [scene.model_dump(exclude_unset=True) for scene in (geared_five_bar(), sliding_input())]


@pytest.mark.parametrize("plain", MACHINES)
def test_friction__agrees_with_a_dense_non_linear_solution(plain):
    of = ReactionValues(in_all_pairs(loaded(plain, 1), 1, 0.3))
    q = places(of)
    names = [name for name in asked(of.scene) if not name.startswith("frame") and "input_moment" not in name]
    names += ["friction_moment", "input_moment_with_friction"]
    found, expected = of(names, q), with_friction(of.scene, q)
    for name in names:
        scale = np.abs(expected[name]).max()
        # The reference solves in float64: condition of the equations, some 10, and xtol of fsolve, which is quadratic.
        assert np.abs(found[name] - expected[name]).max() <= 10 * ROUNDINGS * EPS * scale, name
    assert np.max(of.values([s.residual for s in of.reactions.settlings.values()], q)) <= 1e-10


@pytest.mark.parametrize("plain", MACHINES)
def test_whole_machine_with_friction__is_in_equilibrium(plain):
    of = ReactionValues(in_all_pairs(loaded(plain, 2), 2, 0.3))
    q = places(of)
    force, forces, moment, moments = of.values(list(of.reactions.checks.values()), q)
    assert (force < ROUNDINGS * EPS * forces).all()
    assert (np.abs(moment) < ROUNDINGS * EPS * moments).all()
    ways = of(["input_moment_by_equilibrium", "input_moment_by_power"], q)
    by_equilibrium, by_power = ways.values()
    np.testing.assert_allclose(by_equilibrium, by_power, rtol=0, atol=ROUNDINGS * EPS * np.abs(by_power).max())


def test_friction__costs_at_every_position_what_the_input_supplies_more():
    of, without = ReactionValues(RANDOM), ReactionValues({**RANDOM, "friction": {}})
    q, speed = places(of, 40), of.scene.input.speed
    powers = of([f"{friction['pair']}.friction_power" for friction in RANDOM["friction"].values()], q)
    moments = of(["input_moment_with_friction", "friction_moment"], q)
    plain = without(["input_moment_by_equilibrium"], q)["input_moment_by_equilibrium"]
    lost, rubbed = sum(powers.values()), moments["input_moment_with_friction"]
    scale = np.abs(rubbed).max() * abs(speed)
    assert all((row >= 0).all() for row in powers.values())
    np.testing.assert_allclose((rubbed - plain) * speed, lost, rtol=0, atol=ROUNDINGS * EPS * scale)
    np.testing.assert_allclose(-moments["friction_moment"] * speed, lost, rtol=ROUNDINGS * EPS)


@pytest.mark.parametrize("coefficient", [0.0, 1e-6])
def test_friction__goes_over_into_none(coefficient):
    friction = {name: part | {"coefficient": coefficient} for name, part in RANDOM["friction"].items()}
    of, without = ReactionValues({**RANDOM, "friction": friction}), ReactionValues({**RANDOM, "friction": {}})
    q, names = places(of), asked(of.scene)
    found, expected = of(names, q), without(names, q)
    for name in names:
        # Of first order in the coefficient: forces of this machine feel its thousandfold at most.
        tolerance = (ROUNDINGS * EPS + 1000 * coefficient) * np.abs(expected[name]).max()
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=tolerance)


# Slider-crank, by friction circles and friction angle


@pytest.mark.parametrize("f_guide", [0.0, 0.15])
def test_slider_crank__agrees_with_friction_circles_and_friction_angle(f_guide):
    phi = np.linspace(0.0, math.pi, 38)[1:-1]
    found = ReactionValues(press(f_guide))(["drive.first.reaction", "input_moment_with_friction"], phi)
    expected = np.array([by_friction_circles(q, f_guide) for q in phi]).T
    np.testing.assert_allclose(np.array(list(found.values())), expected, rtol=1e-12)


# Wedge: two guides


def wedge(angle: float, face: float, base: float, guide: float, speed: float = 1.0) -> dict:
    """A wedge that slides on its base and lifts a load of Q, guided upright, by a shoe on its inclined face."""
    coefficients = {"input": base, "lift.first": face, "lift.second": guide}
    friction = {f"f{i}": {"pair": pair, "coefficient": f} for i, (pair, f) in enumerate(coefficients.items())}
    # Shoe and load don't turn on each other: nothing is lost there.
    friction["hinge"] = {"pair": "lift.inner", "coefficient": 0.3, "diameter": 0.05}
    return {
        "guides": {
            "base": {},
            "face": {"link": "wedge", "angle": math.pi - angle},
            "up": {"x": 0.3, "angle": math.pi / 2},
        },
        "input": {"type": "slider", "link": "wedge", "guide": "base", "point": "W"}
        | {"start": 0.0, "stop": 0.1, "speed": speed},
        "groups": {"lift": prp("B", ("shoe", "face", 0.0), ("load", "up", 0.0))},
        "forces": {"weight": {"type": "constant", "on": "B", "angle": -math.pi / 2, "force": Q}},
        "friction": friction,
    }


@pytest.mark.parametrize(
    ("angle", "face", "base", "guide"), [(0.3, 0.2, 0.1, 0.15), (0.8, 0.5, 0.2, 0.3), (0.1, 0.2, 0.0, 0.4)]
)
def test_wedge__takes_the_force_of_its_closed_form_both_ways(angle, face, base, guide):
    inwards, outwards = (ReactionValues(wedge(angle, face, base, guide, speed)) for speed in (1.0, -1.0))
    q, names = places(inwards), ["input_moment_with_friction", "lift.inner.friction_power"]
    found = inwards(names, q)
    expected = wedge_drive(Q, math.tan(angle), face, base, guide)
    np.testing.assert_allclose(found[names[0]], expected, rtol=ROUNDINGS * EPS / inwards.margins(q).min())
    assert not found[names[1]].any()
    # Where the wedge locks by itself it has to be pulled out: that is no jamming.
    held = wedge_withdraw(Q, math.tan(angle), face, base, guide)
    np.testing.assert_allclose(outwards(names, q)[names[0]], -held, rtol=0, atol=ROUNDINGS * EPS * Q)


@pytest.mark.parametrize(("face", "guide"), [(0.2, 0.3), (0.05, 1.5), (0.9, 0.4)])
def test_wedge__jams_at_the_sum_of_its_angles(face, guide):
    # alpha + phi + phi_3 = 90 deg.
    limit = math.pi / 2 - math.atan(face) - math.atan(guide)
    q, names, margins = np.array([0.05]), ["input_moment_with_friction", "lift.first.reaction"], []
    for beyond in (-0.3, -1e-3, -1e-9, 1e-9, 1e-3, 0.5 * (math.pi / 2 - limit)):
        of = ReactionValues(wedge(limit + beyond, face, 0.1, guide))
        margins.append(of.margins(q)[0])
        found = of(names, q)
        if beyond < 0:
            expected = wedge_drive(Q, math.tan(limit + beyond), face, 0.1, guide)
            assert found[names[0]] == pytest.approx(expected, rel=ROUNDINGS * EPS / margins[-1])
        else:
            assert np.isnan(list(found.values())).all()
    assert (np.array(margins) > 1e-14).tolist() == [True] * 3 + [False] * 3
    # The margin falls to zero in proportion to what is left of the angle.
    assert margins[1] / 1e-3 == pytest.approx(margins[2] / 1e-9, rel=0.01)


# Scotch yoke: a slider that tilts


def test_yoke__is_pushed_as_an_overhung_slider():
    length, f = 0.12, 0.3
    q = np.linspace(0.0, math.pi, 16)[1:-1]
    found = ReactionValues(yoke(length, f))(["g.first.reaction"], q)["g.first.reaction"]
    expected = [overhung_drive(Q, 0.0, R * math.sin(at), length / 2, f) for at in q]
    np.testing.assert_allclose(found, expected, rtol=ROUNDINGS * EPS)


def test_yoke__jams_where_its_overhang_reaches_half_its_length_over_f():
    length, f = 0.12, 0.9
    of = ReactionValues(yoke(length, f))
    limit = math.asin(length / 2 / f / R)
    q = np.array([limit - 1e-6, limit + 1e-6, math.pi / 2, math.pi - limit - 1e-6, math.pi - limit + 1e-6])
    jams = [False, True, True, True, False]
    assert (of.margins(q) <= 1e-14).tolist() == jams
    assert np.isnan(of(["g.first.reaction"], q)["g.first.reaction"]).tolist() == jams


# What friction there is in a pair


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"contact": "new"}, friction_circle(0.02, 0.2, NEW)),
        ({"contact": "worn in"}, friction_circle(0.02, 0.2, WORN_IN)),
        ({}, friction_circle(0.02, 0.2, 1.0)),
        (
            {"coefficient": None, "material": "steel on steel, oiled"},
            friction_circle(0.02, STATIC_AND_KINETIC["steel on steel, oiled"].kinetic, 1.0),
        ),
        (
            {"static_coefficient": 0.5, "stribeck_speed": 0.03},
            friction_circle(0.02, stribeck(0.5, 0.2, 0.02 * 2.0, 0.03, 2.0), 1.0),
        ),
    ],
)
def test_journal__has_the_friction_circle_of_its_bush(given, expected):
    own = {"pair": "input", "coefficient": 0.2, "diameter": 0.04} | given
    scene = press(0.0, journals=False)
    scene["friction"] = {"main": {key: value for key, value in own.items() if value is not None}}
    moment, reaction = ReactionValues(scene)(["input.friction_moment", "input.reaction"], np.arange(6.0)).values()
    np.testing.assert_allclose(-moment / reaction, expected, rtol=20 * EPS)


def test_friction_that_falls_with_speed__follows_a_given_motion():
    own = {"pair": "input", "coefficient": 0.2, "diameter": 0.04, "static_coefficient": 0.5, "stribeck_speed": 0.03}
    scene = press(0.0, journals=False) | {"friction": {"main": own}}

    def motion(graph: Graph) -> InputMotion:
        return InputMotion(graph.constant(0.25), graph.zero, graph.constant(0.5))

    names = ["input.friction_moment", "input.reaction", "input.friction_power"]
    moment, reaction, power = ReactionValues(scene, motion)(names, np.arange(6.0)).values()
    expected = friction_circle(0.02, stribeck(0.5, 0.2, 0.02 * 0.5, 0.03, 2.0), 1.0)
    np.testing.assert_allclose(-moment / reaction, expected, rtol=20 * EPS)
    np.testing.assert_allclose(power, -moment * 0.5, rtol=20 * EPS)


def test_guide__of_v_form_presses_harder():
    scene = press(0.0, journals=False)
    scene["friction"]["way"] = {"pair": "drive.second", "coefficient": 0.1, "form": "vee", "vee_angle": 1.2}
    names = ["drive.second.friction_force", "drive.second.reaction"]
    force, normal = ReactionValues(scene)(names, np.linspace(0.0, math.pi, 9)[1:-1]).values()
    np.testing.assert_allclose(np.abs(force), vee_friction(0.1, 0.6) * np.abs(normal), rtol=8 * EPS)
    assert (force > 0).all()


def test_pair_that_never_moves__has_no_friction():
    scene = wedge(0.3, 0.2, 0.1, 0.2)
    found = ReactionValues(scene)(["lift.inner.friction_moment", "lift.inner.friction_power"], np.array([0.05]))
    assert not np.any(list(found.values()))


# What switches, and where friction has kinks


def tilting() -> dict:
    """A slider-crank with masses whose slider bears with its edges or its faces as the crank turns."""
    scene = slider_crank(length=0.1, rod=0.4, speed=9.0)
    scene["bodies"] = {
        "rod": {"link": "rod", "mass": 2.0, "x": 0.2, "inertia": 0.03},
        "ram": {"link": "ram", "mass": 3.0},
    }
    scene["points"]["P"] = on("ram", 0.0, 0.01)
    scene["forces"] = {"work": {"type": "constant", "on": "P", "angle": 2.9, "force": 90.0}}
    scene["friction"] = {
        "a": {"pair": "g.first", "coefficient": 0.2, "diameter": 0.05},
        "b": {"pair": "g.inner", "coefficient": 0.2, "diameter": 0.05},
        "way": {"pair": "g.second", "coefficient": 0.2, "length": 0.15},
    }
    return scene


def massless(f_guide: float) -> dict:
    """A slider-crank whose rod bears nothing but its pins, and changes from push to pull."""
    scene = press(f_guide)
    scene["bodies"] = {"ram": {"link": "ram", "mass": 40.0}}
    scene["input"]["speed"] = 19.0
    if f_guide == 0.0:
        del scene["friction"]["way"]
    return scene


def slotted() -> dict:
    """A crank whose block swings a rocker with mass; the block bears nothing but its pin and slot."""
    return {
        "points": {"O": frame(0.0, 0.0), "D": frame(0.0, -0.5)},
        "input": crank(length=0.1, speed=9.0),
        "groups": {"g": rpr(("block", "A"), ("rocker", "D"))},
        "bodies": {"rocker": {"link": "rocker", "mass": 2.0, "x": 0.3, "inertia": 0.1}},
        "friction": {"pin": {"pair": "g.first", "coefficient": 0.3, "diameter": 0.06}},
    }


def in_panels(of: ReactionValues, cuts: np.ndarray) -> tuple[float, float]:
    """How far the moment of friction between cuts is from polynomials, and from itself with nothing held.

    Both as shares of its peak.
    """
    node, rough, wrong, peak = of.reactions.variables["friction_moment"], 0.0, 0.0, 0.0
    for left, right in pairwise(cuts):
        # Panels of half a radian at most: their series fall by an order of magnitude in every two or three terms.
        for a, b in pairwise(np.linspace(left, right, int((right - left) / 0.5) + 2)):

            def row(x: np.ndarray, a: float = a, b: float = b) -> np.ndarray:
                return of.values.in_panel([node], a, b, 0.5 * (a + b) + 0.5 * (b - a) * x)[0]

            x = np.linspace(-0.999, 0.999, 41)
            found, free = row(x), of.values([node], 0.5 * (a + b) + 0.5 * (b - a) * x)[0]
            series = chebyshev.chebinterpolate(row, 24)
            rough = max(rough, np.abs(chebyshev.chebval(x, series) - found).max())
            wrong, peak = max(wrong, np.abs(found - free).max()), max(peak, np.abs(free).max())
    return rough / peak, wrong / peak


@pytest.mark.parametrize("scene", [tilting(), massless(0.2), massless(0.0), slotted()])
def test_friction_between_cuts__is_smooth_to_the_ends(scene):
    of = ReactionValues(scene)
    cuts = of.values.cuts()
    kinks = np.concatenate(
        [of.values.roots(curve, also=cuts) for curve in of.graph.kinks_behind(of.reactions.checks.values())]
    )
    # Cuts closer than rounding are one.
    every = np.unique(np.concatenate([cuts, kinks]))
    every = every[np.append(True, np.diff(every) > 1e-9)]
    rough, wrong = in_panels(of, every)
    assert rough < 1e-9
    assert wrong == 0.0
    assert in_panels(of, cuts)[0] > 1e-5
    # Without cuts where it switches what is held is wrong; kinks are none of these. The block's pin never turns back.
    if len(cuts) > 2:
        assert in_panels(of, np.unique([of.values.first, *kinks, of.values.last]))[1] > 1e-2


def test_what_may_switch__is_the_motion_in_the_rubbing_pairs():
    of = ReactionValues(RANDOM)
    curves = {crossing.curve for crossing in of.graph.crossings}
    for friction in RANDOM["friction"].values():
        pair = next(p for p in pairs(of.scene) if p.name == friction["pair"])
        if pair.kind == "prismatic":
            assert of.kinematics.slides[pair.link].v in curves
        elif pair.name != "input":
            assert of.kinematics.links[pair.link].w - of.kinematics.links[pair.other].w in curves
    # The rates are derivatives of the curves: central differences of second order.
    q, h = places(of), 1e-5
    for crossing in of.graph.crossings:
        (low, high), slope = (of.values([crossing.curve], q + d)[0] for d in (-h, h)), of.values([crossing.rate], q)[0]
        np.testing.assert_allclose((high - low) / (2 * h), slope, rtol=0, atol=1e-7 * (1 + np.abs(slope).max()))
