"""Bodies whose moment of inertia is told by the time of a swing: as pendulums and on two or three wires."""

import math

import numpy as np
import pytest
from each_case import refusals
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import slider_crank
from scipy.integrate import quad

from engine import Machine, Scene, Verdict
from engine.laws.masses.link_inertia import bifilar_inertia, compound_inertia, trifilar_inertia
from engine.parts.bodies import STANDARD_GRAVITY

EPS = np.finfo(float).eps
few = settings(max_examples=60)
sizes = st.floats(-2, 2).map(lambda e: 10.0**e)
WIRES = {"type": "bifilar", "period": "1.2 s", "spacing": "0.3 m", "length": "1.5 m"}
KNIFE = {"type": "compound", "period": "1 s", "distance": "0.15 m"}


def scene(swing, **body):
    rod = {"link": "rod", "mass": 2.0, "x": 0.08, "swing": swing} | body
    return slider_crank(0.05, 0.2, 30.0, bodies={"rod_body": rod, "ram_body": {"link": "ram", "mass": 1.5}})


# The equations


@few
@given(sizes, sizes, sizes)
def test_pendulum__swings_in_the_time_of_a_uniform_rod(mass, length, gravity):
    """A uniform rod hung at its end is as slow as a point at two thirds of its length."""
    period = math.tau * math.sqrt(2 * length / (3 * gravity))
    found = compound_inertia(mass, mass * gravity, length / 2, period)
    # mL²/3 less mL²/4 leaves a quarter of the minuend: the roundings of a dozen operations, four times.
    assert found == pytest.approx(mass * length**2 / 12, rel=50 * EPS)


@few
@given(sizes, st.floats(0.05, 1.0), st.floats(0.5, 3.0), sizes)
def test_wires__give_the_inertia_that_the_exact_swing_has(weight, radius, length, inertia):
    """The period by energy, T = 4 ∫ dθ/√(2(V₀ − V)/J), for an amplitude so small that its square is lost."""
    top = 1e-3 * min(1.0, length / radius)

    def slowness(u):
        # θ = top sin u leaves no singular end.
        turn = top * math.sin(u)
        # V₀ − V without cancellation, from the product of the sines.
        rise = 4 * radius**2 * math.sin((top + turn) / 2) * math.sin((top - turn) / 2)
        roots = [math.sqrt(length**2 - (2 * radius * math.sin(a / 2)) ** 2) for a in (top, turn)]
        left = weight * rise / (roots[0] + roots[1])
        return top * math.cos(u) / math.sqrt(2 * left / inertia)

    period = 4 * quad(slowness, 0, math.pi / 2, epsrel=1e-10)[0]
    # Of an amplitude a the period is longer by about (a/4)², here and by the wires' lean (a r/L)²: below 2e-6.
    assert trifilar_inertia(weight, radius, length, period) == pytest.approx(inertia, rel=4e-6)
    assert bifilar_inertia(weight, 2 * radius, length, period) == pytest.approx(inertia, rel=4e-6)


# In a machine


@pytest.mark.parametrize(
    ("swing", "inertia"),
    [
        (KNIFE, 2 * STANDARD_GRAVITY * 0.15 / (4 * math.pi**2) - 2 * 0.15**2),
        ({**KNIFE, "gravity": "9.78 m/s2"}, 2 * 9.78 * 0.15 / (4 * math.pi**2) - 2 * 0.15**2),
        (WIRES, 2 * STANDARD_GRAVITY * 0.3**2 * 1.2**2 / (16 * math.pi**2 * 1.5)),
        (
            {"type": "trifilar", "period": "1.2 s", "radius": "0.2 m", "length": "1.5 m"},
            2 * STANDARD_GRAVITY * 0.2**2 * 1.2**2 / (4 * math.pi**2 * 1.5),
        ),
    ],
    ids=["compound", "compound elsewhere", "bifilar", "trifilar"],
)
def test_swung_body__is_the_body_of_that_inertia(swing, inertia):
    asked = ["reduced_inertia.max", "input_moment.max"]
    swung = Machine(Scene.model_validate(scene(swing)), [*asked, "rod_body.moment_of_inertia"]).evaluate({})
    plain = scene(None, inertia=inertia)
    given_outright = Machine(Scene.model_validate(plain), asked).evaluate({})
    found = swung.summaries["rod_body.moment_of_inertia"][0]
    assert abs(found - inertia) <= 4 * swung.errors["rod_body.moment_of_inertia"][0] < 1e-13 * inertia
    for name in asked:
        assert swung.summaries[name] == pytest.approx(given_outright.summaries[name], rel=1e-12)


def test_swing__varies_and_one_faster_than_a_point_mass_gives_no_number():
    path = "bodies.rod_body.swing.period"
    asked = ["rod_body.moment_of_inertia", "reduced_inertia.max"]
    periods = np.array([0.9, 1.0, 0.7])
    outcome = Machine(Scene.model_validate(scene(KNIFE)), asked, varied=[path]).evaluate({path: periods})
    assert outcome.status.tolist() == [Verdict.OK, Verdict.OK, Verdict.NOT_FINITE]
    exact = 2 * STANDARD_GRAVITY * 0.15 * (periods / math.tau) ** 2 - 2 * 0.15**2
    assert outcome.summaries[asked[0]][:2] == pytest.approx(exact[:2], rel=1e-13)
    assert np.isnan([outcome.summaries[name][2] for name in asked]).all()


test_swing_that_cannot_be__is_refused = refusals(
    lambda swing, body: Scene.model_validate(scene(swing, **body)),
    ({**KNIFE, "period": "0.5 s"}, {}, "period = 0.5 s: no body swings faster … in 0.7771 s"),
    (KNIFE, {"inertia": 0.01}, "give swing or inertia, one of the two"),
    (WIRES, {"mass": None, "density": 7800.0, "shape": {"type": "rod", "length": 0.2}}, "give swing or shape"),
    (WIRES, {"mass": None}, "give mass"),
)
