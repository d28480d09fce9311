"""Truncated Taylor series by the crank angle: derivatives of closed formulas to any order, in any arithmetic.

A series holds the coefficients f, f', f''/2!, … at many crank angles at once, as NumPy arrays of extended precision
(80 bits, 19 digits) or of mpmath's numbers with as many digits as are set. None of it is the engine's: it is the
arithmetic of the references.
"""

from collections.abc import Callable
from typing import NamedTuple

import mpmath
import numpy as np

PI = "3.14159265358979323846264338327950288419716939937510582097494"


class Arithmetic(NamedTuple):
    """Numbers and functions of one kind of arithmetic."""

    number: Callable
    sqrt: Callable
    sin: Callable
    cos: Callable
    power: Callable

    @property
    def pi(self) -> object:
        """π, to all digits that the arithmetic has."""
        return self.number(PI)


EXTENDED = Arithmetic(np.longdouble, np.sqrt, np.sin, np.cos, np.power)
MANY_DIGITS = Arithmetic(
    mpmath.mpf,
    *(np.frompyfunc(f, n, 1) for f, n in ((mpmath.sqrt, 1), (mpmath.sin, 1), (mpmath.cos, 1), (mpmath.power, 2))),
)


class Series:
    """Coefficients of a truncated Taylor series, lowest order first; operations keep the lesser order of two."""

    __array_ufunc__ = None

    def __init__(self, terms: list, arithmetic: Arithmetic) -> None:
        self.terms, self.arithmetic = terms, arithmetic

    def __getitem__(self, k: int) -> np.ndarray:
        return self.terms[k]

    def _with(self, terms: list) -> "Series":
        return Series(terms, self.arithmetic)

    def __add__(self, other: object) -> "Series":
        if isinstance(other, Series):
            return self._with([a + b for a, b in zip(self.terms, other.terms, strict=False)])
        return self._with([self.terms[0] + other, *self.terms[1:]])

    def __mul__(self, other: object) -> "Series":
        if not isinstance(other, Series):
            return self._with([a * other for a in self.terms])
        a, b = self.terms, other.terms
        return self._with([sum(a[i] * b[k - i] for i in range(k + 1)) for k in range(min(len(a), len(b)))])

    def __neg__(self) -> "Series":
        return self._with([-a for a in self.terms])

    def __sub__(self, other: object) -> "Series":
        return self + (-other)

    def __rsub__(self, other: object) -> "Series":
        return -self + other

    def __truediv__(self, other: object) -> "Series":
        if not isinstance(other, Series):
            return self._with([a / other for a in self.terms])
        found, b = [], other.terms
        for k in range(min(len(self.terms), len(b))):
            found.append((self.terms[k] - sum(found[i] * b[k - i] for i in range(k))) / b[0])
        return self._with(found)

    def __rtruediv__(self, other: object) -> "Series":
        return self._with([0 * a + (other if k == 0 else 0) for k, a in enumerate(self.terms)]) / self

    __radd__, __rmul__ = __add__, __mul__

    def sqrt(self) -> "Series":
        """Square root."""
        found = [self.arithmetic.sqrt(self.terms[0])]
        for k in range(1, len(self.terms)):
            rest = sum(found[i] * found[k - i] for i in range(1, k))
            found.append((self.terms[k] - rest) / (found[0] + found[0]))
        return self._with(found)

    def power(self, exponent: float) -> "Series":
        """Power with any exponent, of a positive series: k a₀ fₖ = Σ (i (p + 1) − k) aᵢ fₖ₋ᵢ."""
        a, p = self.terms, self.arithmetic.number(exponent)
        found = [self.arithmetic.power(a[0], p)]
        for k in range(1, len(a)):
            found.append(sum((i * (p + 1) - k) * a[i] * found[k - i] for i in range(1, k + 1)) / (k * a[0]))
        return self._with(found)

    def by_angle(self) -> "Series":
        """Derivative by the crank angle, one order shorter."""
        return self._with([k * a for k, a in enumerate(self.terms)][1:])


def crank(angles: np.ndarray, order: int, arithmetic: Arithmetic) -> tuple[Series, Series]:
    """Cosine and sine of the crank angle."""
    c, s = arithmetic.cos(angles), arithmetic.sin(angles)
    cosine, sine, factor = [], [], 1
    for k in range(order + 1):
        factor *= max(k, 1)
        cosine.append((c, -s, -c, s)[k % 4] / factor)
        sine.append((s, c, -s, -c)[k % 4] / factor)
    return Series(cosine, arithmetic), Series(sine, arithmetic)
