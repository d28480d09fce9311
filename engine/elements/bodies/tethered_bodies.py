"""A body on an elastic tie about a fixed point: its greatest pull after an impulse, beside that of a slow spin-up.

Set off across the tie of length r₀ with the speed v, the body goes straight on and stretches the tie until that turns
it. Moment of momentum and energy are kept, m v r₀ = m r² φ̇ and ½m v² = ½m(r φ̇)² + ½c(r − r₀)² where r is greatest;
with x = (r − r₀)/r₀ and κ = c r₀²/(m v²)

    κ x (1 + x)² = 2 + x,   F = c r₀ x.

Spun up slowly, to the speed v on its circle, the tie pulls with F = m v²/r = c(r − r₀). A stiff tie is pulled by an
impulse with 2mv²/r₀, twice as much. It bursts where F is its strength, which sets v; with a tie that gives way the
speed by impulse comes nearer to that by spin-up.

Source: J. P. Den Hartog, Mechanics (conservation of energy and of moment of momentum).
"""

from collections.abc import Mapping

import numpy as np

from engine.elements.bodies.body_elements import TetheredBody
from engine.elements.element_laws import ElementResult, LawOfArrays, with_nudges

_KEYS = ("mass", "length", "stiffness", "strength", "speed")
_ROUNDS = 100
_RESULTS = (
    ElementResult("impulse", "impulse that gives the speed at once", "N s"),
    ElementResult("impulse_stretch", "greatest stretch of the tie after the impulse", "m"),
    ElementResult("impulse_force", "greatest force in the tie after the impulse", "N"),
    ElementResult("spin_up_stretch", "stretch of the tie, spun up slowly to the speed", "m"),
    ElementResult("spin_up_force", "force in the tie, spun up slowly to the speed", "N"),
    ElementResult("dynamic_factor", "greatest force after the impulse over that of a slow spin-up", "1"),
    ElementResult("impulse_burst_speed", "speed at which the tie bursts, given by an impulse", "m s-1"),
    ElementResult("spin_up_burst_speed", "speed at which the tie bursts, spun up slowly", "m s-1"),
    ElementResult("bursts_by_impulse", "whether the impulse bursts the tie (1 or 0)", "1", exact=True),
    ElementResult("bursts_by_spin_up", "whether a slow spin-up to the speed bursts the tie (1 or 0)", "1", exact=True),
)


def tethered_body_law(element: TetheredBody) -> LawOfArrays:
    """The law of a body on an elastic tie.

    Parameters
    ----------
    element : TetheredBody
        Its numbers are not used.
    """

    def rows(table: np.ndarray) -> np.ndarray:
        return _tethered(dict(zip(_KEYS, table, strict=True)))

    return LawOfArrays(with_nudges(rows), lambda given_element, given: tuple(given(key) for key in _KEYS), _RESULTS)


def _relative_stretch(stiffness: np.ndarray) -> np.ndarray:
    """The x of κ x (1 + x)² = 2 + x, by Newton's method from above the only root, where it is convex."""
    # At 2/κ, and at 1/√κ, the left side is the greater one.
    x = np.minimum(2.0 / stiffness, 1.0 / np.sqrt(stiffness))
    for _ in range(_ROUNDS):
        over = stiffness * x * (1.0 + x) ** 2 - 2.0 - x
        new = x - over / (stiffness * (1.0 + x) * (1.0 + 3.0 * x) - 1.0)
        if np.all(np.abs(new - x) <= 4e-16 * x):
            break
        x = new
    return x


def _tethered(n: Mapping[str, np.ndarray]) -> np.ndarray:
    mass, length, stiffness, strength, speed = (n[key] for key in _KEYS)
    stretch = length * _relative_stretch(stiffness * length**2 / (mass * speed**2))
    # The positive root of c y² + c r₀ y − m v² = 0.
    taut, doubled = stiffness * length, 2.0 * mass * speed**2
    slow = doubled / (taut + np.sqrt(taut**2 + 2.0 * stiffness * doubled))
    last = strength / stiffness
    by_spin_up = np.sqrt(strength * (length + last) / mass)
    by_impulse = (length + last) * np.sqrt(strength / (mass * (2.0 * length + last)))
    return np.stack(
        [
            mass * speed,
            stretch,
            stiffness * stretch,
            slow,
            stiffness * slow,
            stretch / slow,
            by_impulse,
            by_spin_up,
            (speed > by_impulse).astype(float),
            (speed > by_spin_up).astype(float),
        ]
    )
