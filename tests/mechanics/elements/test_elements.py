"""Results of machine elements, with their verdicts and error estimates."""

import math

import mpmath
import numpy as np
import pytest
from element_samples import BELT, CAR, GUIDE, INCLINE, JACK, JOURNAL, ROLLER, WEDGE, one, results, scene, solved
from hypothesis import given, settings
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose, assert_array_equal
from scipy.optimize import brentq

from engine import ElementsAlone, Verdict
from engine.laws.friction.coefficients import WORN_IN

EPS = np.finfo(float).eps

# Results of the elements


@pytest.mark.parametrize(("thread", "angle"), [("square", 0.0), ("trapezoidal", 30.0), ("metric", 60.0)])
def test_named_thread__is_that_of_its_angle(thread, angle):
    bare = {key: value for key, value in JACK.items() if key != "thread"}
    names = ("raise_moment", "lower_moment", "locking_friction", "friction_angle")
    assert one(bare, *names, thread=thread) == one(bare, *names, thread_angle=math.radians(angle))
    with mpmath.workdps(30):
        reduced = mpmath.atan(mpf(0.08) / mpmath.cos(mpmath.radians(angle / 2)))
    assert_allclose(one(bare, "friction_angle", thread=thread), [float(reduced)], rtol=6 * EPS)


@settings(max_examples=25)
@given(st.floats(0.001, 0.1), st.floats(0.0, 0.3), st.floats(0.0, 1.2), st.floats(0.0, 0.02))
def test_screw__takes_in_what_it_gives_and_loses(pitch, friction, angle, collar):
    changes = {"pitch": pitch, "friction": friction, "thread": None, "thread_angle": angle, "collar_friction": collar}
    names = ("raise_moment", "lower_moment", "raise_efficiency", "lower_efficiency", "self_locking")
    values, errors, _ = results(JACK | changes, *names)
    lead, load = 2 * pitch, 6400.0
    with mpmath.workdps(40):
        beta = mpmath.atan(mpf(lead) / (mpmath.pi * mpf(0.030)))
        phi = mpmath.atan(mpf(friction) / mpmath.cos(mpf(angle) / 2))
        if beta + phi >= mpmath.pi / 2 - mpf(10) ** -6:
            return
        held = mpf(collar) * load * mpf(0.020)
        up = mpf(load) * mpf(0.015) * mpmath.tan(beta + phi) + held
        down = mpf(load) * mpf(0.015) * mpmath.tan(phi - beta) + held
        work = mpf(load) * mpf(lead) / (2 * mpmath.pi)
        expected = [up, down, work / up, max(-down / work, 0), 1 if down >= 0 else 0]
        # The stated error estimates hold.
        for name, exact in zip(names[:4], expected[:4], strict=True):
            assert abs(mpf(float(values[name][0])) - exact) <= errors[name][0]
    if abs(down) > errors["lower_moment"][0]:
        assert values["self_locking"][0] == expected[4]
    assert errors["self_locking"][0] == 0.0


@pytest.mark.parametrize("collar", [0.0, 0.02])
def test_screw__locks_by_itself_from_the_friction_it_names(collar):
    changes = {**JACK, "thread": "trapezoidal", "collar_friction": collar}

    def lowering(friction):
        return one(changes, "lower_moment", friction=friction)[0]

    limit = one(changes, "locking_friction")[0]
    slope = 0.008 / (math.pi * 0.030)
    if collar == 0.0:
        assert_allclose(limit, slope * math.cos(math.radians(15.0)), rtol=4 * EPS)
    # The moment's rounding over its derivative.
    assert_allclose(brentq(lowering, 0.0, 1.0, xtol=1e-16, rtol=4 * EPS), limit, atol=16 * EPS)
    locks = (one(changes, "self_locking", friction=limit * (1 + sign * 1e-9))[0] for sign in (-1, 1))
    assert tuple(locks) == (0.0, 1.0)


def test_without_friction__nothing_is_lost():
    for element in (JACK, WEDGE, INCLINE, GUIDE):
        key = "raise_efficiency" if element is JACK else "efficiency"
        bare = {k: 0.0 for k in ("friction", "collar_friction") if k in element}
        # Sine, cosine and tangent of the wedge's and the incline's angle, a few roundings each.
        assert_allclose(one(element, key, **bare), [1.0], rtol=8 * EPS)
    assert one(JOURNAL, "friction_moment", friction=0.0) == [0.0]
    assert one(ROLLER, "pull_force", rolling_arm=0.0) == [0.0]


def test_belt__of_a_tension_and_of_the_moment_it_carries_are_the_same():
    names = ("tight_tension", "slack_tension", "moment", "shaft_force", "tension_ratio")
    running = {"speed": 20.0, "linear_density": 0.4, "groove_angle": 0.7}
    given_tension = one(BELT, *names, **running)
    tight, slack, moment, shaft, ratio = given_tension
    bare = {k: v for k, v in BELT.items() if k != "tension"}
    # T - q v² and back.
    assert_allclose(one(bare, *names, moment=moment, **running), given_tension, rtol=16 * EPS)
    centrifugal = 0.4 * 20.0**2
    assert_allclose((tight - centrifugal) / (slack - centrifugal), ratio, rtol=1e-12)
    assert_allclose((tight - slack) * 0.1, moment, rtol=16 * EPS)
    assert_allclose(one(BELT, "power", **running), [moment / 0.1 * 20.0], rtol=4 * EPS)
    x, y = tight - centrifugal - (slack - centrifugal) * np.cos(3.0), (slack - centrifugal) * np.sin(3.0)
    assert_allclose(shaft, np.hypot(x, y), rtol=1e-12)


def test_wedge__has_the_friction_of_its_face_on_its_base_too():
    drive, withdraw = one(WEDGE, "drive_force", "withdraw_force")
    phi = math.atan(0.15)
    assert_allclose(drive, 5e3 * (math.tan(0.14 + phi) + 0.15), rtol=8 * EPS)
    assert_allclose(withdraw, 5e3 * (math.tan(phi - 0.14) + 0.15), rtol=8 * EPS)
    limit = brentq(lambda angle: one(WEDGE, "withdraw_force", angle=angle)[0], 0.1, 1.0, xtol=1e-15)
    assert_allclose(limit, 2 * phi, rtol=8 * EPS)
    assert one(WEDGE, "self_locking", angle=2 * phi * (1 - 1e-9)) == [1.0]
    assert one(WEDGE, "self_locking", angle=2 * phi * (1 + 1e-9)) == [0.0]


def test_incline__starts_and_stays_by_its_static_friction():
    names = ("up_force", "start_force", "self_locking", "friction_angle")
    up, start, stays, angle = one(INCLINE, *names, static_friction=0.4)
    assert_allclose(up, 1e3 * (math.sin(0.35) + 0.3 * math.cos(0.35)), rtol=8 * EPS)
    assert_allclose(start, 1e3 * (math.sin(0.35) + 0.4 * math.cos(0.35)), rtol=8 * EPS)
    assert (stays, angle) == (1.0, math.atan(0.3))
    # tan(0.35) = 0.365: 0.3 doesn't hold the load.
    assert one(INCLINE, "self_locking") == [0.0]
    assert one(INCLINE, "down_force")[0] < 0


def test_guide__of_each_form_has_its_friction():
    for form, factor in (("flat", 1.0), ("half-round, worn in", WORN_IN), ("half-round, new", math.pi / 2)):
        assert_allclose(one(GUIDE, "effective_friction", form=form), [0.1 * factor], rtol=2 * EPS)
    vee = one(GUIDE, "effective_friction", form="vee", vee_angle=math.radians(60.0))
    assert_allclose(vee, [0.2], rtol=4 * EPS)


def test_roller__on_a_plane_and_on_its_mate():
    moment, friction, force, way = one(ROLLER, "rolling_moment", "rolling_friction", "pull_force", "rolls")
    assert_allclose((moment, friction, force, way), (5.0, 5e-4 / 0.3, 5.0 / 0.3, 1.0), rtol=4 * EPS)
    assert one(ROLLER, "rolls", rolling_arm=0.07) == [0.0]
    assert_allclose(one(ROLLER, "pull_force", pull_height=0.6), [5.0 / 0.6], rtol=4 * EPS)
    radius, drive, traction = one(ROLLER, "reduced_radius", "drive_moment", "traction_moment", mate_diameter=0.3)
    assert_allclose((radius, drive, traction), (0.1, 15.0, 600.0), rtol=4 * EPS)


# Verdicts, variants and error estimates


def test_jamming__is_a_verdict_and_no_number():
    values, _, status = results(GUIDE, "drive_force", "jamming_overhang", overhang=[0.15, 0.999, 1.0, 3.0])
    drive, jam = values.values()
    assert_array_equal(status, [Verdict.OK, Verdict.OK, Verdict.JAMS, Verdict.JAMS])
    assert_array_equal(np.isfinite(drive), [True, True, False, False])
    assert_allclose(jam, 1.0, rtol=4 * EPS)


def test_belt_of_many_turns__overflows_and_does_not_jam():
    _, _, status = results(BELT, "tension_ratio", wrap=[3.0, 3000.0])
    assert_array_equal(status, [Verdict.OK, Verdict.NOT_FINITE])


def test_guide_without_friction__never_jams_and_is_well():
    jam, drive = one(GUIDE | {"friction": 0.0}, "jamming_overhang", "drive_force")
    assert math.isnan(jam)
    assert drive == 500.0


def test_load_lifted_off_the_plane__is_undefined():
    values, _, status = results(INCLINE | {"pull_angle": 1.3}, "up_force")
    assert status[0] == Verdict.NOT_FINITE
    assert math.isnan(values["up_force"][0])


def test_variants__outside_limits_or_dropped_get_no_numbers():
    paths = {"elements.jack.pitch": np.array([0.004, -1.0, 0.004, np.nan])}
    ready = ElementsAlone(scene(jack=JACK), ["jack.raise_moment"], varied=paths)
    outcome = ready.evaluate(paths, drop=np.array([False, False, True, False]))
    expected = [Verdict.OK, Verdict.OUTSIDE_LIMITS, Verdict.DROPPED, Verdict.OUTSIDE_LIMITS]
    assert_array_equal(outcome.status, expected)
    assert_array_equal(np.isfinite(outcome.summaries["jack.raise_moment"]), outcome.status == Verdict.OK)
    nothing = ready.evaluate({"elements.jack.pitch": np.array([-1.0])})
    assert nothing.status[0] == Verdict.OUTSIDE_LIMITS


def test_error_figure__grows_where_digits_cancel():
    limit = one(JACK, "locking_friction", collar_friction=0.0)[0]
    frictions = np.array([2 * limit, limit * (1 + 1e-9)])
    down, errors = solved(JACK | {"collar_friction": 0.0}, "lower_moment", friction=frictions)["lower_moment"]
    relative = errors / abs(down)
    assert relative[0] < 1e-13
    assert 1e-8 < relative[1] < 1e-5
    with mpmath.workdps(40):
        slope = mpf(0.008) / (mpmath.pi * mpf(0.030))
        for friction, got, error in zip(frictions, down, errors, strict=True):
            f = mpf(float(friction))
            assert abs(mpf(float(got)) - 6400 * mpf(0.015) * (f - slope) / (1 + f * slope)) <= error


def test_results_that_need_a_number__are_offered_with_it_alone():
    for key, name, elements in (
        ("speed", "it.power", BELT),
        ("speed", "it.friction_power", JOURNAL),
        ("mate_diameter", "it.drive_moment", ROLLER),
    ):
        assert name not in ElementsAlone(scene(it=elements)).available_summaries
        assert name in ElementsAlone(scene(it={**elements, key: 2.0})).available_summaries


# Cars


@pytest.mark.parametrize("brakes", ["rear", "front", "all"])
@pytest.mark.parametrize("slope", [-0.1, 0.3])
def test_car_on_a_slope__is_in_equilibrium(brakes, slope):
    names = ("deceleration", "stopping_distance", "stopping_time", "front_share")
    slowing, way, time, share = one(CAR, *names, brakes=brakes, slope=slope)
    level = one(CAR, "stopping_distance", brakes=brakes)
    assert (way, time) == pytest.approx(((50 / 3.6) ** 2 / (2 * slowing), 50 / 3.6 / slowing), rel=1e-13)
    front, rear = share * math.cos(slope), (1 - share) * math.cos(slope)
    pulls = 0.6 * (front * (brakes != "rear") + rear * (brakes != "front"))
    # Along the road, and about the point under the centre of mass: inertia and weight along it have the same arm.
    assert slowing / 9.81 == pytest.approx(pulls + math.sin(slope), rel=1e-13)
    tipping = (slowing / 9.81 - math.sin(slope)) * 0.6
    assert front * 1.6 - rear * 1.2 == pytest.approx(tipping, rel=1e-12)
    (delayed,) = one(CAR, "stopping_distance", brakes=brakes, slope=slope, reaction_time=0.8)
    assert delayed - way == pytest.approx(0.8 * 50 / 3.6, rel=1e-12)
    assert (way > level[0]) == (slope < 0)


def test_car_that_does_not_stop_or_tips_over__has_a_verdict():
    _, _, status = results(CAR, "stopping_distance", friction=[0.05, 0.6, 3.0], slope=[-0.2, 0.0, 0.0])
    # With friction 3 the centre is too high for its distance to the front wheels.
    assert status.tolist() == [Verdict.NOT_FINITE, Verdict.OK, Verdict.NOT_FINITE]
