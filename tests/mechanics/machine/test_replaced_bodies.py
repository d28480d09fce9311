"""Machines computed with replacement masses in place of bodies, and scenes whose replacement is refused.

Where nothing else is said, tolerances are some roundings (EPS) of the greatest value.
"""

import numpy as np
import pytest
from each_case import refusals
from machines import changed, four_bar, frame, moving, on, rpr, variants_of
from machines import slider_crank as crank_and_ram
from oracle import EPS
from press import bodies, press

from engine import Machine, Scene, Verdict
from engine.scene.masses import body_inertia
from engine.scene.scene import Numbers, scene_numbers

DYNAMICS = ["reduced_inertia", "reduced_inertia_phi", "gravity.moment", "input_moment"]
DYNAMICS += ["shaking_force_x", "shaking_force_y", "shaking_moment"]


def with_points(scene):
    """Three more points on every link that carries a body, none in line with another two."""
    places = {"Q": (0.31, 0.05), "V": (-0.12, 0.22), "W": (0.09, -0.17)}
    links = {body["link"] for body in scene["bodies"].values()}
    more = {f"{q}_{link}": on(link, *at) for link in sorted(links) for q, at in places.items()}
    return scene | {"points": scene["points"] | more}


def dynamic_choices(link):
    q, v, w = (f"{name}_{link}" for name in "QVW")
    return [
        {"type": "dynamic", "at": [q]},
        {"type": "dynamic", "at": [v, w], "mass": 0.4},
        {"type": "dynamic", "at": [q, v, "centre", w]},
    ]


@pytest.mark.parametrize("choice", range(3))
def test_dynamic_replacement_of_every_body__changes_nothing(choice):
    plain = with_points(press(bodies=bodies()))
    replaced = changed(
        plain, {f"bodies.{n}.replace": dynamic_choices(b["link"])[choice] for n, b in plain["bodies"].items()}
    )
    varied = {
        "input.speed": [7.0, -3.0, 5.0],
        "bodies.rocker_body.x": [0.35, 0.3, -0.1],
        "bodies.link_body.shape.length": [0.9, 0.8, 1.4],
        "bodies.coupler_body.mass": [3.0, 30.0, 1.0],
        "groups.bars.first.length": [1.0, 0.95, 1.05],
    }
    for one, other in zip(variants_of(plain, varied), variants_of(replaced, varied), strict=True):
        own, made = moving(one, DYNAMICS, 48)[1], moving(other, DYNAMICS, 48)[1]
        # Replacement masses are some times the body's own, with signs: some hundred roundings of the greatest value.
        for name in DYNAMICS:
            np.testing.assert_allclose(made[name], own[name], rtol=0, atol=500 * EPS * np.abs(own[name]).max())


def test_static_replacement__misses_the_moment_of_inertia_it_says():
    plain = press(bodies={"bar": bodies()["coupler_body"] | {"x": 0.4}})
    replaced = changed(plain, {"bodies.bar.replace": {"type": "static", "at": ["A", "B"]}})
    varied = {"bodies.bar.mass": np.array([3.0, 5.0, 1e-3]), "bodies.bar.x": np.array([0.4, 0.1, 0.6])}
    fields = ["reduced_inertia", "coupler.angle_phi", "bar.inertia_moment", "coupler.angular_acceleration"]
    found = [
        Machine(Scene.model_validate(s), asked, fields, varied, 24).evaluate(varied)
        for s, asked in ((plain, []), (replaced, ["bar.replacement_error"]))
    ]
    error = found[1].summaries["bar.replacement_error"][:, None]
    gap = found[1].fields["reduced_inertia"] - found[0].fields["reduced_inertia"]
    w, epsilon = (found[0].fields[f] for f in ("coupler.angle_phi", "coupler.angular_acceleration"))
    size = np.abs(found[0].fields["reduced_inertia"]).max(axis=1, keepdims=True)
    assert (np.abs(gap - error * w**2) <= 32 * EPS * size).all()
    gap = found[1].fields["bar.inertia_moment"] - found[0].fields["bar.inertia_moment"]
    size = np.abs(found[1].fields["bar.inertia_moment"]).max(axis=1, keepdims=True)
    assert (np.abs(gap + error * epsilon) <= 32 * EPS * size).all()


def test_static_masses__lie_in_the_pins_and_add_up():
    """A connecting rod's textbook masses: m·b/l at the crank pin, m·a/l at the gudgeon pin."""
    scene = slider_crank(replace={"type": "static", "at": ["A", "B"]})
    asked = [f"rod_body.replacement_{what}" for what in ("mass_1", "mass_2", "x_1", "x_2", "y_2", "error")]
    varied = {"groups.g.first.length": np.array([0.8, 1.2]), "bodies.rod_body.x": np.array([0.2, 0.9])}
    found = Machine(Scene.model_validate(scene), asked, varied=varied, positions=8).evaluate(varied).summaries
    length, x = varied.values()
    expected = [2.0 * (length - x) / length, 2.0 * x / length, 0 * x, length, 0 * x, 2.0 * x * (length - x) - 0.1]
    for name, value in zip(asked, expected, strict=True):
        np.testing.assert_allclose(found[name], value, rtol=16 * EPS, atol=8 * EPS)


def slider_crank(**changes):
    body = {"link": "rod", "mass": 2.0, "x": 0.3, "inertia": 0.1, **changes}
    points = {"O": frame(0, 0), "P": on("rod", 0.3, 0.2), "N": on("rod", 0.5, 0.0)}
    bodies = {"rod_body": body, "slider_body": {"link": "slider", "mass": 1.0}}
    return crank_and_ram(0.3, 0.8, slider="slider", points=points, bodies=bodies)


@pytest.mark.parametrize("at", [["A", "centre", "B"], ["A", "N", "B"]])
def test_dynamic_replacement_in_line__changes_nothing(at):
    fields = ["reduced_inertia", "reduced_inertia_phi", "input_moment"]
    scenes = slider_crank(), slider_crank(replace={"type": "dynamic", "at": at})
    own, made = (moving(scene, fields, 24)[1] for scene in scenes)
    for name in fields:
        np.testing.assert_allclose(made[name], own[name], rtol=0, atol=100 * EPS * np.abs(own[name]).max())


def test_variant_that_cannot_be_replaced__is_told_and_has_no_numbers():
    scene = slider_crank(replace={"type": "static", "at": ["A", "B"]})
    machine = Machine(Scene.model_validate(scene), ["reduced_inertia.max"], varied=["bodies.rod_body.y"], positions=8)
    found = machine.evaluate({"bodies.rod_body.y": np.array([0.0, 0.01])})
    assert found.status.tolist() == [Verdict.OK, Verdict.NOT_FINITE]
    assert np.isnan(found.summaries["reduced_inertia.max"]).tolist() == [False, True]


@pytest.mark.parametrize("place", ["crank.O", "crank.A", "coupler.A", "gear.S", "ram.E", "rocker.D", "stone.A"])
def test_joints_of_every_kind_of_link__may_carry_masses(place):
    link, joint = place.split(".")
    scene = press(bodies={"b": {"link": link, "mass": 2.0, "x": 0.11, "y": 0.07, "inertia": 0.03}})
    scene["groups"]["q"] = rpr(("stone", "A"), ("slotted", "D"))
    scene = with_points(scene)
    # What the masses add: a body with the inertia that the static replacement says.
    at = [joint, f"Q_{link}", f"V_{link}"]
    replaced = changed(scene, {"bodies.b.replace": {"type": "static", "at": at}})
    missed = Machine(Scene.model_validate(replaced), ["b.replacement_error"]).evaluate({}).summaries
    scene["bodies"]["b"]["inertia"] += float(missed["b.replacement_error"][0])
    rows = [moving(data, ["reduced_inertia"], 16)[1]["reduced_inertia"] for data in (replaced, scene)]
    np.testing.assert_allclose(*rows, rtol=0, atol=64 * EPS * np.abs(rows[1]).max())


def test_bodies_on_a_yoke__whatever_their_names():
    """The crossing of a yoke's slot and guide has a name like the yoke's own; a body's may be the same."""
    rows = []
    for names in (("yoke", "second"), ("first", "second")):
        scene = four_bar()
        scene["guides"] = {"way": {"link": "rocker", "x": 0.2, "angle": 0.3}}
        second = {"link": "yoke", "guide": "way", "slot_angle": 1.2}
        scene["groups"]["saw"] = {"type": "RPP", "first": {"link": "stone", "joint": "A"}, "second": second}
        scene["bodies"] = {n: {"link": "yoke", "mass": 2.0, "x": 0.2, "y": 0.1} for n in names}
        rows.append(moving(scene, ["reduced_inertia"], 8)[1]["reduced_inertia"])
    assert (rows[0] == rows[1]).all()


# Scenes that are refused


def with_more_points(replace):
    scene = slider_crank(replace=replace)
    scene["points"] |= {"D": frame(1, 1), "M": on("rod", 0.5, 0.0)}
    return Machine(Scene.model_validate(scene))


AT = "bodies.rod_body.replace.at: "
test_impossible_choice__is_refused_in_the_mechanics_words = refusals(
    with_more_points,
    ({"type": "static", "at": ["A", "D"]}, f"{AT}'D' is not a point of link 'rod' … A, B"),
    ({"type": "static", "at": ["A", "center", "B"]}, f"{AT} … did you mean 'centre'"),
    ({"type": "dynamic", "at": ["A", "N", "centre", "M"]}, f"{AT} … 'N' and 'M' coincide"),
    ({"type": "static", "at": ["A", "P"]}, f"{AT} … A, P … on a line through"),
    ({"type": "static", "at": ["A", "N", "B"]}, f"{AT} … don't lie on one line"),
    ({"type": "dynamic", "at": ["centre"]}, f"{AT} … away from the centre of mass"),
    ({"type": "dynamic", "at": ["A", "P", "B"]}, f"{AT} … through its centre of mass"),
    ({"type": "dynamic", "at": ["A", "B"], "mass": 2.0}, f"{AT} … leaves nothing"),
    ({"type": "dynamic", "at": ["A", "N", "B", "centre"]}, f"{AT} … one circle or line"),
)


test_wrong_count__is_refused = refusals(
    lambda replace: Scene.model_validate(slider_crank(replace=replace)),
    ({"type": "static", "at": ["A"]}, "1 points; a static replacement takes 2 or 3"),
    ({"type": "dynamic", "at": ["A", "B", "N", "P", "O"]}, "5 points; a dynamic replacement takes 1, 2, 3 or 4"),
    ({"type": "dynamic", "at": ["A", "B"]}, "the mass at the first, 'A'"),
    ({"type": "static", "at": ["A", "B"], "mass": 1.0}, "mass belongs to a dynamic replacement"),
    ({"type": "static", "at": ["A", "A"]}, "a point twice: A, A"),
)


def test_mass_at_the_first_point__may_vary():
    scene = Scene.model_validate(slider_crank(replace={"type": "dynamic", "at": ["A", "B"], "mass": 0.7}))
    path = "bodies.rod_body.replace.mass"
    asked = [f"rod_body.replacement_mass_{i}" for i in (1, 2, 3)]
    machine = Machine(scene, [*asked, "rod_body.replacement_error"], varied=[path], positions=8)
    found = machine.evaluate({path: np.array([0.2, -0.3, 1.9])})
    np.testing.assert_allclose(sum(found.summaries[name] for name in asked), 2.0, rtol=32 * EPS)
    inertia = body_inertia(scene, "rod_body", Numbers(scene_numbers(scene), {}))
    assert (np.abs(found.summaries["rod_body.replacement_error"]) <= 200 * EPS * inertia).all()
