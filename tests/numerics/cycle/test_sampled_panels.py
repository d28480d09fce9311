"""Polynomials on panels as arrays: tops, integrals and roots against closed forms, of many random waves."""

import numpy as np
import pytest

from engine.cycle.panels.chebyshev import PLACES
from engine.cycle.panels.sampled import panel_integrals, root_inside, tails, tops

EPS = np.finfo(float).eps


@pytest.fixture(scope="module")
def waves():
    """cos(w x − a) of 500 panels: less than a third of a wave on each, where 17 positions follow it to rounding."""
    rng = np.random.default_rng(8)
    w, a = rng.uniform(0.3, 0.9, 500)[:, None], rng.uniform(-np.pi, np.pi, 500)[:, None]
    return w, a, np.cos(w * PLACES - a)


def test_top__is_that_of_the_wave(waves):
    w, a, values = waves
    found = tops(values, np.full(len(w), 64 * EPS))
    at = np.where(np.abs(a / w) <= 1, a / w, np.where(np.cos(w - a) > np.cos(w + a), 1.0, -1.0))[:, 0]
    np.testing.assert_allclose(found.values, np.cos(w[:, 0] * at - a[:, 0]), rtol=0, atol=64 * EPS)
    inside = np.abs(at) < 0.99
    # A step of Newton's method leaves the rounding of the slope.
    np.testing.assert_allclose(found.places[inside], at[inside], rtol=0, atol=1e-7)
    np.testing.assert_allclose(found.bends[inside], -(w[inside, 0] ** 2), rtol=1e-6)


def test_top_of_a_constant__is_its_first_place():
    values = np.full((3, PLACES.size), 0.3) + EPS * np.random.default_rng(1).uniform(-1, 1, (3, PLACES.size))
    assert (tops(values, np.full(3, 64 * EPS)).places == -1.0).all()


def test_integral__is_that_of_the_wave(waves):
    w, a, values = waves
    true = (np.sin(w - a) + np.sin(w + a))[:, 0] / w[:, 0]
    np.testing.assert_allclose(panel_integrals(values), true, rtol=0, atol=64 * EPS)


def test_root__is_that_of_the_wave_and_none_of_what_polynomials_do_not_follow(waves):
    w, a, values = waves
    roots = (a + np.pi / 2 * np.array([-3, -1, 1, 3])) / w
    inside = np.abs(roots) < PLACES[-2]
    one = inside.sum(axis=1) == 1
    true = np.where(inside, roots, 0.0).sum(axis=1)
    np.testing.assert_allclose(root_inside(values)[one], true[one], rtol=0, atol=256 * EPS)
    assert (root_inside(values)[~inside.any(axis=1)] == 0.0).all()
    assert (root_inside(np.sign(PLACES - 0.3)[None]) == 0.0).all()


def test_tail__is_what_polynomials_miss(waves):
    _, _, values = waves
    assert tails(values).max() < 16 * EPS
    assert (tails(np.abs(PLACES - 0.3)[None]) > 1e-4).all()
