"""Curves known at nodes and smooth between jumps: their integral, and bounds between the nodes.

A jump has a node on either side, with a negligible step between them. Nodes may be unequally spaced. The behaviour
within a step is estimated from neighbours on the same side of all jumps. Each function takes `values` at the nodes, and
the `steps` between them, one fewer.
"""

import math

import numpy as np

from engine.compiling.decorators import scalar
from engine.compiling.running import over_variants
from engine.motion.moments.grid import GAP

# For a kink in a step next to a jump, where the slope grows by D at the fraction t of the step, the integral error is
# at most D(1 − t)(t/2 − 1/8)h². The adjacent step shows D(1 − t)/4, a quarter of which is already included there.
BESIDE = 1.25
# Fewest and most nodes of the polynomial at a peak; bisections of its slope between two nodes.
LEAST_NODES, MOST_NODES, HALVINGS = 5, 8, 26
# A curve is smooth if a higher degree changes its peak by at most this fraction of the previous change, or by rounding,
# relative to its range.
DRAWN_TOGETHER, ROUNDED = 0.1, 1e-14
# Near a kink the values may agree by chance. For a smooth curve their change is at most this fraction of the drop to
# the neighbours: 0.047 h² for a sine, with h the radians between nodes.
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
    """Whether step k exists and is not a jump."""
    return 0 <= k < steps.shape[0] and steps[k] > GAP


@scalar
def integral(values: np.ndarray, steps: np.ndarray) -> tuple[float, float]:
    """Integral by cubics with the slopes at both ends of each step, and a bound on the error due to kinks.

    Fourth order for a smooth curve. A kink within a step appears as a difference between the chord and the mean of the
    slopes at its ends. Next to a jump, where a one-sided parabola gives the slope, it appears in the adjacent step.
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
    """Difference between the chord from node k to the next and the mean of the slopes at both."""
    return abs((values[k + 1] - values[k]) / h - 0.5 * (near + far))


@scalar
def rise_towards(values: np.ndarray, steps: np.ndarray, k: int, side: int, otherwise: float) -> float:
    """Slope of the rise towards node k from a side (−1: before it): over the last step, or extrapolated if larger.

    `otherwise` if a jump or the end of the nodes is on that side.
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
    """Upper bound of a curve from node k to the next.

    Even with a kink, the curve stays below the intersection of the two straight lines that continue it from before and
    from after the step. Next to a jump only one of them is known.
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
    """Peak near node k of the polynomial through nodes first … last − 1; NaN if there is none within.

    Uses divided differences (in the scratch array `room`) and bisection of the slope; for signed squares, returns the
    root.
    """
    for i in range(first, last):
        room[i - first] = values[i]
    for order in range(1, last - first):
        for i in range(last - 1, first + order - 1, -1):
            room[i - first] = (room[i - first] - room[i - first - 1]) / (places[i] - places[i - order])
    low, high = places[max(k - 1, first)], places[min(k + 1, last - 1)]
    value = math.nan
    for halving in range(HALVINGS + 2):
        # Check both ends first: the polynomial must rise at one and fall at the other.
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
    """Maximum of a curve, also between its nodes; the nearest node; an upper bound.

    At each local maximum of the nodes, polynomials of three degrees pass through the nodes around it: if their peaks
    converge, the differences give the error of the best; if not, the curve has a kink and only its nodes are known. For
    a curve of one sign its signed square is interpolated: it is smooth where a magnitude touches 0.
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
            # The node sets: centred, without either end, and without both ends.
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


def extremes_along(row: np.ndarray, steps: np.ndarray) -> np.ndarray:
    """−minimum and maximum of curves, each with the nearest node and an upper bound, (2, 3, variants).

    Parameters
    ----------
    row : ndarray (nodes, variants)
    steps : ndarray (nodes − 1, variants)
    """
    found = np.empty((2, 3, row.shape[1]))
    for sign, own in zip((-1.0, 1.0), found, strict=True):
        peaks_along(row.shape[1], np.ascontiguousarray(sign * row), np.ascontiguousarray(steps), own)
    return found


@over_variants
def peaks_along(begin: int, end: int, row: np.ndarray, steps: np.ndarray, found: np.ndarray) -> None:
    """Maximum of a row, the nearest node, and an upper bound: three numbers for each variant."""
    nodes = row.shape[0]
    own, h = np.empty(nodes), np.empty(nodes - 1)
    for v in range(begin, end):
        for k in range(nodes):
            own[k] = row[k, v]
        for k in range(nodes - 1):
            h[k] = steps[k, v]
        found[0, v], found[1, v], found[2, v] = peak_between(own, h)


def of_extremes(most: np.ndarray, bounds: np.ndarray) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Statistics that follow from −minimum and maximum, (2, variants), with errors from the upper bounds of both."""
    (low, high), (below, above) = most * [[-1.0], [1.0]], bounds - most
    peak = np.abs(most).max(axis=0)
    values = {"min": low, "max": high, "range": high - low, "amplitude": (high - low) / 2, "peak": peak}
    errors = {"min": below, "max": above, "range": below + above, "amplitude": (below + above) / 2}
    return values, errors | {"peak": (np.abs(most) + bounds - most).max(axis=0) - peak}
