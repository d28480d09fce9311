"""Static balancing of a flat rotor: the resultant of its unbalances, and the single mass that balances it.

Unbalances m r e^(iα) add up to D; the mass D/r_c opposite to D moves the centre of mass onto the axis. On knife edges
the rotor rolls until its heavy side is at the bottom, except for the unbalance m k held by rolling friction.

Source: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 21 (several masses in one plane).
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Columns, Element, ElementResult, Numbers
from engine.elements.panels import Panel
from engine.elements.rotors.knife_edges import KNIFE_EDGES, on_knife_edges
from engine.elements.rotors.rotor_parts import OffAxis
from engine.elements.rotors.unbalance import vector_polygon
from engine.laws.rounding import EPS
from engine.parts.skeleton import AngularSpeed, Length, Mass, Name


class StaticRotor(Element):
    """A flat rotor, such as a wheel or a disc: all masses off its axis are assumed to be in one plane.

    One mass at `correction_radius` balances them. On knife edges, with the rotor's `mass` and the arm of rolling
    friction, `rolling_arm`, friction hides a part of the unbalance.
    """

    needs: ClassVar = {"rolling_arm": ("mass",)}
    picture: ClassVar = "plan"
    RESULTS: ClassVar = (
        ElementResult("unbalance", "resultant unbalance", "kg m"),
        ElementResult("unbalance_angle", "angle of the resultant unbalance", "rad", None, True),
        ElementResult("correction_mass", "mass that balances the rotor", "kg"),
        ElementResult("correction_angle", "angle of the mass that balances the rotor", "rad", None, True),
        ElementResult("eccentricity", "distance of the centre of mass from the axis", "m", "mass"),
        ElementResult("centrifugal_force", "force of the unbalance on the bearings", "N", "speed"),
        *KNIFE_EDGES,
    )

    type: Literal["static_rotor"]
    unbalances: Annotated[dict[Name, OffAxis], Field(min_length=1)]
    correction_radius: Annotated[Length, Field(gt=0)]
    mass: Annotated[Mass, Field(gt=0)] | None = None
    rolling_arm: Annotated[Length, Field(gt=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        masses = [[n[f"unbalances.{name}.{key}"] for name in self.unbalances] for key in ("mass", "radius", "angle")]
        mass, radius, angle = np.array(masses)
        parts = mass * radius * np.exp(1j * angle)
        total = parts.sum(axis=0)
        size = np.abs(total)
        # The remainder of unbalances that cancel is rounding, and has no direction.
        size = np.where(size <= 4.0 * EPS * np.abs(parts).sum(axis=0), 0.0, size)
        direction = np.where(size > 0.0, np.angle(total), math.nan)
        own, arm = n.get("mass", math.nan), n.get("rolling_arm", math.nan)
        return {
            "unbalance": size,
            "unbalance_angle": direction,
            "correction_mass": size / n["correction_radius"],
            "correction_angle": np.where(direction > 0.0, direction - math.pi, direction + math.pi),
            "eccentricity": size / own,
            "centrifugal_force": size * n.get("speed", math.nan) ** 2,
            **on_knife_edges(size, own, arm),
        }

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """Polygon of the unbalances, closed by the balance mass."""
        parts = np.array([u.mass * u.radius * np.exp(1j * u.angle) for u in self.unbalances.values()])
        names = *self.unbalances, "balance mass"
        return (vector_polygon(names, np.append(parts, -parts.sum()), 1, "Unbalances", "kg m"),)
