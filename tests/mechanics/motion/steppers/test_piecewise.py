"""Integrals and peaks of curves known at nodes: against quadrature and dense sampling, with jumps and cusps."""

import math
from itertools import pairwise

import numba
import numpy as np
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


def test_a_magnitude_that_almost_vanishes__leaves_its_maximum_well_known():
    x = np.linspace(0.0, TURN, 361)
    row = np.hypot(np.sin(x), 1e-3 * np.cos(x))
    found = piecewise.extremes_along(row[:, None], np.diff(x)[:, None])
    values, errors = piecewise.of_extremes(found[:, 0], found[:, 2])
    exact = {"min": 1e-3, "max": 1.0, "range": 1.0 - 1e-3, "amplitude": 0.5 - 5e-4, "peak": 1.0}
    for name, value in exact.items():
        assert abs(values[name] - value) <= errors[name] + 1e-15
    assert errors["max"] == errors["peak"] < 1e-9 < 1e-4 < errors["min"]
