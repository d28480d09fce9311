"""Values with error estimates, real or complex.

The error estimate of a result follows from those of its operands to first order, plus the rounding of the operation.
Contributions are added by magnitude, because they may have a common cause. Where the first order fails, at zeros of
square roots and of divisors, the estimate is the change that the operands' errors can cause.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np

from engine.laws.rounding import EPS, LEAST_NORMAL

# Rounding units of a complex product or quotient.
_COMPLEX_ROUNDING = 4.0
# A smaller number that was computed from squares is unknown, since its square is subnormal.
UNKNOWN_ROOT = LEAST_NORMAL**0.5


class Measured:
    """Values with error estimates, element by element.

    Parameters
    ----------
    value : array_like
        Real or complex.
    error : array_like
        Error estimate, at least 0; meaningless where the value is NaN.
    """

    __slots__ = ("error", "value")
    __array_ufunc__ = None

    def __init__(self, value: object, error: object = 0.0) -> None:
        value = np.asarray(value)
        self.value = value.astype(complex if value.dtype.kind == "c" else float, copy=False)
        error = np.asarray(error, dtype=float)
        self.error = error if error.shape == self.value.shape else np.broadcast_to(error, self.value.shape)

    def __repr__(self) -> str:
        return f"Measured({self.value!r}, {self.error!r})"

    def __getitem__(self, index: object) -> Measured:
        return self._of(self.value[index], self.error[index])

    @classmethod
    def _of(cls, value: np.ndarray, error: np.ndarray) -> Measured:
        """Floating-point values and error estimates of one shape."""
        found = cls.__new__(cls)
        found.value, found.error = np.asarray(value), np.asarray(error)
        return found

    @classmethod
    def _rounded(cls, value: np.ndarray, error: np.ndarray) -> Measured:
        """Result of an operation, with its rounding."""
        units = _COMPLEX_ROUNDING if value.dtype.kind == "c" else 1.0
        return cls._of(value, error + units * EPS * np.abs(value))

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the values."""
        return self.value.shape

    def reshape(self, *shape: int) -> Measured:
        """The same values in another shape."""
        return Measured(self.value.reshape(shape), self.error.reshape(shape))

    @property
    def real(self) -> Measured:
        """The real part."""
        return Measured(self.value.real, self.error)

    def sum(self) -> Measured:
        """Sum over the first axis."""
        rounded = EPS * np.abs(self.value).sum(axis=0)
        return Measured(self.value.sum(axis=0), self.error.sum(axis=0) + rounded)

    def __neg__(self) -> Measured:
        return self._of(-self.value, self.error)

    def __abs__(self) -> Measured:
        return self._of(np.abs(self.value), self.error)

    def __add__(self, other: object) -> Measured:
        other = measured(other)
        return self._rounded(self.value + other.value, self.error + other.error)

    def __sub__(self, other: object) -> Measured:
        return self + -measured(other)

    def __mul__(self, other: object) -> Measured:
        if isinstance(other, float):
            return self._rounded(self.value * other, self.error * abs(other))
        other = measured(other)
        error = np.abs(self.value) * other.error + (np.abs(other.value) + other.error) * self.error
        return self._rounded(self.value * other.value, error)

    def __truediv__(self, other: object) -> Measured:
        other = measured(other)
        with np.errstate(divide="ignore", invalid="ignore"):
            value = self.value / other.value
            # The smallest divisor within the error; the estimate is infinite where that is 0.
            least = np.abs(other.value) - other.error
            error = (self.error + np.abs(value) * other.error) / np.where(least > 0.0, least, 0.0)
            exact = (self.error == 0.0) & (other.error == 0.0)
            return self._rounded(value, np.where(exact, 0.0, error))

    def __pow__(self, exponent: float) -> Measured:
        with np.errstate(divide="ignore", invalid="ignore"):
            value = self.value**exponent
            slope = exponent * self.value ** (exponent - 1.0)
            error = np.where(self.error == 0.0, 0.0, np.abs(slope) * self.error)
            return self._rounded(value, error)

    __radd__ = __add__
    __rmul__ = __mul__

    def __rsub__(self, other: object) -> Measured:
        return measured(other) - self

    def __rtruediv__(self, other: object) -> Measured:
        return measured(other) / self


def stacked(parts: Sequence[Measured]) -> Measured:
    """Values of one shape along a new first axis."""
    return Measured(np.stack([x.value for x in parts]), np.stack([x.error for x in parts]))


def measured(value: object) -> Measured:
    """Return a value as `Measured`; plain numbers are exact."""
    return value if isinstance(value, Measured) else Measured(value)


def propagated(value: np.ndarray, *operands: tuple[np.ndarray, Measured]) -> Measured:
    """A value with its operands' errors propagated by partial derivatives, for operands that occur more than once.

    Parameters
    ----------
    value : ndarray
    operands : tuple of (ndarray, Measured)
        The derivative with respect to an operand, and the operand.
    """
    return Measured._rounded(value, sum(np.abs(slope) * x.error for slope, x in operands))


def sqrt(x: Measured) -> Measured:
    """Square root. If x is 0 within its error, the estimate is the square root of the largest possible x."""
    with np.errstate(divide="ignore", invalid="ignore"):
        value = np.sqrt(np.where((x.value < 0.0) & (x.value >= -x.error), 0.0, x.value))
        first_order = 0.5 * x.error / value
    error = np.where(x.error > x.value, np.sqrt(np.abs(x.value) + x.error), first_order)
    return of_squares(Measured._rounded(value, np.where(x.error == 0.0, 0.0, error)))


def of_squares(x: Measured) -> Measured:
    """Add the underflow of squares to the error estimate of a number computed from them."""
    return Measured(x.value, np.where(np.abs(x.value) < UNKNOWN_ROOT, np.maximum(x.error, UNKNOWN_ROOT), x.error))


def atan2(y: Measured, x: Measured) -> Measured:
    """Angle of the direction (x, y) [rad], above −π by more than its error; the estimate is π if it is undefined."""
    y, x = measured(y), measured(x)
    with np.errstate(divide="ignore", invalid="ignore"):
        square = x.value**2 + y.value**2
        error = (np.abs(x.value) * y.error + np.abs(y.value) * x.error) / square
    error = np.where((x.error == 0.0) & (y.error == 0.0), 0.0, np.fmin(error, np.pi))
    found = Measured._rounded(np.arctan2(y.value, x.value), error)
    return Measured(found.value + np.where(found.value <= found.error - np.pi, math.tau, 0.0), found.error)


def _chosen(first: Measured, second: Measured, better: Callable) -> Measured:
    first, second = measured(first), measured(second)
    value = better(first.value, second.value)
    is_first = value == first.value
    own, other = np.where(is_first, first.error, second.error), np.where(is_first, second.error, first.error)
    # The other operand may still be the larger, or the smaller, one within its error.
    return Measured(value, np.maximum(own, other - np.abs(first.value - second.value)))


def maximum(first: Measured, second: Measured) -> Measured:
    """The larger of two values; NaN if either is NaN."""
    return _chosen(first, second, np.maximum)


def minimum(first: Measured, second: Measured) -> Measured:
    """The smaller of two values; NaN if either is NaN."""
    return _chosen(first, second, np.minimum)


def where(condition: np.ndarray, first: Measured, second: Measured) -> Measured:
    """The first value where a condition holds, else the second."""
    first, second = measured(first), measured(second)
    return Measured(np.where(condition, first.value, second.value), np.where(condition, first.error, second.error))
