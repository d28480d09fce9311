"""Exact response of one mass to a force or support motion that is linear between the rows of a table.

In a piece that starts at t = 0 the force F = F₀ + F₁t, or the support motion x = x₀ + x₁t, has the particular solution
A + Bt,

    force:   B = F₁/k,   A = (F₀ − bB)/k;        support:   B = x₁,   A = x₀,

to which a free vibration is added: q = A + Bt + u, ü + 2βu̇ + ω₀²u = 0. The spring is stretched by q, or by q − x = u.

At the extremes of q, B + u̇ = 0. The velocity u̇ is itself a free vibration with a stationary point every half period,
so that B + u̇ vanishes at most once between two of them. The successive maxima of a decaying vibration with a drift
first fall, if at all, and then rise, as Ce^(−βt) + Bt does: the largest is one of the first or of the last.

Source: J. P. Den Hartog, Mechanical Vibrations, chapter 2; S. S. Rao, Mechanical Vibrations, chapter 4 (response to an
arbitrary excitation by pieces).
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.running import over_variants
from engine.elements.oscillators.damped_vibration import damped_vibration, next_turn
from engine.laws.rounding import MOST_TURNS, newton_between

# Half periods searched for the peak at either end of a piece: two extremes of each sign.
_ENDS = 4
# Largest number of half periods that can be counted.
_MOST = 2.0**52
# Ties within rounding go to the earlier peak.
_HIGHER = 1.0 + 1e-11


class Oscillators(NamedTuple):
    """One mass on a spring for each variant; every attribute is an ndarray (variants,).

    Attributes
    ----------
    stiffness, mass, damping_ratio : ndarray
        k [N/m], m [kg], ζ.
    displacement, velocity : ndarray
        At the start [m], [m/s].
    horizon : ndarray
        Duration of the motion [s].
    """

    stiffness: np.ndarray
    mass: np.ndarray
    damping_ratio: np.ndarray
    displacement: np.ndarray
    velocity: np.ndarray
    horizon: np.ndarray


class Response(NamedTuple):
    """Peaks of an oscillator's motion, and its state at the horizon; every attribute is an ndarray (variants,).

    Attributes
    ----------
    displacement, displacement_at : ndarray
        Peak magnitude [m] and its time [s].
    stretch, stretch_at : ndarray
        The same for the stretch of the spring.
    end, end_velocity : ndarray
        Displacement [m] and velocity [m/s] at the horizon.
    rounded : ndarray
        Sum of the displacements that rounding acts on [m].
    """

    displacement: np.ndarray
    displacement_at: np.ndarray
    stretch: np.ndarray
    stretch_at: np.ndarray
    end: np.ndarray
    end_velocity: np.ndarray
    rounded: np.ndarray


@routine
def _when_it_turns(low: float, high: float, w: float, beta: float, u: float, v: float, drift: float) -> float:
    """Root of B + u̇, which changes its sign once between two instants, by Newton's method within the bracket."""
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
    """Peak magnitude of A + Bt + u after the start of a piece, and its time."""
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


@over_variants
def follow_pieces(
    begin: int,
    end: int,
    moves_support: bool,
    oscillators: Oscillators,
    rows: np.ndarray,
    found: Response,
    states: np.ndarray,
) -> None:
    """Compute oscillators `begin` … `end` − 1 through the pieces of their excitation.

    Parameters
    ----------
    begin, end : int
    moves_support : bool
        Whether the rows are displacements of the support instead of forces on the mass.
    oscillators : Oscillators
    rows : ndarray (1 or variants, 2, rows)
        Times, ascending from 0, and forces or displacements; the last value stays.
    found : Response
        Output.
    states : ndarray (variants, kept, 3)
        Output: time, displacement and velocity at the start of the first `kept` pieces; the time is NaN past the last.
    """
    for i in range(begin, end):
        k, mass, horizon = oscillators.stiffness[i], oscillators.mass[i], oscillators.horizon[i]
        w = math.sqrt(k / mass)
        beta = oscillators.damping_ratio[i] * w
        damping = 2.0 * beta * mass
        own = rows[min(i, rows.shape[0] - 1)]
        count = own.shape[1]
        q, rate, rounded, kept = oscillators.displacement[i], oscillators.velocity[i], 0.0, 0
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
            # A velocity moves the mass by at most v/ω₀, and less with strong damping.
            rounded += abs(level) + abs(slope * length) + abs(q) + (abs(rate) + abs(slope)) / (w + beta)
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
        found.displacement[i], found.displacement_at[i] = greatest, greatest_at
        found.stretch[i], found.stretch_at[i] = stretch, stretch_at
        found.end[i], found.end_velocity[i], found.rounded[i] = q, rate, rounded
