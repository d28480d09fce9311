"""Non-circular wheels: closed forms of ellipses, 50 digits, rolling, curvature by Euler and Savary, forces."""

import cmath
import math

import numpy as np
import pytest
from driving_cams import asked, changed
from each_case import refusals
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import moving
from mpmath import mp
from noncircular_wheels import CHAIN, ELLIPSES

from engine import Mechanics, MovingMachine, Scene, Verdict
from sweeps.pictures.drawing import primitives

EPS = np.finfo(float).eps


def test_ellipses__turn_and_curve_as_their_closed_forms_say():
    """tan(ψ/2) = (1 + e)/(1 − e) tan(θ/2); ellipses of the half axes a/2, b curve by a b /(a² sin² + b² cos²)^(3/2)."""
    names = ["angle", "pitch_radius", "driver_pitch_radius", "curvature", "driver_curvature", "ratio"]
    q, rows = asked(ELLIPSES, [f"second.{name}" for name in names])
    angle, own, other, curvature, driver_curvature, ratio = (rows[f"second.{n}"] for n in names)
    theta, e, a = q - 0.3, 0.4, math.hypot(0.2, 0.05) / 2
    psi = 2 * np.arctan2((1 + e) * np.sin(theta / 2), (1 - e) * np.cos(theta / 2))
    np.testing.assert_allclose(np.exp(1j * angle), np.exp(1j * (1.0 - psi)), atol=32 * EPS)
    b = a * math.sqrt(1 - e * e)
    # From the focus: r = a(1 − e²)/(1 − e cos θ), and the angle E at the centre by r = a(1 + e cos E).
    np.testing.assert_allclose(other, a * (1 - e * e) / (1 - e * np.cos(theta)), rtol=16 * EPS)
    np.testing.assert_allclose(own + other, 2 * a, rtol=4 * EPS)
    np.testing.assert_allclose(own * ratio, other, rtol=8 * EPS)
    cosine = (other / a - 1) / e
    true = a * b / (a * a * (1 - cosine**2) + b * b * cosine**2) ** 1.5
    np.testing.assert_allclose(driver_curvature, true, rtol=200 * EPS)
    # Equal ellipses touch at points that lie alike.
    np.testing.assert_allclose(curvature, true, rtol=200 * EPS)


def exact_chain(phi: float) -> list[float]:
    """Angles of both wheels of the chain, with two derivatives, by the integrals of their laws."""

    def middle(q: mp.mpf) -> mp.mpf:
        u = 3 * (q - mp.mpf(0.2))
        lead = mp.mpf(0.2) * mp.sin(u) - mp.mpf(0.1) * (1 - mp.cos(u)) + mp.mpf(0.05) / 2 * (1 - mp.cos(2 * u))
        return mp.mpf(0.7) - mp.mpf(3) / 2 * (u + lead) / 3

    def last(q: mp.mpf) -> mp.mpf:
        theta, e = middle(q), mp.mpf(0.3)
        return -theta - 2 * mp.atan2(e * mp.sin(theta), 1 - e * mp.cos(theta))

    return [float(mp.diff(of, phi, n)) for of in (middle, last) for n in (0, 1, 2)]


def test_wheels_after_each_other__turn_as_50_digits_say():
    fields = [f"{of}.angle{rate}" for of in ("middle", "last") for rate in ("", "_phi", "_phiphi")]
    q, rows = asked(CHAIN, [*fields, "middle.pitch_radius", "middle.driver_pitch_radius", "middle.ratio"])
    with mp.workdps(50):
        for k in (0, 5, 16):
            true = exact_chain(q[k])
            found = [rows[name][k] for name in fields]
            for i in (0, 3):
                found[i] -= round((found[i] - true[i]) / math.tau) * math.tau
            # Angles up to 4π, multiplied by three lobes, carry their rounding into two derivatives.
            np.testing.assert_allclose(found, true, atol=1000 * EPS * max(np.abs(true)))
    own, other, ratio = (rows[f"middle.{n}"] for n in ("pitch_radius", "driver_pitch_radius", "ratio"))
    np.testing.assert_allclose(own * ratio, other, rtol=8 * EPS)


def test_force_between_teeth__leans_from_the_tangent_of_the_ellipse_and_holds_the_moment():
    """The normal of an ellipse halves the angle between the lines to its foci."""
    data = changed(ELLIPSES, gravity=0, groups={}, bodies={}, points__D=None, guides={})
    data["moments"] = {"load": {"type": "constant", "on": "second", "moment": "9 N m"}}
    names = ["reaction_x", "reaction_y", "pitch_x", "pitch_y", "tangential_force", "radial_force", "normal_force"]
    q, rows = asked(data, [*(f"second.{name}" for name in names), "input.reaction_x"])
    rows = {name: rows[f"second.{name}"] for name in names}
    distance = complex(0.2, 0.05)
    for k in (1, 7, 15):
        force = -complex(rows["reaction_x"][k], rows["reaction_y"][k])
        place = complex(rows["pitch_x"][k], rows["pitch_y"][k])
        arm = place - distance
        assert (arm.conjugate() * force).imag == pytest.approx(-9, rel=64 * EPS)
        # At the law's beginning the far end of the ellipse, and with it the second focus, points to the other axis.
        second = 0.4 * distance * cmath.exp(1j * (q[k] - 0.3))
        if k == 1:
            assert abs(place) + abs(place - second) == pytest.approx(abs(distance), rel=16 * EPS)
        normal = -place / abs(place) - (place - second) / abs(place - second)
        parts = force / (normal / abs(normal))
        # It pushes the wheel away from the driver, whose foci lie behind the pitch point.
        assert -parts.real == pytest.approx(rows["radial_force"][k], rel=200 * EPS)
        assert abs(parts.imag) == pytest.approx(abs(rows["tangential_force"][k]), rel=200 * EPS)
        assert abs(force) == pytest.approx(rows["normal_force"][k], rel=200 * EPS)
        assert -parts.real == pytest.approx(abs(parts.imag) * math.tan(math.radians(20)), rel=200 * EPS)


FIELDS = [
    *("input_moment_by_equilibrium", "input_moment_by_power", "input.reaction", "middle.reaction", "last.reaction"),
    *("middle.curvature", "middle.driver_curvature", "middle.pitch_radius", "middle.driver_pitch_radius"),
    *("middle.ratio", "middle.angle_phi", "middle.angle_phiphi"),
]
VARIED = (
    *("noncircular_wheels.middle.law.harmonics.one.cosine", "noncircular_wheels.middle.law.harmonics.two.cosine"),
    *("noncircular_wheels.last.law.eccentricity", "noncircular_wheels.middle.begin", "input.speed"),
)


@settings(max_examples=12)
@given(st.floats(-0.4, 0.4), st.floats(-0.3, 0.3), st.floats(0.0, 0.6), st.floats(-6.0, 6.0), st.floats(1.0, 500.0))
def test_any_wheels__balance_and_roll_as_euler_and_savary_say(one, two, eccentricity, begin, speed):
    """Of curves that roll on each other about fixed axes κ₁ + κ₂ = (1/r₁ + 1/r₂) sin μ, tan μ = r₁/r₁′."""
    values = dict(zip(VARIED, (one, two, eccentricity, begin, speed), strict=True))
    rows = [*moving(CHAIN, FIELDS, 24, values)[1].values()]
    balance, power, *forces = rows[:5]
    # Forces at arms of a tenth of a metre, passed on by ratios of up to 1.5·1.85 and 1.6/0.4.
    size = (np.abs(balance) + 12 * sum(np.abs(f) for f in forces)).max()
    np.testing.assert_allclose(balance, power, atol=100 * EPS * size)
    own, other, radius, driver_radius, ratio, w, e = rows[5:]
    first = (radius + driver_radius) * -e / (1 + ratio) ** 2
    sine = driver_radius / np.hypot(driver_radius, first)
    whole = (1 / radius + 1 / driver_radius) * sine
    size = np.abs(own) + np.abs(other) + whole
    np.testing.assert_allclose(own + other, whole, atol=1e-13 * size.max())
    np.testing.assert_allclose(-w, ratio, rtol=4 * EPS)


def test_law_that_would_turn_back__is_a_dead_centre():
    values = dict(zip(VARIED, (1.3, 0.0, 0.0, 0.0, 1.0), strict=True))
    assert MovingMachine(Scene.model_validate(CHAIN), values, 24).verdict(FIELDS) == Verdict.SINGULAR


AT = "noncircular_wheels__second"


test_wrong_wheels__are_refused_in_words = refusals(
    lambda changes: Mechanics(Scene.model_validate(changed(ELLIPSES, **changes))),
    ({f"{AT}__geared_to": "rod"}, "nothing drives"),
    ({f"{AT}__geared_to": "frame"}, "is in mesh with the crank"),
    ({f"{AT}__pivot": "O"}, "wheels in mesh have two axes"),
    ({f"{AT}__pivot": "A"}, "'A' is not on the frame"),
    ({f"{AT}__lobes": 2}, "makes -0.5 turns in a cycle of 1 of the crank"),
    ({"friction": {"f": {"pair": "second", "coefficient": 0.1, "diameter": 0.01}}}, "forces between teeth"),
)


def test_harmonics_that_turn_back__are_refused():
    law = {"type": "harmonic", "harmonics": {"one": {"order": 1, "cosine": 1.1}}}
    with pytest.raises(ValueError, match="would stop or reverse 180°"):
        Scene.model_validate(changed(ELLIPSES, **{f"{AT}__law": law}))


def test_pitch_curves__are_drawn_and_touch_at_the_pitch_point():
    drawn = primitives(Scene.model_validate(ELLIPSES), 1.0)
    own, other = (np.array(p.points) for p in drawn if p.layer == "pitch")
    distance = complex(0.2, 0.05)
    assert own.size == other.size == 721
    theta = 1.0 - 0.3
    touch = abs(distance) / 2 * (1 - 0.16) / (1 - 0.4 * math.cos(theta)) * distance / abs(distance)
    # Points of the curves lie half a degree apart, and the drawing is of the node nearest to 1 rad.
    assert min(abs(own - touch)) < 0.002
    assert min(abs(other - touch)) < 0.002
