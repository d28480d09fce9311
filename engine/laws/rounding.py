"""Rounding of float64, and zeros found to rounding."""

from engine.compiling.decorators import scalar

# Machine epsilon: distance from 1 to the next float64.
EPS = 2.0**-52
# The smallest normal number.
LEAST_NORMAL = 2.0**-1022
# Relative perturbation by which sensitivity to rounding is measured: half of the digits remain for the change.
NUDGE = 2.0**-26
# Maximum steps towards a zero, at least as many as bisection needs, and relative width at which it is found.
MOST_TURNS, _CONVERGED = 80, 4e-16
# Of a reach: half a unit in the last place for each of four coordinates and two lengths, and for the operations.
_OF_REACH = 8.0 * EPS


@scalar
def left_over(square: float, scale: float) -> float:
    """Surplus of the links' reach, 0 at a dead centre; within rounding, where its sign is random, it counts as 0.

    Parameters
    ----------
    square, scale : float
        Product of the reach's two factors, and the magnitude of its terms [m², or its square].
    """
    rounding = _OF_REACH * scale
    return rounding - rounding if abs(square) < rounding else square


@scalar
def newton_between(
    x: float, over: float, slope: float, rises: bool, low: float, high: float
) -> tuple[float, float, float, bool]:
    """One step towards the zero of a function whose signs differ at two bounds.

    Parameters
    ----------
    x : float
        Between the bounds.
    over, slope : float
        The function and its derivative at x.
    rises : bool
        Whether the function is positive at the upper bound.
    low, high : float

    Returns
    -------
    x : float
        Newton's step, or the midpoint of the bounds if that leaves them.
    low, high : float
        The narrower bounds.
    settled : bool
        Whether x has converged to rounding.
    """
    if (over > 0.0) == rises:
        high = x
    else:
        low = x
    new = x - over / slope if slope != 0.0 else low
    if not low < new < high:
        new = 0.5 * (low + high)
    return new, low, high, abs(new - x) <= _CONVERGED * abs(new) or high - low <= _CONVERGED * abs(high)
