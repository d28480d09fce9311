"""The Pareto front against a comparison of all pairs, and of a million points."""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from sweeps.optimising.pareto import pareto_front


def brute_force_front(values, minimise):
    costs = values * np.where(minimise, 1, -1)
    with np.errstate(invalid="ignore"):
        better = (costs[:, None] <= costs[None]).all(axis=2) & (costs[:, None] < costs[None]).any(axis=2)
    return ~better.any(axis=0) & ~np.isnan(costs).any(axis=1)


@settings(deadline=None, max_examples=150)
@given(st.data())
def test_pareto_front__as_by_comparing_all_pairs(data):
    objectives = data.draw(st.integers(1, 4))
    # Few different numbers, so that there are ties, doubles and two kinds of zero.
    number = st.sampled_from([-2.0, -1.0, -0.0, 0.0, 0.5, 1.0, 3.0, math.inf, -math.inf, math.nan])
    rows = data.draw(st.lists(st.lists(number, min_size=objectives, max_size=objectives), max_size=40))
    minimise = data.draw(st.lists(st.booleans(), min_size=objectives, max_size=objectives))
    values = np.array(rows).reshape(-1, objectives)
    assert pareto_front(values, minimise).tolist() == brute_force_front(values, minimise).tolist()


def test_pareto_front_of_a_million_points__the_known_front():
    rng = np.random.default_rng(7)
    x = rng.random(1_000_000)
    values = np.column_stack([x, 1 - x + rng.exponential(size=x.size)])
    front = np.linspace(0, 1, 50)
    values[:50] = np.column_stack([front, 1 - front - 1e-3])
    found = np.flatnonzero(pareto_front(values, [True, True]))
    # Any other point lies above the line x + y = 1, the fifty 0.001 below it, 1/49 apart.
    assert set(range(50)) <= set(found)
    assert (values[found].sum(axis=1) < 1 + 1 / 49).all()
