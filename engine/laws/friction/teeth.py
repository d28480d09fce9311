"""Losses between teeth, from the efficiency η of a mesh.

Power flows through a mesh with the speeds relative to its carrier. A moment M on a wheel, whose speed is r times that
of the driver, loads the driver with r M without losses; with losses, with r M/η where power flows to the wheel and η r
M where it comes from it. The force between the teeth is shifted from the pitch point along the line of centres by δ,
such that the moments on both wheels have that ratio: with the wheel's pitch radius ρ, measured from its axis, and the
driver's r ρ,

    (r ρ + δ)/(ρ + δ) = k r,   k = 1/η or η

Source: V. N. Kudryavtsev, Planetary Gears, chapter on efficiency (power in relative motion).
"""

from engine.compiling.decorators import scalar


@scalar
def lost_share(rolling: float, efficiency: float) -> float:
    """Factor k on the moment that loads a driver, due to losses between teeth.

    Parameters
    ----------
    rolling : float
        Power that a wheel takes from its driver, relative to the carrier, or a number of the same sign.
    efficiency : float
        η, between 0 and 1.
    """
    if rolling > 0.0:
        return 1.0 / efficiency
    return efficiency + 0.0 * rolling


@scalar
def shifted_contact(radius: float, ratio: float, k: float) -> float:
    """Distance from a wheel's axis, along the line of centres, at which the force between its teeth acts [m].

    Parameters
    ----------
    radius : float
        Signed radius ρ of the pitch circle [m].
    ratio : float
        Ratio r of the speeds relative to the carrier.
    k : float
        From `lost_share`.
    """
    return radius * (1.0 - ratio) / (1.0 - k * ratio)
