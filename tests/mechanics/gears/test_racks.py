"""Racks and pinions in mechanisms: s = r φ, 50 digits, forces by hand, and what must balance."""

import cmath
import math

import numpy as np
import pytest
from driving_cams import asked, changed
from each_case import refusals
from mpmath import mp
from racks import DOUBLER, LIFT, ON_CRANK

from engine import Mechanics, Scene
from sweeps.pictures.drawing import primitives

EPS = np.finfo(float).eps


def test_pinion_between_two_racks__doubles_the_stroke():
    fields = ["ram.slide", "table.slide", "table.slide_phiphi", "ram.slide_phiphi", "wheel.angle_phi", "ram.slide_phi"]
    _, rows = asked(DOUBLER, fields)
    ram, table, table2, ram2, turned, ram1 = (rows[name] for name in fields)
    np.testing.assert_allclose(table, 2 * ram, rtol=8 * EPS)
    np.testing.assert_allclose(table2, 2 * ram2, rtol=8 * EPS)
    # It rolls to the right over a rack below it: clockwise.
    np.testing.assert_allclose(turned, -ram1 / 0.03, rtol=8 * EPS)


def exact_lift(phi: float) -> list[float]:
    """Gear's angle, post's place, idler's angle, each with two derivatives, by s = r φ from the slider's place."""

    def ram(q: mp.mpf) -> mp.mpf:
        along, across = mp.mpf(0.05) * mp.cos(q - mp.mpf(0.2)), mp.mpf(0.05) * mp.sin(q - mp.mpf(0.2))
        return along + mp.sqrt(mp.mpf(0.2) ** 2 - across**2)

    axis = mp.mpf(0.25) * mp.cos(mp.mpf(0.2)) + mp.mpf(0.03) * mp.sin(mp.mpf(0.2))
    lift, beside = mp.mpf(0.03) * mp.sin(mp.mpf(1.5)), mp.mpf(0.05) * mp.cos(mp.mpf(1.5))

    def gear(q: mp.mpf) -> mp.mpf:
        return mp.mpf(0.4) + (ram(q) - axis) / mp.mpf(0.04)

    def post(q: mp.mpf) -> mp.mpf:
        return lift + mp.mpf(0.01) - mp.mpf(0.05) * gear(q)

    def idler(q: mp.mpf) -> mp.mpf:
        return (post(q) - beside - mp.mpf(0.1) * mp.sin(mp.mpf(1.5))) / mp.mpf(0.02)

    return [float(mp.diff(of, phi, n)) for of in (gear, post, idler) for n in (0, 1, 2)]


def test_rack_gear_rack_and_idler__move_as_50_digits_say():
    fields = [f"{of}{rate}" for of in ("gear.angle", "post.slide", "idler.angle") for rate in ("", "_phi", "_phiphi")]
    q, rows = asked(LIFT, fields)
    with mp.workdps(50):
        for k in (0, 5, 16):
            true = exact_lift(q[k])
            found = [rows[name][k] for name in fields]
            turns = [round((a - b) / math.tau) * math.tau for a, b in zip(found[::6], true[::6], strict=True)]
            found[0], found[6] = found[0] - turns[0], found[6] - turns[1]
            # Two divisions by radii of a few centimetres after the dyad.
            np.testing.assert_allclose(found, true, atol=2000 * EPS * max(np.abs(true)))


def test_rack_on_a_turning_guide__slides_by_what_its_pinion_gains():
    fields = ["bar.slide", "bar.slide_phi", "bar.slide_phiphi", "bar.angle_phi"]
    q, rows = asked(ON_CRANK, fields)
    phi = q
    beside = -0.01 * math.cos(0.3) - 0.02 * math.sin(0.3)
    np.testing.assert_allclose(rows["bar.slide"], beside + 0.02 * (0.5 + 2 * phi), rtol=16 * EPS, atol=EPS)
    np.testing.assert_allclose(rows["bar.slide_phi"], 0.04, rtol=4 * EPS)
    np.testing.assert_allclose(rows["bar.angle_phi"], 1.0, rtol=4 * EPS)


def test_forces_between_rack_and_pinion__hold_up_a_weight_and_push_the_axis_away():
    """A post of 10 N along y on a pinion to its left: F_t = 10 N, apart F_t tan α, and the moment is F_t r."""
    data = {
        "points": {"O": {"x": 0, "y": 0}},
        "guides": {"up": {"angle": "90 deg"}},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": 1, "start": 0, "stop": 1},
        "racks": {"post": {"pinion": "crank", "pivot": "O", "guide": "up", "radius": 0.04, "pressure_angle": 0.35}},
        "bodies": {"own": {"link": "post", "mass": 1}},
        "gravity": 10,
        "inertia_in_reactions": False,
    }
    names = ["post.tangential_force", "post.radial_force", "post.reaction_x", "input.reaction_x", "input.reaction_y"]
    names += ["input_moment_by_equilibrium", "post.slide", "post.normal_force"]
    q, rows = asked(data, names)
    pull, apart = 10.0, 10 * math.tan(0.35)
    # Driven up by a pinion that turns counter-clockwise, the rack is to the right of its axis.
    expected = [pull, apart, -apart, apart, pull, 0.04 * pull, 0.04 * q[3], pull / math.cos(0.35)]
    for name, value in zip(names, expected, strict=True):
        assert rows[name][3] == pytest.approx(value, rel=16 * EPS), name


test_wrong_racks__are_refused_in_words = refusals(
    lambda data, changes: Mechanics(Scene.model_validate(changed(data, **changes))),
    (DOUBLER, {"racks__table__pinion": "rod"}, "the angle of 'rod' isn't known"),
    (DOUBLER, {"racks__table__pinion": "crank", "racks__table__pivot": "O"}, "the rack would run away"),
    (DOUBLER, {"racks__table__pivot": "A"}, "'A' is not a point of 'wheel'"),
    (DOUBLER, {"racks__table__guide": "other", "guides__other": {}}, "doesn't keep its distance from guide 'other'"),
    (DOUBLER, {"pinions__wheel__pivot": "O"}, "doesn't move along 'way'"),
    (LIFT, {"pinions__gear__rack": "rod"}, "'rod' doesn't slide on a guide"),
    (LIFT, {"pinions__gear__pivot": "B"}, "moves with 'ram'"),
    (LIFT, {"pinions__gear__rack": "post"}, "nothing drives"),
    (DOUBLER, {"guides__arm": {"link": "rod"}, "racks__table__guide": "arm"}, "whose angle relative to 'wheel' isn't"),
    (LIFT, {"friction": {"f": {"pair": "gear", "coefficient": 0.1, "diameter": 0.01}}}, "forces between teeth"),
)


test_pinions_without_sense__are_refused = refusals(
    lambda changes: Scene.model_validate(changed(LIFT, **changes)),
    ({"pinions__gear__guide": "up"}, "give rack or guide, one of the two"),
    ({"pinions__gear__radius": 0}, "moves no rack"),
)


def test_racks__are_drawn_along_the_pitch_circle():
    drawn = primitives(Scene.model_validate(DOUBLER), 1.0)
    circles = [p for p in drawn if p.layer == "pitch"]
    (joint,) = [p for p in drawn if p.layer == "joints" and p.text == "B"]
    assert [p.size for p in circles] == [0.03, 0.03]
    assert all(p.points == joint.points for p in circles)
    along = cmath.exp(0.2j)
    bars = [p for p in drawn if p.kind == "polygon" and len(p.points) == 4]
    heights = [((corner - joint.points[0]) / along).imag for bar in bars for corner in bar.points]
    # The table's bar begins at the top of the circle; positions pass through a few dozen operations.
    assert min(abs(height - 0.03) for height in heights) < 1e-12
