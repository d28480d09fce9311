"""Teeth in mesh against tooth thicknesses, published examples, flanks moved past each other, and sliding."""

import itertools
import math

import numpy as np
import pytest
from element_samples import results, solved
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from engine import Verdict
from engine.elements.gears.tooth_laws import TeethInMesh, mesh_efficiency, mesh_geometry, minimum_teeth


def teeth(z1, z2, sense=1, angle=20.0, helix=0.0, shifts=(0.0, 0.0)):
    numbers = (np.array(float(z)) for z in (z1, z2))
    return TeethInMesh(*numbers, sense, *(np.radians([angle, helix])), *(np.array(float(x)) for x in shifts))


def inv(angle):
    return math.tan(angle) - angle


def half_angle(z, x, side, angle, r):
    """Half the angle that a tooth takes at a radius, in modules; its flanks are straight below the base circle."""
    base = z / 2 * math.cos(angle)
    here = math.acos(min(base / r, 1.0))
    return (math.pi / 2 + side * 2 * x * math.tan(angle)) / z + side * (inv(angle) - inv(here))


@given(
    z1=st.integers(8, 80),
    more=st.integers(0, 120),
    sense=st.sampled_from([1, -1]),
    angle=st.floats(14.5, 28.0),
    shifts=st.tuples(st.floats(-0.8, 0.8), st.floats(-0.8, 0.8)),
)
@settings(max_examples=60)
def test_distance_of_axes__leaves_no_backlash(z1, more, sense, angle, shifts):
    """At operating pitch circles a tooth of one wheel fills the space of the other: solved for the distance itself."""
    z2 = z1 + more if sense > 0 else z1 + more + 10
    found = mesh_geometry(teeth(z1, z2, sense, angle, 0.0, shifts))
    alpha, total = math.radians(angle), z2 + sense * z1

    def left_over(a):
        r1, r2 = a * z1 / total, a * z2 / total
        filled = half_angle(z1, shifts[0], 1, alpha, r1) + half_angle(z2, shifts[1], sense, alpha, r2) * z2 / z1
        # Apart, wheels outside get room; in a ring the wheel moves towards its teeth.
        return sense * (filled - math.pi / z1)

    nearest = total / 2 * math.cos(alpha)
    if left_over(nearest) <= 0.0:
        assert not found.distance > nearest * (1 + 1e-6)
        return
    exact = brentq(left_over, nearest, 2 * total + 4, xtol=1e-13)
    assume(exact > nearest * 1.001)
    assert found.distance == pytest.approx(exact, rel=1e-11)
    assert found.rolling[0] == pytest.approx(2 * exact * z1 / total, rel=1e-11)
    assert found.angle == pytest.approx(math.acos(nearest / exact), rel=1e-8)


def test_published_shifted_pairs():
    """KHK, Gear Technical Reference, profile shifted spur and internal gears: module 3 mm."""
    outside = mesh_geometry(teeth(12, 24, shifts=(0.6, 0.36)))
    assert math.degrees(outside.angle) == pytest.approx(26.0886, abs=5e-5)
    assert 3 * outside.distance == pytest.approx(56.4999, abs=5e-5)
    assert [3 * float(d) for d in outside.tips] == pytest.approx([44.840, 79.3997], abs=5e-4)
    ring = mesh_geometry(teeth(16, 24, -1, shifts=(0.0, 0.5)))
    assert math.degrees(ring.angle) == pytest.approx(31.0937, abs=1e-4)
    assert 3 * ring.distance == pytest.approx(13.1683, abs=5e-5)
    assert [3 * float(d) for d in ring.tips] == pytest.approx([54.0, 69.0], abs=1e-9)


@pytest.mark.parametrize(("pinion", "most"), [(13, 16), (14, 26), (15, 45), (16, 101), (17, 1309)])
def test_minimum_teeth__are_those_of_the_published_table(pinion, most):
    """Shigley, Mechanical Engineering Design: largest gear that a pinion of full depth at 20° runs with."""
    assert minimum_teeth(teeth(5, most)) == pinion
    assert minimum_teeth(teeth(most + 1, 7)) == pinion + 1


@pytest.mark.parametrize(("z", "possible"), [(1, 0.4826), (3, 0.6994), (6, 0.9613), (10, 1.2640)])
def test_contact_ratio__ends_at_the_interference_points(z, possible):
    """The tip of the wheel reaches no farther than where the line of action touches the pinion's base circle."""
    found = mesh_geometry(teeth(z, 40))
    assert found.interferes
    # A single tooth is pointed before it is one module high.
    assert sum(found.contact) == pytest.approx(possible, abs=5e-5 if z > 1 else 0.04)
    assert sum(found.contact) <= possible + 5e-5


def penetration(mesh, corner_of):
    """How deep a corner of a tooth comes into the teeth of the other wheel, as an angle there; negative if it doesn't.

    Wheel 1 about the origin, wheel 2 about (a, 0); a tooth of 1 and a space of 2 are on the line of centres.
    """
    found = mesh_geometry(mesh)
    alpha = float(mesh.pressure_angle)
    z, x, sides = (float(mesh.first), float(mesh.second)), (mesh.first_shift, mesh.second_shift), (1, mesh.sense)
    tips = [float(d) / 2 for d in found.tips]
    other = 1 - corner_of
    a = float(found.distance)
    centres = (0.0, a if mesh.sense > 0 else -a)
    # Where the teeth's middles are: a tooth of wheel 1 towards the pitch point, a space of wheel 2 there.
    begin = (0.0, math.pi + math.pi / z[1] if mesh.sense > 0 else math.pi / z[1])
    turn = np.linspace(-1.2, 1.2, 24001) * 2 * math.pi / min(z[0], 12)
    turns = turn, -mesh.sense * turn * z[0] / z[1]
    own = half_angle(z[corner_of], float(x[corner_of]), sides[corner_of], alpha, tips[corner_of])
    deepest = -np.inf
    for flank in (own, -own):
        at = begin[corner_of] + turns[corner_of] + flank
        point = centres[corner_of] + tips[corner_of] * np.exp(1j * at) - centres[other]
        r, angle = np.abs(point), np.angle(point) - begin[other] - turns[other]
        pitch = 2 * math.pi / z[other]
        angle -= pitch * np.round(angle / pitch)
        base = z[other] / 2 * math.cos(alpha)
        inside = r <= tips[other] if sides[other] > 0 else r >= tips[other]
        here = np.arccos(np.minimum(base / r, 1.0))
        half = (math.pi / 2 + sides[other] * 2 * float(x[other]) * math.tan(alpha)) / z[other] + sides[other] * (
            inv(alpha) - (np.tan(here) - here)
        )
        if inside.any():
            deepest = max(deepest, (half - np.abs(angle))[inside].max())
    return deepest


@given(
    z1=st.integers(8, 40),
    more=st.integers(0, 60),
    sense=st.sampled_from([1, -1]),
    angle=st.floats(16.0, 25.0),
    shifts=st.tuples(st.floats(-0.4, 0.4), st.floats(-0.4, 0.4)),
)
@settings(max_examples=40)
def test_interference__is_where_flanks_cut_into_each_other(z1, more, sense, angle, shifts):
    z2 = z1 + more if sense > 0 else z1 + more + 6
    mesh = teeth(z1, z2, sense, angle, 0.0, shifts)
    found = mesh_geometry(mesh)
    assume(np.isfinite(found.distance) and all(d > 0 for d in found.tips) and found.angle > 0.15)
    deepest = max(penetration(mesh, 0), penetration(mesh, 1))
    if not found.interferes:
        assert deepest < 1e-6
    else:
        assert deepest > -1e-9


def lost_share(mesh, tips, angle, friction):
    """Work of friction over work passed on, module 1: pairs of teeth share the load equally, one pitch of contact.

    Between places where a pair comes or goes, or the pitch point is passed, what is lost goes linearly along the path.
    Helical teeth press along the normal of their flanks, which leans by β_b, tan β_b = tan β cos α_t.
    """
    z, sense, beta = (float(mesh.first), float(mesh.second)), mesh.sense, float(mesh.helix_angle)
    alpha = math.atan(math.tan(float(mesh.pressure_angle)) / math.cos(beta))
    base = [n / math.cos(beta) * math.cos(alpha) / 2 for n in z]
    # Lengths of contact on both sides of the pitch point, along the line of action.
    first, second = (
        side * (math.sqrt(tip**2 - b**2) - b * math.tan(angle))
        for side, tip, b in zip((1, sense), tips, base, strict=True)
    )
    pitch = math.pi / math.cos(beta) * math.cos(alpha)
    steps = range(-8, 9)
    ends = {-second, first, 0.0, *(end + k * pitch for k in steps for end in (-second, first))}
    places = sorted(end for end in ends if -second <= end <= first)
    work = 0.0
    for a, b in itertools.pairwise(places):
        middle = (a + b) / 2
        pairs = sum(-second < middle + k * pitch < first for k in steps)
        work += abs(middle) * (b - a) / pairs
    sliding, lean = 1 / base[0] + sense / base[1], math.atan(math.tan(beta) * math.cos(alpha))
    return friction / math.cos(lean) * work * sliding / pitch, first / pitch, second / pitch


@given(
    z1=st.integers(18, 80),
    more=st.integers(0, 80),
    sense=st.sampled_from([1, -1]),
    angle=st.floats(15.0, 27.0),
    helix=st.sampled_from([0.0, 20.0, 35.0]),
    shifts=st.tuples(st.floats(-0.3, 0.9), st.floats(-0.3, 0.9)),
)
@settings(max_examples=40)
def test_mesh_loss_and_contact_ratio__are_lengths_and_work_along_the_line_of_action(
    z1, more, sense, angle, helix, shifts
):
    mesh = teeth(z1, z1 + more + (15 if sense < 0 else 0), sense, angle, helix, shifts)
    found = mesh_geometry(mesh)
    assume(np.isfinite(found.distance) and not found.interferes and sum(found.contact) >= 1)
    tips = [float(d) / 2 for d in found.tips]
    exact, *shares = lost_share(mesh, tips, float(found.angle), 0.05)
    assert [float(e) for e in found.contact] == pytest.approx(shares, abs=1e-10)
    assert 1 - float(mesh_efficiency(mesh, found.contact, np.asarray(0.05))) == pytest.approx(exact, rel=1e-9)


def pair(sun, wheel, **keys):
    shifts = keys.pop("shifts", (0.0, 0.0))
    return {
        "type": "gear_train",
        "wheels": {
            "a": {"shaft": "s", "teeth": sun, "profile_shift": shifts[0]},
            "b": {"shaft": "t", "teeth": wheel, "profile_shift": shifts[1]},
        },
        "shafts": {"s": {"speed": 10.0}, "t": {"moment": 5.0}},
        "meshes": {"m": {"between": ["a", "b"], "friction": 0.06} | keys},
        "module": 0.002,
    }


@pytest.mark.parametrize("z", [1, 6, 14])
def test_small_pinion__has_its_verdict_and_says_why(z):
    found, _, status = results(pair(z, 40))
    assert status == Verdict.INTERFERES
    assert found["m.minimum_teeth"][0] == 15
    assert np.isfinite(found["m.contact_ratio"][0])
    assert np.isnan(found["efficiency"][0])


def test_profile_shift__lets_a_small_pinion_run_at_the_standard_distance():
    """x₁ = −x₂ leaves distance and operating angle; ten teeth at 20° need x₁ of some (17 − 10)/17."""
    varied = {"wheels.a.profile_shift": [0.0, 0.45], "wheels.b.profile_shift": [0.0, -0.45]}
    found, _, status = results(pair(10, 40), **varied)
    assert list(status) == [Verdict.INTERFERES, Verdict.OK]
    np.testing.assert_allclose(found["m.centre_distance"], 0.05, rtol=1e-15)
    np.testing.assert_allclose(found["m.operating_pressure_angle"], math.radians(20), rtol=1e-15)
    assert found["m.contact_ratio"][1] > 1.2


def test_forces_of_shifted_wheels__act_at_the_operating_pitch_point():
    found = solved(pair(20, 30, shifts=(0.5, 0.4), friction=0.0))
    base = 0.002 * 30 * math.cos(math.radians(20))
    # The normal force turns the wheel about its base circle.
    assert found["m.normal_force"][0] == pytest.approx(5.0 / (base / 2), rel=1e-12)
    across = math.hypot(found["m.tangential_force"][0], found["m.radial_force"][0])
    assert across == pytest.approx(found["m.normal_force"][0], rel=1e-12)


def test_contact_ratio_below_one__has_its_verdict_but_for_helical_teeth_whose_overlap_suffices():
    short = {"shifts": (0.9, 0.9), "pressure_angle": math.radians(25)}
    found, _, status = results(pair(12, 13, **short))
    assert found["m.contact_ratio"][0] < 1
    assert status == Verdict.CONTACT_BREAKS
    helical = pair(12, 13, **short, helix_angle=0.3)
    assert results(helical)[2] == Verdict.OK
    helical["wheels"]["a"]["width"] = 0.0005
    assert results(helical)[2] == Verdict.CONTACT_BREAKS
    helical["wheels"]["a"]["width"] = 0.05
    assert results(helical)[2] == Verdict.OK
