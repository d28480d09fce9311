"""Static balancing of a flat rotor: the resultant of its unbalances, and the single mass that balances it.

Unbalances m r e^(iα) add up to D; the mass D/r_c opposite to D moves the centre of mass onto the axis. On knife edges
the rotor rolls until its heavy side is at the bottom, except for the unbalance m k held by rolling friction.

Source: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 21 (several masses in one plane).
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Element, NamedRows, Numbers
from engine.elements.panels import Panel
from engine.elements.rotors.knife_edges import knife_edge_results
from engine.elements.rotors.rotor_parts import OffAxis
from engine.elements.rotors.unbalance import vector_polygon
from engine.laws.rounding import EPS
from engine.parts.skeleton import AngularSpeed, Length, Mass, Name
from engine.words.quantity import main_result


class StaticRotor(Element):
    """A flat rotor, such as a wheel or a disc: all masses off its axis are assumed to be in one plane.

    One mass at `correction_radius` balances them. On knife edges, with the rotor's `mass` and the arm of rolling
    friction, `rolling_arm`, friction hides a part of the unbalance.
    """

    needs: ClassVar = {"rolling_arm": ("mass",)}
    picture: ClassVar = "plan"

    type: Literal["static_rotor"]
    unbalances: Annotated[dict[Name, OffAxis], Field(min_length=1)]
    correction_radius: Annotated[Length, Field(gt=0)]
    mass: Annotated[Mass, Field(gt=0)] | None = None
    rolling_arm: Annotated[Length, Field(gt=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        masses = [[n[f"unbalances.{name}.{key}"] for name in self.unbalances] for key in ("mass", "radius", "angle")]
        mass, radius, angle = np.array(masses)
        parts = mass * radius * np.exp(1j * angle)
        total = parts.sum(axis=0)
        size = np.abs(total)
        # The remainder of unbalances that cancel is rounding, and has no direction.
        size = np.where(size <= 4.0 * EPS * np.abs(parts).sum(axis=0), 0.0, size)
        direction = np.where(size > 0.0, np.angle(total), math.nan)
        turned = np.where(direction > 0.0, direction - math.pi, direction + math.pi)
        yield main_result("unbalance", "resultant unbalance", "kg m"), size
        yield main_result("unbalance_angle", "angle of the resultant unbalance", "rad", True), direction
        yield main_result("correction_mass", "mass that balances the rotor", "kg"), size / n["correction_radius"]
        yield main_result("correction_angle", "angle of the mass that balances the rotor", "rad", True), turned
        if "mass" in n:
            yield main_result("eccentricity", "distance of the centre of mass from the axis", "m"), size / n["mass"]
        if "speed" in n:
            words = "force of the unbalance on the bearings"
            yield main_result("centrifugal_force", words, "N"), size * n["speed"] ** 2
        yield from knife_edge_results(size, n)

    def panels(self) -> tuple[Panel, ...]:
        """Polygon of the unbalances, closed by the balance mass."""
        parts = np.array([u.mass * u.radius * np.exp(1j * u.angle) for u in self.unbalances.values()])
        names = *self.unbalances, "balance mass"
        return (vector_polygon(names, np.append(parts, -parts.sum()), 1, "Unbalances", "kg m"),)
