"""Work of forces given over a stroke against quadrature over the stroke, by a slider-crank in closed form."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from engine.equal_positions.stroke_work import work_over_stroke
from engine.laws.tables import integrated, make_table, table_integral, table_value

few = settings(deadline=None, max_examples=60)

# A force that sets in at 0.02, jumps at 0.05 and ends at 0.11.
STEPPED = make_table([0.02, 0.05, 0.05, 0.11], [300.0, 500.0, -200.0, 900.0], "linear", outside="zero")
SMOOTH = make_table([0.0, 0.03, 0.07, 0.2], [10.0, 700.0, 300.0, 20.0], "pchip")
EDGES = {0: (0.02, 0.05, 0.11), 1: (0.0, 0.03, 0.07, 0.2)}


def force(table, x):
    return table_value(*table, x)


@few
@given(st.sampled_from([STEPPED, SMOOTH]), st.floats(-0.1, 0.3), st.floats(-0.1, 0.3))
def test_integral_of_a_table__is_its_quadrature(table, a, b):
    whole = integrated(table)
    found = table_integral(whole.breaks, whole.coefficients, b) - table_integral(whole.breaks, whole.coefficients, a)
    points = [x for x in sorted({*EDGES[0], *EDGES[1]}) if min(a, b) < x < max(a, b)]
    exact, _ = quad(lambda x: force(table, x), a, b, points=points or None, epsabs=1e-13, limit=200)
    # Sums of a handful of areas of up to 0.4 · 900.
    assert found == pytest.approx(exact, abs=1e-11)


def crank(n, turn=0.0, way=1.0):
    """Coordinate and transfer velocity of an in-line slider-crank, r = 0.1, l = 0.3, dead centres at 0.2 and 0.4."""
    phi = turn + way * np.arange(n) * (2 * math.pi / n)
    root = np.sqrt(0.09 - (0.1 * np.sin(phi)) ** 2)
    return 0.1 * np.cos(phi) + root, -0.1 * np.sin(phi) * (1.0 + 0.1 * np.cos(phi) / root)


def by_quadrature(table, cosine, direction, origin, sense, forward, d, v):
    """Work between neighbours: dx by dx, parted at the dead centre."""

    def piece(a, b, acts):
        places = sorted({(x - origin) / sense for x in (*EDGES[0], *EDGES[1])})
        inside = [x for x in places if min(a, b) < x < max(a, b)]
        f = quad(lambda x: force(table, origin + sense * x), a, b, points=inside or None, epsabs=1e-13, limit=100)[0]
        return cosine * f if acts else 0.0

    steps = []
    for k in range(d.size):
        a, b = (d[k], v[k]), (d[(k + 1) % d.size], v[(k + 1) % d.size])
        acts = [direction == 0 or direction * cosine * forward * u > 0 for _, u in (a, b)]
        if a[1] * b[1] < 0.0:
            end = 0.4 if a[1] > 0 else 0.2
            steps.append(piece(a[0], end, acts[0]) + piece(end, b[0], acts[1]))
        else:
            steps.append(piece(a[0], b[0], acts[0] if a[1] != 0.0 else acts[1]))
    return np.concatenate(([0.0], np.cumsum(steps)))


@few
@given(
    st.sampled_from([STEPPED, SMOOTH]),
    st.sampled_from([40, 64, 90]),
    st.floats(0.0, 1.0),
    st.sampled_from([0.0, 1.0, -1.0]),
    st.sampled_from([(0.4, -1.0), (-0.2, 1.0), (-0.25, 1.0)]),
    st.sampled_from([1.0, -1.0, 0.6]),
    st.sampled_from([1.0, -1.0]),
)
def test_work__is_the_integral_over_the_stroke_however_the_force_jumps(table, n, turn, direction, place, cosine, way):
    d, v = crank(n, turn)
    work, whole = np.empty(n), integrated(table)
    arguments = (*place, whole.breaks, whole.coefficients, work)
    total = work_over_stroke(d, v, 2 * math.pi / n, way, cosine, direction, *arguments)
    exact = by_quadrature(table, cosine, direction, *place, way, d, v)
    # Only the dead centres are approximate: to h⁴/384 of the fourth derivative, about 0.1, times forces up to 900.
    allowed = 2 * 900 * 0.2 * (2 * math.pi / n) ** 4 / 384 + 1e-11
    assert work == pytest.approx(exact[:-1], abs=allowed)
    assert total == pytest.approx(exact[-1], abs=allowed)


def test_work__is_exact_with_eight_positions_a_turn():
    d, v = crank(8)
    v[np.abs(v) < 1e-15] = 0.0
    work, whole = np.empty(8), integrated(STEPPED)
    total = work_over_stroke(d, v, math.pi / 4, 1.0, -1.0, -1.0, 0.4, -1.0, whole.breaks, whole.coefficients, work)
    # Against the motion, on the way up from 0.2 to 0.4 only: minus the area of the table over the whole stroke.
    assert total == pytest.approx(-(12.0 + 0.06 * 350.0), rel=1e-13)


@pytest.mark.parametrize("shift", [0, 3])
def test_work__begins_at_a_dead_centre_that_is_a_position(shift):
    d, v = (np.roll(row, shift) for row in crank(8))
    v[np.abs(v) < 1e-15] = 0.0
    work, whole = np.empty(8), integrated(STEPPED)
    total = work_over_stroke(d, v, math.pi / 4, 1.0, 1.0, -1.0, -0.2, 1.0, whole.breaks, whole.coefficients, work)
    # Against the motion on the way down, from the top dead centre on: minus the area of the table.
    assert total == pytest.approx(-(12.0 + 0.06 * 350.0), rel=1e-13)


def test_work__of_a_slider_that_rests_a_while_is_none_meanwhile():
    # Up, a dwell of four positions that rounding alone moves, and down again.
    d = np.array([0.0, 0.05, 0.1, 0.1, 0.1, 0.1, 0.1, 0.05])
    v = np.array([0.0, 0.06, 0.0, 0.0, 1e-18, 0.0, 0.0, -0.06])
    work, whole = np.empty(8), integrated(SMOOTH)
    total = work_over_stroke(d, v, 1.0, 1.0, 1.0, 1.0, 0.0, 1.0, whole.breaks, whole.coefficients, work)
    area = table_integral(whole.breaks, whole.coefficients, 0.1)
    assert work[2:6] == pytest.approx(area, rel=1e-12)
    assert total == pytest.approx(area, rel=1e-12)


def test_work__of_a_position_that_is_none_is_none():
    d, v = crank(24)
    d[7] = v[7] = math.nan
    work, whole = np.empty(24), integrated(STEPPED)
    args = (whole.breaks, whole.coefficients, work)
    assert math.isnan(work_over_stroke(d, v, 2 * math.pi / 24, 1.0, 1.0, 0.0, 0.0, 1.0, *args))
