"""Friction in the pairs of mechanisms against closed forms, the law of energy, and a dense non-linear solution.

ROUNDINGS: reactions are sums of some ten products and quotients of numbers of their own size, each good to EPS; near
jamming the error grows with the reciprocal of the margin.
"""

import math
from functools import cache

import numpy as np
import pytest
from drawn_machines import geared_five_bar, sliding_input
from each_case import refusals
from element_samples import WEDGE, one
from loaded_machines import asked, loaded
from machines import chain, changed, moving, prp
from reaction_graphs import in_all_pairs
from rubbing import with_friction
from rubbing_machines import Q, R, by_friction_circles, press, yoke

from engine import Machine, MovingMachine, Outcome, Scene, SceneError, Verdict
from engine.laws.friction.coefficients import MATERIALS, NEW, WORN_IN, stribeck
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
ROUNDINGS = 100


# Crank and rocker, with a slider hung on the rocker.
@cache
def random_dyads() -> dict:
    return in_all_pairs(loaded(chain(0, 2, True), 0), 0, 0.3)


def outcome_of(scene: dict, fields: list[str], summaries: list[str] = (), **settings: object) -> Outcome:
    return Machine(Scene.model_validate(scene), summaries, fields, **settings).evaluate({})


# Whole machines


# RRR and RRP; RRP and RPR; RPP and PRP; a shaft in its pivot; a sliding input.
@pytest.mark.parametrize(
    "made",
    [(0, 2, True), (1, 2, True), (3, 1, True), geared_five_bar, sliding_input],
    ids=lambda made: getattr(made, "__name__", str(made)),
)
def test_friction__agrees_with_a_dense_non_linear_solution(made):
    plain = chain(*made) if isinstance(made, tuple) else made().model_dump(exclude_unset=True)
    scene = in_all_pairs(loaded(plain, 1), 1, 0.3)
    machine = MovingMachine(Scene.model_validate(scene), positions=8)
    names = [name for name in asked(machine.scene) if not name.startswith("frame")]
    fields = [*(n for n in names if "input_moment" not in n), "friction_moment", "input_moment_with_friction"]
    assert machine.verdict(fields) == Verdict.OK
    expected = with_friction(machine.scene, machine.q)
    for name, row in machine.fields(fields).items():
        scale = np.abs(expected[name]).max()
        # The reference solves in float64: condition of the equations, some 10, and xtol of fsolve, which is quadratic.
        assert np.abs(row - expected[name]).max() <= 10 * ROUNDINGS * EPS * scale, name


def test_friction__costs_at_every_position_what_the_input_supplies_more():
    scene = random_dyads()
    powers = [f"{friction['pair']}.friction_power" for friction in scene["friction"].values()]
    fields = ["input_moment", "input_moment_with_friction", "friction_moment", *powers]
    checks = ["input_moment_disagreement", "equilibrium_residual", "friction_residual"]
    outcome = outcome_of(scene, [], ["friction_loss", *checks])
    machine, rows = moving(scene, fields, 720)
    assert all(0.0 < outcome.summaries[name][0] < ROUNDINGS * EPS for name in checks[:2])
    assert outcome.summaries["friction_residual"][0] <= 1e-10
    lost = sum(rows[name] for name in powers)
    more = (rows["input_moment_with_friction"] - rows["input_moment"]) * machine.scene.input.speed
    scale = np.abs(rows["input_moment_with_friction"]).max() * abs(machine.scene.input.speed)
    assert all((rows[name] >= 0).all() for name in powers)
    np.testing.assert_allclose(more, lost, rtol=0, atol=ROUNDINGS * EPS * scale)
    np.testing.assert_allclose(-rows["friction_moment"] * machine.scene.input.speed, lost, rtol=ROUNDINGS * EPS)
    # Work over a turn: the mean of the power times the time of the turn.
    turn = 2 * math.pi / abs(machine.scene.input.speed)
    # The power has kinks between these positions, each of which costs the mean h²/8 of its change of slope.
    step = turn * abs(machine.scene.input.speed) / 720
    assert outcome.summaries["friction_loss"][0] == pytest.approx(lost.mean() * turn, rel=step**2)


def test_friction__goes_over_into_none():
    scene = random_dyads()
    plain = {key: part for key, part in scene.items() if key != "friction"}
    paths = [f"friction.{name}.coefficient" for name in scene["friction"]]
    names = asked(Scene.model_validate(scene))
    fields = [name for name in names if "input_moment" not in name]
    none, little = (moving(changed(scene, dict.fromkeys(paths, f)), fields, 16)[1] for f in (0.0, 1e-6))
    for name, expected in moving(plain, fields, 16)[1].items():
        scale = np.abs(expected).max()
        np.testing.assert_allclose(none[name], expected, rtol=0, atol=ROUNDINGS * EPS * scale)
        # Of first order in the coefficient: forces of this machine feel its thousandfold at most.
        np.testing.assert_allclose(little[name], expected, rtol=0, atol=1e-3 * scale)


# Slider-crank, by friction circles and friction angle


@pytest.mark.parametrize("f_guide", [0.0, 0.15])
def test_slider_crank__agrees_with_friction_circles_and_friction_angle(f_guide):
    fields = ["drive.first.reaction", "input_moment_with_friction"]
    machine, rows = moving(press(f_guide), fields, 72)
    for k in range(1, 36):
        if k == 18:
            # The rod is at rest for the moment: friction in B may be anything there.
            continue
        expected = by_friction_circles(machine.q[k], f_guide)
        for name, value in zip(fields, expected, strict=True):
            assert rows[name][k] == pytest.approx(value, rel=1e-12), (name, k)


@pytest.mark.parametrize("role", ["useful", "driving", "harmful"])
def test_efficiency__is_an_answer_where_a_load_is_useful_or_drives(role):
    scene = press(0.2)
    scene["forces"]["work"]["role"] = role
    machine = Machine(Scene.model_validate(scene), [])
    assert "mechanical_efficiency" in machine.available_summaries
    assert ("mechanical_efficiency" in machine.register.answers) == (role != "harmful")


def test_slider_crank__has_the_efficiency_of_its_works():
    names = ["mechanical_efficiency", "friction_loss", "drive.second.friction_work", "required_drive_moment"]
    outcome = outcome_of(press(0.2, journals=False), ["ram.slide"], names)
    value = {name: outcome.summaries[name][0] for name in names}
    assert value["drive.second.friction_work"] == value["friction_loss"] > 0
    # A force that stays the same gives back what it took: nothing comes out.
    assert value["mechanical_efficiency"] == pytest.approx(0.0, abs=1e-12)
    scene = press(0.2, journals=False)
    scene["forces"]["work"] |= {"acts": "against"}
    outcome = outcome_of(scene, [], names)
    value = {name: (outcome.summaries[name][0], outcome.errors[name][0]) for name in names}
    useful = Q * 2 * R
    found, error = value["mechanical_efficiency"]
    loss, uncertainty = value["friction_loss"]
    assert abs(found - useful / (useful + loss)) <= error + uncertainty / useful
    # In line, the press loses as much with the crank turning clockwise.
    scene["input"] |= {"speed": -scene["input"]["speed"]}
    outcome = outcome_of(scene, [], names)
    assert abs(outcome.summaries["mechanical_efficiency"][0] - found) <= 2 * error
    assert outcome.summaries["friction_loss"][0] == pytest.approx(loss, rel=1e-12)


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
    fields = ["input_moment_with_friction", "lift.inner.friction_power"]
    inwards = outcome_of(wedge(angle, face, base, guide), fields, ["jamming_margin"], positions=8)
    given = {"load": Q, "angle": angle, "friction": face, "base_friction": base, "guide_friction": guide}
    expected, held = one(WEDGE, "drive_force", "withdraw_force", **given)
    margin = inwards.summaries["jamming_margin"][0]
    np.testing.assert_allclose(inwards.fields[fields[0]][0], expected, rtol=ROUNDINGS * EPS / margin)
    assert (inwards.fields[fields[1]] == 0).all()
    # Where the wedge locks by itself it has to be pulled out: that is no jamming.
    _, outwards = moving(wedge(angle, face, base, guide, -1.0), fields, 8)
    np.testing.assert_allclose(outwards[fields[0]], -held, rtol=0, atol=ROUNDINGS * EPS * Q)


@pytest.mark.parametrize(("face", "guide"), [(0.2, 0.3), (0.05, 1.5), (0.9, 0.4)])
def test_wedge__jams_at_the_sum_of_its_angles(face, guide):
    # alpha + phi + phi_3 = 90 deg.
    limit = math.pi / 2 - math.atan(face) - math.atan(guide)
    machine = Machine(
        Scene.model_validate(wedge(0.3, face, 0.1, guide)), ["jamming_margin"], ["input_moment"], ["guides.face.angle"]
    )
    angles = limit + np.array([-0.3, -1e-3, -1e-9, 1e-9, 1e-3, 0.5 * (math.pi / 2 - limit)])
    outcome = machine.evaluate({"guides.face.angle": math.pi - angles})
    assert list(outcome.status) == [Verdict.OK] * 3 + [Verdict.JAMS] * 3
    assert list(outcome.status_group) == [-1, -1, -1, 0, 0, 0]
    assert (outcome.status_at[3:] == 0.0).all()
    assert np.isfinite(outcome.fields["input_moment"]).all()
    # The margin falls to zero in proportion to what is left of the angle.
    margins = outcome.summaries["jamming_margin"][:3]
    assert margins[1] / 1e-3 == pytest.approx(margins[2] / 1e-9, rel=0.01)


def test_jammed_results__are_undefined_and_no_numbers():
    fields = ["input_moment_with_friction", "lift.first.reaction"]
    outcome = outcome_of(wedge(1.2, 0.6, 0.1, 0.3), fields, ["friction_loss"], positions=8)
    assert outcome.status[0] == Verdict.JAMS
    assert all(np.isnan(row).all() for row in outcome.fields.values())
    assert np.isnan(outcome.summaries["friction_loss"][0])


# Scotch yoke: a slider that tilts


def test_yoke__is_pushed_as_an_overhung_slider():
    length, f = 0.12, 0.3
    machine, rows = moving(yoke(length, f), ["g.first.reaction"], 32)
    for k in range(1, 16):
        overhang = R * math.sin(machine.q[k])
        expected = Q / (1.0 - f * abs(overhang) / (length / 2))
        assert rows["g.first.reaction"][k] == pytest.approx(expected, rel=ROUNDINGS * EPS)


def test_yoke__jams_where_its_overhang_reaches_half_its_length_over_f():
    length, f = 0.12, 0.9
    outcome = outcome_of(yoke(length, f), ["g.first.reaction"], positions=360)
    assert outcome.status[0] == Verdict.JAMS
    # Panels are shortened towards the place until they are 1e-7 of the turn.
    assert outcome.status_at[0] == pytest.approx(math.asin(length / 2 / f / R), abs=1e-7 * 2 * math.pi)


# What friction there is in a pair


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"contact": "new"}, NEW * 0.02 * math.sin(math.atan(0.2))),
        ({"contact": "worn in"}, WORN_IN * 0.02 * math.sin(math.atan(0.2))),
        ({}, 0.02 * math.sin(math.atan(0.2))),
        ({"above_prismatic": 0.25}, 0.02 * math.sin(math.atan(0.25))),
        (
            {"above_prismatic": 0.5, "static_coefficient": 0.5, "stribeck_speed": 0.03},
            0.02 * math.sin(math.atan(stribeck(0.75, 0.3, 0.02 * 2.0, 0.03, 2.0))),
        ),
        (
            {"coefficient": None, "material": "steel on steel, oiled"},
            0.02 * math.sin(math.atan(MATERIALS["steel on steel, oiled"])),
        ),
        (
            {"static_coefficient": 0.5, "stribeck_speed": 0.03},
            0.02 * math.sin(math.atan(stribeck(0.5, 0.2, 0.02 * 2.0, 0.03, 2.0))),
        ),
    ],
)
def test_journal__has_the_friction_circle_of_its_bush(given, expected):
    scene = press(0.0, journals=False)
    own = {"pair": "input", "coefficient": 0.2, "diameter": 0.04} | given
    scene["friction"] = {"main": {key: value for key, value in own.items() if value is not None}}
    _, rows = moving(scene, ["input.friction_moment", "input.reaction"], 8)
    circle = -rows["input.friction_moment"] / rows["input.reaction"]
    np.testing.assert_allclose(circle, expected, rtol=8 * EPS)


def test_guide__of_v_form_presses_harder():
    scene = press(0.0, journals=False)
    scene["friction"]["way"] = {"pair": "drive.second", "coefficient": 0.1, "form": "vee", "vee_angle": 1.2}
    _, rows = moving(scene, ["drive.second.friction_force", "drive.second.reaction"], 16)
    force, normal = (row[1:8] for row in rows.values())
    np.testing.assert_allclose(np.abs(force), 0.1 / math.sin(0.6) * np.abs(normal), rtol=8 * EPS)
    assert (force > 0).all()


# Only what is asked


def settled_groups(*fields: str) -> set[str]:
    """Groups on whose friction some fields depend."""
    return {margin.group for margin in Machine(Scene.model_validate(random_dyads()), fields=fields)._measuring.margins}


def test_friction__is_left_out_where_nothing_asked_feels_it():
    assert settled_groups("B1.x", "reduced_inertia", "input_moment") == set()


def test_friction__is_settled_in_the_groups_that_are_asked_alone():
    # Groups are settled last first: the last one feels no other.
    assert settled_groups("g1.first.friction_power") == {"g1"}
    assert settled_groups("g0.first.friction_power") == {"g0", "g1"}


# Refused


test_wrong_friction__is_refused_with_its_mend = refusals(
    lambda friction: order(Scene.model_validate(press(0.1, journals=False) | {"friction": {"x": friction}})),
    ({"pair": "drive.frist", "coefficient": 0.1}, "friction.x.pair … did you mean 'drive.first'"),
    ({"pair": "drive.first", "coefficient": 0.1}, "friction.x.diameter … is missing"),
    ({"pair": "drive.second", "coefficient": 0.1, "diameter": 0.1}, "friction.x.diameter … leave it out"),
    ({"pair": "drive.second"}, "give coefficient or material"),
    ({"pair": "drive.second", "material": "cheese"}, "cheese … known are … steel on steel"),
    ({"pair": "drive.second", "coefficient": 0.1, "form": "vee"}, "vee_angle is missing"),
    ({"pair": "drive.second", "coefficient": 0.1, "stribeck_speed": 1.0}, "belong together"),
)


def test_second_friction_of_a_pair__is_refused():
    scene = press(0.1)
    scene["friction"]["again"] = scene["friction"]["way"]
    with pytest.raises(SceneError, match=r"friction\.again\.pair.*friction\.way"):
        order(Scene.model_validate(scene))
