"""Pressing forces settled by a fixed number of iterations, against closed forms and against the equations themselves.

ROUNDINGS: an iteration is some thirty operations; what it solves amplifies rounding by the reciprocal of the margin.
"""

import math
import platform
import re
from functools import cache

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numba import njit

from engine.compiling.blocks import LANES
from engine.compiling.compilers import Apart
from engine.compiling.decorators import RULES
from engine.graph.nodes import Graph, Stage
from engine.graph.over_arrays import NodesOverArrays
from engine.laws.friction.feedback import GUIDE, JOURNAL, bearing
from engine.mechanism.friction import Rub, pressing_in_group

EPS = np.finfo(float).eps
ROUNDINGS = 100

quick = settings(max_examples=60)


@cache
def of_pairs(count: int) -> NodesOverArrays:
    """Pressing forces, margin and residual over the numbers of the pairs, in the order of `known`."""
    graph = Graph()
    given = [graph.given(f"number {i}", Stage.VARIANT) for i in range(count * (4 + 2 * count))]
    each = [given[i : i + 4 + 2 * count] for i in range(0, len(given), 4 + 2 * count)]
    rubs = [Rub(kind, edge, edge, edge) for kind, edge, *_ in each]
    backs = [list(zip(own[4::2], own[5::2], strict=True)) for own in each]
    found = pressing_in_group(rubs, [tuple(own[2:4]) for own in each], backs)
    return NodesOverArrays(given, [*found.pressing, found.margin, found.residual])


def settled(*numbers: float | np.ndarray) -> np.ndarray:
    count = next(count for count in range(1, 9) if count * (4 + 2 * count) == len(numbers))
    rows = np.array(np.broadcast_arrays(*numbers), float)
    found = of_pairs(count)(rows.reshape(len(rows), -1))
    return found.reshape(len(found), *rows.shape[1:])


# Several pairs: the equations themselves


def known(kinds: list[float], edges: list[float], free: np.ndarray, backs: np.ndarray) -> list[float]:
    """Numbers of each pair: its kind, edge, reaction and what each pair gives it."""
    parts = zip(kinds, edges, free, backs, strict=True)
    return [float(x) for kind, edge, r, row in parts for x in (kind, edge, *r, *row.T.ravel())]


def pressing(kinds: list[float], edges: list[float], free: np.ndarray, backs: np.ndarray, n: np.ndarray) -> np.ndarray:
    """|R_i| with the friction of the forces n; `backs` is (pairs, components, pairs)."""
    parts = zip(kinds, edges, free + backs @ n, strict=True)
    return np.array([math.hypot(*r) if k == JOURNAL else max(abs(r[0]), e * abs(r[1])) for k, e, r in parts])


@st.composite
def groups(draw: st.DrawFn) -> tuple:
    """Two or three pairs, each of which gives back up to half of its force to all."""
    count = draw(st.integers(2, 3))
    kinds = draw(st.lists(st.sampled_from([JOURNAL, GUIDE]), min_size=count, max_size=count))
    edges = [0.0 if k == JOURNAL else draw(st.one_of(st.just(0.0), st.floats(0.5, 20.0))) for k in kinds]
    rng = np.random.default_rng(draw(st.integers(0, 2**32)))
    free = rng.normal(size=(count, 2)) * 10.0 ** rng.uniform(-2, 3, (count, 1))
    backs = rng.uniform(-0.5, 0.5, (count, 2, count)) / count
    for i, edge in enumerate(edges):
        if kinds[i] == GUIDE:
            backs[i, 1] /= max(edge, 1.0)
    return kinds, edges, free, backs


@quick
@given(group=groups())
def test_pairs_of_a_group__press_with_the_magnitudes_of_their_reactions(group):
    _, _, free, _ = group
    *n, margin, residual = settled(*known(*group))
    assume(residual < 1e-2)
    n = np.array(n)
    # The equations are in error by no more than their greatest force and what the last iteration still changed of it.
    error = np.abs(pressing(*group, n) - n).max()
    assert error <= (ROUNDINGS * EPS + residual) * (n.sum() + np.abs(free).max())
    assert (n >= -error).all()
    assert margin > 0


def test_margin__determinant_of_the_equations_that_remain():
    rng = np.random.default_rng(2)
    free, backs = rng.normal(size=(3, 2)), rng.uniform(-0.2, 0.2, (3, 2, 3))
    kinds, edges = [JOURNAL, GUIDE, JOURNAL], [0.0, 0.5, 0.0]
    *n, margin, _ = settled(*known(kinds, edges, free, backs))
    step, n = 1e-6, np.array(n)
    slopes = [
        (pressing(kinds, edges, free, backs, n + d) - pressing(kinds, edges, free, backs, n - d)) / (2 * step)
        for d in step * np.eye(3)
    ]
    # Central differences of second order: rounding over the step.
    assert margin == pytest.approx(np.linalg.det(np.eye(3) - np.array(slopes).T), abs=1e-8)


def test_unknown_reaction__unknown_forces_and_margin():
    *n, margin, _ = settled(*known([JOURNAL, GUIDE], [0.0, 2.0], np.full((2, 2), math.nan), np.zeros((2, 2, 2))))
    assert np.isnan([*n, margin]).all()


# Side by side


@njit(error_model="numpy", fastmath=set(RULES), pipeline_class=Apart)
def _in_lanes(rows: np.ndarray, found: np.ndarray) -> None:
    r, f = rows.ravel(), found.ravel()
    for i in range(LANES):
        kind, edge, x, y = r[i], r[LANES + i], r[2 * LANES + i], r[3 * LANES + i]
        f[i], f[LANES + i], f[2 * LANES + i] = bearing(kind, edge, x, y)


def test_variants__are_settled_side_by_side():
    rng = np.random.default_rng(4)
    rows = np.array(known([JOURNAL, GUIDE], [0.0, 2.0], np.ones((2, 2)), np.ones((2, 2, 2))))[:, None]
    rows = rows * rng.uniform(0.1, 0.3, (len(rows), LANES))
    rows[[0, 8]] = [[JOURNAL], [GUIDE]]
    np.testing.assert_array_equal(settled(*rows), np.array([settled(*row) for row in rows.T]).T)
    _in_lanes(rows[:4], np.empty((3, LANES)))
    assembly = "\n".join(_in_lanes.inspect_asm().values())
    if platform.machine() in ("x86_64", "AMD64"):
        assert re.search(r"\bv?sqrtpd\b", assembly)
    # Nothing is called but what allocates and frees: those calls go through addresses.
    assert not re.search(r"\bcallq?\s+\W*(sqrt|hypot|copysign)\b", assembly)
