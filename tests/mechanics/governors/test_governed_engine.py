"""An engine with its governor near equilibrium: its linear equation from the governor's energies, its verdicts."""

import mpmath as mp
import numpy as np
import pytest
from each_case import refusals
from element_samples import results
from exact_governor import ExactGovernor
from governor_samples import ENGINE, HARTNELL, PORTER, PROELL, TABLE
from numpy.testing import assert_allclose

from engine import Scene, Verdict

REGULATED = {"inertia": 6.0, "ratio": 1.4, "throttle": {"type": "linear", "full": 500.0, "closed": 40.0}, "load": 350.0,
             "new_load": 180.0, "self_regulation": 3.0}  # fmt: skip


def equilibrium(governor, load):
    """Angle at which the engine carries a load, with many digits."""
    engine = governor["engine"]
    exact = ExactGovernor(governor)
    low, high = exact.inner, exact.angle(governor["greatest_radius"])
    mean, whole = (exact.speed(low) + exact.speed(high)) / 2, exact.lift(high)
    full, closed = (mp.mpf(engine["throttle"].get(key, 0.0)) for key in ("full", "closed"))

    def left(angle):
        moment = full - (full - closed) * exact.lift(angle) / whole
        return moment - engine["self_regulation"] * (exact.speed(angle) - mean) / engine["ratio"] - load

    return exact, mp.findroot(left, (low + high) / 2), (full - closed) / whole


@pytest.mark.parametrize("governor", [PORTER, PROELL, HARTNELL], ids=lambda g: g["type"])
def test_linear_equation__is_that_of_the_energies(governor):
    governor = governor | {"damping": 250.0, "engine": REGULATED}
    found, errors, status = results(governor)
    assert status[0] == Verdict.OK
    with mp.workdps(40):
        exact, angle, gain = equilibrium(governor, 180.0)
        _, before, _ = equilibrium(governor, 350.0)
        m, c = exact.sleeve_mass(angle), exact.sleeve_stiffness(angle)
        ratio, s, b = mp.mpf(1.4), mp.mpf(3), mp.mpf(250)
        inertia = 6 + ratio**2 * exact.inertia(angle)
        speed = exact.speed(angle) / ratio
        pull = 2 * exact.sleeve_force(angle) / speed
        # State: lift, its rate, speed. Moving balls take 2 E/ω of the engine's momentum for each metre.
        matrix = mp.matrix([[0, 1, 0], [-c / m, -b / m, pull / m], [-gain / inertia, -pull / inertia, -s / inertia]])
        roots = mp.eig(matrix, left=False, right=False)
        slowest = max(mp.re(r) for r in roots)
        wanted = {
            "working_lift": exact.lift(angle),
            "working_speed": speed,
            "steady_speed_change": speed - exact.speed(before) / ratio,
            "decay_rate": -slowest,
            "hunting_frequency": max(mp.im(r) for r in roots),
        }
    for name, value in wanted.items():
        assert abs(float(value - mp.mpf(float(found[name][0])))) <= errors[name][0] < 1e-9 * abs(value), name
    assert found["stable"][0] == (slowest < 0)
    assert found["oscillates"][0] == (wanted["hunting_frequency"] > 0)


def test_isochronous_governor__keeps_the_speed_and_hunts():
    stiff = 19.8e3
    governor = HARTNELL | {"gravity": 0.0, "preload": stiff * 0.12 * 2 / 3, "damping": 300.0, "engine": ENGINE}
    found, errors, status = results(governor)
    assert status[0] == Verdict.OK
    assert abs(found["steady_speed_change"][0]) <= errors["steady_speed_change"][0] < 1e-11
    # Y is what the balls' momentum makes of it, and nothing else: little.
    assert found["stable"][0] == 0
    assert 0 <= found["vyshnegradsky_y"][0] < 0.1
    # With self-regulation enough, a wheel light enough and damping it is stable all the same.
    calm = governor | {"damping": 3000.0, "engine": ENGINE | {"self_regulation": 60.0}}
    assert results(calm)[0]["stable"][0] == 1


def test_without_damping__nothing_helps_but_the_gain():
    found, _, status = results(PORTER | {"engine": ENGINE})
    assert (status[0], found["stable"][0]) == (Verdict.OK, 0)
    assert found["gain_margin"][0] == 0
    assert np.isnan(found["critical_inertia"][0])
    assert found["critical_damping"][0] > 0


def test_loads_that_the_throttle_cannot_carry__are_verdicts():
    governor = PORTER | {"engine": ENGINE}
    _, _, status = results(governor, engine__load=[399.0, 401.0, 1.0, -1.0])
    assert list(status) == [Verdict.OK, Verdict.STALLS, Verdict.OK, Verdict.RUNS_AWAY]
    _, _, status = results(governor, engine__new_load=[399.0, 401.0, 1.0, -1.0])
    assert list(status) == [Verdict.OK, Verdict.STALLS, Verdict.OK, Verdict.RUNS_AWAY]


def test_throttle_by_a_straight_table__is_the_linear_one():
    lift = results(PORTER)[0]["sleeve_lift"][0]
    table = {"type": "table", "over_lift": [0.0, lift / 3, lift], "moment": [400.0, 800 / 3, 0.0],
             "interpolation": "linear"}  # fmt: skip
    governor = PORTER | {"damping": 100.0, "engine": ENGINE}
    linear, _, _ = results(governor)
    tabled, _, _ = results(governor | {"engine": ENGINE | {"throttle": table}})
    for name, column in linear.items():
        assert_allclose(tabled[name], column, rtol=1e-12, atol=1e-15, err_msg=name)


def test_valve_that_is_open_or_shut__has_no_equilibrium_but_its_switch():
    throttle = {"type": "full and shut", "full": 400.0, "closed": 0.0, "switch": 0.03}
    governor = PORTER | {"damping": 100.0, "engine": ENGINE | {"throttle": throttle}}
    found, _, status = results(governor, engine__throttle__switch=[0.03, 0.05, 0.11])
    assert list(status) == [Verdict.OK, Verdict.OK, Verdict.OUTSIDE_LIMITS]
    assert_allclose(found["working_lift"][:2], [0.03, 0.05], rtol=1e-12)
    assert list(found["stable"][:2]) == [0, 0]
    assert np.isnan(found["vyshnegradsky_x"]).all()
    with mp.workdps(30):
        exact = ExactGovernor(PORTER)
        angle = mp.findroot(lambda a: exact.lift(a) - mp.mpf("0.03"), exact.inner + mp.mpf("0.1"))
        assert_allclose(found["working_speed"][0], float(exact.speed(angle)), rtol=1e-12)


test_engines_that_cannot_be__are_refused = refusals(
    lambda engine: Scene.model_validate({"elements": {"it": TABLE | {"engine": ENGINE | engine}}}),
    ({"throttle": {"type": "linear", "full": 0.0, "closed": 100.0}}, "full = 0 N·m is not above closed = 100 N·m"),
    (
        {"throttle": {"type": "table", "over_lift": [0, 0.1], "moment": [100, 200], "interpolation": "linear"}},
        "moment rises in row 2, from 100 N·m to 200 N·m",
    ),
    ({"new_load": None, "duration": 3.0}, "give new_load, or leave duration out"),
    ({"inertia": 0.0}, "inertia is missing"),
    ({"inertia": -1.0}, "must be at least 0"),
)
