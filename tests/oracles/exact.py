"""Exact arithmetic for references: mpmath numbers, and errors against them."""

import mpmath
import numpy as np
from mpmath import mpf

EPS = np.finfo(float).eps


def exactly(*values):
    return [mpf(value) for value in values]


def assert_within(got, expected, allowed):
    assert abs(mpf(got) - expected) <= mpf(float(allowed)), f"{got} is not {mpmath.nstr(expected, 20)} ± {allowed}"
