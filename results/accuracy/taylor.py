"""Truncated Taylor series by the crank angle: derivatives of closed formulas to any order, in extended precision.

A series has the coefficients f, f', f''/2!, … at many crank angles at once, as NumPy arrays. It is the arithmetic of
the references, independent of the engine.
"""

import numpy as np

# Extended precision: 80 bits, 19 digits.
LONG = np.longdouble
PI = LONG("3.14159265358979323846264338327950288419716939937510582097494")


class Series:
    """Coefficients of a truncated Taylor series, lowest order first; operations keep the lower order of two."""

    __array_ufunc__ = None

    def __init__(self, terms: list) -> None:
        self.terms = terms

    def __getitem__(self, k: int) -> np.ndarray:
        return self.terms[k]

    def __add__(self, other: object) -> "Series":
        if isinstance(other, Series):
            return Series([a + b for a, b in zip(self.terms, other.terms, strict=False)])
        return Series([self.terms[0] + other, *self.terms[1:]])

    def __mul__(self, other: object) -> "Series":
        if not isinstance(other, Series):
            return Series([a * other for a in self.terms])
        a, b = self.terms, other.terms
        return Series([sum(a[i] * b[k - i] for i in range(k + 1)) for k in range(min(len(a), len(b)))])

    def __neg__(self) -> "Series":
        return Series([-a for a in self.terms])

    def __sub__(self, other: object) -> "Series":
        return self + (-other)

    def __rsub__(self, other: object) -> "Series":
        return -self + other

    def __truediv__(self, other: object) -> "Series":
        if not isinstance(other, Series):
            return Series([a / other for a in self.terms])
        found, b = [], other.terms
        for k in range(min(len(self.terms), len(b))):
            found.append((self.terms[k] - sum(found[i] * b[k - i] for i in range(k))) / b[0])
        return Series(found)

    def __rtruediv__(self, other: object) -> "Series":
        return Series([0 * a + (other if k == 0 else 0) for k, a in enumerate(self.terms)]) / self

    __radd__, __rmul__ = __add__, __mul__

    def sqrt(self) -> "Series":
        """Square root."""
        found = [np.sqrt(self.terms[0])]
        for k in range(1, len(self.terms)):
            rest = sum(found[i] * found[k - i] for i in range(1, k))
            found.append((self.terms[k] - rest) / (found[0] + found[0]))
        return Series(found)

    def power(self, exponent: float) -> "Series":
        """Power with any exponent, of a positive series: k a₀ fₖ = Σ (i (p + 1) − k) aᵢ fₖ₋ᵢ."""
        a, p = self.terms, LONG(exponent)
        found = [np.power(a[0], p)]
        for k in range(1, len(a)):
            found.append(sum((i * (p + 1) - k) * a[i] * found[k - i] for i in range(1, k + 1)) / (k * a[0]))
        return Series(found)

    def by_angle(self) -> "Series":
        """Derivative by the crank angle, one order shorter."""
        return Series([k * a for k, a in enumerate(self.terms)][1:])


def crank(angles: np.ndarray, order: int) -> tuple[Series, Series]:
    """Cosine and sine of the crank angle."""
    c, s = np.cos(angles), np.sin(angles)
    cosine, sine, factor = [], [], 1
    for k in range(order + 1):
        factor *= max(k, 1)
        cosine.append((c, -s, -c, s)[k % 4] / factor)
        sine.append((s, c, -s, -c)[k % 4] / factor)
    return Series(cosine), Series(sine)
