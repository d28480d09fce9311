"""The characteristic of a governor between its stops: where it is stable, and where friction does most.

Stability is sampled at positions spread evenly, in each piece of a table for itself; a stretch that changes its sign
twice between neighbouring samples is not seen. Ends of stretches and least values are then found to the last digits.
"""

import math

from engine.compiling.decorators import routine
from engine.cycle.panels.lanes import Memory
from engine.elements.governors.places import (
    FRICTION,
    GREATEST,
    LEAST,
    Holding,
    linkage_at,
    margin_at,
    position_of,
)
from engine.laws.tables import HEAD
from engine.verdicts import Verdict

SAMPLES = 33
# In each piece of a table, and how many samples there are room for.
PIECE_SAMPLES = 9
MOST_SAMPLES = 1024
_ROUNDS = 100
_GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
# From a minimum so many roundings of what is sought can't be told from it.
_GOLDEN_ROUNDS = 44
# How far inside a piece of a table its ends are sampled, as a share of the range.
_INSIDE = 1e-12

_OK, _CANNOT_ASSEMBLE, _SINGULAR = int(Verdict.OK), int(Verdict.CANNOT_ASSEMBLE), int(Verdict.SINGULAR)
_OUTSIDE, _JAMS, _UNSTABLE = int(Verdict.OUTSIDE_LIMITS), int(Verdict.JAMS), int(Verdict.UNSTABLE)
_OVER_RADIUS, _OVER_LIFT = int(Holding.OVER_RADIUS), int(Holding.OVER_LIFT)

# What `stretches` marks of a characteristic: positions of the stops, of the ends of the stable stretch, of the least
# stability between the stops, of the least force at the sleeve in the stable stretch; how far rounding moves the third
# to the sixth; whether the stretch is isochronous.
INNER, OUTER, FROM, TO, LEAST_STABLE, WEAKEST = range(6)
OFF_FROM, OFF_TO, OFF_LEAST_STABLE, ISOCHRONOUS = range(6, 10)
MARKS = 10


@routine
def sample_places(kind: int, memory: Memory, low: float, high: float, lift_ratio: float, places: Memory) -> int:
    """Write positions from one stop to the other at which a characteristic is sampled; how many.

    Parameters
    ----------
    kind : int
        `Holding`.
    memory : Memory
        Tables.
    low, high : float
        Positions of the stops [m].
    lift_ratio : float
        Of a governor with a table over the lift.
    places : Memory (MOST_SAMPLES,)
        To be written to.
    """
    if kind < _OVER_RADIUS:
        for k in range(SAMPLES):
            places[k] = low + (high - low) * k / (SAMPLES - 1)
        return SAMPLES
    count, pieces, tiny = 0, int(memory[0]), _INSIDE * (high - low)
    left = low
    for k in range(1, pieces + 1):
        right = memory[HEAD + k]
        if kind == _OVER_LIFT:
            right = low + right / lift_ratio
        right = min(right, high) if k < pieces else high
        if right <= left or count + PIECE_SAMPLES > MOST_SAMPLES:
            continue
        for j in range(PIECE_SAMPLES):
            places[count] = left + tiny + (right - left - 2.0 * tiny) * j / (PIECE_SAMPLES - 1)
            count += 1
        left = right
    places[0], places[count - 1] = low, high
    return count


@routine
def least_between(kind: int, p: Memory, memory: Memory, zero: float, sought: int, low: float, high: float) -> float:
    """Position of the least margin (`sought` 0) or sleeve force (2) between two positions, by golden section."""
    a, b = low, high
    c, d = b - _GOLDEN * (b - a), a + _GOLDEN * (b - a)
    at_c, at_d = margin_at(kind, p, memory, c, zero)[sought], margin_at(kind, p, memory, d, zero)[sought]
    for _ in range(_GOLDEN_ROUNDS):
        if at_c < at_d:
            b, d, at_d = d, c, at_c
            c = b - _GOLDEN * (b - a)
            at_c = margin_at(kind, p, memory, c, zero)[sought]
        else:
            a, c, at_c = c, d, at_d
            d = a + _GOLDEN * (b - a)
            at_d = margin_at(kind, p, memory, d, zero)[sought]
    return 0.5 * (a + b)


@routine
def stable_at(kind: int, p: Memory, memory: Memory, zero: float, x: float) -> bool:
    """Whether a governor is stable or isochronous at a position, as far as rounding lets tell."""
    margin, rounding, sleeve, _, _ = margin_at(kind, p, memory, x, zero)
    return sleeve > 0.0 and margin >= -rounding


@routine
def edge_of_stability(kind: int, p: Memory, memory: Memory, zero: float, stable: float, unstable: float) -> float:
    """Position between a stable and an unstable one where stability ends, by halving."""
    for _ in range(_ROUNDS):
        middle = 0.5 * (stable + unstable)
        if middle in (stable, unstable):
            break
        if stable_at(kind, p, memory, zero, middle):
            stable = middle
        else:
            unstable = middle
    return stable


@routine
def location_error(span: float, rounding: float, rise: float) -> float:
    """How far rounding moves a minimum from which a function rises by `rise` within `span`."""
    return span * math.sqrt(min(rounding / max(rise, 1e-300), 1.0))


@routine
def stretches(kind: int, p: Memory, memory: Memory, marks: Memory, places: Memory) -> int:
    """Mark the longest stable stretch of a characteristic; its verdict.

    Parameters
    ----------
    kind : int
        `Holding`.
    p : Memory (NUMBERS,)
    memory : Memory
        Tables.
    marks : Memory (MARKS,)
        To be written to.
    places : Memory (MOST_SAMPLES,)
        Room.

    Returns
    -------
    int
        `Verdict`: OK; OUTSIDE_LIMITS without a range between the stops; CANNOT_ASSEMBLE where arms don't reach;
        SINGULAR where sleeve or balls don't rise with the position; UNSTABLE without a stable stretch; JAMS where
        friction holds the sleeve at any speed.
    """
    if not p[LEAST] < p[GREATEST]:
        return _OUTSIDE
    low, high = position_of(kind, p, p[LEAST]), position_of(kind, p, p[GREATEST])
    if not low < high:
        return _CANNOT_ASSEMBLE
    marks[INNER], marks[OUTER] = low, high
    link = linkage_at(kind, p, low)
    zero = link[5]
    count = sample_places(kind, memory, low, high, link[6], places)
    best, best_begin, best_end, begin = 0.0, -1, -1, -1
    least, least_at, most = math.inf, 0, -math.inf
    for j in range(count):
        margin, rounding, sleeve, radius_rate, lift_rate = margin_at(kind, p, memory, places[j], zero)
        if not (math.isfinite(radius_rate) and math.isfinite(lift_rate)):
            return _CANNOT_ASSEMBLE
        if not (radius_rate > 0.0 and lift_rate > 0.0):
            return _SINGULAR
        if margin < least:
            least, least_at = margin, j
        most = max(most, margin - rounding)
        if sleeve > 0.0 and margin >= -rounding:
            begin = j if begin < 0 else begin
            length = places[j] - places[begin]
            if best_begin < 0 or length > best:
                best, best_begin, best_end = length, begin, j
        else:
            begin = -1
    if best_begin < 0:
        return _UNSTABLE
    marks[FROM], marks[OFF_FROM] = low, 0.0
    marks[TO], marks[OFF_TO] = high, 0.0
    if best_begin > 0:
        marks[FROM] = edge_of_stability(kind, p, memory, zero, places[best_begin], places[best_begin - 1])
        marks[OFF_FROM] = edge_error(kind, p, memory, zero, marks[FROM], places[best_begin])
    if best_end < count - 1:
        marks[TO] = edge_of_stability(kind, p, memory, zero, places[best_end], places[best_end + 1])
        marks[OFF_TO] = edge_error(kind, p, memory, zero, marks[TO], places[best_end])
    before, after = max(least_at - 1, 0), min(least_at + 1, count - 1)
    marks[LEAST_STABLE], marks[OFF_LEAST_STABLE] = places[least_at], 0.0
    if 0 < least_at < count - 1:
        marks[LEAST_STABLE] = least_between(kind, p, memory, zero, 0, places[before], places[after])
        margin, rounding, _, _, _ = margin_at(kind, p, memory, marks[LEAST_STABLE], zero)
        rise = min(
            margin_at(kind, p, memory, places[before], zero)[0], margin_at(kind, p, memory, places[after], zero)[0]
        )
        marks[OFF_LEAST_STABLE] = location_error(places[after] - places[before], rounding, rise - margin)
        if least < margin:
            # A table's kink: its side is sampled, and no minimum is found by narrowing it in.
            marks[LEAST_STABLE], marks[OFF_LEAST_STABLE] = places[least_at], 0.0
    marks[ISOCHRONOUS] = 1.0 if best_end > best_begin and most <= 0.0 else 0.0
    return mark_weakest(kind, p, memory, zero, marks, places, best_begin, best_end)


@routine
def edge_error(kind: int, p: Memory, memory: Memory, zero: float, edge: float, inside: float) -> float:
    """How far rounding moves the end of a stable stretch."""
    margin, rounding, _, _, _ = margin_at(kind, p, memory, inside, zero)
    at_edge = margin_at(kind, p, memory, edge, zero)[0]
    return abs(inside - edge) * min(4.0 * rounding / max(abs(margin - at_edge), 1e-300), 1.0)


@routine
def mark_weakest(
    kind: int,
    p: Memory,
    memory: Memory,
    zero: float,
    marks: Memory,
    places: Memory,
    begin: int,
    end: int,
) -> int:
    """Mark where the force at the sleeve is least in the stable stretch; JAMS where friction is more than that."""
    least, at = math.inf, marks[FROM]
    index = -1
    for j in range(begin - 1, end + 2):
        x = marks[FROM] if j < begin else (marks[TO] if j > end else places[j])
        sleeve = margin_at(kind, p, memory, x, zero)[2]
        if sleeve < least:
            least, at, index = sleeve, x, j
    if begin < index < end:
        at = least_between(kind, p, memory, zero, 2, places[index - 1], places[index + 1])
        if margin_at(kind, p, memory, at, zero)[2] > least:
            at = places[index]
    marks[WEAKEST] = at
    return _OK if p[FRICTION] < margin_at(kind, p, memory, at, zero)[2] else _JAMS
