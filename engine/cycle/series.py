"""The Chebyshev series of a curve within a panel: its integral, what is missing beyond degree 16, its values anywhere.

The coefficients of a smooth curve fall by a constant factor in the end. By how much the last four are below the four
before them tells what the next ones would be. Those also tell how far the integral is off, of which far less is missed:
the rule for degree 16 is nearly exact for the next few. Where coefficients don't fall, as what is left is rounding or
something within the panel bends or jumps, no fall faster than SLOWEST is taken for granted.
"""

from engine.cycle.chebyshev import DEGREE, EVEN, MIDDLE, MISSED, ODD, WEIGHTS
from engine.cycle.compiling import routine, scalar
from engine.cycle.lanes import LANES, Memory, memory

# Rows of a panel's figures: sum over the positions with the weights of the integral over [−1, 1]; what of the curve and
# of that integral lies beyond degree 16; greatest magnitude; whether coefficients don't fall at all (1 or 0).
SUM, TAIL, MISSING, MAGNITUDE, NOISE = range(5)
FIGURES = 5
of_figures = memory(FIGURES, LANES)

# Share by which four coefficients fall against four before them at the least.
SLOWEST = 0.65
# Last coefficients this share of half the range of the values or more are rounding: those of a jump are a third of it.
NOISY = 0.15
MARGIN = 4.0
TINY = 1e-300


@scalar
def larger(a: float, b: float) -> float:
    """The larger of two numbers in one instruction; b where either is NaN."""
    return a if a > b else b


@scalar
def smaller(a: float, b: float) -> float:
    """The smaller of two numbers in one instruction; b where either is NaN."""
    return a if a < b else b


@routine
def panel_figures(tile: Memory, curve: int, figures: Memory) -> None:
    """Figures of a curve in each lane's panel.

    Parameters
    ----------
    tile : panels (curves, positions, LANES)
    curve : int
    figures : rows (curves, FIGURES, LANES)
        Receives them in the curve's rows.
    """
    for lane in range(LANES):
        total = WEIGHTS[MIDDLE] * tile[curve, MIDDLE, lane]
        low = high = tile[curve, MIDDLE, lane]
        for j in range(MIDDLE):
            total += WEIGHTS[j] * (tile[curve, j, lane] + tile[curve, DEGREE - j, lane])
            low = smaller(smaller(tile[curve, j, lane], tile[curve, DEGREE - j, lane]), low)
            high = larger(larger(tile[curve, j, lane], tile[curve, DEGREE - j, lane]), high)
        last = before = 0.0
        for i in range(5, 9):
            even = EVEN[i, MIDDLE] * tile[curve, MIDDLE, lane]
            odd = 0.0
            for j in range(MIDDLE):
                even += EVEN[i, j] * (tile[curve, j, lane] + tile[curve, DEGREE - j, lane])
                odd += ODD[i - 1, j] * (tile[curve, j, lane] - tile[curve, DEGREE - j, lane])
            pair = larger(abs(even), abs(odd))
            if i < 7:
                before = larger(pair, before)
            else:
                last = larger(pair, last)
        fall = last / larger(before, larger(last * (1.0 / SLOWEST), TINY))
        figures[curve, SUM, lane] = total
        figures[curve, TAIL, lane] = 4.0 * last * fall * (1.0 + fall * (1.0 + fall * (1.0 + fall * 3.0)))
        missing = fall * (MISSED[0] + fall * (MISSED[1] + fall * (MISSED[2] + fall * MISSED[3])))
        figures[curve, MISSING, lane] = MARGIN * last * missing
        figures[curve, MAGNITUDE, lane] = larger(abs(low), abs(high))
        figures[curve, NOISE, lane] = 1.0 if last > NOISY * 0.5 * (high - low) else 0.0
