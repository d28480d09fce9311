"""Reactions of dyads against the six equations of equilibrium of their two links, at 50 digits.

The reference writes every pair's reactions as unknowns and solves the six equations densely; it knows nothing of the
closed forms. Positions are built from exact angles, so that the data of both sides are the same float64 numbers.

Tolerances: cosines and sines carry errors of EPS, and `sine` is made of them: it is known to EPS/|sine| of itself.
Each reaction is a load over `sine` and possibly over `sine` again for the moment it makes, so its error is bounded by
ROUNDINGS·EPS/sine² of the greatest force, lengths being of order one.
"""

import math

import mpmath
import pytest
from closed_geometry import EPS
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mp, mpf

from engine.laws.kinematics.prp import prp_reactions
from engine.laws.kinematics.rpp import rpp_reactions
from engine.laws.kinematics.rpr import rpr_reactions
from engine.laws.kinematics.rrp import rrp_reactions
from engine.laws.kinematics.rrr import rrr_reactions

ROUNDINGS = 64
modest = settings(max_examples=60, deadline=None)
angles = st.floats(-math.pi, math.pi)
lengths = st.floats(0.2, 5.0)
places = st.floats(-3.0, 3.0)
signs = st.sampled_from([-1.0, 1.0])


@st.composite
def loads(draw):
    """Force and moment on each of two links; each part may be zero or of any size."""
    size = st.floats(-1.0, 1.0).map(lambda v: v * 10 ** draw(st.integers(-3, 3)))
    return tuple(draw(size) for _ in range(6))


@pytest.fixture(autouse=True)
def _fifty_digits():
    with mp.workdps(50):
        yield


def unit(angle: float) -> tuple[float, float]:
    return math.cos(angle), math.sin(angle)


def along(place: tuple, direction: tuple, length: float) -> tuple:
    """Place at a distance, in exact arithmetic."""
    return tuple(mpf(p) + mpf(length) * mpf(u) for p, u in zip(place, direction, strict=True))


def joint(at: tuple, *links: tuple[int, int]) -> list[list]:
    """Columns of the two unknown components of a force in a joint, on links (0 or 1) with a sign."""
    return [_column(at, direction, links) for direction in ((1, 0), (0, 1))]


def guide(at: tuple, u: tuple, *links: tuple[int, int]) -> list[list]:
    """Columns of normal force and moment of a prismatic pair with the direction u."""
    moment = [mpf(0)] * 6
    for link, sign in links:
        moment[3 * link + 2] = mpf(sign)
    return [_column(at, (-mpf(u[1]), mpf(u[0])), links), moment]


def _column(at: tuple, f: tuple, links: tuple) -> list:
    column = [mpf(0)] * 6
    for link, sign in links:
        column[3 * link : 3 * link + 3] = [sign * f[0], sign * f[1], sign * (at[0] * f[1] - at[1] * f[0])]
    return column


def check(found: tuple, columns: list[list], loads: tuple, origins: tuple, sine: float) -> None:
    """Compare reactions with the solution of the six equations, moments about the frame's origin."""
    right = []
    for i, (x, y) in enumerate(origins):
        fx, fy, m = (mpf(v) for v in loads[3 * i : 3 * i + 3])
        right += [-fx, -fy, -(m + x * fy - y * fx)]
    expected = mpmath.lu_solve(mpmath.matrix(columns).T, mpmath.matrix(right))
    scale = max(1e-300, *(abs(v) for v in expected), *(abs(mpf(v)) for v in loads))
    for got, value in zip(found, expected, strict=True):
        assert abs(mpf(got) - value) <= ROUNDINGS * EPS / sine**2 * scale


@modest
@given(places, places, lengths, lengths, angles, angles, loads())
def test_rrr__equilibrium_of_both_links(ax, ay, r1, r2, angle1, angle2, loads):
    u1, u2 = unit(angle1), unit(angle2)
    sine = math.sin(angle2 - angle1)
    assume(abs(sine) > 1e-3)
    a = (mpf(ax), mpf(ay))
    b = along(a, u1, r1)
    d = along(b, u2, -r2)
    found = rrr_reactions(loads[:3], loads[3:], (r1, *u1), (r2, *u2), sine)
    columns = [*joint(a, (0, 1)), *joint(b, (0, 1), (1, -1)), *joint(d, (1, 1))]
    check(found, columns, loads, (a, d), sine)


@modest
@given(places, places, lengths, angles, angles, loads())
def test_rrp__equilibrium_of_rod_and_slider(ax, ay, r1, rod, way, loads):
    u1, u = unit(rod), unit(way)
    sine = math.cos(rod - way)
    assume(abs(sine) > 1e-3)
    a = (mpf(ax), mpf(ay))
    b = along(a, u1, r1)
    found = rrp_reactions(loads[:3], loads[3:], (r1, *u1), u, sine)
    columns = [*joint(a, (0, 1)), *joint(b, (0, 1), (1, -1)), *guide(b, u, (1, 1))]
    check(found, columns, loads, (a, b), sine)


@modest
@given(places, places, lengths, st.floats(-2.0, 2.0), angles, signs, loads())
def test_rpr__equilibrium_of_block_and_rocker(dx, dy, reach, offset, angle, mode, loads):
    u, slide = unit(angle), mode * reach
    d = (mpf(dx), mpf(dy))
    a = along(along(d, u, slide), (-u[1], u[0]), offset)
    found = rpr_reactions(loads[:3], loads[3:], u, slide)
    columns = [*joint(a, (0, 1)), *guide(a, u, (0, 1), (1, -1)), *joint(d, (1, 1))]
    # The slot's direction is known to EPS, which moves A by EPS of its distance from D: as a sine of slide/distance.
    check(found, columns, loads, (a, d), slide / math.hypot(slide, offset) / (1.0 + 1.0 / reach))


@modest
@given(places, places, angles, angles, loads())
def test_prp__equilibrium_of_both_sliders(bx, by, angle1, angle2, loads):
    u1, u2 = unit(angle1), unit(angle2)
    sine = math.sin(angle2 - angle1)
    assume(abs(sine) > 1e-3)
    b = (mpf(bx), mpf(by))
    found = prp_reactions(loads[:3], loads[3:], u1, u2)
    columns = [*guide(b, u1, (0, 1)), *joint(b, (0, 1), (1, -1)), *guide(b, u2, (1, 1))]
    check(found, columns, loads, (b, b), sine)


@modest
@given(places, places, angles, angles, st.floats(-3.0, 3.0), loads())
def test_rpp__equilibrium_of_block_and_sliding_link(x, y, way, slot, slide, loads):
    u, v = unit(way), unit(slot)
    sine = math.sin(slot - way)
    assume(abs(sine) > 1e-3)
    crossing = (mpf(x), mpf(y))
    a = along(crossing, v, slide)
    found = rpp_reactions(loads[:3], loads[3:], u, v, slide)
    columns = [*joint(a, (0, 1)), *guide(a, v, (0, 1), (1, -1)), *guide(crossing, u, (1, 1))]
    check(found, columns, loads, (a, crossing), sine)


def test_singular_positions__no_finite_reaction():
    ahead, upwards, nothing = (1.0, 0.0), (0.0, 1.0), (0.0, 0.0, 0.0)
    stretched = rrr_reactions((0.0, 1.0, 0.5), nothing, (1.0, *ahead), (1.0, *ahead), 0.0)
    upright = rrp_reactions((0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (1.0, *upwards), ahead, 0.0)
    at_pivot = rpr_reactions((0.0, 0.0, 1.0), nothing, ahead, 0.0)
    parallel = prp_reactions((1.0, 0.0, 0.0), nothing, ahead, ahead)
    along_guide = rpp_reactions(nothing, (1.0, 0.0, 0.0), ahead, ahead, 0.2)
    for found in (stretched, upright, at_pivot, parallel, along_guide):
        assert not all(math.isfinite(part) for part in found)


def test_loads_of_nothing__no_reactions():
    found = rrr_reactions((0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (1.0, 0.6, 0.8), (1.0, 0.8, -0.6), -1.0)
    assert found == (0.0,) * 6
