"""One mass under a force, or on a support, that changes linearly from row to row of a table: exactly, piece by piece.

In a piece that begins at t = 0 the force F = F₀ + F₁t, or the support at x = x₀ + x₁t, moves the mass by A + Bt,

    force:   B = F₁/k,   A = (F₀ − bB)/k;        support:   B = x₁,   A = x₀,

and about that it vibrates freely, q = A + Bt + u, ü + 2βu̇ + ω₀²u = 0. The spring is stretched by q, or by q − x = u.

Where q is greatest, B + u̇ = 0. The velocity u̇ is itself a free vibration, stationary every half period, so that
between two such instants B + u̇ vanishes once at the most. The tops of a vibration that drifts as it dies away fall at
first, if at all, and then rise, as Ce^(−βt) + Bt does: the greatest is one of the first or of the last.

Source: J. P. Den Hartog, Mechanical Vibrations, chapter 2; S. S. Rao, Mechanical Vibrations, chapter 4 (response to an
arbitrary excitation by pieces).
"""

import math

import numpy as np

from engine.compiling.decorators import driver, routine
from engine.cycle.roots import MOST_TURNS, newton_between
from engine.elements.oscillators.damped_vibration import damped_vibration, next_turn

# What an oscillator is given, and what is found; in this order in the tables.
STIFFNESS, MASS, RATIO, DISPLACEMENT, VELOCITY, HORIZON = range(6)
GREATEST, GREATEST_AT, STRETCH, STRETCH_AT, END, END_RATE, CARRIED = range(7)
FOUND = 7

# Half periods at either end of a piece in which its greatest displacement is looked for: of each sign two tops.
_ENDS = 4
# Half periods that can be counted.
_MOST = 2.0**52
# Of tops that are the same but for rounding, the first.
_HIGHER = 1.0 + 1e-11


@routine
def _when_it_turns(low: float, high: float, w: float, beta: float, u: float, v: float, drift: float) -> float:
    """When B + u̇ vanishes, which changes its sign once between two instants: Newton's method between bounds."""
    rises = drift + damped_vibration(w, beta, u, v, high)[1] > 0.0
    time = 0.5 * (low + high)
    for _ in range(MOST_TURNS):
        moved, rate = damped_vibration(w, beta, u, v, time)
        slope = -2.0 * beta * rate - w * w * moved
        time, low, high, settled = newton_between(time, drift + rate, slope, rises, low, high)
        if settled:
            break
    return time


@routine
def _greatest_in(
    length: float, w: float, beta: float, u: float, v: float, level: float, drift: float
) -> tuple[float, float]:
    """Greatest magnitude of A + Bt + u after the start of a piece, and when it is reached."""
    greatest, at = abs(level + drift * length + damped_vibration(w, beta, u, v, length)[0]), length
    first = next_turn(w, beta, v, -2.0 * beta * v - w * w * u)
    half = math.pi / math.sqrt((w - beta) * (w + beta)) if w > beta else math.inf
    # Between turning points of u̇: up to the first, by half periods, and from the last to the end of the piece.
    stretches = 1.0 if first >= length else min(2.0 + math.floor((length - first) / half), _MOST)
    j = 0.0
    while j < stretches:
        if j == _ENDS and stretches > 2 * _ENDS:
            j = stretches - _ENDS
        begin = 0.0 if j == 0.0 else first + (j - 1.0) * half if j > 1.0 else first
        end = min(length, first if j == 0.0 else first + j * half)
        if begin < end:
            before = drift + damped_vibration(w, beta, u, v, begin)[1]
            after = drift + damped_vibration(w, beta, u, v, end)[1]
            if (before > 0.0) != (after > 0.0):
                turn = _when_it_turns(begin, end, w, beta, u, v, drift)
                reached = abs(level + drift * turn + damped_vibration(w, beta, u, v, turn)[0])
                if reached > greatest * _HIGHER or (at > turn and reached * _HIGHER >= greatest):
                    greatest, at = reached, turn
        j += 1.0
    return greatest, at


@driver
def follow_pieces(
    begin: int,
    end: int,
    moves_support: bool,
    given: np.ndarray,
    rows: np.ndarray,
    found: np.ndarray,
    states: np.ndarray,
) -> None:
    """Follow oscillators `begin` … `end` − 1 through the pieces of what drives them.

    Parameters
    ----------
    begin, end : int
    moves_support : bool
        Whether the rows hold displacements of the support, instead of forces on the mass.
    given : ndarray (6, variants)
        STIFFNESS k, MASS m, damping RATIO ζ; DISPLACEMENT and VELOCITY at the start; HORIZON, the time it is followed.
    rows : ndarray (1 or variants, 2, rows)
        Times, ascending from 0, and forces or displacements; the last one stays.
    found : ndarray (FOUND, variants)
        Greatest magnitude of displacement and of the spring's stretch, each with its time; displacement and velocity at
        the horizon; the sum of displacements that rounding has acted on.
    states : ndarray (variants, kept, 3)
        Time, displacement and velocity at the begin of pieces, as many as there is room for; NaN behind the last.
    """
    for i in range(begin, end):
        k, horizon = given[STIFFNESS, i], given[HORIZON, i]
        w = math.sqrt(k / given[MASS, i])
        beta = given[RATIO, i] * w
        damping = 2.0 * beta * given[MASS, i]
        own = rows[min(i, rows.shape[0] - 1)]
        count = own.shape[1]
        q, rate, carried, kept = given[DISPLACEMENT, i], given[VELOCITY, i], 0.0, 0
        greatest, greatest_at = abs(q), 0.0
        stretch, stretch_at = abs(q - own[1, 0]) if moves_support else abs(q), 0.0
        for row in range(count):
            now = own[0, row]
            until = min(own[0, row + 1], horizon) if row < count - 1 else horizon
            length = until - now
            if not length > 0.0:
                continue
            level, slope = own[1, row], 0.0
            if row < count - 1:
                slope = (own[1, row + 1] - level) / (own[0, row + 1] - now)
            if not moves_support:
                slope /= k
                level = level / k - damping / k * slope
            if kept < states.shape[1]:
                states[i, kept, 0], states[i, kept, 1], states[i, kept, 2] = now, q, rate
                kept += 1
            u, v = q - level, rate - slope
            carried += abs(level) + abs(slope * length) + abs(q)
            top, at = _greatest_in(length, w, beta, u, v, level, slope)
            if top > greatest * _HIGHER:
                greatest, greatest_at = top, now + at
            if moves_support:
                top, at = _greatest_in(length, w, beta, u, v, 0.0, 0.0)
            if top > stretch * _HIGHER:
                stretch, stretch_at = top, now + at
            moved, moving = damped_vibration(w, beta, u, v, length)
            q, rate = level + slope * length + moved, slope + moving
        for row in range(kept, states.shape[1]):
            states[i, row, 0] = math.nan
        found[GREATEST, i], found[GREATEST_AT, i] = greatest, greatest_at
        found[STRETCH, i], found[STRETCH_AT, i] = stretch, stretch_at
        found[END, i], found[END_RATE, i], found[CARRIED, i] = q, rate, carried
