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
# Polynomials beside a greatest value go through so many nodes, and are halved so often between two of them.
LEAST_NODES, MOST_NODES, HALVINGS = 5, 8, 26
# A curve is smooth where its value by more nodes changes by no more than such a share of what it did before, or where
# it changes by rounding, as a share of its range.
DRAWN_TOGETHER, ROUNDED = 0.1, 1e-14
# Near a bend values may draw together by chance. Of a smooth curve they differ by no more than such a share of its fall
# to the neighbours: 0.047 h² of a sine, with h of its radians between nodes.
WELL_WITHIN = 0.004


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
def bound(values: np.ndarray, steps: np.ndarray, k: int) -> float:
    """Greatest value that a curve may come to from node k to the next.

    It goes on as before the step, and comes from what follows it: no farther than where those two straight lines meet,
    even if it bends there. Beside a jump only one of them is known.
    """
    h, a, b = steps[k], values[k], values[k + 1]
    best = max(a, b)
    if h <= GAP:
        return best
    near, far = slope_of(values, steps, k), slope_of(values, steps, k + 1)
    left, right = rise_towards(values, steps, k, -1, near), rise_towards(values, steps, k + 1, 1, -far)
    best += h * bend_within(values, h, near, far, k)
    if not joins(steps, k + 1):
        return max(best, a + max(left, 0.0) * h)
    if not joins(steps, k - 1):
        return max(best, b + max(right, 0.0) * h)
    if left > 0.0 and right > 0.0:
        return max(best, a + left * min(max((b - a + right * h) / (left + right), 0.0), h))
    return best


@scalar
def crest(
    values: np.ndarray, places: np.ndarray, first: int, last: int, k: int, room: np.ndarray, sign: float
) -> float:
    """Greatest value beside node k of the polynomial through nodes first … last − 1; NaN where it has none within.

    By divided differences, for which there is `room`, and bisection of its slope; of squares with a sign, their root.
    """
    for i in range(first, last):
        room[i - first] = values[i]
    for order in range(1, last - first):
        for i in range(last - 1, first + order - 1, -1):
            room[i - first] = (room[i - first] - room[i - first - 1]) / (places[i] - places[i - order])
    low, high = places[max(k - 1, first)], places[min(k + 1, last - 1)]
    value = math.nan
    for halving in range(HALVINGS + 2):
        # The ends first: between them it is to rise and fall.
        x = (low, high)[halving] if halving < 2 else 0.5 * (low + high)
        value, slope = room[last - first - 1], 0.0
        for i in range(last - first - 2, -1, -1):
            slope = slope * (x - places[first + i]) + value
            value = value * (x - places[first + i]) + room[i]
        if halving < 2:
            if not (slope > 0.0 if halving == 0 else slope < 0.0):
                return math.nan
        elif slope > 0.0:
            low = x
        else:
            high = x
    return sign * math.sqrt(max(sign * value, 0.0)) if sign != 0.0 else value


@scalar
def peak_between(values: np.ndarray, steps: np.ndarray) -> tuple[float, float, float]:
    """Greatest value of a curve between its nodes, too; the node next to it; what it may come to at most.

    Beside each node that lies above its neighbours, by polynomials of three degrees through those about it: where their
    values draw together, they tell what the best of them is off by. Where they don't, the curve bends, and is known at
    its nodes alone. The square of a curve of one sign is followed instead: that of a magnitude is smooth where it dips.
    """
    count, total, lowest, highest = values.shape[0], 0.0, math.inf, -math.inf
    places, followed, room = np.empty(count), np.empty(count), np.empty(MOST_NODES)
    for k in range(count):
        if not abs(values[k]) < math.inf:
            return math.nan, math.nan, math.nan
        places[k] = total
        total += steps[k] if k + 1 < count else 0.0
        lowest, highest = min(lowest, values[k]), max(highest, values[k])
    sign = 1.0 if lowest >= 0.0 else (-1.0 if highest <= 0.0 else 0.0)
    for k in range(count):
        followed[k] = values[k] * abs(values[k]) if sign != 0.0 else values[k]
    best, node, most, first = -math.inf, 0, -math.inf, 0
    for k in range(count):
        before, after = joins(steps, k - 1), joins(steps, k)
        first = first if before else k
        if (before and values[k - 1] > values[k]) or (after and values[k + 1] > values[k]):
            continue
        top = limit = values[k]
        if before:
            limit = bound(values, steps, k - 1)
        if after:
            limit = max(limit, bound(values, steps, k))
        if limit <= best:
            continue
        last = k + 1
        while last - k < MOST_NODES and joins(steps, last - 1):
            last += 1
        nodes = min(last - first, MOST_NODES)
        if nodes >= LEAST_NODES:
            # Those about it in the middle of all nodes, towards either end of them, and fewest.
            begin, fewer = max(first, min(k - (nodes - 1) // 2, last - nodes)), 2 if nodes > LEAST_NODES + 1 else 1
            found = crest(followed, places, begin, begin + nodes, k, room, sign)
            left = crest(followed, places, begin, begin + nodes - fewer, k, room, sign)
            right = crest(followed, places, begin + fewer, begin + nodes, k, room, sign)
            few = crest(followed, places, begin + fewer, begin + nodes - fewer, k, room, sign)
            now, then = max(abs(found - left), abs(found - right)), abs(found - few)
            fall = max(values[k] - values[k - 1] if before else 0.0, values[k] - values[k + 1] if after else 0.0)
            smooth = now <= DRAWN_TOGETHER * then and then <= WELL_WITHIN * fall
            if (smooth or now <= ROUNDED * (highest - lowest)) and found >= top:
                top, limit = found, min(found + math.sqrt(now * then), max(limit, found))
        most = max(most, limit)
        if top > best:
            best, node = top, k
    return best, float(node), max(most, best)
