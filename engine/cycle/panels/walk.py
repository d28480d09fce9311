"""Panels: each lane walks over its own range, from edge to edge, in panels as long as its curves allow.

All lanes take their next panel at the same time. A lane whose series has too much left beyond its last coefficient
takes a shorter panel from the same place in the next step, while the others go on. What is left falls with the 17th
power of a panel's length, which tells the length of the next one. The distance to the next edge is shared out equally.

What a lane does depends on nothing but the lane.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, PLACES, POSITIONS
from engine.cycle.panels.lanes import any_positive
from engine.cycle.panels.series import TINY, Figures, larger, smaller

# What a lane's `accepted` holds where there is no panel before.
NOTHING_BEFORE = -1.0


class Walk(NamedTuple):
    """Where each lane is on its walk: input positions count in the direction in which the input runs.

    Attributes
    ----------
    begin, end : row
        Ends of the panel.
    edge : row
        The edge ahead.
    last : row
        Last position.
    range : row
        Length of the range.
    close : row
        Edges nearer than this are one.
    wanted : row
        Length of the next panel.
    taken : row
        How many panels were taken.
    direction : row
        1 or −1.
    middle, half : row
        Middle and half length of the panel as the machine's functions see them.
    active : row
        Whether the lane has panels left.
    accepted : row
        Whether its panel is accepted, or NOTHING_BEFORE.
    excess, level : row
        What is left over what is tolerated, at most, of curves whose coefficients fall, and of those whose last ones
        are level.
    opened, next_opened, ahead : row
        Error of the place of the edge where this panel begins, where the next one does, and of the edge ahead.
    kink : row
        Where the next kink is that a refused panel had inside.
    tried : row
        How many panels in a row were refused for one.
    sign : row
        First place in the panel where a curve of kinks changes its sign, on [−1, 1], else infinity.
    bent : row
        1 where there is such a place, else 0.
    behind : row
        How many edges lie behind.
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
    behind: Row


class Scales(NamedTuple):
    """What a walk knows of a curve.

    Attributes
    ----------
    greatest : row
        Greatest magnitude so far.
    rounding : row
        By how much it differed so far where one panel ended and the next began, or began anew.
    at_begin, at_end : row
        Its value at either end of the panel tried before.
    """

    greatest: Row
    rounding: Row
    at_begin: Row
    at_end: Row


class Edge(NamedTuple):
    """Places that no panel may have inside, and their errors.

    Attributes
    ----------
    place, error : row
    """

    place: Row
    error: Row


# A panel is made this much shorter, of its length, or longer than the one before, at most.
SHORTER, LONGER = 0.25, 3.0
# Share of the tolerance that a panel's length is chosen for.
AIM = 0.2
# Length of the panels of a lane that has taken as many as it may, as a share of the range.
LAST_ONES = 0.1
# Least length of a panel as a share of the range, and most panels a lane takes before it goes on in long ones.
FLOOR, MOST = 1e-7, 200
# Coefficients are level for what is narrower than the panel, or for rounding. Rounding is measured: positions of panels
# that begin or end at one place are computed from their middles, and a curve there differs by the rounding of its
# direction and of all that follows from it. What is left is rounding where it is no more than so many times that.
LEFT_BY_ROUNDING = 32.0
# A panel may be longer than wanted by this share, so as not to leave a sliver of the distance to the next edge.
STRETCH = 1e-9
# So many panels in a row are made to end at a kink, told more and more closely, before they are made shorter instead.
# Each try is ten to a hundred times as close.
TRIES = 8.0
# Share of the greatest magnitude that rounding leaves of a smooth curve.
NOTHING = 2e-15
# Edges that are closer than this share of the greatest position are one.
ONE_EDGE = 2e-15


@routine
def set_out(first: Row, last: Row, longest: float, walk: Walk) -> None:
    """Begin a walk over each lane's range of the input; a lane whose range isn't finite has no panels."""
    for lane in range(LANES):
        direction = 1.0 if last[lane] >= first[lane] else -1.0
        begin, end = direction * first[lane], direction * last[lane]
        walk.direction[lane], walk.begin[lane], walk.last[lane] = direction, begin, end
        walk.wanted[lane], walk.taken[lane], walk.end[lane] = longest, 0.0, begin
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
        Positions that no panel may have inside, in the direction of the walk and in order, infinite for none; what they
        may be off by.
    count : int
        Number of rows of `edges` that are used.
    walk : Walk

    Returns
    -------
    bool
        Whether any lane is still on its way; lanes that aren't keep their last panel.
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
        # A lane that has taken as many as it may goes on in a few long ones.
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
        walk.sign[lane] = math.inf
    return any_positive(walk.active)


@routine
def find_kink(curve: Rows, walk: Walk) -> None:
    """Note where a curve at whose zeros others bend first changes its sign in each lane's panel.

    Parameters
    ----------
    curve : rows (POSITIONS, LANES)
    walk : Walk
    """
    for i in range(DEGREE):
        j = DEGREE - 1 - i
        for lane in range(LANES):
            here, there, known = curve[j, lane], curve[j + 1, lane], walk.sign[lane]
            place = PLACES[j] + (PLACES[j + 1] - PLACES[j]) * (here / (here - there))
            walk.sign[lane] = place if (here * there < 0.0) & (place < known) else known
            walk.bent[lane] = 1.0 if here * there < 0.0 else walk.bent[lane]


@routine
def note_rounding(curve: Rows, scales: Scales, walk: Walk) -> None:
    """Widen each lane's rounding of a curve by how much it differs from before where its panel begins.

    Parameters
    ----------
    curve : rows (POSITIONS, LANES)
    scales : Scales
    walk : Walk
    """
    for lane in range(LANES):
        accepted = walk.accepted[lane]
        before = scales.at_end[lane] if accepted > 0.0 else scales.at_begin[lane]
        # At a cut or a kink a curve may jump; lanes that have arrived stay where they are.
        unknown = (accepted < 0.0) | (walk.opened[lane] > 0.0) | (walk.active[lane] == 0.0)
        here, known = curve[0, lane], scales.rounding[lane]
        scales.rounding[lane] = larger(0.0 if unknown else abs(here - before), known)
        scales.at_begin[lane], scales.at_end[lane] = here, curve[DEGREE, lane]


@routine
def compare_with_tolerance(
    figures: Figures, tolerance: float, only_integral: float, scales: Scales, walk: Walk
) -> bool:
    """Widen each lane's excess by that of a curve, but for its rounding.

    Parameters
    ----------
    figures : Figures
        Of the curve.
    tolerance : float
        What may be left, as a share of the greatest magnitude.
    only_integral : float
        1 where nothing but the curve's mean counts: then that is what something may be left of; else 0.
    scales : Scales
    walk : Walk

    Returns
    -------
    bool
        Whether a value in any lane's panel isn't finite.
    """
    broken = False
    for lane in range(LANES):
        scale = larger(figures.magnitude[lane], scales.greatest[lane])
        scales.greatest[lane] = scale
        # What is nothing but rounding doesn't tell how long a panel may be.
        rounding = larger(NOTHING * scale, LEFT_BY_ROUNDING * scales.rounding[lane])
        of_mean = figures.missing[lane] * abs(walk.half[lane]) * (2.0 / walk.range[lane])
        tail = figures.tail[lane] - rounding
        left = smaller(of_mean, tail) if only_integral > 0.0 else tail
        excess = larger(left, 0.0) / larger(tolerance * scale, TINY)
        flat = figures.flat[lane] > 0.0
        walk.excess[lane] = larger(0.0 if flat else excess, walk.excess[lane])
        walk.level[lane] = larger(excess if flat else 0.0, walk.level[lane])
        broken |= not abs(figures.sum[lane]) < math.inf
    return broken


@routine
def compare_root(curve: Rows, figures: Figures, tolerance: float, scales: Scales, walk: Walk) -> None:
    """Widen each lane's excess by that of the root of a curve that is nowhere negative.

    The less the curve is, the more its root is off.

    Parameters
    ----------
    curve : rows (POSITIONS, LANES)
    figures, tolerance, scales, walk
        As for `compare_with_tolerance`, which is called before.
    """
    for lane in range(LANES):
        scale, whole = scales.greatest[lane], figures.tail[lane]
        least = scale
        for j in range(POSITIONS):
            least = smaller(curve[j, lane], least)
        left = larger(whole - larger(NOTHING * scale, LEFT_BY_ROUNDING * scales.rounding[lane]), 0.0)
        off = left / (2.0 * math.sqrt(larger(least, larger(left, TINY))))
        excess = off / larger(tolerance * math.sqrt(scale), TINY)
        flat = figures.flat[lane] > 0.0
        walk.excess[lane] = larger(0.0 if flat else excess, walk.excess[lane])


@inlined
def sixteenth_root(x: float) -> float:
    """X to the power 1/16."""
    return math.sqrt(math.sqrt(math.sqrt(math.sqrt(x))))


@routine
def judge(longest: float, walk: Walk) -> bool:
    """Accept each lane's panel or not, and move those on that do; the length of the next follows from the excess.

    Returns
    -------
    bool
        Whether any lane's panel was accepted.
    """
    for lane in range(LANES):
        begin, end, falling, level = walk.begin[lane], walk.end[lane], walk.excess[lane], walk.level[lane]
        length, active, least = end - begin, walk.active[lane] > 0.0, FLOOR * walk.range[lane]
        shortest = length <= least * (1.0 + 2.0 * STRETCH)
        enough = ((falling <= 1.0) & (level <= 1.0)) | shortest | (walk.taken[lane] >= MOST)
        # What is level where that is little enough is rounding, and tells nothing of how long a panel may be.
        excess = falling if level <= 1.0 else larger(falling, level)
        factor = larger(smaller(sixteenth_root(AIM / larger(excess, 1e-9)), LONGER), SHORTER)
        wanted = larger(length * factor, least)
        # Where it isn't good enough for a kink inside, the next one ends there.
        sign, tries = walk.sign[lane], walk.tried[lane]
        bent = (not enough) & (sign < 1.0) & (tries < TRIES)
        kink = walk.kink[lane]
        walk.kink[lane] = begin + 0.5 * (1.0 + sign) * length if bent & active else kink
        walk.tried[lane] = tries + 1.0 if bent else (0.0 if enough else tries)
        # A short panel before an edge says little of how long the next may be.
        wanted = smaller(larger(wanted, walk.wanted[lane]) if excess <= AIM else wanted, longest)
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
