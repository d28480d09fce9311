"""Panels: each lane walks over its own range, from edge to edge, in panels as long as its curves allow.

All lanes take their next panel at the same time. A lane whose series has too much left beyond its last coefficient
takes a shorter panel from the same place in the next step, while the others go on. What is left falls with the 17th
power of a panel's length, which tells the length of the next one. The distance to the next edge is shared out equally.

What a lane does depends on nothing but the lane.
"""

import math

import numpy as np

from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, PLACES, POSITIONS
from engine.cycle.panels.lanes import Memory, any_positive, memory
from engine.cycle.panels.series import FLAT, MAGNITUDE, MISSING, SUM, TAIL, TINY, larger, smaller

# Rows of a walk. Along it, input positions count in the direction in which the input runs: BEGIN and END of the panel,
# the EDGE ahead, the LAST position, the length of the RANGE; edges nearer than CLOSE are one.
BEGIN, END, EDGE, LAST, RANGE, CLOSE = range(6)
# The length WANTED of the next panel, how many were TAKEN; DIRECTION 1 or −1; the panel's MIDDLE and HALF length as the
# machine's functions see them.
WANTED, TAKEN, DIRECTION, MIDDLE, HALF = range(6, 11)
# Whether the lane is still on its way; whether its panel is ACCEPTED, or there is NOTHING_BEFORE; what is left over
# what is tolerated, at most, of curves whose coefficients fall (EXCESS), and of those whose last ones are LEVEL.
ACTIVE, ACCEPTED, EXCESS, LEVEL = range(11, 15)
NOTHING_BEFORE = -1.0
# What the place may be off by of the edges where this panel begins, where the next one does, and of the edge AHEAD.
OPENED, NEXT_OPENED, AHEAD = range(15, 18)
# Where the next KINK is that a refused panel had inside, and how many panels in a row were refused for one. In the
# panel under way, the first place where a curve of kinks changes its SIGN, on [−1, 1], else infinity.
KINK, TRIED, SIGN = range(18, 21)
# How many edges lie behind.
BEHIND = 21
WALK = 22
# Of a curve: the greatest magnitude so far; by how much it differed so far where one panel ended and the next began, or
# began anew; its value at either end of the panel tried before.
GREATEST, ROUNDING, AT_BEGIN, AT_END = range(4)
SCALES = 4
of_scales = memory(SCALES, LANES)
# Parts of an edge: its place, and what that may be off by.
PLACE, PLACE_ERROR = range(2)
EDGES = 2
of_edges = memory(EDGES, LANES)

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
def set_out(first: Memory, last: Memory, longest: float, walk: Memory) -> None:
    """Begin a walk over each lane's range of the input; a lane whose range isn't finite has no panels."""
    for lane in range(LANES):
        direction = 1.0 if last[lane] >= first[lane] else -1.0
        begin, end = direction * first[lane], direction * last[lane]
        walk[DIRECTION, lane], walk[BEGIN, lane], walk[LAST, lane] = direction, begin, end
        walk[WANTED, lane], walk[TAKEN, lane], walk[END, lane] = longest, 0.0, begin
        walk[RANGE, lane] = end - begin
        walk[CLOSE, lane] = ONE_EDGE * larger(abs(begin), abs(end))
        walk[MIDDLE, lane], walk[HALF, lane] = first[lane], 0.0
        walk[TRIED, lane] = walk[BEHIND, lane] = 0.0
        walk[KINK, lane] = math.inf
        walk[ACCEPTED, lane] = NOTHING_BEFORE
        walk[OPENED, lane] = walk[NEXT_OPENED, lane] = 0.0
        walk[ACTIVE, lane] = 1.0 if end - begin < math.inf and end > begin else 0.0


@routine
def next_panels(edges: Memory, count: int, walk: Memory) -> bool:
    """Lay each lane's next panel.

    Parameters
    ----------
    edges : rows (edges, EDGES, LANES)
        Positions that no panel may have inside, in the direction of the walk and in order, infinite for none; what they
        may be off by.
    count : int
        Number of rows of `edges` that are used.
    walk : rows (WALK, LANES)

    Returns
    -------
    bool
        Whether any lane is still on its way; lanes that aren't keep their last panel.
    """
    for lane in range(LANES):
        begin, last, kink = walk[BEGIN, lane], walk[LAST, lane], walk[KINK, lane]
        bent = (kink > begin + walk[CLOSE, lane]) & (kink < last)
        walk[EDGE, lane], walk[AHEAD, lane] = kink if bent else last, walk[CLOSE, lane] if bent else 0.0
        walk[OPENED, lane] = walk[NEXT_OPENED, lane]
    if count > 0:
        for lane in range(LANES):
            behind, close, ahead = int(walk[BEHIND, lane]), walk[CLOSE, lane], walk[EDGE, lane]
            while behind < count and edges[behind, PLACE, lane] <= walk[BEGIN, lane] + close:
                behind += 1
            walk[BEHIND, lane] = behind
            if behind < count and edges[behind, PLACE, lane] < smaller(ahead, walk[LAST, lane] - close):
                walk[EDGE, lane], walk[AHEAD, lane] = edges[behind, PLACE, lane], edges[behind, PLACE_ERROR, lane]
    for lane in range(LANES):
        begin, edge, active = walk[BEGIN, lane], walk[EDGE, lane], walk[ACTIVE, lane] > 0.0
        # A lane that has taken as many as it may goes on in a few long ones.
        wanted = walk[WANTED, lane] if walk[TAKEN, lane] < MOST else LAST_ONES * walk[RANGE, lane]
        pieces = np.ceil((edge - begin) / wanted * (1.0 - STRETCH))
        at_once = pieces <= 1.0
        end = edge if at_once else begin + (edge - begin) / pieces
        direction, end_before = walk[DIRECTION, lane], walk[END, lane]
        middle_before, half_before = walk[MIDDLE, lane], walk[HALF, lane]
        walk[END, lane] = end if active else end_before
        walk[MIDDLE, lane] = direction * (0.5 * (begin + end)) if active else middle_before
        walk[HALF, lane] = direction * (0.5 * (end - begin)) if active else half_before
        walk[EXCESS, lane] = walk[LEVEL, lane] = 0.0
        walk[SIGN, lane] = math.inf
    return any_positive(walk[ACTIVE])


@routine
def find_kink(tile: Memory, curve: int, walk: Memory) -> None:
    """Note where a curve at whose zeros others bend first changes its sign in each lane's panel.

    Parameters
    ----------
    tile : panels (curves, POSITIONS, LANES)
    curve : int
    walk : rows (WALK, LANES)
    """
    for i in range(DEGREE):
        j = DEGREE - 1 - i
        for lane in range(LANES):
            here, there, known = tile[curve, j, lane], tile[curve, j + 1, lane], walk[SIGN, lane]
            place = PLACES[j] + (PLACES[j + 1] - PLACES[j]) * (here / (here - there))
            walk[SIGN, lane] = place if (here * there < 0.0) & (place < known) else known


@routine
def note_rounding(tile: Memory, row: int, scales: Memory, curve: int, walk: Memory) -> None:
    """Widen each lane's rounding of a curve by how much it differs from before where its panel begins.

    Parameters
    ----------
    tile : panels (curves, POSITIONS, LANES)
    row : int
        Of the curve in the tile.
    scales : rows (curves, SCALES, LANES)
    curve : int
        Row of the scales.
    walk : rows (WALK, LANES)
    """
    for lane in range(LANES):
        accepted = walk[ACCEPTED, lane]
        before = scales[curve, AT_END, lane] if accepted > 0.0 else scales[curve, AT_BEGIN, lane]
        # At a cut or a kink a curve may jump; lanes that have arrived stay where they are.
        unknown = (accepted < 0.0) | (walk[OPENED, lane] > 0.0) | (walk[ACTIVE, lane] == 0.0)
        here, known = tile[row, 0, lane], scales[curve, ROUNDING, lane]
        scales[curve, ROUNDING, lane] = larger(0.0 if unknown else abs(here - before), known)
        scales[curve, AT_BEGIN, lane], scales[curve, AT_END, lane] = here, tile[row, DEGREE, lane]


@routine
def compare_with_tolerance(
    figures: Memory, curve: int, tolerance: float, only_integral: float, scales: Memory, walk: Memory
) -> bool:
    """Widen each lane's excess by that of a curve, but for its rounding.

    Parameters
    ----------
    figures : rows (curves, FIGURES, LANES)
    curve : int
    tolerance : float
        What may be left, as a share of the greatest magnitude.
    only_integral : float
        1 where nothing but the curve's mean counts: then that is what something may be left of; else 0.
    scales : rows (curves, SCALES, LANES)
    walk : rows (WALK, LANES)

    Returns
    -------
    bool
        Whether a value in any lane's panel isn't finite.
    """
    broken = False
    for lane in range(LANES):
        scale = larger(figures[curve, MAGNITUDE, lane], scales[curve, GREATEST, lane])
        scales[curve, GREATEST, lane] = scale
        # What is nothing but rounding doesn't tell how long a panel may be.
        rounding = larger(NOTHING * scale, LEFT_BY_ROUNDING * scales[curve, ROUNDING, lane])
        of_mean = figures[curve, MISSING, lane] * abs(walk[HALF, lane]) * (2.0 / walk[RANGE, lane])
        tail = figures[curve, TAIL, lane] - rounding
        left = smaller(of_mean, tail) if only_integral > 0.0 else tail
        excess = larger(left, 0.0) / larger(tolerance * scale, TINY)
        flat = figures[curve, FLAT, lane] > 0.0
        walk[EXCESS, lane] = larger(0.0 if flat else excess, walk[EXCESS, lane])
        walk[LEVEL, lane] = larger(excess if flat else 0.0, walk[LEVEL, lane])
        broken |= not abs(figures[curve, SUM, lane]) < math.inf
    return broken


@routine
def compare_root(tile: Memory, figures: Memory, curve: int, tolerance: float, scales: Memory, walk: Memory) -> None:
    """Widen each lane's excess by that of the root of a curve that is nowhere negative.

    The less the curve is, the more its root is off.

    Parameters
    ----------
    tile : panels (curves, POSITIONS, LANES)
    figures, curve, tolerance, scales, walk
        As of `compare_with_tolerance`, which is called before.
    """
    for lane in range(LANES):
        scale, whole = scales[curve, GREATEST, lane], figures[curve, TAIL, lane]
        least = scale
        for j in range(POSITIONS):
            least = smaller(tile[curve, j, lane], least)
        left = larger(whole - larger(NOTHING * scale, LEFT_BY_ROUNDING * scales[curve, ROUNDING, lane]), 0.0)
        off = left / (2.0 * math.sqrt(larger(least, larger(left, TINY))))
        excess = off / larger(tolerance * math.sqrt(scale), TINY)
        flat = figures[curve, FLAT, lane] > 0.0
        walk[EXCESS, lane] = larger(0.0 if flat else excess, walk[EXCESS, lane])


@inlined
def sixteenth_root(x: float) -> float:
    """X to the power 1/16."""
    return math.sqrt(math.sqrt(math.sqrt(math.sqrt(x))))


@routine
def judge(longest: float, walk: Memory) -> bool:
    """Accept each lane's panel or not, and move those on that do; the length of the next follows from the excess.

    Returns
    -------
    bool
        Whether any lane's panel was accepted.
    """
    for lane in range(LANES):
        begin, end, falling, level = walk[BEGIN, lane], walk[END, lane], walk[EXCESS, lane], walk[LEVEL, lane]
        length, active, least = end - begin, walk[ACTIVE, lane] > 0.0, FLOOR * walk[RANGE, lane]
        shortest = length <= least * (1.0 + 2.0 * STRETCH)
        enough = ((falling <= 1.0) & (level <= 1.0)) | shortest | (walk[TAKEN, lane] >= MOST)
        # What is level where that is little enough is rounding, and tells nothing of how long a panel may be.
        excess = falling if level <= 1.0 else larger(falling, level)
        factor = larger(smaller(sixteenth_root(AIM / larger(excess, 1e-9)), LONGER), SHORTER)
        wanted = larger(length * factor, least)
        # Where it isn't good enough for a kink inside, the next one ends there.
        sign, tries = walk[SIGN, lane], walk[TRIED, lane]
        bent = (not enough) & (sign < 1.0) & (tries < TRIES)
        kink = walk[KINK, lane]
        walk[KINK, lane] = begin + 0.5 * (1.0 + sign) * length if bent & active else kink
        walk[TRIED, lane] = tries + 1.0 if bent else (0.0 if enough else tries)
        # A short panel before an edge says little of how long the next may be.
        wanted = smaller(larger(wanted, walk[WANTED, lane]) if excess <= AIM else wanted, longest)
        accepted, wanted_before, opened_before = active & enough, walk[WANTED, lane], walk[OPENED, lane]
        wanted = wanted_before if bent else wanted
        walk[WANTED, lane] = wanted if active else wanted_before
        walk[ACCEPTED, lane] = 1.0 if accepted else 0.0
        walk[TAKEN, lane] += 1.0 if accepted else 0.0
        walk[BEGIN, lane] = end if accepted else begin
        opened = walk[AHEAD, lane] if end == walk[EDGE, lane] else 0.0
        walk[NEXT_OPENED, lane] = opened if accepted else opened_before
        walk[ACTIVE, lane] = 1.0 if active & ((not enough) | (end < walk[LAST, lane])) else 0.0
    return any_positive(walk[ACCEPTED])
