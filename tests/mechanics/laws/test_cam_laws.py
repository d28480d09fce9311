"""Motion laws of cams: known peaks, derivatives against integrals, continuity where their pieces meet."""

from itertools import pairwise

import numpy as np
import pytest

from engine.laws.cams import motion_laws as laws
from engine.laws.cams.profiles import least_height_for_curvature

WITHOUT_PLACE = {
    "uniform": laws.uniform_motion,
    "harmonic": laws.harmonic_motion,
    "cycloidal": laws.cycloidal_motion,
    "3-4-5": laws.polynomial_345,
    "4-5-6-7": laws.polynomial_4567,
}
WITH_PLACE = {
    "parabolic": laws.parabolic_motion,
    "modified sine": laws.modified_sine,
    "modified trapezoid": laws.modified_trapezoid,
}
BREAKS = {
    "parabolic": (0.0, 0.5, 1.0),
    "modified sine": (0.0, 0.125, 0.875, 1.0),
    "modified trapezoid": (0.0, 0.125, 0.375, 0.625, 0.875, 1.0),
}
NAMES = [*WITHOUT_PLACE, *WITH_PLACE]
EPS = 2.0**-52


def law(name):
    """S … S''' at places of one piece, as rows."""
    chosen = (WITHOUT_PLACE | WITH_PLACE)[name]

    def values(u, held):
        args = (lambda x: (x, held)) if name in WITH_PLACE else (lambda x: (x,))
        return np.array([chosen(*args(float(x))) for x in np.atleast_1d(u)]).T

    return values


def pieces(name):
    breaks = BREAKS.get(name, (0.0, 1.0))
    return [(a, b, (a + b) / 2) for a, b in pairwise(breaks)]


@pytest.mark.parametrize("name", NAMES)
def test_law__goes_from_zero_to_one(name):
    first, last = pieces(name)[0], pieces(name)[-1]
    assert law(name)(0.0, first[2])[0, 0] == 0.0
    assert law(name)(1.0, last[2])[0, 0] == pytest.approx(1.0, abs=2 * EPS)


@pytest.mark.parametrize("name", NAMES)
def test_derivatives__integrate_to_the_law(name):
    """Gauss's rule of 24 points integrates waves of at most half a turn a piece, four in all, to rounding."""
    x, w = np.polynomial.legendre.leggauss(24)
    for a, b, held in pieces(name):
        u = (a + b) / 2 + (b - a) / 2 * x
        values, ends = law(name)(u, held), law(name)(np.array([a, b]), held)
        for order in range(3):
            change = ends[order, 1] - ends[order, 0]
            size = np.abs(values[order + 1]).max() + np.abs(ends[order]).max()
            assert (b - a) / 2 * w @ values[order + 1] == pytest.approx(change, abs=64 * EPS * size)


@pytest.mark.parametrize("name", BREAKS)
def test_pieces__meet(name):
    """Displacement and velocity do in all laws; the acceleration of parabolas jumps."""
    orders = 2 if name == "parabolic" else 3
    for (_, b, before), (_, _, after) in pairwise(pieces(name)):
        left, right = law(name)(b, before)[:orders], law(name)(b, after)[:orders]
        np.testing.assert_allclose(left, right, rtol=0, atol=64 * EPS)


def test_least_height_for_curvature__is_the_greatest_root_of_its_polynomial():
    """Squared, R³ = ρ(R² + v s′ − y s″) has six roots; those of the equation itself have a positive right side."""
    rng, seen = np.random.default_rng(0), 0
    for _ in range(400):
        s, (s1, s2, offset) = rng.uniform(0, 0.03), rng.normal(size=3) * 10 ** rng.uniform([-3, -3, -2.5], [-1, 0, -2])
        radius, v = 10 ** rng.uniform(-3, -1.3), s1 - offset
        square, right = np.array([1.0, 0.0, v * v]), np.array([1.0, -s2, v * v + v * s1])
        cube = np.polymul(square, np.polymul(square, square))
        roots = np.roots(np.polysub(cube, radius**2 * np.polymul(right, right)))
        y = roots[np.abs(roots.imag) < 1e-9 * np.abs(roots)].real
        y = y[(np.polyval(right, y) > 0.0) & (y > s)]
        seen += y.size > 0
        expected = y.max() - s if y.size else 0.0
        found = least_height_for_curvature(s, s1, s2, offset, radius)
        # A double root has half the digits.
        assert found == pytest.approx(expected, abs=1e-6 * max(expected, radius))
    assert seen > 60
