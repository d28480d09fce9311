"""Roots in brackets, in NumPy: of functions that defeat a secant."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.cycle.regula_falsi import regula_falsi

# Each with a single root at 0.
SHAPES = {
    "straight": lambda x: x,
    "nearly a triple root": lambda x: x * (x * x + 1e-10),
    "steep at one end": lambda x: np.expm1(40.0 * x),
    "steep at the root": lambda x: np.cbrt(x),
    "a jump": lambda x: np.where(x < 0.0, -1.0, 3.0),
    "flat beyond": lambda x: np.arctan(1e6 * x),
}


@settings(max_examples=60)
@given(st.floats(1e-3, 3.0), st.floats(1e-3, 3.0), st.sampled_from([1.0, -1.0]), st.floats(-5.0, 5.0))
def test_roots__are_found_whatever_the_shape_and_alone_as_together(before, after, sign, root):
    ends = np.array([root - before, root + after])[:: int(sign)]
    a, b = np.repeat(ends[:, None], len(SHAPES), axis=1)
    # Differences from the root are rounded, as the root itself is.
    rounding = 4.0 * np.spacing(abs(root) + before + after)
    found = regula_falsi(lambda x: np.array([f(v - root) for f, v in zip(SHAPES.values(), x, strict=True)]), a, b)
    assert found == pytest.approx(np.full(a.size, root), abs=1e-13 * (before + after) + rounding)
    for f, one in zip(SHAPES.values(), found, strict=True):
        (alone,) = regula_falsi(lambda x, f=f: f(x - root), a[:1], b[:1])
        assert alone == one


def test_brackets__may_end_at_a_root_or_have_none():
    found = regula_falsi(lambda x: x - np.array([0.0, 2.0, 3.0, math.nan]), np.zeros(4), np.full(4, 2.0))
    assert found.tolist() == [0.0, 2.0, 2.0, 2.0]


def test_roots_of_functions_that_round__take_few_evaluations():
    roots, rounding, slope, calls = np.random.default_rng(3).uniform(0.1, 0.9, 20_000), 3e-15, 0.15, []

    def rounded(x):
        calls.append(x)
        return slope * (x - roots) * (1.0 + 0.1 * (x - roots)) + rounding * np.sin(1e16 * x)

    found = regula_falsi(rounded, np.zeros(roots.size), np.ones(roots.size))
    # The last step is 4e-14 of the bracket.
    assert found == pytest.approx(roots, abs=rounding / slope + 4e-14)
    # Steps shrink to the power 1.7; a few tiny ones check them.
    assert len(calls) < 30
