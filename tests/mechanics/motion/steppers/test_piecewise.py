"""Integrals and peaks of curves known at nodes: against quadrature and dense sampling, with jumps and cusps."""

import math
from itertools import pairwise

import numba
import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from engine.motion.moments import piecewise
from engine.motion.moments.grid import JUMP

TURN = 2 * math.pi
# As compiled code has them.
laws = (piecewise.integral, piecewise.peak_between)
integral, peak_between = (numba.njit(law.py_func, error_model="numpy") for law in laws)


def nodes_with(jump: float, count: int) -> np.ndarray:
    """Equally spaced nodes over a turn, and one on either side of a jump."""
    return np.sort(np.concatenate((np.linspace(0.0, TURN, count + 1), [jump - JUMP, jump + JUMP])))


@given(
    st.floats(-0.95, 0.95),
    st.floats(0.1, 6.0),
    st.floats(-10.0, 10.0),
    st.floats(0.2, 6.0),
    st.sampled_from([180, 720]),
)
# A cusp in the last step; two steps from the jump.
@example(-0.5, 4.18516814208444, 6.269895797303086, 1.3796693861353058, 720)
@example(0.95, 0.30420261557894035, -9.074891125771309, 5.761442256771904, 180)
@example(-0.8271337761634273, 0.8270421502092531, -10.0, 3.384811911128233, 720)
# Polynomials through the nodes about the cusp draw together by chance.
@example(0.0, 1.9371003796515147, 2.75, 1.0, 180)
@settings(deadline=None, max_examples=60)
def test_cusps_and_a_jump__within_what_they_may_hide(level, phase, size, jump, count):
    """A magnitude, as that of a force whose direction turns round, beside a load that sets in."""

    def curve(x: np.ndarray) -> np.ndarray:
        return size * np.abs(np.cos(x - phase) - level) + np.where(x > jump, 5 * np.cos(x), 0.0)

    x = nodes_with(jump, count)
    h, values = np.diff(x), curve(x)
    places = [0.0, jump, TURN, *((phase + side * math.acos(level)) % TURN for side in (-1, 1))]
    edges = np.unique(places)
    exact = sum(quad(curve, a, b, epsabs=1e-12, limit=200)[0] for a, b in pairwise(edges))
    total, hidden = integral(values, h)
    # Quadrature reaches 1e-9 beside the jump itself.
    assert abs(total - exact) <= hidden + 1e-8
    dense = np.sort(np.concatenate((np.linspace(0.0, TURN, 20001), x, edges[1:-1])))
    # Between dense nodes a parabola of curvature 15 rises by 15 (2π/20000)²/8 at most.
    room = 15 * (TURN / 20000) ** 2 / 8
    for sign in (1.0, -1.0):
        top, node, within = peak_between(sign * values, h)
        assert (sign * values).max() <= top <= within
        # From a single step between a jump and a cusp nothing tells how its slope grows: by a curvature of 15 at most.
        ends = (0.0, jump, TURN)
        beside = min(abs(place - end) for place in places[3:] for end in ends) < 3 * TURN / count
        assert (sign * curve(dense)).max() <= within + room + (15 * (TURN / count) ** 2 if beside else 0.0)
        # A bound that says something: of the order of a step of the steepest slope.
        assert within - (sign * values).max() <= 30 * TURN / count
        assert abs(top - sign * values[int(node)]) <= 30 * TURN / count


def dense_top(curve, count: int) -> float:
    """Greatest value of a curve over a turn, by looking ever more closely about each place above its neighbours."""
    x = np.linspace(0.0, TURN, 10 * count + 1)
    y, tops = curve(x), []
    step = x[1]
    for place in x[1:-1][(y[1:-1] >= y[:-2]) & (y[1:-1] >= y[2:])]:
        around, half = place, step
        for _ in range(5):
            u = around + half * np.linspace(-1.0, 1.0, 101)
            around, half = u[int(np.argmax(curve(u)))], 0.02 * half
        tops.append(curve(np.array([around]))[0])
    return max(*tops, y[0], y[-1])


@pytest.mark.parametrize("kind", ["smooth", "bent", "magnitude"])
def test_peaks_between_nodes__are_known_within_their_estimate(kind):
    """Series of twelve harmonics; with a cusp that may be the peak; magnitudes of vectors that almost vanish."""
    rng, apart = np.random.default_rng(7), []
    for _ in range(150):
        sizes, phases = rng.normal(size=(2, 12)) * 0.6 ** np.arange(12), rng.uniform(0.0, TURN, (2, 12))
        small, bend, where = 10.0 ** rng.uniform(-3.0, 0.0), abs(rng.normal()), rng.uniform(0.0, TURN)

        def series(x, which, sizes=sizes, phases=phases):
            return sizes[which] @ np.cos(np.arange(1, 13)[:, None] * x - phases[which][:, None])

        curves = {
            "smooth": lambda x, series=series: series(x, 0),
            "bent": lambda x, series=series, bend=bend, where=where: (
                series(x, 0) - bend * np.abs(np.sin(0.5 * (x - where)))
            ),
            "magnitude": lambda x, series=series, small=small: np.hypot(series(x, 0), small * series(x, 1)),
        }
        curve, x = curves[kind], np.linspace(0.0, TURN, 361)
        scale = np.abs(curve(x)).max()
        for sign in (1.0, -1.0):
            top, _, most = peak_between(sign * curve(x), np.diff(x))
            exact = dense_top(lambda u, curve=curve, sign=sign: sign * curve(u), 360)
            assert abs(top - exact) <= most - top + 1e-13 * scale
            apart.append(abs(top - exact) / scale)
    assert np.median(apart) < 1e-10


def test_a_magnitude_that_almost_vanishes__leaves_its_maximum_well_known():
    x = np.linspace(0.0, TURN, 361)
    row = np.hypot(np.sin(x), 1e-3 * np.cos(x))
    found = piecewise.extremes_along(row[:, None], np.diff(x)[:, None])
    values, errors = piecewise.of_extremes(found[:, 0], found[:, 2])
    exact = {"min": 1e-3, "max": 1.0, "range": 1.0 - 1e-3, "amplitude": 0.5 - 5e-4, "peak": 1.0}
    for name, value in exact.items():
        assert abs(values[name] - value) <= errors[name] + 1e-15
    assert errors["max"] == errors["peak"] < 1e-9 < 1e-4 < errors["min"]
