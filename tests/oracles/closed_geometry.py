"""References for the dyads at 50 digits: closed geometry in complex numbers."""

import mpmath
from hypothesis import strategies as st
from mpmath import mpc, mpf

EPS = 2.0**-53

coordinate = st.floats(-4.0, 4.0)
angle = st.floats(-3.2, 3.2)
mode = st.sampled_from([1.0, -1.0])
exponent = st.floats(-6.0, 6.0)


def unit(a):
    return mpmath.expj(a)


def dot(a, b):
    return (mpmath.conj(a) * b).real


def cross(a, b):
    return (mpmath.conj(a) * b).imag


def vector(x, y):
    return mpc(mpf(x), mpf(y))


def parts(*vectors):
    """Components of complex vectors, rounded to float64."""
    return tuple(float(c) for v in vectors for c in (v.real, v.imag))


def near(value, reference, tolerance):
    told = value, mpmath.nstr(reference, 20), mpmath.nstr(tolerance, 3)
    assert abs(mpf(value) - reference) <= tolerance, told


def rrr_angles(a, d, r1, r2, sign):
    """Angles of A → B and D → B by the law of cosines."""
    base = d - a
    at_a = mpmath.acos((r1**2 + abs(base) ** 2 - r2**2) / (2 * r1 * abs(base)))
    first = mpmath.arg(base) + sign * at_a
    return first, mpmath.arg(a + r1 * unit(first) - d)


def rrp_angle(a, g, guide, r, offset, sign):
    """Angle of the rod: its height over the guide's parallel gives the arcsine."""
    height = offset - cross(unit(guide), a - g)
    tilt = mpmath.asin(height / r)
    return guide + (tilt if sign > 0 else mpmath.pi - tilt)


def rpr_angle(a, d, offset, sign):
    """Angle of the slot, seen from the pivot: the block's bearing less that of its place in the slot's axes."""
    along = sign * mpmath.cos(mpmath.asin(offset / abs(a - d))) * abs(a - d)
    return mpmath.arg(a - d) - mpmath.arg(mpc(along, offset))
