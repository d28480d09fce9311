"""Adaptive panels: each lane walks over its range, from edge to edge, in panels as long as its curves allow.

All lanes take their next panel together. A lane whose series leaves too large a remainder retries from the same
position with a shorter panel in the next step, while the others advance. The remainder beyond degree n is proportional
to the power n + 1 of a panel's length, which gives the length of the next panel. The distance to the next edge is
divided into equal panels.

A lane's panels don't depend on other lanes.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.chebyshev import DEGREE, PLACES
from engine.cycle.panels.lanes import any_positive
from engine.cycle.panels.series import TINY, Figures, larger, smaller

# Value of `accepted` before a lane's first panel.
NOTHING_BEFORE = -1.0


class Walk(NamedTuple):
    """State of each lane's walk; positions are multiplied by the direction in which the input runs.

    Attributes
    ----------
    begin, end : row
        Ends of the panel.
    edge : row
        Next edge.
    last : row
        Last position.
    range : row
        Length of the range.
    close : row
        Edges closer than this coincide.
    wanted : row
        Length wanted for the next panel.
    taken : row
        Number of panels accepted.
    direction : row
        1 or −1.
    middle, half : row
        Middle and half length of the panel in the input's own sign, as the machine's functions take them.
    active : row
        1 if the lane has panels left, else 0.
    accepted : row
        1 if its panel was accepted, 0 if not, NOTHING_BEFORE before the first.
    excess, level : row
        Maximum ratio of remainder to tolerance, over curves with decaying coefficients and over those with level ones.
    opened, next_opened, ahead : row
        Error estimate of the position of the edge at the start of this panel, of the next panel, and of the next edge.
    kink : row
        Position in a rejected panel at which a kink curve changes sign or may touch zero. The next panel ends there.
    tried : row
        Number of panels in a row rejected for that reason.
    sign : row
        First position on [−1, 1] where a kink curve changes sign in the panel, or may touch zero; else infinity.
    bent : row
        1 if a kink curve changes sign in the panel, else 0.
    before_kink, past_kink : row
        Distance from the panel's start to a kink next to it inside, and from a kink to the panel's end; 0 without one.
    behind : row
        Number of edges passed.
    """

    begin: Row
    end: Row
    edge: Row
    last: Row
    range: Row
    close: Row
    wanted: Row
    taken: Row
    direction: Row
    middle: Row
    half: Row
    active: Row
    accepted: Row
    excess: Row
    level: Row
    opened: Row
    next_opened: Row
    ahead: Row
    kink: Row
    tried: Row
    sign: Row
    bent: Row
    before_kink: Row
    past_kink: Row
    behind: Row


class Scales(NamedTuple):
    """Scale and rounding of a curve along a walk.

    Attributes
    ----------
    greatest : row
        Maximum magnitude so far.
    rounding : row
        Maximum difference so far between values at one position from different panels.
    at_begin, at_end : row
        Values at the ends of the panel tried before.
    level : row
        Remainder of the panel tried before, if it was of minimum length and its coefficients were level; else 0.
    """

    greatest: Row
    rounding: Row
    at_begin: Row
    at_end: Row
    level: Row


class Edge(NamedTuple):
    """A position that no panel may contain inside, and its error estimate.

    Attributes
    ----------
    place, error : row
    """

    place: Row
    error: Row


# Limits of a panel's length relative to the one before.
SHORTER, LONGER = 0.25, 3.0
# Fraction of the tolerance for which the length of a panel is chosen.
AIM = 0.2
# Maximum length of a panel as a fraction of the range: rounding is measured where panels meet. Two panels measure it at
# one position, which leaves 6 of 1000 estimates too small; three leave none.
LONGEST = 0.34
# Length of the panels of a lane that has reached MOST panels, as a fraction of the range.
LAST_ONES = 0.1
# Minimum length of a panel as a fraction of the range, and number of panels after which a lane finishes in long ones.
FLOOR, MOST = 1e-7, 200
# Coefficients are level for a feature narrower than the panel, or for rounding. Rounding is measured: a position shared
# by two panels is computed from each panel's middle, and values there differ by the rounding of the position's
# direction and of everything that follows. A remainder up to this multiple of the difference counts as rounding. Near
# φ = 0 the direction is exact, so the difference is 0: there the remainder itself is taken for rounding if two
# successive panels of minimum length have level coefficients.
LEFT_BY_ROUNDING = 32.0
# A panel may exceed the wanted length by this fraction, so that no sliver is left before the next edge.
STRETCH = 1e-9
# Number of panels in a row that end at a kink, located ten to a hundred times more closely each time, before panels are
# shortened instead.
TRIES = 8.0
# A kink curve may change sign and back if it turns nearer to zero than this fraction of its rise to the positions
# beside, unless it turns next to an end of the panel on [−1, 1], or the rise is too small relative to its maximum
# magnitude: what is missed is then negligible, or rounding.
TOUCHES, NEAR_END, FLAT = 0.1, 0.999, 1e-8
# Excess of a panel that is rejected whatever its remainders are.
REJECTED = 2.0
# Rounding left by a smooth curve, relative to its maximum magnitude.
NOTHING = 2e-15
# Edges closer than this, relative to the largest position, coincide.
ONE_EDGE = 2e-15


@routine
def set_out(first: Row, last: Row, longest: float, walk: Walk) -> None:
    """Start a walk over each lane's range of the input; a lane with a NaN or infinite range has no panels."""
    for lane in range(LANES):
        direction = 1.0 if last[lane] >= first[lane] else -1.0
        begin, end = direction * first[lane], direction * last[lane]
        walk.direction[lane], walk.begin[lane], walk.last[lane] = direction, begin, end
        walk.wanted[lane], walk.taken[lane], walk.end[lane] = smaller(longest, LONGEST * (end - begin)), 0.0, begin
        walk.range[lane] = end - begin
        walk.close[lane] = ONE_EDGE * larger(abs(begin), abs(end))
        walk.middle[lane], walk.half[lane] = first[lane], 0.0
        walk.tried[lane] = walk.behind[lane] = 0.0
        walk.kink[lane] = math.inf
        walk.accepted[lane] = NOTHING_BEFORE
        walk.opened[lane] = walk.next_opened[lane] = 0.0
        walk.active[lane] = 1.0 if end - begin < math.inf and end > begin else 0.0


@routine
def next_panels(edges: Rows, count: int, walk: Walk) -> bool:
    """Lay each lane's next panel.

    Parameters
    ----------
    edges : rows (edges,) of Edge
        Sorted positions, in the direction of the walk, that no panel may contain inside, with error estimates; infinite
        for none.
    count : int
        Number of rows of `edges` in use.
    walk : Walk

    Returns
    -------
    bool
        Whether any lane has panels left; the others keep their last panel.
    """
    for lane in range(LANES):
        begin, last, kink = walk.begin[lane], walk.last[lane], walk.kink[lane]
        bent = (kink > begin + walk.close[lane]) & (kink < last)
        walk.edge[lane], walk.ahead[lane] = kink if bent else last, walk.close[lane] if bent else 0.0
        walk.opened[lane] = walk.next_opened[lane]
    if count > 0:
        for lane in range(LANES):
            behind, close, ahead = int(walk.behind[lane]), walk.close[lane], walk.edge[lane]
            while behind < count and edges[behind].place[lane] <= walk.begin[lane] + close:
                behind += 1
            walk.behind[lane] = behind
            if behind < count and edges[behind].place[lane] < smaller(ahead, walk.last[lane] - close):
                walk.edge[lane], walk.ahead[lane] = edges[behind].place[lane], edges[behind].error[lane]
    for lane in range(LANES):
        begin, edge, active = walk.begin[lane], walk.edge[lane], walk.active[lane] > 0.0
        # A lane that has reached MOST panels finishes in a few long ones.
        wanted = walk.wanted[lane] if walk.taken[lane] < MOST else LAST_ONES * walk.range[lane]
        pieces = np.ceil((edge - begin) / wanted * (1.0 - STRETCH))
        at_once = pieces <= 1.0
        end = edge if at_once else begin + (edge - begin) / pieces
        direction, end_before = walk.direction[lane], walk.end[lane]
        middle_before, half_before = walk.middle[lane], walk.half[lane]
        walk.end[lane] = end if active else end_before
        walk.middle[lane] = direction * (0.5 * (begin + end)) if active else middle_before
        walk.half[lane] = direction * (0.5 * (end - begin)) if active else half_before
        walk.excess[lane] = walk.level[lane] = walk.bent[lane] = 0.0
        walk.sign[lane], walk.before_kink[lane], walk.past_kink[lane] = math.inf, 0.0, 0.0
    return any_positive(walk.active)


@routine
def find_kink(curve: Rows, degree: int, walk: Walk) -> None:
    """Find the first sign change of a kink curve in each lane's panel, and its distance from an end next to it.

    Parameters
    ----------
    curve : rows (degree + 1, LANES)
        Curve at whose zeros other curves have kinks.
    degree : int
    walk : Walk
    """
    stride = DEGREE // degree
    for i in range(degree):
        j = degree - 1 - i
        k = j + 2 if j + 2 <= degree else j - 1
        before, after, beside = PLACES[stride * j], PLACES[stride * (j + 1)], PLACES[stride * k]
        for lane in range(LANES):
            here, there, known = curve[j, lane], curve[j + 1, lane], walk.sign[lane]
            slope = (there - here) / (after - before)
            bend = ((curve[k, lane] - there) / (beside - after) - slope) / (beside - before)
            straight = before - here / slope
            # One step of Newton's method on the parabola.
            steep = slope + bend * ((straight - before) + (straight - after))
            place = straight - bend * (straight - before) * (straight - after) / steep
            place = place if (place > before) & (place < after) else straight
            walk.sign[lane] = place if (here * there < 0.0) & (place < known) else known
            walk.bent[lane] = 1.0 if here * there < 0.0 else walk.bent[lane]
    for lane in range(LANES):
        # By a secant, a distance is known to half.
        length = 2.0 * abs(walk.half[lane]) * (PLACES[stride] - PLACES[0])
        first, second, last, end = curve[0, lane], curve[1, lane], curve[degree - 1, lane], curve[degree, lane]
        begins = length * abs(first / (second - first)) if first * second < 0.0 else 0.0
        ends = length * abs(end / (end - last)) if last * end < 0.0 else 0.0
        walk.before_kink[lane] = larger(begins, walk.before_kink[lane])
        walk.past_kink[lane] = larger(ends, walk.past_kink[lane])


@routine
def find_touch(curve: Rows, degree: int, scales: Scales, walk: Walk) -> None:
    """Reject each lane's panel if a kink curve may change sign and back between its positions.

    The next panel ends at the turning point, which shows whether it does. The turning point is that of the parabola
    through three positions.

    Parameters
    ----------
    curve : rows (degree + 1, LANES)
        Curve at whose zeros other curves have kinks.
    degree : int
    scales : Scales
        Of the curve.
    walk : Walk
    """
    stride = DEGREE // degree
    for i in range(degree - 1):
        j = degree - 2 - i
        before, middle, after = PLACES[stride * j], PLACES[stride * (j + 1)], PLACES[stride * (j + 2)]
        for lane in range(LANES):
            a, b, c, known = curve[j, lane], curve[j + 1, lane], curve[j + 2, lane], walk.sign[lane]
            slope = (b - a) / (middle - before)
            bend = ((c - b) / (after - middle) - slope) / (after - before)
            place = 0.5 * (before + middle - slope / bend)
            height = a + (place - before) * (slope + bend * (place - middle))
            rise = bend * math.copysign(0.25 * (after - before) * (after - before), b)
            between = (a * b > 0.0) & (b * c > 0.0) & (place > before) & (place < after) & (abs(place) < NEAR_END)
            low = height * math.copysign(1.0, b) < TOUCHES * rise
            touches = between & low & (rise > FLAT * scales.greatest[lane])
            touches &= walk.tried[lane] < TRIES
            walk.sign[lane] = place if touches & (place < known) else known
            walk.excess[lane] = larger(REJECTED if touches else 0.0, walk.excess[lane])


@routine
def note_rounding(curve: Rows, degree: int, scales: Scales, walk: Walk) -> None:
    """Update the measured rounding of a curve by the difference of its values where the panel meets the one before.

    Parameters
    ----------
    curve : rows (degree + 1, LANES)
    degree : int
    scales : Scales
    walk : Walk
    """
    for lane in range(LANES):
        accepted = walk.accepted[lane]
        before = scales.at_end[lane] if accepted > 0.0 else scales.at_begin[lane]
        # The curve may jump at a cut or a kink, and lanes that have finished repeat their last panel.
        unknown = (accepted < 0.0) | (walk.opened[lane] > 0.0) | (walk.active[lane] == 0.0)
        here, known = curve[0, lane], scales.rounding[lane]
        scales.rounding[lane] = larger(0.0 if unknown else abs(here - before), known)
        scales.at_begin[lane], scales.at_end[lane] = here, curve[degree, lane]


@routine
def compare_with_tolerance(
    figures: Figures, tolerance: float, only_integral: float, scales: Scales, walk: Walk
) -> bool:
    """Raise each lane's excess to that of a curve, after subtracting its rounding.

    Parameters
    ----------
    figures : Figures
        Figures of the curve.
    tolerance : float
        Admissible remainder, relative to the maximum magnitude.
    only_integral : float
        1 if only the curve's mean counts, so that the remainder of the mean is compared; else 0.
    scales : Scales
    walk : Walk

    Returns
    -------
    bool
        Whether a value in any lane's panel is NaN or infinite.
    """
    broken = False
    for lane in range(LANES):
        scale = larger(figures.magnitude[lane], scales.greatest[lane])
        scales.greatest[lane] = scale
        flat, length = figures.flat[lane] > 0.0, walk.end[lane] - walk.begin[lane]
        level = figures.tail[lane] if flat & is_shortest(length, walk.range[lane], walk.close[lane]) else 0.0
        unresolved = smaller(level, scales.level[lane]) if walk.active[lane] > 0.0 else 0.0
        scales.rounding[lane], scales.level[lane] = larger(unresolved, scales.rounding[lane]), level
        # A remainder that is only rounding says nothing about the panel's length.
        rounding = larger(NOTHING * scale, LEFT_BY_ROUNDING * scales.rounding[lane])
        of_mean = figures.missing[lane] * abs(walk.half[lane]) * (2.0 / walk.range[lane])
        tail = figures.tail[lane] - rounding
        left = smaller(of_mean, tail) if only_integral > 0.0 else tail
        excess = larger(left, 0.0) / larger(tolerance * scale, TINY)
        walk.excess[lane] = larger(0.0 if flat else excess, walk.excess[lane])
        walk.level[lane] = larger(excess if flat else 0.0, walk.level[lane])
        broken |= not abs(figures.sum[lane]) < math.inf
    return broken


@routine
def compare_root(curve: Rows, degree: int, figures: Figures, tolerance: float, scales: Scales, walk: Walk) -> None:
    """Raise each lane's excess to that of the square root of a nonnegative curve.

    The error of the root grows as the curve falls.

    Parameters
    ----------
    curve : rows (degree + 1, LANES)
    degree : int
    figures, tolerance, scales, walk
        As in `compare_with_tolerance`, which must be called before.
    """
    for lane in range(LANES):
        scale, whole = scales.greatest[lane], figures.tail[lane]
        least = scale
        for j in range(degree + 1):
            least = smaller(curve[j, lane], least)
        left = larger(whole - larger(NOTHING * scale, LEFT_BY_ROUNDING * scales.rounding[lane]), 0.0)
        off = left / (2.0 * math.sqrt(larger(least, larger(left, TINY))))
        excess = off / larger(tolerance * math.sqrt(scale), TINY)
        flat = figures.flat[lane] > 0.0
        walk.excess[lane] = larger(0.0 if flat else excess, walk.excess[lane])


@inlined
def is_shortest(length: float, whole: float, close: float) -> bool:
    """Whether a panel has the minimum length, within the rounding of its ends."""
    return length <= FLOOR * whole * (1.0 + 2.0 * STRETCH) + close


@inlined
def root_of_degree(x: float, degree: int) -> float:
    """Return x to the power 1/16, or 1/8 for COARSE."""
    root = math.sqrt(math.sqrt(math.sqrt(x)))
    return math.sqrt(root) if degree == DEGREE else root


@routine
def judge(longest: float, degree: int, walk: Walk) -> bool:
    """Accept or reject each lane's panel, advance accepted ones, and choose the next length from the excess.

    Returns
    -------
    bool
        Whether any lane's panel was accepted.
    """
    for lane in range(LANES):
        begin, end, falling, level = walk.begin[lane], walk.end[lane], walk.excess[lane], walk.level[lane]
        length, active, least = end - begin, walk.active[lane] > 0.0, FLOOR * walk.range[lane]
        shortest = is_shortest(length, walk.range[lane], walk.close[lane])
        enough = ((falling <= 1.0) & (level <= 1.0)) | shortest | (walk.taken[lane] >= MOST)
        # Level coefficients within the tolerance are rounding, and say nothing about the panel's length.
        excess = falling if level <= 1.0 else larger(falling, level)
        factor = larger(smaller(root_of_degree(AIM / larger(excess, 1e-9), degree), LONGER), SHORTER)
        wanted = larger(length * factor, least)
        # If a panel is rejected and has a kink inside, the next one ends at the kink.
        sign, tries = walk.sign[lane], walk.tried[lane]
        bent = (not enough) & (sign < 1.0) & (tries < TRIES)
        kink = walk.kink[lane]
        walk.kink[lane] = begin + 0.5 * (1.0 + sign) * length if bent & active else kink
        walk.tried[lane] = tries + 1.0 if bent else (0.0 if enough else tries)
        # A short panel before an edge says little about the length of the next.
        most = smaller(longest, LONGEST * walk.range[lane])
        wanted = smaller(larger(wanted, walk.wanted[lane]) if excess <= AIM else wanted, most)
        accepted, wanted_before, opened_before = active & enough, walk.wanted[lane], walk.opened[lane]
        wanted = wanted_before if bent else wanted
        walk.wanted[lane] = wanted if active else wanted_before
        walk.accepted[lane] = 1.0 if accepted else 0.0
        walk.taken[lane] += 1.0 if accepted else 0.0
        walk.begin[lane] = end if accepted else begin
        opened = walk.ahead[lane] if end == walk.edge[lane] else 0.0
        walk.next_opened[lane] = opened if accepted else opened_before
        walk.active[lane] = 1.0 if active & ((not enough) | (end < walk.last[lane])) else 0.0
    return any_positive(walk.accepted)
