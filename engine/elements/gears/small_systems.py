"""Small linear systems for many variants at once, with bounds on their errors.

The error of a solution x of A x = b is A⁻¹ (b − A x); the residual is computed to within (n + 1) ε (|A| |x| + |b|). For
a train with a basic ratio near 1, equations are nearly dependent and the bound grows with A⁻¹.

Source: N. J. Higham, Accuracy and Stability of Numerical Algorithms, ch. 7 (componentwise forward bounds).
"""

import numpy as np

from engine.cycle.measured import Measured
from engine.laws.rounding import EPS

# Systems with a greater condition number count as singular.
_GREATEST_CONDITION = 2.0**40


def solve(matrix: np.ndarray, right: np.ndarray) -> tuple[Measured, np.ndarray]:
    """Solve systems with exact coefficients.

    Parameters
    ----------
    matrix : ndarray (unknowns, unknowns, variants)
    right : ndarray (unknowns, right sides, variants)

    Returns
    -------
    solutions : Measured (unknowns, right sides, variants)
        NaN for singular systems.
    inverse : ndarray (unknowns, equations, variants)
        Magnitudes of the inverse.
    """
    a, b = np.moveaxis(matrix, -1, 0), np.moveaxis(right, -1, 0)
    # With rows of equal size, the condition number measures how nearly the equations are dependent.
    scale = np.abs(a).max(axis=2, keepdims=True, initial=0.0)
    usable = (np.isfinite(scale) & (scale > 0.0)).all(axis=(1, 2))
    even = _where(usable, a / _where(usable, scale, 1.0), np.eye(a.shape[1]))
    usable &= np.linalg.cond(even) < _GREATEST_CONDITION
    inverse = np.linalg.inv(_where(usable, even, np.eye(a.shape[1])))
    inverse = _where(usable, inverse / np.swapaxes(_where(usable, scale, 1.0), 1, 2), np.nan)
    with np.errstate(invalid="ignore", over="ignore"):
        found = inverse @ b
        found = found + inverse @ (b - a @ found)
        sizes = np.abs(a) @ np.abs(found) + np.abs(b)
        errors = np.abs(inverse) @ (np.abs(b - a @ found) + (a.shape[1] + 2) * EPS * sizes)
    found, errors, inverse = (np.moveaxis(part, 0, -1) for part in (found, errors, np.abs(inverse)))
    return Measured(found, errors), inverse


def _where(variants: np.ndarray, matrices: np.ndarray, others: np.ndarray | float) -> np.ndarray:
    return np.where(variants[:, None, None], matrices, others)
