"""Static balancing of a flat rotor: the resultant of its unbalances, and the one mass that takes it away.

Unbalances m r e^(iα) add up to D; the mass D/r_c opposite to it brings the centre of mass on the axis. On knife edges
the rotor rolls until its heavy side hangs below, but for what rolling friction holds, m k.

Source: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 21 (several masses in one plane).
"""

import math

import numpy as np

from engine.elements.element_laws import ElementResult, LawOfArrays, with_nudges
from engine.elements.rotors.knife_edges import residual_unbalance, resting_angle
from engine.elements.rotors.rotor_element import StaticRotor

_RESULTS = (
    ElementResult("unbalance", "resultant unbalance", "kg m"),
    ElementResult("unbalance_angle", "angle of the resultant unbalance", "rad", None, True),
    ElementResult("correction_mass", "mass that balances the rotor", "kg"),
    ElementResult("correction_angle", "angle of the mass that balances the rotor", "rad", None, True),
    ElementResult("eccentricity", "distance of the centre of mass from the axis", "m", "mass"),
    ElementResult("centrifugal_force", "force of the unbalance on the bearings", "N", "speed"),
    ElementResult(
        "knife_edge_unbalance", "unbalance that rolling friction on knife edges leaves", "kg m", "rolling_arm"
    ),
    ElementResult(
        "knife_edge_angle", "angle to the lowest place at which friction may hold the heavy side", "rad", "rolling_arm"
    ),
)


def static_rotor_law(element: StaticRotor) -> LawOfArrays:
    """The law of a flat rotor.

    Parameters
    ----------
    element : StaticRotor
        Its numbers are not used.
    """
    masses = [f"unbalances.{name}.{key}" for name in element.unbalances for key in ("mass", "radius", "angle")]
    others = [key for key in ("mass", "rolling_arm", "speed") if getattr(element, key) is not None]
    keys = ("correction_radius", *others, *masses)

    def rows(table: np.ndarray) -> np.ndarray:
        return _balanced(dict(zip(keys, table[: 1 + len(others)], strict=False)), table[1 + len(others) :])

    return LawOfArrays(with_nudges(rows), lambda given_element, given: tuple(given(key) for key in keys), _RESULTS)


def _balanced(n: dict[str, np.ndarray], masses: np.ndarray) -> np.ndarray:
    mass, radius, angle = masses[0::3], masses[1::3], masses[2::3]
    parts = mass * radius * np.exp(1j * angle)
    total = parts.sum(axis=0)
    size = np.abs(total)
    # What is left of unbalances that cancel is rounding, and has no direction.
    size = np.where(size <= 4.0 * np.finfo(float).eps * np.abs(parts).sum(axis=0), 0.0, size)
    nothing = np.full(size.shape, math.nan)
    direction = np.where(size > 0.0, np.angle(total), math.nan)
    own, arm = n.get("mass", nothing), n.get("rolling_arm", nothing)
    return np.stack(
        [
            size,
            direction,
            size / n["correction_radius"],
            np.where(direction > 0.0, direction - math.pi, direction + math.pi),
            size / own,
            size * n.get("speed", nothing) ** 2,
            residual_unbalance(own, arm),
            resting_angle(size, own, arm),
        ]
    )
