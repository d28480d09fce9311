"""Motion of a governor and its engine, by Lagrange's equations for the governor's position x and the engine's angle.

The kinetic energy is ½ A(x) ẋ² + ½ (I + i² J(x)) ω², where J = 2 m r² is the inertia of the balls about the spindle,
which turns i times as fast as the engine with speed ω. Primes are derivatives by x; see
`engine.elements.governors.governor_forces`:

    A ẍ + ½ A' ẋ² = ½ i² ω² J' − V' − z' (b z' ẋ + F sgn ẋ),   (I + i² J) ω̇ + i² J' ẋ ω = M_d − M_c
"""

import math

import numpy as np

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen


@scalar
def releasing_speeds(place: float, speed: float, held: float) -> tuple[float, float]:
    """Engine speeds above which a resting sleeve rises and below which it falls: ω √(1 ± F/E).

    Parameters
    ----------
    place : float
        Of the sleeve: 0 at the inner stop, 1 at the outer one; infinite speeds are returned where a stop blocks it.
    speed, held : float
        ω of the engine in equilibrium without friction [rad/s]; F/E.
    """
    rises, falls = speed * math.sqrt(1.0 + held), speed * math.sqrt(1.0 - min(held, 1.0))
    return chosen(place < 1.0, rises, math.inf), chosen(place > 0.0, falls, -math.inf)


@scalar
def released(speed: float, rises: float, falls: float) -> float:
    """Sense in which a sleeve at rest sets off: +1 upwards, −1 downwards, 0 if it stays; see `releasing_speeds`."""
    return chosen(speed > rises, 1.0, chosen(speed < falls, -1.0, 0.0))


@scalar
def holding_margin(sense: float, speed: float, rises: float, falls: float) -> float:
    """Change of the engine speed that releases a sleeve at rest; infinite for one that moves."""
    return chosen(sense == 0.0, min(rises - speed, speed - falls), math.inf)


@scalar
def room_ahead(sense: float, room: float) -> float:
    """Distance to a stop for a sleeve that moves towards it, `sense` > 0; otherwise 1."""
    return chosen(sense > 0.0, room, 1.0)


@scalar
def goes_on(inner: float, outer: float, velocity: float, margin: float) -> float:
    """1 while a sleeve has room on both sides, keeps the sign of its velocity, or is held; 0 once any of these ends."""
    return chosen(min(min(inner, outer), min(velocity, margin)) > 0.0, 1.0, 0.0)


# Curves over the cycle of an engine that is a mechanism, and through how many neighbours they go.
CURVES, NEIGHBOURS = 4, 6
BEFORE = NEIGHBOURS // 2 - 1


@scalar
def curves_of_cycle(
    memory: np.ndarray, offset: float, positions: float, cycle: float, angle: float
) -> tuple[float, float, float, float]:
    """Curves of the engine's mechanism at a crank angle, by Lagrange's polynomials through six neighbours.

    Parameters
    ----------
    memory : array of float
    offset, positions : float
        Index of the curves in it, and number of equally spaced angles at which they are known: at each angle a value of
        each curve, starting BEFORE positions before the first.
    cycle, angle : float
        [rad]

    Returns
    -------
    tuple of 4 floats
        Reduced inertia minus its mean [kg·m²], its derivative by the angle, the driving moment over its mean, and all
        other moments minus their mean [N·m].
    """
    turns = angle / cycle
    place = (turns - math.floor(turns)) * positions
    first = math.floor(min(place, positions - 1.0))
    t = place - first + BEFORE
    at = int(offset) + CURVES * int(first)
    inertia, slope, driving, other = 0.0, 0.0, 0.0, 0.0
    for i in range(NEIGHBOURS):
        weight = 1.0
        for j in range(NEIGHBOURS):
            weight *= (t - j) * (1.0 / (i - j)) if j != i else 1.0
        k = at + CURVES * i
        inertia += weight * memory[k]
        slope += weight * memory[k + 1]
        driving += weight * memory[k + 2]
        other += weight * memory[k + 3]
    return inertia, slope, driving, other
