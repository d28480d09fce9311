"""Mass of governors' arms: against integrals along the rod, by quadrature with many digits."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.laws.governors.arms import arm_inertia, arm_moving_inertia

EPS = np.finfo(float).eps
number = st.floats(-2.0, 2.0).map(lambda x: round(x, 6))


@settings(deadline=None, max_examples=50)
@given(st.floats(0.01, 100.0), st.lists(number, min_size=6, max_size=6))
def test_rods__are_the_integrals_along_them(mass, numbers):
    """Ends are a + a' x + ½ a'' x², and so are all points between."""
    a, a1, a2, b, b1, b2 = (mp.mpf(n) for n in numbers)

    def radius(t, x):
        return (1 - t) * (a + a1 * x + a2 * x * x / 2) + t * (b + b1 * x + b2 * x * x / 2)

    def along(what):
        return mass * mp.quad(what, [0, 1])

    with mp.workdps(30):
        inertia = [mp.diff(lambda x: along(lambda t: radius(t, x) ** 2), 0, n) for n in range(3)]
        moving = [
            mp.diff(lambda x: along(lambda t: ((1 - t) * (a1 + a2 * x) + t * (b1 + b2 * x)) ** 2), 0, n)
            for n in range(2)
        ]
    # Products of numbers up to 2 in a dozen terms.
    slack = 64 * EPS * mass * 24
    assert arm_inertia(mass, *numbers) == pytest.approx([float(v) for v in inertia], abs=slack, rel=0)
    assert arm_moving_inertia(mass, *numbers[1:3], *numbers[4:]) == pytest.approx(
        [float(v) for v in moving], abs=slack, rel=0
    )
