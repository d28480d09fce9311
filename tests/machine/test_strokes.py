"""Ends of stroke and strokes of an engine: closed forms, on rows of numbers and through whole machines."""

import math

import numpy as np
import pytest
from engine.equal_positions.rows_machine import RowsMachine as Machine
from engine.equal_positions.strokes import (
    extreme_between,
    four_stroke_number,
    quick_return_ratio,
    stroke_ends,
    swing_ends,
    two_stroke_number,
    unwrap_angle,
)
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from engine import Scene

EPS = 2.3e-16
TURN = 2 * math.pi

few = settings(deadline=None, max_examples=60)
angles = st.floats(0, TURN, exclude_max=True)


def apart(a, b):
    """Distance of two crank angles."""
    return abs((a - b + math.pi) % TURN - math.pi)


# The extreme between two positions


@few
@given(st.floats(-2, 2), st.floats(0.01, 0.99), st.floats(-10, 10), st.floats(0.01, 3), st.sampled_from([1, -1]))
def test_extreme_between__is_exact_for_cubics(value, place, second_root, h, sign):
    # A cubic whose derivative vanishes at `place` and, outside the interval, at `second_root`.
    assume(not -0.01 <= second_root <= 1.01)
    slope = sign * np.poly([place, second_root]) * 3
    cubic = np.polyint(slope, k=value)
    ends = [np.polyval(cubic, t) for t in (0, 1)]
    v = [np.polyval(slope, t) / h for t in (0, 1)]
    assume(v[0] * v[1] < 0)
    t, extreme = extreme_between(*ends, *v, h)
    # The derivative's roots are nowhere nearer than 0.01 to each other, the coefficients below 100.
    assert t == pytest.approx(place, abs=1e-10)
    assert extreme == pytest.approx(np.polyval(cubic, place), abs=1e-12)


@pytest.mark.parametrize("v0", [0.0, 1e-300, 1e-34, 1e-18, -1e-34])
@pytest.mark.parametrize("side", [1, -1])
def test_extreme_between__holds_where_a_flat_dead_centre_lies_on_a_position(v0, side):
    # d = 0.15 - x^4, as a toggle's ram where its links straighten; rounding alone says which way it moves there.
    h = 0.01
    ends, v = (0.15, 0.15 - h**4), (v0, -4 * h**3)
    if v0 < 0.0:
        ends, v = (0.15, 0.15 + h**4), (v0, 4 * h**3)
    if side < 0:
        ends, v = ends[::-1], (-v[1], -v[0])
    t, extreme = extreme_between(*ends, *v, h)
    # Its cubic goes beyond by less than h^4/384 times the fourth derivative, 24.
    assert 0.0 <= t <= 1.0
    assert abs(extreme - 0.15) <= 24 * h**4 / 384 + 2 * EPS


@few
@given(st.floats(0.001, 0.3), st.floats(0.01, 0.99))
def test_extreme_between__keeps_its_error_bound_for_a_cosine(h, share):
    a, b = -share * h, (1 - share) * h
    t, extreme = extreme_between(math.cos(a), math.cos(b), -math.sin(a), -math.sin(b), h)
    assert abs(extreme - 1) <= h**4 / 384 + 2 * EPS
    # The cubic's derivative is off by less than h³/24 max|d⁗|, and the cosine's crosses zero with slope 1.
    assert abs(a + t * h) <= h**3 / 24 + 1e-12


# Rows


def rocking(n, revolutions=1):
    """A coordinate with two unequal humps, its derivative, and the spacing."""
    phi = np.arange(n) * (TURN * revolutions / n)
    return np.cos(phi - 1) + 0.3 * np.cos(2 * phi), -np.sin(phi - 1) - 0.6 * np.sin(2 * phi), phi[1]


@few
@given(st.integers(24, 720), angles, st.floats(0.01, 100), st.floats(-5, 5))
def test_stroke_of_a_cosine__has_its_amplitude_and_dead_centres(n, phase, size, middle):
    phi = np.arange(n) * (TURN / n)
    h = phi[1]
    d, v = middle + size * np.cos(phi - phase), -size * np.sin(phi - phase)
    low, high, low_at, high_at = stroke_ends(d, v, 0.0, h, True)
    rounding = 10 * EPS * (size + abs(middle))
    assert high - low == pytest.approx(2 * size, abs=2 * size * h**4 / 384 + rounding)
    # A dead centre at a position itself is taken with its derivative's sign, which rounding decides.
    assert apart(high_at, phase) <= h**3 / 24 + 1e-7
    assert apart(low_at, phase + math.pi) <= h**3 / 24 + 1e-7


def test_open_range__ends_its_stroke_at_its_ends():
    q = np.linspace(0.2, 0.9, 15)
    low, high, low_at, high_at = stroke_ends(np.sin(q), np.cos(q), 0.2, q[1] - q[0], False)
    assert (low, high) == (math.sin(0.2), math.sin(0.9))
    assert (low_at, high_at) == pytest.approx((0.2, 0.9), rel=1e-14)


def test_open_range__does_not_close_from_its_end_to_its_start():
    q = np.linspace(0.2, 2.0, 15)
    d, v = np.sin(q), np.cos(q)
    assert stroke_ends(d, v, 0.2, q[1] - q[0], False)[0] == d[0]
    # As a cycle, it would turn below its first position.
    assert stroke_ends(d, v, 0.2, q[1] - q[0], True)[0] < d[0]


@pytest.mark.parametrize("which", [0, 1])
@pytest.mark.parametrize("place", [0, 7, 23])
def test_undefined_position__leaves_no_stroke(which, place):
    d, v, h = rocking(24)
    for periodic in (True, False):
        for undefined in (math.nan, math.inf):
            (d, v)[which][place] = undefined
            assert np.isnan(stroke_ends(d, v, 0.0, h, periodic)).all()


@pytest.mark.parametrize("place", [0, 7, 23])
def test_undefined_position__leaves_no_swing(place):
    angle, w, h = rocking(24)
    w[place] = math.nan
    for periodic in (True, False):
        assert np.isnan(swing_ends(np.cos(angle), np.sin(angle), w, 0.0, h, periodic)).all()


def test_stroke__converges_with_the_fourth_order():
    fine = rocking(200_000)[0]
    errors = []
    for n in (25, 50, 100):
        d, v, h = rocking(n)
        low, high, _, _ = stroke_ends(d, v, 0.0, h, True)
        errors.append(max(abs(high - fine.max()), abs(low - fine.min())))
    # h⁴/384 · max|d⁗|, max|d⁗| ≤ 1 + 0.3·16; where in an interval the extreme lies makes it smaller.
    assert errors[0] <= (TURN / 25) ** 4 / 384 * 5.8
    assert errors[2] <= (TURN / 100) ** 4 / 384 * 5.8


@pytest.mark.parametrize("turns", [1, -1, 2])
def test_swing__is_undefined_for_a_link_that_turns_round(turns):
    phi = np.arange(72) * (TURN / 72)
    angle, w = turns * phi + 0.2 * np.sin(phi), turns + 0.2 * np.cos(phi)
    assert np.isnan(swing_ends(np.cos(angle), np.sin(angle), w, 0.0, phi[1], True)).all()


@few
@given(st.integers(48, 720), st.floats(-9, 9), angles, st.floats(0.001, 5), st.booleans())
def test_swing__is_that_of_the_angle_wherever_it_begins(n, middle, phase, size, periodic):
    # Links may swing by more than a turn, and across the angle of π where directions jump by 2π.
    phi = np.arange(n) * (TURN / n)
    h = phi[1]
    angle, w = middle + size * np.cos(phi - phase), -size * np.sin(phi - phase)
    low, high, low_at, high_at = swing_ends(np.cos(angle), np.sin(angle), w, 0.0, h, periodic)
    expected = stroke_ends(angle, w, 0.0, h, periodic)
    assert high - low == pytest.approx(expected[1] - expected[0], abs=1e-12 * (1 + size))
    assert math.remainder(low - expected[0], TURN) == pytest.approx(0, abs=1e-12 * (1 + size))
    # Cosine and sine give the angle to 1e-16; a dead centre's place is the root of it over the size.
    assert apart(low_at, expected[2]) < 1e-9 / size**0.5 + 1e-9
    assert apart(high_at, expected[3]) < 1e-9 / size**0.5 + 1e-9


@few
@given(angles, st.floats(0.01, TURN - 0.01))
def test_quick_return_ratio__is_the_slow_share_over_the_fast(low, up):
    ratio = quick_return_ratio(low, (low + up) % TURN)
    assert ratio >= 1
    assert ratio == pytest.approx(max(up, TURN - up) / min(up, TURN - up), rel=1e-11)
    assert ratio == pytest.approx(quick_return_ratio((low + up) % TURN, low), rel=1e-11)


@few
@given(st.integers(5, 200), st.floats(-9, 9), st.integers(-3, 3), st.floats(-0.9, 0.9))
def test_unwrapped_angle__is_continuous_and_starts_in_the_principal_turn(n, start, turns, sway):
    phi = np.linspace(0, TURN, 16 * n)
    angle = start + turns * phi + sway * np.sin(2 * phi)
    unwrapped = np.empty_like(phi)
    unwrap_angle(np.cos(angle), np.sin(angle), unwrapped)
    assert -math.pi - 1e-12 <= unwrapped[0] <= math.pi + 1e-12
    np.testing.assert_allclose(unwrapped - unwrapped[0], angle - start, atol=phi.size * 10 * EPS)


# Strokes of an engine


@few
@given(angles, st.floats(-10, 10), st.sampled_from([1, -1]), st.floats(-20, 20))
def test_four_strokes__follow_the_firing_dead_centre_in_the_direction_of_rotation(head_at, firing, forward, phi):
    # Walk from the firing angle in the direction of rotation to the first head-end dead centre.
    wait = forward * (head_at - firing) % TURN
    assume(1e-4 < wait < TURN - 1e-4)
    since = forward * (phi - firing) - wait
    half_turns = since / math.pi
    assume(abs(half_turns - round(half_turns)) > 1e-6)
    # A piston that leaves the head for half a turn and comes back for the other.
    toward_head = math.floor(half_turns) % 2 == 1
    expected = math.floor(half_turns) % 4
    assert four_stroke_number(head_at, firing, forward, phi, toward_head) == expected
    assert two_stroke_number(toward_head) == expected % 2


@pytest.mark.parametrize("rounding", [-1e-9, 0.0, 1e-9])
@pytest.mark.parametrize("forward", [1, -1])
def test_firing_at_the_dead_centre__means_that_dead_centre(rounding, forward):
    assert four_stroke_number(1.0 + rounding, 1.0, forward, 1.0 + forward * 0.5, False) == 0
    assert four_stroke_number(1.0 + rounding, 1.0 + TURN, forward, 1.0 + forward * 0.5, False) == 2


# Machines


def scene(groups, points, length, guides=None, **more):
    return Scene.model_validate(
        {
            "points": {"O": {"x": 0, "y": 0}} | points,
            "guides": guides or {},
            "input": {"type": "crank", "pivot": "O", "pin": "A", "length": length, "speed": 10.0, "revolutions": 2},
            "groups": groups,
        }
        | more
    )


SLIDER_CRANK = {
    "type": "RRP",
    "inner": "B",
    "first": {"link": "rod", "joint": "A", "length": 0.2},
    "second": {"link": "ram", "guide": "way", "offset": 0.01},
}


def test_offset_slider_crank__has_the_stroke_and_time_ratio_of_its_triangles():
    asked = ["ram.stroke", "ram.stroke_low_at", "ram.stroke_high_at", "ram.stroke_time_ratio", "g.transmission_angle"]
    rng = np.random.default_rng(3)
    r, rod = rng.uniform(0.01, 0.08, 200), rng.uniform(0.12, 0.5, 200)
    offset = rng.uniform(-0.95, 0.95, 200) * (rod - r)
    varied = {"input.length": r, "groups.g.first.length": rod, "groups.g.second.offset": offset}
    machine = Machine(scene({"g": SLIDER_CRANK}, {}, 0.05, {"way": {}}), asked, varied=list(varied))
    outcome = machine.evaluate(varied)
    found = outcome.summaries
    stroke = np.sqrt((rod + r) ** 2 - offset**2) - np.sqrt((rod - r) ** 2 - offset**2)
    high, low = np.arcsin(offset / (rod + r)), np.pi + np.arcsin(offset / (rod - r))
    ratio = (np.pi + np.abs(low - high - np.pi)) / (np.pi - np.abs(low - high - np.pi))
    # The bound is h⁴/384 max|d⁗|; d⁗ grows beyond r where the rod nears the normal of the guide, so measured.
    np.testing.assert_allclose(found["ram.stroke"], stroke, rtol=1e-7)
    np.testing.assert_allclose(found["ram.stroke_time_ratio"], ratio, rtol=1e-5)
    assert max(map(apart, found["ram.stroke_high_at"], high)) < 1e-5
    assert max(map(apart, found["ram.stroke_low_at"], low)) < 1e-5
    # Rod against guide: sin β = (r + |e|)/l at a crank across the guide, which is among the 720 positions.
    transmission = np.arccos((r + np.abs(offset)) / rod)
    np.testing.assert_allclose(found["g.transmission_angle"], transmission, rtol=1e-7)
    for key, exact in (("ram.stroke", stroke), ("ram.stroke_time_ratio", ratio)):
        # Where full and half resolution err alike, by chance, the figure is too small: measured, 3 of 100.
        within = np.abs(found[key] - exact) <= outcome.errors[key]
        assert within.mean() > 0.9


def test_crank_rocker__has_the_swing_of_its_dead_centres():
    rocker = {
        "type": "RRR",
        "inner": "B",
        "first": {"link": "rod", "joint": "A", "length": 0.2},
        "second": {"link": "rocker", "joint": "D", "length": 0.15},
    }
    names = ["rocker.swing", "rocker.swing_time_ratio", "rod.swing", "g.transmission_angle"]
    rng = np.random.default_rng(4)
    a, b, c = rng.uniform(0.01, 0.05, 100), rng.uniform(0.18, 0.25, 100), rng.uniform(0.13, 0.17, 100)
    d = np.full(100, 0.22)
    varied = {"input.length": a, "groups.g.first.length": b, "groups.g.second.length": c, "points.D.x": d}
    machine = Machine(scene({"g": rocker}, {"D": {"x": 0.22, "y": 0}}, 0.05), names, varied=list(varied))
    found = machine.evaluate(varied).summaries

    def triangle(side, other, opposite):
        return np.arccos((side**2 + other**2 - opposite**2) / (2 * side * other))

    # Crank and coupler in line, stretched and folded: triangles of sides b ± a, c, d.
    swing = triangle(d, c, b + a) - triangle(d, c, b - a)
    between = triangle(d, b - a, c) - triangle(d, b + a, c)
    ratio = (np.pi + np.abs(between)) / (np.pi - np.abs(between))
    np.testing.assert_allclose(found["rocker.swing"], swing, rtol=1e-7)
    np.testing.assert_allclose(found["rocker.swing_time_ratio"], ratio, rtol=1e-5)
    # Least transmission angle with the crank along the line of centres, one way or the other.
    angle = np.array([triangle(b, c, d - a), triangle(b, c, d + a)])
    least = np.minimum(angle, np.pi - angle).min(axis=0)
    np.testing.assert_allclose(found["g.transmission_angle"], least, rtol=1e-12)
    assert np.isfinite(found["rod.swing"]).all()


def test_oscillating_slotted_lever__has_the_time_ratio_of_its_tangents():
    lever = {"type": "RPR", "first": {"link": "block", "joint": "A"}, "second": {"link": "lever", "joint": "D"}}
    rng = np.random.default_rng(5)
    distance = rng.uniform(0.15, 0.6, 100)
    asked = ["lever.swing", "lever.swing_time_ratio", "block.stroke", "g.transmission_angle"]
    machine = Machine(
        scene({"g": lever}, {"D": {"x": 0, "y": -0.24}}, 0.12), asked, varied=["points.D.y", "input.length"]
    )
    radius = distance * rng.uniform(0.05, 0.9, 100)
    found = machine.evaluate({"points.D.y": -distance, "input.length": radius}).summaries
    half = np.arcsin(radius / distance)
    # Dead centres are found to h³, and near r/d = 0.9 the lever's derivatives are large: measured 4e-6.
    np.testing.assert_allclose(found["lever.swing"], 2 * half, rtol=1e-7)
    np.testing.assert_allclose(found["lever.swing_time_ratio"], (np.pi + 2 * half) / (np.pi - 2 * half), rtol=1e-5)
    np.testing.assert_allclose(found["block.stroke"], 2 * radius, rtol=1e-12)
    np.testing.assert_allclose(found["g.transmission_angle"], np.pi / 2, rtol=1e-12)
