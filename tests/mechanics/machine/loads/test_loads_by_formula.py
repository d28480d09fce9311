"""Loads by formula over the cycle: equal to the loads that they restate, and to closed forms."""

import math

import machines
import numpy as np
import pytest
from each_case import refusals
from hypothesis import example, given, settings
from hypothesis import strategies as st

from engine import Machine, Scene, Verdict
from engine.scene.structure.ordering import order

CRANK, ROD = 0.05, 0.2
LOW, HIGH = ROD - CRANK, ROD + CRANK
EPS = np.finfo(float).eps


def slider_crank(forces: dict | None = None, moments: dict | None = None, speed: float = 10.0) -> Scene:
    """A centric slider-crank; its fast shaft turns three times as fast."""
    parts = {"forces": forces or {}, "moments": moments or {}}
    fast = {"fast": {"geared_to": "crank", "ratio": 3.0}}
    return Scene.model_validate(machines.slider_crank(CRANK, ROD, speed, "drive", shafts=fast, **parts))


def force(formula: str, **more: object) -> dict:
    return {"type": "formula", "on": "B", "angle": 0.0, "force": formula, **more}


def moment(formula: str, **more: object) -> dict:
    return {"type": "formula", "on": "crank", "moment": formula, **more}


def measured(scene: Scene, name: str, values: dict | None = None, statistic: str = "mean") -> np.ndarray:
    values = {path: np.asarray(value, float) for path, value in (values or {}).items()}
    outcome = Machine(scene, summaries=[f"{name}.moment.{statistic}"], varied=list(values)).evaluate(values)
    assert (outcome.status == Verdict.OK).all()
    return outcome.summaries[f"{name}.moment.{statistic}"]


def test_gas_law_by_polynomials_of_the_stroke__works_as_its_integral_says():
    """p = a0 + a1 s + a2 s² out, b0 + b3 s³ back; the work of a cycle is the area between."""
    formula = "area * (a0 + a1 * ram.from_low + a2 * ram.from_low^2 if v > 0 else b0 + b3 * ram.from_low^3)"
    numbers = {"area": "20 cm2", "a0": "5 bar", "a1": "-40 bar/m", "a2": "90 bar/m2", "b0": "1 bar", "b3": "700 bar/m3"}
    s, a3 = HIGH - LOW, np.array([70e5, 700e5, 1400e5])
    out = 5e5 * s - 40e5 * s**2 / 2 + 90e5 * s**3 / 3
    back = 1e5 * s + a3 * s**4 / 4
    scene = slider_crank({"gas": force(formula, numbers=numbers)})
    found = measured(scene, "gas", {"forces.gas.numbers.b3": a3})
    # Integrals of smooth pieces, of sizes of a few joules over a turn.
    np.testing.assert_allclose(found, 20e-4 * (out - back) / (2 * math.pi), rtol=1e-12)


def test_window_at_a_swept_place__has_its_work_to_rounding():
    """A spring that is met on the way out only: ½ k (high − x0)², from none at all to the whole stroke, and less."""
    scene = slider_crank(
        {
            "stop": force(
                "-k * (ram.slide - x0) if ram.slide > x0 and v > 0 else 0", numbers={"k": "8 N/mm", "x0": "0.2 m"}
            )
        }
    )
    places = np.array([LOW - 0.01, LOW, 0.2, HIGH - 1e-3, HIGH - 1e-6, HIGH, HIGH + 0.01])
    depth = HIGH - places
    work = np.where(
        places < LOW, 8e3 * (HIGH - LOW) * (0.5 * (HIGH + LOW) - places), 0.5 * 8e3 * np.maximum(depth, 0) ** 2
    )
    found = measured(scene, "stop", {"forces.stop.numbers.x0": places})
    # Rounding of a place of 0.25 m, at the force there.
    np.testing.assert_allclose(found, -work / (2 * math.pi), rtol=1e-11, atol=1e-13)


def test_lesser_of_a_level_and_a_power_of_the_stroke__switches_where_they_meet():
    """Full force from half the stroke on: ∫ 4 (s/h)² ds to h/2, then 1: h (4/24 + 1/2), times 100 N."""
    scene = slider_crank({"gas": force("min(100 N, 400 N * (ram.from_low / ram.stroke)^2) if v > 0 else 0")})
    expected = 100 * (HIGH - LOW) * (1 / 6 + 1 / 2) / (2 * math.pi)
    assert measured(scene, "gas")[0] == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("periods", [1, 3, 6])
def test_pieces_over_the_crank_angle__have_their_mean(periods):
    scene = slider_crank(moments={"pulse": moment(f"10 N m if sin({periods} * phi + 1) > 0.2 else 1 N m")})
    share = (math.pi - 2 * math.asin(0.2)) / (2 * math.pi)
    np.testing.assert_allclose(measured(scene, "pulse"), 1 + 9 * share, rtol=1e-13)


WINDOWED = slider_crank(
    moments={"pulse": moment("10 N m if phi > a and phi < b else 0", numbers={"a": "0.1 rad", "b": "0.2 rad"})}
)


@settings(max_examples=25)
@given(st.tuples(st.floats(0.0, 6.28), st.floats(0.0, 6.28)).map(sorted))
@example([0.2, 6.2831])
@example([6.11, 6.15])
@example([6.2, 6.2831853])
def test_window_of_the_crank_angle__ends_where_it_says_up_to_the_end_of_the_turn(window):
    given_by = {f"moments.pulse.numbers.{name}": np.array([end]) for name, end in zip("ab", window, strict=True)}
    found = measured(WINDOWED, "pulse", given_by)[0]
    # Each end is found to some roundings of a turn.
    assert found == pytest.approx(10 * (window[1] - window[0]) / (2 * math.pi), abs=10 * 32 * EPS)


def test_smooth_formula__has_mean_and_rms_in_closed_form():
    scene = slider_crank(moments={"m": moment("5 N m + 3 N m * sin(2 * phi + 0.4) - 2 N m * cos(3 * phi)")})
    assert measured(scene, "m")[0] == pytest.approx(5.0, rel=1e-13)
    assert measured(scene, "m", statistic="rms")[0] == pytest.approx(math.sqrt(25 + 4.5 + 2), rel=1e-12)


RAMP = {"over_time": [0.25, 2.0], "moment": [3.0, 24.0], "interpolation": "linear", "outside": "zero"}


@pytest.mark.parametrize(
    "load", [moment("12 N m * t / (1 s) if t > 0.25 s else 0"), {"type": "table", "on": "crank"} | RAMP]
)
def test_moment_that_depends_on_time__is_that_of_a_range_at_uniform_speed(load):
    """∫ t dφ: 12 N m s⁻¹ · t over 0 … 2π/ω, after a second that is half over at twice the speed.

    Over a range of the crank, as a cycle would have to repeat itself.
    """
    speed = 2 * math.pi
    scene = slider_crank(moments={"m": load}, speed=speed)
    drive = scene.input.model_copy(update={"start": 0.0, "stop": 2 * math.pi})
    scene = scene.model_copy(update={"input": drive})
    found = measured(scene, "m", {"input.speed": [speed, 2 * speed]})
    np.testing.assert_allclose(found, [12 * (1 - 1 / 16) / 2, 12 * (1 / 4 - 1 / 16)], rtol=1e-12)


def test_speed_in_other_ways_than_by_powers__is_true_at_uniform_speed():
    """Stribeck's curve at the pin, whose speed is constant."""
    formula = "-(2 N + 3 N * exp(-(v / vs)^2))"
    scene = slider_crank({"rub": {**force(formula, numbers={"vs": "0.4 m/s"}), "on": "A", "angle": None}})
    found = measured(scene, "rub", {"input.speed": [10.0, -10.0]})
    size = CRANK * (2 + 3 * math.exp(-((0.5 / 0.4) ** 2)))
    np.testing.assert_allclose(found, [-size, size], rtol=1e-14)


def test_root_that_begins_in_a_switch__is_finite_up_to_its_end():
    scene = slider_crank(
        {"f": force("3 N * sqrt((ram.slide - x0) / (1 m)) if ram.slide > x0 and v > 0 else 0", numbers={"x0": "0.2 m"})}
    )
    found = measured(scene, "f", {"forces.f.numbers.x0": [0.16, 0.2, 0.24]})
    expected = 3 * (HIGH - np.array([0.16, 0.2, 0.24])) ** 1.5 / 1.5 / (2 * math.pi)
    # A root ends with an infinite slope, which panels follow more and more closely only.
    np.testing.assert_allclose(found, expected, rtol=1e-8)


@pytest.mark.parametrize("formula", ["1 N m / (phi - n)", "1 N m * (phi - n)^-2"])
def test_pole_within_the_cycle__is_a_status_wherever_it_is(formula):
    scene = slider_crank(moments={"m": moment(formula, numbers={"n": 1})})
    machine = Machine(scene, summaries=["m.moment.mean"], varied=["moments.m.numbers.n"])
    outcome = machine.evaluate({"moments.m.numbers.n": np.array([-1.0, 0.001, 2.0, 3.7, 6.2831, 7.0])})
    met = Verdict.NOT_FINITE
    assert outcome.status.tolist() == [Verdict.OK, met, met, met, met, Verdict.OK]
    turn = 2 * math.pi
    expected = [math.log((turn - n) / -n if n < 0 else (n - turn) / n) for n in (-1.0, 7.0)]
    if "^" in formula:
        expected = [1 / -n + 1 / (n - turn) for n in (-1.0, 7.0)]
    off = outcome.summaries["m.moment.mean"][[0, -1]] - np.array(expected) / turn
    assert (np.abs(off) <= outcome.errors["m.moment.mean"][[0, -1]]).all()
    assert (outcome.errors["m.moment.mean"][[0, -1]] < 1e-11).all()


def test_quotient_of_what_vanishes_together__has_its_limit():
    """What many write for a sign; and one whose limit is that of the rates."""
    loads = {
        "sign": force("5 N * v / abs(v)", on="B"),
        "other": force("5 N * sign(v)", on="B"),
        "flat": force("4 N * sin(phi - 2) / (phi - 2)", on="B"),
    }
    scene = slider_crank(loads)
    names = [f"{name}.moment.rms" for name in loads]
    outcome = Machine(scene, summaries=names, fields=["flat.moment"], positions=8).evaluate({})
    assert outcome.status[0] == Verdict.OK
    sign, other = (outcome.summaries[name][0] for name in names[:2])
    assert abs(sign - other) <= 40 * EPS * other
    assert np.isfinite(outcome.fields["flat.moment"]).all()


def test_machine_that_cannot_be_assembled__isn_t_helped_by_a_piece_that_holds_without_it():
    scene = slider_crank(
        {"f": force("max(0, 3 N * (ram.slide - 0.3 m) / (1 m))")}, {"m": moment("1 N m if ram.slide > 1 m else 2 N m")}
    )
    machine = Machine(scene, summaries=["f.moment.mean", "m.moment.mean"], varied=["groups.drive.first.length"])
    outcome = machine.evaluate({"groups.drive.first.length": np.array([0.2, 0.04])})
    assert outcome.status.tolist() == [Verdict.OK, Verdict.CANNOT_ASSEMBLE]
    assert np.isnan(outcome.summaries["m.moment.mean"][1])


OFTEN = "may switch too often in a cycle to be found"
test_what_may_switch_oftener_than_is_looked_for__is_refused = refusals(
    lambda formula: order(slider_crank({"f": force(formula, numbers={"n": 2})})),
    ("1 N if sin(7 * phi) > 0 else 0", OFTEN),
    ("1 N if sin(n * phi) > 0 else 0", OFTEN),
    ("abs(1 N * sin(40 * ram.slide / ram.stroke))", OFTEN),
    ("min(1 N, 1 N * sin(2 * phi) * cos(3 * phi) * sin(4 * phi))", OFTEN),
    ("1 N * sign(sin(100 rad/s * t))", OFTEN),
    ("1 N if (ram.slide / (1 m))^9 > 0.2 else 0", OFTEN),
)
