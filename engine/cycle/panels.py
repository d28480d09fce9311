"""Panels: each lane walks over its own range, from edge to edge, in panels as long as its curves allow.

All lanes take their next panel at the same time. A lane whose series has too much left beyond its last coefficient
takes a shorter panel from the same place in the next step, while the others go on. What is left falls with the 17th
power of a panel's length, which tells the length of the next one. The distance to the next edge is shared out equally.

What a lane does depends on nothing but the lane.
"""

import math

from engine.cycle.chebyshev import DEGREE
from engine.cycle.compiling import routine, scalar
from engine.cycle.lanes import LANES, Memory, memory
from engine.cycle.series import FLAT as FLAT_FIGURE
from engine.cycle.series import MAGNITUDE, SUM, TAIL, TINY, larger, smaller

# Rows of a walk. Along it, input positions count in the direction in which the input runs: BEGIN and END of the panel,
# the EDGE ahead, the LAST position, the length of the RANGE; edges nearer than CLOSE are one.
BEGIN, END, EDGE, LAST, RANGE, CLOSE = range(6)
# The length WANTED of the next panel, how many were TAKEN; DIRECTION 1 or −1; the panel's MIDDLE and HALF length as the
# machine's functions see them.
WANTED, TAKEN, DIRECTION, MIDDLE, HALF = range(6, 11)
# Whether the lane is still on its way; whether its panel is ACCEPTED; EXCESS of what is left over what is tolerated,
# that of one curve NOW; whether the last coefficients of this are FLAT, and how often it TURNS.
ACTIVE, ACCEPTED, EXCESS, NOW, FLAT, TURNS = range(11, 17)
# What the place may be off by of the edges where this panel begins, where the next one does, and of the edge AHEAD.
OPENED, NEXT_OPENED, AHEAD = range(17, 20)
WALK = 20
# Parts of an edge: its place, and what that may be off by.
PLACE, PLACE_ERROR = range(2)
EDGES = 2
of_edges = memory(EDGES, LANES)

# A panel is made this much shorter, of its length, or longer than the one before, at most.
SHORTER, LONGER = 0.25, 1.5
# Share of the tolerance that a panel's length is chosen for.
AIM = 0.2
# Least length of a panel as a share of the range, and most panels a lane takes before it goes on from edge to edge.
FLOOR, MOST = 1e-7, 200
# Coefficients that are level are taken for rounding in panels no longer than this share of the longest, which a wave
# would have been resolved by, where what is left is this small a share of the greatest magnitude, or where the curve
# turns at so many positions, as a narrow peak doesn't.
SHORT, SMALL, RESTLESS = 0.25, 1e-7, 6.0
# Edges that are closer than this share of the greatest position are one.
SAME = 2e-15


@routine
def set_out(first: Memory, last: Memory, longest: float, walk: Memory) -> None:
    """Begin a walk over each lane's range of the input; a lane whose range isn't finite has no panels."""
    for lane in range(LANES):
        direction = 1.0 if last[lane] >= first[lane] else -1.0
        begin, end = direction * first[lane], direction * last[lane]
        walk[DIRECTION, lane], walk[BEGIN, lane], walk[LAST, lane] = direction, begin, end
        walk[WANTED, lane], walk[TAKEN, lane], walk[END, lane] = longest, 0.0, begin
        walk[RANGE, lane] = end - begin
        walk[CLOSE, lane] = SAME * larger(abs(begin), abs(end))
        walk[MIDDLE, lane], walk[HALF, lane] = first[lane], 0.0
        walk[ACCEPTED, lane] = walk[OPENED, lane] = walk[NEXT_OPENED, lane] = 0.0
        walk[ACTIVE, lane] = 1.0 if end - begin < math.inf and end > begin else 0.0


@routine
def next_panels(edges: Memory, count: int, walk: Memory) -> bool:
    """Lay each lane's next panel.

    Parameters
    ----------
    edges : rows (edges, EDGES, LANES)
        Positions that no panel may have inside, in any order, in the direction of the walk, NaN for none; what they may
        be off by.
    count : int
        Number of rows of `edges` that are used.
    walk : rows (WALK, LANES)

    Returns
    -------
    bool
        Whether any lane is still on its way; lanes that aren't keep their last panel.
    """
    for lane in range(LANES):
        walk[EDGE, lane], walk[AHEAD, lane] = walk[LAST, lane], 0.0
        walk[OPENED, lane] = walk[NEXT_OPENED, lane]
    for e in range(count):
        for lane in range(LANES):
            edge, close = edges[e, PLACE, lane], walk[CLOSE, lane]
            ahead = (edge > walk[BEGIN, lane] + close) & (edge < walk[LAST, lane] - close)
            nearest = ahead & (edge < walk[EDGE, lane])
            walk[EDGE, lane] = edge if nearest else walk[EDGE, lane]
            walk[AHEAD, lane] = edges[e, PLACE_ERROR, lane] if nearest else walk[AHEAD, lane]
    going = False
    for lane in range(LANES):
        begin, edge, active = walk[BEGIN, lane], walk[EDGE, lane], walk[ACTIVE, lane] > 0.0
        pieces = math.ceil((edge - begin) / walk[WANTED, lane] * (1.0 - 1e-9))
        at_once = (pieces <= 1.0) | (walk[TAKEN, lane] >= MOST)
        end = edge if at_once else begin + (edge - begin) / pieces
        direction = walk[DIRECTION, lane]
        walk[END, lane] = end if active else walk[END, lane]
        walk[MIDDLE, lane] = direction * (0.5 * (begin + end)) if active else walk[MIDDLE, lane]
        walk[HALF, lane] = direction * (0.5 * (end - begin)) if active else walk[HALF, lane]
        walk[EXCESS, lane] = 0.0
        going |= active
    return going


@routine
def forgive_noise(tile: Memory, curve: int, walk: Memory) -> None:
    """Take no offence at what is left of a curve in panels where it goes up and down from position to position."""
    for lane in range(LANES):
        walk[TURNS, lane] = 0.0
    for j in range(1, DEGREE):
        for lane in range(LANES):
            here = tile[curve, j, lane]
            turns = (here - tile[curve, j - 1, lane]) * (tile[curve, j + 1, lane] - here) < 0.0
            walk[TURNS, lane] += 1.0 if turns else 0.0
    for lane in range(LANES):
        noise = (walk[FLAT, lane] > 0.0) & (walk[TURNS, lane] >= RESTLESS)
        walk[NOW, lane] = 0.0 if noise else walk[NOW, lane]


@routine
def compare_with_tolerance(
    tile: Memory, figures: Memory, curve: int, tolerance: float, longest: float, scales: Memory, walk: Memory
) -> bool:
    """Widen each lane's excess by that of a curve.

    Parameters
    ----------
    tile : panels (curves, POSITIONS, LANES)
    figures : rows (curves, FIGURES, LANES)
    curve : int
    tolerance : float
        What may be left, as a share of the greatest magnitude.
    longest : float
        Longest panel.
    scales : rows (curves, LANES)
        Greatest magnitudes so far.
    walk : rows (WALK, LANES)

    Returns
    -------
    bool
        Whether a value in any lane's panel isn't finite.
    """
    broken = restless = False
    for lane in range(LANES):
        scale = larger(figures[curve, MAGNITUDE, lane], scales[curve, lane])
        scales[curve, lane] = scale
        excess = figures[curve, TAIL, lane] / larger(tolerance * scale, TINY)
        short = abs(walk[HALF, lane]) <= 0.5 * SHORT * longest
        flat = (figures[curve, FLAT_FIGURE, lane] > 0.0) & short & (excess > 1.0)
        walk[NOW, lane] = 0.0 if flat & (excess * tolerance <= SMALL) else excess
        walk[FLAT, lane] = 1.0 if flat else 0.0
        restless |= flat
        broken |= not abs(figures[curve, SUM, lane]) < math.inf
    if restless:
        forgive_noise(tile, curve, walk)
    for lane in range(LANES):
        walk[EXCESS, lane] = larger(walk[NOW, lane], walk[EXCESS, lane])
    return broken


@scalar
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
    any_accepted = False
    for lane in range(LANES):
        begin, end, excess = walk[BEGIN, lane], walk[END, lane], walk[EXCESS, lane]
        length, active = end - begin, walk[ACTIVE, lane] > 0.0
        least = FLOOR * walk[RANGE, lane]
        enough = (excess <= 1.0) | (length <= least) | (walk[TAKEN, lane] >= MOST)
        factor = sixteenth_root(AIM / larger(excess, 1e-9))
        factor = larger(smaller(factor, LONGER), SHORTER)
        wanted = larger(length * factor, least)
        # A short panel before an edge says little of how long the next may be.
        wanted = larger(wanted, walk[WANTED, lane]) if excess <= AIM else wanted
        accepted = active & enough
        walk[WANTED, lane] = smaller(wanted, longest) if active else walk[WANTED, lane]
        walk[ACCEPTED, lane] = 1.0 if accepted else 0.0
        walk[TAKEN, lane] += 1.0 if accepted else 0.0
        walk[BEGIN, lane] = end if accepted else begin
        opened = walk[AHEAD, lane] if end == walk[EDGE, lane] else 0.0
        walk[NEXT_OPENED, lane] = opened if accepted else walk[OPENED, lane]
        walk[ACTIVE, lane] = 1.0 if active & ((not enough) | (end < walk[LAST, lane])) else 0.0
        any_accepted |= accepted
    return any_accepted
