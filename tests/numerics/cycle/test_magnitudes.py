"""Means of magnitudes that dip sharply, against complete elliptic integrals."""

import math

import numpy as np
import pytest
import scipy.special as sp
from cycle_machines import smooth_numbers, squares

TURN = 2.0 * math.pi


@pytest.mark.parametrize("tolerance", [1e-5, 1e-8, 1e-9])
def test_mean_of_a_magnitude_with_sharp_dips__is_covered_and_takes_no_panels_for_them(tolerance):
    rng = np.random.default_rng(2)
    least = np.append(10.0 ** rng.uniform(-12.0, 0.0, 1000), 0.0)
    numbers = smooth_numbers(least, rng.uniform(0.0, TURN, least.size))
    found = squares(roots=(0,), rooted=(0,), tolerance=tolerance).evaluate(numbers)
    # ∫ √(cos² x + b² sin² x) dx over a turn is 4 E(1 − b²).
    off = np.abs(found.roots.value[0] - 4.0 * sp.ellipe(1.0 - least**2))
    assert np.mean(off <= found.roots.error[0] + 1e-15) > 0.999
    assert off.max() < 1e-6
    # Of the sharpest dips little is known; of most as much as is asked.
    assert found.roots.error[0].max() < 1e-2
    assert np.median(found.roots.error[0]) < 10.0 * tolerance
    smooth = squares(integrals=(0,), extremes=(0,), tolerance=tolerance).evaluate(numbers)
    assert found.panels.max() <= 3 * smooth.panels.max()
