"""Dyads between and at their dead centres against closed geometry in complex numbers, at 50 digits.

The references know nothing of the formulas under test: a joint is found by angles (law of cosines, arcsine). Velocities
and accelerations, and dyads on two guides, are tested in `test_mechanisms.py`.

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
    dot,
    exponent,
    mode,
    near,
    parts,
    rpr_angle,
    rrp_angle,
    rrr_angles,
    unit,
    vector,
)
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

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


# Two guides


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, -1.0)])
@pytest.mark.parametrize("gap", [(0.3, 0.1), (0.8, 0.0), (0.0, -0.2)])
def test_oblique_components_of_parallel_directions__not_finite(gap, direction):
    # Directions oblique to the axes are parallel to rounding only: a machine judges by their sine.
    c, s = direction
    assert not any(math.isfinite(x) for x in oblique_components(gap, (c, s), (-c, -s)))
