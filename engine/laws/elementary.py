"""Elementary functions made of arithmetic only: unlike those of the C library, they vectorise in a loop.

All work in float64, take scalars, have no branches, and are accurate to little more than one unit in the last place
(ulp). NaN gives NaN. They are compiled in strict order for all callers: reordering would simplify the computed rounding
remainders to zero. Called from Python, where a fused product and sum is rounded twice, they are
accurate to four ulp.

Sources: J.-M. Muller et al., Handbook of Floating-Point Arithmetic (error-free sums and products, argument
reduction); S. L. Moshier's Cephes library for the polynomials of `direction_of`. The other polynomials interpolate at
Chebyshev points, computed with 60 digits.
"""

import math

import numpy as np

from engine.compiling.decorators import in_order
from engine.compiling.instructions import bits_of, fused, number_of
from engine.laws.rounding import LEAST_NORMAL

# Added to a number below 2^51 in magnitude, it gives a sum whose last bits are the nearest integer.
_ROUNDER = 1.5 * 2.0**52
_ROUNDER_BITS = 0x4338000000000000
_SIGNIFICAND_BITS = 52
# Biased exponent of 1.
_EXPONENT_OF_ONE = 1023
# Significands for logarithms lie between √½ and √2.
_ROOT_HALF_BITS = 0x3FE6A09E667F3BCD
_NEAR_OVERFLOW = 2.0**1022

# Constants split into two parts. The first part of ln 2 is short enough for exact products with exponents.
_LN2, _LN2_REST = 0.6931471805598903, 5.497923018708371e-14
_HALF_PI, _HALF_PI_REST = 1.5707963267948966, 6.123233995736766e-17
_INVERSE_HALF_PI = 0.6366197723675814
_TWO_THIRDS, _TWO_THIRDS_REST = 0.6666666666666666, 3.700743415417188e-17
_INVERSE_LN2 = 1.4426950408889634

# Logarithms of the largest number, and of twice the smallest normal number.
_GREATEST_LOGARITHM, _LEAST_LOGARITHM = 709.782712893384, -707.7032713517042


@in_order
def _cubic(x: float, xx: float, c0: float, c1: float, c2: float, c3: float) -> float:
    """Cubic in x, lowest power first, given x²; grouping terms by four shortens the chain of dependent operations."""
    return fused(xx, fused(x, c3, c2), fused(x, c1, c0))


@in_order
def _logarithm_parts(x: float) -> tuple[float, float]:
    """Natural logarithm as a sum of two parts, accurate to 4e-20 relative; special values as in `logarithm`.

    With x = 2^k m, √½ ≤ m < √2, and s = (m − 1)/(m + 1): ln x = k ln 2 + 2 artanh s = k ln 2 + 2 s + s³ (2/3 + …).
    Terms up to s³ carry their rounding remainders.
    """
    bits = bits_of(x)
    exponent = (bits - _ROOT_HALF_BITS) >> _SIGNIFICAND_BITS
    k = number_of(exponent + _ROUNDER_BITS) - _ROUNDER
    m = number_of(bits - (exponent << _SIGNIFICAND_BITS))
    above, denominator = m - 1.0, m + 1.0
    denominator_rest = m - (denominator - 1.0)
    inverse = 1.0 / denominator
    s = above * inverse
    s_rest = fused(-s, denominator_rest, fused(-s, denominator, above)) * inverse
    twice = s + s
    z = s * s
    z_rest = fused(twice, s_rest, fused(s, s, -z))
    zz = z * z
    p = _cubic(z, zz, 0.4, 0.2857142857142937, 0.22222222221652765, 0.18181818336099848)
    q = _cubic(z, zz, 0.1538459488700718, 0.1333480879881234, 0.11706126464563398, 0.11724327060846747)
    p = z * fused(zz * zz, q, p)
    c = _TWO_THIRDS + p
    c_rest = (p - (c - _TWO_THIRDS)) + _TWO_THIRDS_REST
    cube = s * z
    cube_rest = fused(s_rest, z, fused(s, z_rest, fused(s, z, -cube)))
    t = cube * c
    t_rest = fused(cube_rest, c, fused(cube, c_rest, fused(cube, c, -t)))
    # In each sum the first term is the larger one, or zero.
    whole = k * _LN2
    first = whole + twice
    first_rest = twice - (first - whole)
    logarithm = first + t
    rest = t - (logarithm - first)
    rest += first_rest + fused(2.0, s_rest, fused(k, _LN2_REST, t_rest))
    logarithm = logarithm if x < math.inf else x
    logarithm = -math.inf if x < LEAST_NORMAL else logarithm
    return (math.nan if x < 0.0 else logarithm), rest


@in_order
def _exponential_of_sum(x: float, rest: float) -> float:
    """e^(x + rest), where the rest is a few roundings of x; see `exponential`."""
    rounded = fused(x, _INVERSE_LN2, _ROUNDER)
    k = rounded - _ROUNDER
    r = fused(-k, _LN2, x) + fused(-k, _LN2_REST, rest)
    rr = r * r
    r4 = rr * rr
    p = _cubic(r, rr, 0.5, 0.1666666666666667, 0.04166666666666667, 0.008333333333326136)
    q = _cubic(r, rr, 0.0013888888888883748, 0.00019841269874820627, 2.4801587325547743e-05, 2.7557255400206422e-06)
    q = fused(r4, fused(rr, 2.0914686968086876e-09, fused(r, 2.5105217004720745e-08, 2.75572736431103e-07)), q)
    power = 1.0 + fused(rr, fused(r4, q, p), r)
    # The largest power of two needed overflows, but half of it doesn't.
    scale = number_of((bits_of(rounded) + (_EXPONENT_OF_ONE - 1)) << _SIGNIFICAND_BITS)
    found = (power + power) * scale
    found = math.inf if x > _GREATEST_LOGARITHM else found
    return 0.0 if x < _LEAST_LOGARITHM else found


@in_order
def exponential(x: float) -> float:
    """Exponential function, e^x.

    Parameters
    ----------
    x : float

    Returns
    -------
    float
        To 1 ulp; 0 below 4.5e-308, twice the smallest normal number, and infinite above the largest number.

    Notes
    -----
    With k the integer nearest to x/ln 2 and r = x − k ln 2: e^x = 2^k (1 + r + r² q(r)).
    """
    return _exponential_of_sum(np.float64(x), 0.0)


@in_order
def logarithm(x: float) -> float:
    """Natural logarithm, ln x.

    Parameters
    ----------
    x : float
        A subnormal number counts as 0.

    Returns
    -------
    float
        To 0.51 ulp; −∞ for 0, ∞ for ∞, NaN for negative numbers.
    """
    whole, rest = _logarithm_parts(np.float64(x))
    return whole + rest


@in_order
def power(x: float, n: float) -> float:
    """Power of a nonnegative number, x^n = e^(n ln x).

    Parameters
    ----------
    x : float
        A subnormal number counts as 0.
    n : float
        Finite.

    Returns
    -------
    float
        To 1.5 ulp; 0 and infinite as in `exponential`. 0^n is 0 for n > 0 and infinite for n < 0, ∞^n the reverse; x^0
        is 1. NaN for negative x.
    """
    x, n = np.float64(x), np.float64(n)
    whole, rest = _logarithm_parts(x)
    # 0 · ∞ would be NaN.
    whole = 0.0 if (n == 0.0) & (x >= 0.0) else whole
    product = n * whole
    return _exponential_of_sum(product, fused(n, rest, fused(n, whole, -product)))


@in_order
def angle_of(x: float, y: float) -> float:
    """Angle of a vector from the x axis, counter-clockwise.

    Parameters
    ----------
    x, y : float
        Components; the length doesn't matter.

    Returns
    -------
    float
        [rad], −π < angle ≤ π, to 2 ulp; the sign of a zero is ignored. NaN for a vector without direction: zero, or
        infinite along both axes.

    Notes
    -----
    With t the ratio of the smaller to the larger component, or, where that exceeds ½, (t − 1)/(t + 1), which subtracts
    an eighth of a turn, the arctangent is t (1 + t² q(t²)).
    """
    x, y = np.float64(x), np.float64(y)
    along, across = abs(x), abs(y)
    steep = across > along
    small, large = (along if steep else across), (across if steep else along)
    # Near overflow the sum of both would be infinite.
    scale = 0.25 if large >= _NEAR_OVERFLOW else 1.0
    small, large = scale * small, scale * large
    turned = small > 0.5 * large
    t = (small - large if turned else small) / (small + large if turned else large)
    z = t * t
    zz = z * z
    z4 = zz * zz
    p = _cubic(z, zz, -0.3333333333333333, 0.19999999999999485, -0.1428571428559874, 0.11111111100881761)
    q = _cubic(z, zz, -0.09090908618865388, 0.07692294677482635, -0.06666435144143137, 0.05879573107799684)
    r = _cubic(z, zz, -0.052400641544110685, 0.04627870086418654, -0.03806224794996687, 0.024999689507521367)
    q = fused(z4, fused(z4, fused(z4, -0.009211063504627926, r), q), p)
    arctangent = fused(t * z, q, t)
    # In right angles: the angle from which the arctangent is measured, and its sense.
    start = 0.5 if turned else 0.0
    start = 1.0 - start if steep else start
    start = 2.0 - start if x < 0.0 else start
    backwards = steep != (x < 0.0)
    arctangent = -arctangent if backwards else arctangent
    found = fused(start, _HALF_PI, fused(start, _HALF_PI_REST, arctangent))
    return -found if y < 0.0 else found


@in_order
def angle_or_zero(x: float, y: float) -> float:
    """Angle of a vector as in `angle_of`; 0 for a zero vector, such as a vanishing force."""
    return angle_of(1.0 if (x == 0.0) & (y == 0.0) else x, y)


@in_order
def direction_near_zero(r: float) -> tuple[float, float]:
    """Cosine and sine of an angle of at most π/4 in magnitude [rad], to about 1 ulp."""
    z = r * r
    p = fused(z, 1.58962301576546568060e-10, -2.50507477628578072866e-8)
    p = fused(z, p, 2.75573136213857245213e-6)
    p = fused(z, p, -1.98412698295895385996e-4)
    p = fused(z, p, 8.33333333332211858878e-3)
    p = fused(z, p, -1.66666666666666307295e-1)
    sine = fused(r * z, p, r)
    p = fused(z, -1.13585365213876817300e-11, 2.08757008419747316778e-9)
    p = fused(z, p, -2.75573141792967388112e-7)
    p = fused(z, p, 2.48015872888517045348e-5)
    p = fused(z, p, -1.38888888888730564116e-3)
    p = fused(z, p, 4.16666666666665929218e-2)
    return fused(z * z, p, fused(z, -0.5, 1.0)), sine


@in_order
def direction_of(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle.

    Parameters
    ----------
    angle : float
        [rad], below 1e14 in magnitude.

    Returns
    -------
    cosine, sine : float
        To 2e-16 plus 4e-17 of the angle.

    Notes
    -----
    The angle is reduced to the nearest multiple of a right angle; the polynomials hold up to 45 degrees. A right angle
    is π/2 as rounded, so that a cycle of whole turns, each 2π as rounded, ends exactly where it began.
    """
    angle = np.float64(angle)
    rounded = fused(angle, _INVERSE_HALF_PI, _ROUNDER)
    quarters = rounded - _ROUNDER
    cosine, sine = direction_near_zero(fused(-quarters, _HALF_PI, angle))
    # The last two bits are the number of right angles, modulo 4.
    turns = bits_of(rounded)
    odd = turns & 1 != 0
    c, s = (sine if odd else cosine), (cosine if odd else sine)
    return (-c if (turns + 1) & 2 != 0 else c), (-s if turns & 2 != 0 else s)
