"""Stability of an engine with its governor: against the roots of its polynomial, with many digits."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from engine.laws.governors.stability import (
    critical_damping_of_sleeve,
    critical_inertia_of_engine,
    governed_polynomial,
    most_gain,
    normal_roots,
    vyshnegradsky,
)

EPS = np.finfo(float).eps
some = settings(max_examples=50)
scale = st.floats(-3.0, 3.0).map(lambda e: 10.0**e)
maybe = st.one_of(st.just(0.0), scale)


def roots(*coefficients):
    """Roots of a cubic with many digits, a real one first: Newton's method from those of a matrix."""
    start = min(np.roots(coefficients), key=lambda root: abs(root.imag)).real
    with mp.workdps(60):
        a3, a2, a1, a0 = (mp.mpf(c) for c in coefficients)
        real = mp.mpf(start)
        for _ in range(12):
            real -= (((a3 * real + a2) * real + a1) * real + a0) / ((3 * a3 * real + 2 * a2) * real + a1)
        half = -(a2 / a3 + real) / 2
        pair = mp.sqrt(mp.mpc(half**2 - (a1 / a3 + real * (a2 / a3 + real))))
        return real, half + pair, half - pair


def growth(*numbers):
    """Greatest real part of a root, over the size of the roots."""
    found = roots(*governed_polynomial(*numbers))
    return float(max(mp.re(r) for r in found) / max(abs(r) for r in found))


@some
@given(maybe, maybe)
def test_normal_roots__are_those_of_the_polynomial(x, y):
    real, middle, square = normal_roots(x, y)
    with mp.workdps(60):
        first = [mp.mpf(real)]
        pair = mp.sqrt(mp.mpc(square))
        found = [*first, middle + pair, middle - pair]
        for root in found:
            value = root**3 + x * root**2 + y * root + 1
            # A root is as good as its polynomial's value is small against the terms.
            size = abs(root) ** 3 + x * abs(root) ** 2 + y * abs(root) + 1
            assert abs(value) <= 128 * EPS * size
    assert real < 0


@some
@given(scale, scale, maybe, maybe, maybe, scale, scale)
def test_vyshnegradsky__is_the_polynomial_in_other_units(inertia, m, b, c, s, gain, pull):
    a3, a2, a1, a0 = governed_polynomial(inertia, m, b, c, s, gain, pull)
    x, y, time = vyshnegradsky(a3, a2, a1, a0)
    assert x == pytest.approx(a2 / a3 * time, rel=8 * EPS)
    assert y == pytest.approx(a1 / a3 * time**2, rel=8 * EPS)
    assert a0 / a3 * time**3 == pytest.approx(1.0, rel=64 * EPS)
    # Hurwitz: stable where X Y > 1.
    assume(abs(x * y - 1) > 1e-9)
    assert (x * y > 1) == (growth(inertia, m, b, c, s, gain, pull) < 0)


@some
@given(scale, scale, maybe, maybe, scale, scale)
def test_critical_damping__is_where_roots_reach_the_imaginary_axis(inertia, m, c, s, gain, pull):
    # Otherwise nothing but rounding is left of what damping has to make up for.
    assume(abs(inertia * gain - s * pull) > 1e-6 * inertia * gain)
    b = critical_damping_of_sleeve(inertia, m, c, s, gain, pull)
    assert 0 <= b < math.inf
    if b > 0:
        assert abs(growth(inertia, m, b, c, s, gain, pull)) < 1e-12
        assert growth(inertia, m, 0.99 * b, c, s, gain, pull) > 0
    assert growth(inertia, m, 1.01 * b + 1e-9, c, s, gain, pull) < 1e-15


@some
@given(scale, scale, scale, maybe, scale, scale)
def test_critical_inertia__is_the_last_at_which_it_hunts(m, b, c, s, gain, pull):
    assume(abs(m * gain * pull - s * b * b - b * pull * pull) > 1e-6 * m * gain * pull)
    inertia = critical_inertia_of_engine(m, b, c, s, gain, pull)
    assert 0 <= inertia < math.inf
    if inertia > 0:
        assert abs(growth(inertia, m, b, c, s, gain, pull)) < 1e-12
        assert growth(0.999 * inertia, m, b, c, s, gain, pull) > 0
    for more in (1.001, 2.0, 100.0):
        assert growth(more * inertia + 1e-9, m, b, c, s, gain, pull) < 0


def test_what_nothing_mends__is_infinite():
    # Without damping no flywheel helps, nor for an isochronous governor without self-regulation.
    assert critical_inertia_of_engine(1.0, 0.0, 1e3, 0.0, 1e4, 10.0) == math.inf
    assert critical_inertia_of_engine(1.0, 1e-3, 0.0, 0.0, 1e4, 1e-3) == math.inf


@some
@given(scale, scale, scale, scale, maybe, scale)
def test_most_gain__is_where_it_begins_to_hunt(inertia, m, b, c, s, pull):
    gain = most_gain(inertia, m, b, c, s, pull)
    if gain == 0.0:
        assert growth(inertia, m, b, c, s, 1e-3, pull) > -1e-9
        return
    # As many digits are lost as s c stands above K f.
    assume(gain * pull > 1e-3 * s * c)
    assert abs(growth(inertia, m, b, c, s, gain, pull)) < 1e-11
