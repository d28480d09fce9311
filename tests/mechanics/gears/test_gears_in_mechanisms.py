"""Planets and geared cranks inside mechanisms: known curves, Willis, 50 digits, and what must balance."""

import math

import numpy as np
import pytest
from driving_cams import asked, changed
from each_case import refusals
from geared_links import CARDAN, FIVE_BAR, TRAIN
from mpmath import mp

from engine import Machine, Mechanics, Scene, SceneError, Verdict

EPS = np.finfo(float).eps


def test_cardan_circles__draw_a_straight_line_of_twice_the_crank_to_either_side():
    q, rows = asked(CARDAN, ["P.x", "P.y", "planet.angle", "ram.velocity"])
    phi, omega = q, 4 * math.pi
    # Angles up to 2π carry its rounding.
    np.testing.assert_allclose(rows["P.x"], 0.1 * np.cos(phi), atol=8 * EPS)
    np.testing.assert_allclose(rows["P.y"], 0.0, atol=8 * EPS)
    np.testing.assert_allclose(rows["planet.angle"], -phi, atol=16 * EPS)
    np.testing.assert_allclose(rows["ram.velocity"], -0.1 * omega * np.sin(phi), atol=30 * EPS * omega)


def test_planets__turn_as_willis_says():
    """ω_p = ω_h + (z_s/z_p)(ω_h − ω_s) on the outside of a sun, ω_h − (z_r/z_p) ω_h inside a ring that stands."""
    # The moon comes back to its place after five turns.
    data = changed(TRAIN, input__revolutions=5)
    _, rows = asked(data, ["moon.angle_phi", "planet.angle_phi", "tip.x", "reduced_inertia"], positions=120)
    planet, moon = 1 - 24 / 30 * (3 - 1), 1 - 84 / 30
    np.testing.assert_allclose(rows["planet.angle_phi"], planet, rtol=4 * EPS)
    np.testing.assert_allclose(rows["moon.angle_phi"], moon, rtol=4 * EPS)
    # Of the moon's centre, off its axis by 0.02 m at the angle θ − φ to the arm.
    angle = 1.0 + (moon - 1.0) * 10 * math.pi * np.arange(120) / 120
    square = 0.05**2 + (0.02 * moon) ** 2 + 2 * 0.05 * 0.02 * moon * np.cos(angle)
    inertia = 0.002 * 9 + 0.003 * planet**2 + 0.0004 * moon**2 + 0.5 * square
    np.testing.assert_allclose(rows["reduced_inertia"], inertia, rtol=40 * EPS)


def exact_five_bar(phi: float, ratio: float) -> tuple:
    """Joint of the rods and its first two derivatives, by the implicit equations |B − A|² = a², |B − D|² = b²."""
    phi, ratio = mp.mpf(phi), mp.mpf(ratio)

    def joint(q: mp.mpf) -> tuple[mp.mpf, mp.mpf]:
        a = mp.matrix([mp.mpf(0.05) * mp.cos(q), mp.mpf(0.05) * mp.sin(q)])
        angle = ratio * q + 1
        d = mp.matrix([mp.mpf(0.18) + mp.mpf(0.04) * mp.cos(angle), mp.mpf(0.04) * mp.sin(angle)])
        apart = mp.norm(d - a)
        along = (apart**2 + mp.mpf(0.15) ** 2 - mp.mpf(0.16) ** 2) / (2 * apart)
        height = mp.sqrt(mp.mpf(0.15) ** 2 - along**2)
        u = (d - a) / apart
        return a[0] + along * u[0] - height * u[1], a[1] + along * u[1] + height * u[0]

    return tuple(mp.diff(lambda q, axis=axis: joint(q)[axis], phi, n) for axis in (0, 1) for n in (0, 1, 2))


@pytest.mark.parametrize("ratio", [1, -1, 2])
def test_geared_five_bar__moves_as_50_digits_say(ratio):
    fields = [f"B.{axis}{rate}" for axis in "xy" for rate in ("", "_phi", "_phiphi")]
    data = changed(FIVE_BAR, shafts__second__ratio=ratio, shafts__second__pressure_angle="20 deg" if ratio < 0 else 0.3)
    if ratio == 1:
        del data["shafts"]["second"]["pressure_angle"]
    q, rows = asked(data, fields)
    with mp.workdps(50):
        for k in (0, 5, 16):
            true = [float(v) for v in exact_five_bar(q[k], ratio)]
            found = [rows[name][k] for name in fields]
            # Ratio 2 doubles what an angle's rounding does, and squares it in the second derivative.
            np.testing.assert_allclose(found, true, atol=400 * EPS * max(np.abs(true)))


def test_forces_between_teeth__turn_the_shaft_and_load_both_bearings():
    """A moment M on a shaft a = 0.18 m away: F_t = M/r, r = a/(1 + 2), and F_r = F_t tan α apart, in both bearings."""
    data = changed(FIVE_BAR, gravity=0, groups={}, bodies={}, points__D=None)
    data["shafts"]["second"] |= {"ratio": -2, "pressure_angle": "20 deg"}
    data["moments"] = {"load": {"type": "constant", "on": "second", "moment": "9 N m"}}
    names = ["second.tangential_force", "second.radial_force", "second.reaction_x", "second.reaction_y"]
    names += ["input.reaction_x", "input.reaction_y", "input_moment_by_equilibrium", "second.normal_force"]
    _, rows = asked(data, names)
    pull = 9 / 0.06
    apart = pull * math.tan(math.radians(20))
    found = {name: rows[name][3] for name in names}
    # The moment is counter-clockwise: at the pitch point, left of it, the shaft presses down, and is held up.
    expected = {
        "second.radial_force": apart,
        "second.normal_force": pull / math.cos(math.radians(20)),
        "second.reaction_x": -apart,
        "second.reaction_y": -pull,
        "input.reaction_x": apart,
        "input.reaction_y": pull,
        "input_moment_by_equilibrium": 18.0,
    }
    assert abs(found["second.tangential_force"]) == pytest.approx(pull, rel=8 * EPS)
    for name, value in expected.items():
        assert found[name] == pytest.approx(value, rel=16 * EPS), name


test_wrong_planets__are_refused_in_words = refusals(
    lambda changes: Mechanics(Scene.model_validate(changed(CARDAN, **changes))),
    ({"shafts__planet__pivot": "O"}, "it is coaxial with 'frame', so it has no mesh"),
    ({"shafts__planet__pivot": None}, "'planet' has no pivot; give it one"),
    ({"shafts__planet__carrier": "rod"}, "gears that nothing drives"),
    ({"shafts__planet__ratio": 1}, "axes lie apart"),
    ({"shafts__planet__geared_to": "crank"}, "'crank' carries this wheel"),
    (
        {
            "points__C": {"x": 0.2, "y": 0},
            "shafts__far": {"geared_to": "crank", "ratio": 2, "pivot": "C"},
            "shafts__planet__geared_to": "far",
        },
        "the distance of their axes would change",
    ),
    ({"shafts__planet__ratio": 1.5}, "'planet' makes -0.5 turns in a cycle of 1 of the crank"),
    ({"shafts__planet__carrier": None}, "'A' is not on the frame"),
    ({"friction": {"f": {"pair": "planet", "coefficient": 0.1, "diameter": 0.01}}}, "aren't computed together"),
)


def test_cycle_of_a_five_bar__closes_after_the_denominator_of_its_ratio():
    data = changed(FIVE_BAR, shafts__second__ratio="-3/2")
    with pytest.raises(SceneError, match=r"makes -1\.5 turns in a cycle of 1"):
        Mechanics(Scene.model_validate(data))
    Mechanics(Scene.model_validate(changed(data, input__revolutions=2)))


def test_ratios_that_do_not_close_the_cycle__are_told():
    machine = Machine(Scene.model_validate(FIVE_BAR), ["equilibrium_residual"], varied=["shafts.second.ratio"])
    status = machine.evaluate({"shafts.second.ratio": np.array([1.0, 1.3, -1.0])}).status
    assert [Verdict(code) for code in status] == [Verdict.OK, Verdict.DOES_NOT_CLOSE, Verdict.OK]
