"""Curves known at nodes, smooth from one jump to the next: their integral, and what may lie between the nodes.

At a jump there is a node on either side, and the step between them is next to nothing. Nodes needn't be equally
spaced. What a curve does within a step is judged by its neighbours on the same side of all jumps: each function takes
`values` at the nodes, and the `steps` between them, one fewer.
"""

import math

import numpy as np

from engine.compiling.decorators import scalar
from engine.motion.moments.grid import GAP

# A bend within a step beside a jump, where the slope grows by D at a share t of it from the step before: the integral
# is off by D(1 − t)(t/2 − 1/8)h² at most, and the step before it shows D(1 − t)/4 of it, a quarter of which is taken
# there already.
BESIDE = 1.25


@scalar
def slope_of(values: np.ndarray, steps: np.ndarray, k: int) -> float:
    """Slope at node k of the parabola through it and two neighbours on the same side of all jumps; 0 without them."""
    last = steps.shape[0]
    before, after = k > 0 and steps[k - 1] > GAP, k < last and steps[k] > GAP
    if before and after:
        h, j = steps[k - 1], steps[k]
        return ((values[k + 1] - values[k]) * h / j + (values[k] - values[k - 1]) * j / h) / (h + j)
    if after and k + 1 < last and steps[k + 1] > GAP:
        h, j = steps[k], steps[k + 1]
        near, far = (values[k + 1] - values[k]) / h, (values[k + 2] - values[k + 1]) / j
        return near + (near - far) * h / (h + j)
    if before and k > 1 and steps[k - 2] > GAP:
        h, j = steps[k - 1], steps[k - 2]
        near, far = (values[k] - values[k - 1]) / h, (values[k - 1] - values[k - 2]) / j
        return near + (near - far) * h / (h + j)
    if after or before:
        i = k if after else k - 1
        return (values[i + 1] - values[i]) / steps[i]
    return 0.0


@scalar
def extremes(values: np.ndarray) -> tuple[float, float, float, float]:
    """Least value and its first node, greatest value and its first node; NaN where any value isn't finite."""
    low = high = values[0]
    low_at = high_at = 0
    for k in range(values.shape[0]):
        value = values[k]
        if not abs(value) < math.inf:
            return math.nan, math.nan, math.nan, math.nan
        if value < low:
            low, low_at = value, k
        if value > high:
            high, high_at = value, k
    return low, float(low_at), high, float(high_at)


@scalar
def joins(steps: np.ndarray, k: int) -> bool:
    """Whether there is a step k, and no jump."""
    return 0 <= k < steps.shape[0] and steps[k] > GAP


@scalar
def integral(values: np.ndarray, steps: np.ndarray) -> tuple[float, float]:
    """Integral by cubics with the slopes at both ends of each step, and what bends may hide of it.

    Of order four where the curve is smooth. A bend within a step shows as a chord that isn't the mean of the slopes at
    its ends. Beside a jump, where a parabola of one side alone gives the slope, it shows in the next step instead.
    """
    total = hidden = before = 0.0
    near = slope_of(values, steps, 0)
    for k in range(steps.shape[0]):
        h, far = steps[k], slope_of(values, steps, k + 1)
        total += 0.5 * h * (values[k] + values[k + 1])
        if h > GAP:
            total += h * h / 12.0 * (near - far)
            bend = bend_within(values, h, near, far, k)
            hidden += 0.25 * h * h * bend
            if joins(steps, k - 1):
                if not joins(steps, k + 1):
                    hidden += BESIDE * h * h * before
                if not joins(steps, k - 2):
                    hidden += BESIDE * steps[k - 1] * steps[k - 1] * bend
            before = bend
        near = far
    return total, hidden


@scalar
def bend_within(values: np.ndarray, h: float, near: float, far: float, k: int) -> float:
    """How far the chord from node k to the next differs from the mean of the slopes at both."""
    return abs((values[k + 1] - values[k]) / h - 0.5 * (near + far))


@scalar
def rise_towards(values: np.ndarray, steps: np.ndarray, k: int, side: int, otherwise: float) -> float:
    """How steeply a curve rises towards node k from a side (−1: from before it): as over the last step, or as it grew.

    `otherwise` where a jump or the end of the nodes is on that side.
    """
    i, j = (k - 1, k - 2) if side < 0 else (k, k + 1)
    if i < 0 or i >= steps.shape[0] or steps[i] <= GAP:
        return otherwise
    rise = (values[k] - values[k + side]) / steps[i]
    if j < 0 or j >= steps.shape[0] or steps[j] <= GAP:
        return rise
    return max(rise, rise + rise - (values[k + side] - values[k + 2 * side]) / steps[j])


@scalar
def bound(values: np.ndarray, steps: np.ndarray) -> float:
    """Greatest value that a curve may come to between its nodes.

    Within a step it goes on as before it, and comes from what follows it: no farther than where those two straight
    lines meet, even if it bends there. Beside a jump only one of them is known.
    """
    best = values[0]
    for k in range(steps.shape[0]):
        h, a, b = steps[k], values[k], values[k + 1]
        best = max(best, b)
        if h > GAP:
            near, far = slope_of(values, steps, k), slope_of(values, steps, k + 1)
            left, right = rise_towards(values, steps, k, -1, near), rise_towards(values, steps, k + 1, 1, -far)
            best = max(best, max(a, b) + h * bend_within(values, h, near, far, k))
            if not joins(steps, k + 1):
                best = max(best, a + max(left, 0.0) * h)
            elif not joins(steps, k - 1):
                best = max(best, b + max(right, 0.0) * h)
            elif left > 0.0 and right > 0.0:
                best = max(best, a + left * min(max((b - a + right * h) / (left + right), 0.0), h))
    return best
