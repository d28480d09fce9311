"""Dyads and rigid links against closed geometry in complex numbers and differentiation, at 50 digits.

The references know nothing of the formulas under test: a joint is found by angles (law of cosines, arcsine),
its velocity and acceleration by differentiating that solution along a random motion of what the dyad hangs on.

Tolerances: lengths and angles are exact float64 numbers, so errors come from rounding alone. A rounding of
EPS in a length moves the joint by EPS·(sum of lengths)/sine; each bound below is that sensitivity times ROUNDINGS,
a generous count of the operations.
"""

import math

import mpmath
import pytest
from closed_geometry import (
    EPS,
    angle,
    coordinate,
    cross,
    derivatives,
    dot,
    exponent,
    mode,
    moving_angles,
    moving_points,
    near,
    parts,
    rpr_angle,
    rrp_angle,
    rrr_angles,
    turned,
    unit,
    vector,
)
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mp, mpc, mpf

from engine.laws.kinematics.prp import prp_position, prp_rates
from engine.laws.kinematics.rpp import rpp_position, rpp_rates
from engine.laws.kinematics.rpr import rpr_position, rpr_rates
from engine.laws.kinematics.rrp import rrp_position, rrp_rates
from engine.laws.kinematics.rrr import rrr_position, rrr_rates
from engine.laws.kinematics.vectors import oblique_components

ROUNDINGS = 16
modest = settings(max_examples=100, deadline=None)
# Places between two dead centres, crowded towards both.
share = st.builds(lambda size, far: 1 - 10**size if far else 10**size, st.floats(-13, -0.3), st.booleans())


@pytest.fixture(autouse=True)
def _fifty_digits():
    with mp.workdps(50):
        yield


# RRR


@st.composite
def triangles(draw):
    """Links of ratio 1e-6 ... 1e6 and a distance at which they meet, from the dead centres outwards."""
    r1, r2 = 10 ** draw(exponent), 1.0
    scale = 10 ** draw(st.floats(-3, 3))
    d = abs(r1 - r2) + draw(share) * 2 * min(r1, r2)
    a = (draw(coordinate) * scale, draw(coordinate) * scale)
    at = draw(angle)
    return a, (a[0] + scale * d * math.cos(at), a[1] + scale * d * math.sin(at)), scale * r1, scale * r2


@modest
@given(triangles(), mode)
def test_rrr_position__closed_geometry(triangle, sign):
    (ax, ay), (dx, dy), r1, r2 = triangle
    a, d = vector(ax, ay), vector(dx, dy)
    assume(abs(mpf(r1) - mpf(r2)) < abs(d - a) < mpf(r1) + mpf(r2))
    t1, t2 = rrr_angles(a, d, mpf(r1), mpf(r2), sign)
    quality = mpmath.sin(t2 - t1)
    moved = ROUNDINGS * EPS * (r1 + r2) / abs(quality)
    # Nearer to the dead centre the sine itself is lost in rounding: it varies as the root of the distance.
    assume(moved / min(r1, r2) < 0.1 * abs(quality))
    bx, by, c1, s1, c2, s2, sine = rrr_position((ax, ay), (dx, dy), r1, r2, sign)
    b = a + mpf(r1) * unit(t1)
    for value, reference in ((bx, b.real), (by, b.imag)):
        near(value, reference, moved + EPS * (abs(ax) + abs(ay)))
    for c, s, t, r in ((c1, s1, t1, r1), (c2, s2, t2, r2)):
        near(c, mpmath.cos(t), moved / r)
        near(s, mpmath.sin(t), moved / r)
    # The angle between the links moves by both of theirs; its sine has a horizontal tangent at 1.
    near(abs(sine), abs(quality), 2 * moved / min(r1, r2))
    assert sine * sign > 0


@modest
@given(moving_points(), moving_points(), share, st.floats(-0.9, 0.9), mode)
def test_rrr_rates__derivatives_of_closed_geometry(a, d, place, unevenness, sign):
    span = abs(d.value - a.value)
    assume(span > 0.1)
    # r1 + r2 ≥ span > |r1 − r2|: links that meet, from nearly stretched to nearly folded.
    total = span / (abs(unevenness) + place * (1 - abs(unevenness)) + mpf(10) ** -3)
    assume(abs(unevenness) * total < span < total)
    r1, r2 = (mpf(float(total * (1 + k * unevenness) / 2)) for k in (1, -1))
    angles = [lambda q, i=i: rrr_angles(a(q), d(q), r1, r2, sign)[i] for i in (0, 1)]
    u1, u2 = (unit(t(0)) for t in angles)
    sine = abs(cross(u1, u2))
    (w1, e1), (w2, e2) = (derivatives(turned(t)) for t in angles)
    velocity = d.speed - a.speed
    acceleration = d.acceleration - a.acceleration + w1**2 * r1 * u1 - w2**2 * r2 * u2
    for gap, one, two in ((velocity, w1, w2), (acceleration, e1, e2)):
        links = (float(r1), *parts(u1)), (float(r2), *parts(u2))
        rates = rrr_rates(parts(gap), *links, float(sign * sine))
        for rate, reference, r in zip(rates, (one, two), (r1, r2), strict=True):
            near(rate, reference, ROUNDINGS * EPS * abs(gap) / (r * sine))


@modest
@given(coordinate, coordinate, angle, exponent, st.floats(1e-9, 1e3), mode, st.booleans())
def test_rrr_out_of_reach__nan(ax, ay, at, ratio, miss, sign, stretched):
    r1, r2 = 10**ratio, 1.0
    d = (r1 + r2) * (1 + miss) if stretched else abs(r1 - r2) / (1 + miss) - 1e-9 * (r1 + r2)
    assume(d > 0)
    found = rrr_position((0.0, 0.0), (d * math.cos(at), d * math.sin(at)), r1, r2, sign)
    assert all(math.isnan(x) for x in found)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize(("r1", "r2"), [(2.0, 3.0), (7.0, 2.0), (2.0, 7.0), (2.5, 2.5)])
def test_rrr_dead_centre__place_finite_rates_not(r1, r2, sign):
    # A, D = (1, 1), (4, 5) are exactly 5 apart: stretched or folded without rounding.
    bx, by, c1, s1, c2, s2, sine = rrr_position((1.0, 1.0), (4.0, 5.0), r1, r2, sign)
    along = -r1 if r2 - r1 == 5.0 else r1
    assert (bx, by) == pytest.approx((1 + 0.6 * along, 1 + 0.8 * along), rel=1e-15)
    assert (abs(c1), abs(s1), abs(c2), abs(s2)) == pytest.approx((0.6, 0.8, 0.6, 0.8), rel=1e-15)
    assert sine == 0.0
    rates = rrr_rates((0.3, -0.2), (r1, c1, s1), (r2, c2, s2), sine)
    assert not any(math.isfinite(w) for w in rates)


# RRP


@modest
@given(coordinate, coordinate, coordinate, coordinate, angle, exponent, st.floats(-0.9999999, 0.9999999), mode)
def test_rrp_position__closed_geometry(ax, ay, gx, gy, guide, size, height, sign):
    r = 10**size
    a, g = vector(ax, ay), vector(gx, gy)
    # The offset that puts the rod at the wanted slope.
    offset = float(cross(unit(mpf(guide)), a - g) + mpf(height) * r)
    assume(abs(offset - cross(unit(mpf(guide)), a - g)) < r * (1 - mpf(10) ** -8))
    t = rrp_angle(a, g, mpf(guide), mpf(r), mpf(offset), sign)
    u = unit(mpf(guide))
    (c, s), quality = parts(u), mpmath.cos(t - mpf(guide))
    bx, by, c1, s1, slide, sine = rrp_position((ax, ay), (gx, gy, c, s), r, offset, sign)
    moved = ROUNDINGS * EPS * (abs(a - g) + abs(offset) + r) / abs(quality)
    assume(moved < 1e-3 * r * abs(quality))
    b = a + mpf(r) * unit(t)
    for value, reference in ((bx, b.real), (by, b.imag)):
        near(value, reference, moved + EPS * (abs(ax) + abs(ay)))
    near(slide, dot(u, b - g), moved)
    near(c1, mpmath.cos(t), moved / r)
    near(s1, mpmath.sin(t), moved / r)
    near(sine, quality, moved / r)
    assert sine * sign > 0


@modest
@given(moving_points(), moving_points(), moving_angles(), st.floats(0.1, 10), st.floats(-0.999, 0.999), mode)
def test_rrp_rates_on_a_moving_guide__derivatives_of_closed_geometry(a, g, guide, r, height, sign):
    offset = cross(unit(guide.value), a.value - g.value) + mpf(height) * r
    r = mpf(r)

    def rod(q):
        return rrp_angle(a(q), g(q), guide(q), r, offset, sign)

    def slide(q):
        return dot(unit(guide(q)), a(q) + r * unit(rod(q)) - g(q))

    t, u, sine = rod(0), unit(guide.value), mpmath.cos(rod(0) - guide.value)
    arm = a.value + r * unit(t) - g.value
    (w, e), (v, acceleration) = derivatives(turned(rod)), derivatives(slide)
    under_v = g.speed + 1j * guide.speed * arm
    coriolis = 2j * guide.speed * v * u
    under_a = g.acceleration + 1j * guide.acceleration * arm - guide.speed**2 * arm + coriolis
    gaps = (under_v - a.speed, under_a - a.acceleration + w**2 * r * unit(t))
    for gap, references in zip(gaps, ((w, v), (e, acceleration)), strict=True):
        rates = rrp_rates(parts(gap), (float(r), *parts(unit(t))), parts(u), float(sine))
        near(rates[0], references[0], ROUNDINGS * EPS * abs(gap) / (r * abs(sine)))
        near(rates[1], references[1], ROUNDINGS * EPS * abs(gap) / abs(sine))


@modest
@given(coordinate, coordinate, angle, exponent, st.floats(1e-9, 1e6), mode, mode)
def test_rrp_rod_too_short__nan(ax, ay, guide, size, miss, side, sign):
    r = 10**size
    c, s = math.cos(guide), math.sin(guide)
    offset = ay * c - ax * s + side * (r * (1 + miss) + 1e-13)
    assert all(math.isnan(x) for x in rrp_position((ax, ay), (0.0, 0.0, c, s), r, offset, sign))


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_rrp_dead_centre__place_finite_rates_not(side, sign):
    # The rod stands at right angles to the guide: y = 3 is a rod's length from y = 1.
    bx, by, c1, s1, slide, sine = rrp_position((2.0, 1.0), (0.5, 0.0, 1.0, 0.0), 2.0, 1.0 + 2 * side, sign)
    assert (bx, by, c1, s1, slide) == (2.0, 1.0 + 2 * side, 0.0, side, 1.5)
    assert sine == 0.0
    assert not any(math.isfinite(w) for w in rrp_rates((0.3, -0.2), (2.0, c1, s1), (1.0, 0.0), sine))


# RPR


@modest
@given(coordinate, coordinate, exponent, angle, st.floats(-0.9999999, 0.9999999), mode)
def test_rpr_position__closed_geometry(dx, dy, size, at, share_of_distance, sign):
    ax, ay = dx + 10**size * math.cos(at), dy + 10**size * math.sin(at)
    a, d = vector(ax, ay), vector(dx, dy)
    assume(abs(a - d) > 0)
    offset = float(mpf(share_of_distance) * abs(a - d))
    t = rpr_angle(a, d, mpf(offset), sign)
    u = unit(t)
    quality = dot(u, a - d) / abs(a - d)
    c, s, slide, sine = rpr_position((ax, ay), (dx, dy), offset, sign)
    turned = ROUNDINGS * EPS / abs(quality)
    near(c, u.real, turned)
    near(s, u.imag, turned)
    near(slide, dot(u, a - d), turned * abs(a - d))
    near(sine, quality, turned)
    assert sine * sign > 0


@modest
@given(moving_points(), moving_points(), st.floats(-0.999, 0.999), mode)
def test_rpr_rates__derivatives_of_closed_geometry(a, d, share_of_distance, sign):
    distance = abs(a.value - d.value)
    assume(distance > 1e-3)
    offset = mpf(share_of_distance) * distance

    def slot(q):
        return rpr_angle(a(q), d(q), offset, sign)

    def slide(q):
        return dot(unit(slot(q)), a(q) - d(q))

    u = unit(slot(0))
    (w, e), (v, acceleration) = derivatives(turned(slot)), derivatives(slide)
    arm = a.value - d.value
    relative = a.acceleration - d.acceleration + w**2 * arm - 2j * w * v * u
    for gap, references in ((a.speed - d.speed, (w, v)), (relative, (e, acceleration))):
        rates = rpr_rates(parts(gap), parts(u), float(offset), float(slide(0)))
        tolerance = ROUNDINGS * EPS * abs(gap)
        near(rates[0], references[0], tolerance / abs(slide(0)))
        near(rates[1], references[1], tolerance * (1 + abs(offset / slide(0))))


@modest
@given(angle, exponent, st.floats(1e-9, 1e6), mode, mode)
def test_rpr_pin_inside_the_offset__nan(at, size, miss, side, sign):
    distance = 10**size
    a = (distance * math.cos(at), distance * math.sin(at))
    found = rpr_position(a, (0.0, 0.0), side * distance * (1 + miss), sign)
    assert all(math.isnan(x) for x in found)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("offset", [5.0, -5.0])
def test_rpr_dead_centre__place_finite_rates_not(offset, sign):
    c, s, slide, sine = rpr_position((4.0, 5.0), (1.0, 1.0), offset, sign)
    # The pin is wholly to the left (right) of the slot's line: n = ±(0.6, 0.8).
    assert (c, s) == pytest.approx((0.8 * offset / 5, -0.6 * offset / 5), rel=1e-15)
    assert (slide, sine) == (0.0, 0.0)
    w, rate = rpr_rates((0.3, -0.2), (c, s), offset, slide)
    assert not math.isfinite(w)
    assert not math.isfinite(rate)


def test_rpr_pin_on_the_pivot__nan():
    # The slot may then point anywhere: there is no position.
    assert all(math.isnan(x) for x in rpr_position((1.0, 1.0), (1.0, 1.0), 0.0, 1.0)[:2])


# PRP and RPP


@modest
@given(coordinate, coordinate, angle, angle)
def test_oblique_components__solution_of_the_two_equations(gx, gy, t1, t2):
    u1, u2 = (vector(math.cos(t), math.sin(t)) for t in (t1, t2))
    sine = cross(u1, u2)
    assume(abs(sine) > 1e-9)
    p, q = mpmath.lu_solve(mpmath.matrix([[u1.real, u2.real], [u1.imag, u2.imag]]), mpmath.matrix([gx, gy]))
    found = oblique_components((gx, gy), parts(u1), parts(u2))
    # The sine of nearly parallel directions has lost digits: EPS/sine relative.
    tolerance = ROUNDINGS * EPS * abs(vector(gx, gy)) / abs(sine) * (1 + 1 / abs(sine))
    near(found[0], p, tolerance)
    near(found[1], q, tolerance)


@modest
@given(coordinate, coordinate, coordinate, coordinate, angle, angle, coordinate, coordinate)
def test_prp_position__crossing_of_the_two_lines(g1x, g1y, g2x, g2y, t1, t2, offset1, offset2):
    u1, u2 = (vector(math.cos(t), math.sin(t)) for t in (t1, t2))
    assume(abs(cross(u1, u2)) > 1e-9)
    q1, q2 = vector(g1x, g1y) + 1j * offset1 * u1, vector(g2x, g2y) + 1j * offset2 * u2
    # With line 1 on the real axis, line 2 crosses it at B.
    gap, turn = (q2 - q1) / u1, u2 / u1
    slide1 = gap.real - gap.imag * turn.real / turn.imag
    b = q1 + slide1 * u1
    found = prp_position((g1x, g1y, *parts(u1)), offset1, (g2x, g2y, *parts(u2)), offset2)
    # Points and offsets reach some 16 m together; their roundings are magnified by 1/sine, and so is the rounding of
    # the sine itself.
    tolerance = ROUNDINGS * EPS * 16 / abs(turn.imag) * (1 + 1 / abs(turn.imag))
    for value, reference in zip(found, (b.real, b.imag, slide1, dot(u2, b - q2), turn.imag), strict=True):
        near(value, reference, tolerance)


@modest
@given(moving_points(), moving_points(), moving_angles(), moving_angles())
def test_prp_rates__joint_on_two_moving_guides(q1, q2, t1, t2):
    sine = mpmath.sin(t2.value - t1.value)
    assume(abs(sine) > 1e-3)

    def place(q):
        # Line 1 is real after a turn back by its angle; the joint is where line 2 crosses it.
        gap = (q2(q) - q1(q)) / unit(t1(q))
        return gap.real - gap.imag / mpmath.tan(t2(q) - t1(q))

    def other(q):
        return dot(unit(t2(q)), q1(q) + place(q) * unit(t1(q)) - q2(q))

    (v1, a1), (v2, a2) = derivatives(place), derivatives(other)
    joint = q1.value + place(0) * unit(t1.value)
    gap = (q2.value - q1.value, mpc(0), mpc(0))
    for sign, line, t, v in ((1, q2, t2, v2), (-1, q1, t1, v1)):
        arm = joint - line.value
        under_v = line.speed + 1j * t.speed * arm
        under_a = line.acceleration + 1j * t.acceleration * arm - t.speed**2 * arm
        coriolis = 2j * t.speed * v * unit(t.value)
        gap = (gap[0], gap[1] + sign * under_v, gap[2] + sign * (under_a + coriolis))
    for one, references in zip(gap, ((place(0), other(0)), (v1, v2), (a1, a2)), strict=True):
        rates = prp_rates(*(parts(v) for v in (one, unit(t1.value), unit(t2.value))))
        tolerance = ROUNDINGS * EPS * abs(one) / abs(sine) * (1 + 1 / abs(sine))
        near(rates[0], references[0], tolerance)
        near(rates[1], references[1], tolerance)


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, -1.0)])
@pytest.mark.parametrize("gap", [(0.3, 0.1), (0.8, 0.0), (0.0, -0.2)])
def test_oblique_components_of_parallel_directions__not_finite(gap, direction):
    # Directions oblique to the axes are parallel to rounding only: a machine judges by their sine.
    c, s = direction
    assert not any(math.isfinite(x) for x in oblique_components(gap, (c, s), (-c, -s)))


@modest
@given(coordinate, coordinate, coordinate, coordinate, angle, st.floats(0.1, 3.0))
def test_rpp_position__crossing_of_slot_and_guide(ax, ay, gx, gy, way, turn):
    u, by = vector(math.cos(way), math.sin(way)), vector(math.cos(turn), math.sin(turn))
    # With the guide on the real axis, the slot rises from the crossing to A.
    there = vector(ax - gx, ay - gy) / u
    along, slide = there.real - there.imag * by.real / by.imag, there.imag / by.imag
    crossing, slot = vector(gx, gy) + along * u, u * by
    found = rpp_position((ax, ay), (gx, gy, *parts(u)), parts(by))
    expected = (crossing.real, crossing.imag, slot.real, slot.imag, along, slide)
    # As for PRP.
    tolerance = ROUNDINGS * EPS * 16 / by.imag * (1 + 1 / by.imag)
    for value, reference in zip(found, expected, strict=True):
        near(value, reference, tolerance)


@modest
@given(moving_points(), angle, st.floats(0.1, 3.0))
def test_rpp_rates__derivatives_of_closed_geometry(a, way, turn):
    u, by = vector(math.cos(way), math.sin(way)), vector(math.cos(turn), math.sin(turn))

    def along(q):
        there = a(q) / u
        return there.real - there.imag * by.real / by.imag

    def slide(q):
        return (a(q) / u).imag / by.imag

    references = zip(derivatives(along), derivatives(slide), strict=True)
    for gap, expected in zip((a.speed, a.acceleration), references, strict=True):
        tolerance = ROUNDINGS * EPS * abs(gap) / by.imag * (1 + 1 / by.imag)
        for rate, reference in zip(rpp_rates(parts(gap), parts(u), parts(u * by)), expected, strict=True):
            near(rate, reference, tolerance)
