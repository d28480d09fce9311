"""Exact arithmetic for references: mpmath numbers, roots of polynomials, and errors against them."""

import mpmath
import numpy as np
from mpmath import mpf

EPS = np.finfo(float).eps


def exactly(*values):
    return [mpf(value) for value in values]


def assert_within(got, expected, allowed):
    assert abs(mpf(got) - expected) <= mpf(float(allowed)), f"{got} is not {mpmath.nstr(expected, 20)} ± {allowed}"


def polynomial_roots(coefficients):
    """Real roots of a t² + b t + c; 120 digits leave enough where one is 10^40 times the other."""
    with mpmath.workdps(120):
        a, b, c = coefficients
        if a == 0:
            return [-c / b] if b else []
        square = b * b - 4 * a * c
        return [(-b + sign * mpmath.sqrt(square)) / (2 * a) for sign in (1, -1)] if square >= 0 else []
