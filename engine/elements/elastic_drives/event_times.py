"""When what ends a phase comes about: Newton's method between bounds that it can't leave."""

from engine.compiling.decorators import inlined

# Most steps: bisection alone would take no more than these.
MOST_TURNS = 80
_SETTLED = 4e-16


@inlined
def newton_between(
    time: float, over: float, slope: float, rises: bool, low: float, high: float
) -> tuple[float, float, float, bool]:
    """One step towards the zero of a function that has different signs at two bounds.

    Parameters
    ----------
    time : float
        Between the bounds.
    over, slope : float
        The function and its derivative there.
    rises : bool
        Whether the function is above 0 at the upper bound.
    low, high : float

    Returns
    -------
    time : float
        Nearer to the zero: Newton's step, or half-way between the bounds where that leaves them.
    low, high : float
        Nearer to each other.
    settled : bool
        Whether it can't be told any better.
    """
    if (over > 0.0) == rises:
        high = time
    else:
        low = time
    new = time - over / slope if slope != 0.0 else low
    if not low < new < high:
        new = 0.5 * (low + high)
    return new, low, high, abs(new - time) <= _SETTLED * new or high - low <= _SETTLED * high
