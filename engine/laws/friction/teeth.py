"""Losses between teeth, as a mesh's efficiency tells them: η of what rolls through it is left.

Power rolls through a mesh by the speeds relative to its carrier. Of moments M on a wheel, with the ratio r of its speed
to that of the driver, r M loads the driver without losses; with them r M/η where power goes to the wheel, η r M where
it comes from it. The force between the teeth takes hold beside the pitch point, on the line of centres, so far away, δ,
that the moments on both wheels have that ratio: with the wheel's pitch radius ρ, measured from its axis, and the
driver's r ρ,

    (r ρ + δ)/(ρ + δ) = k r,   k = 1/η or η

Source: V. N. Kudryavtsev, Planetary Gears, chapter on efficiency (power in relative motion).
"""

from engine.compiling.decorators import scalar


@scalar
def lost_share(rolling: float, efficiency: float) -> float:
    """By how much the moment that loads a driver is changed by losses between teeth.

    Parameters
    ----------
    rolling : float
        Power that a wheel takes from its driver, relative to the carrier, or what has its sign.
    efficiency : float
        η, between 0 and 1.
    """
    if rolling > 0.0:
        return 1.0 / efficiency
    return efficiency + 0.0 * rolling


@scalar
def shifted_contact(radius: float, ratio: float, k: float) -> float:
    """Distance from a wheel's axis, along the line of centres, at which the force between its teeth takes hold [m].

    Parameters
    ----------
    radius : float
        Of the pitch circle, signed ρ [m].
    ratio : float
        Of the speeds relative to the carrier, r.
    k : float
        From `lost_share`.
    """
    return radius * (1.0 - ratio) / (1.0 - k * ratio)
