"""Loads on an inclined plane.

Source: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 10.
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import NamedRows, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, FORCE, Friction, FrictionElement, Load
from engine.parts.skeleton import Angle
from engine.words.quantity import main_result


class InclineElement(FrictionElement):
    """A load on an inclined plane, pulled at `pull_angle` above the plane; `static_friction` holds it at rest."""

    shown: ClassVar = ((FORCE, ("up_force", "down_force")), (EFFICIENCY, ("efficiency",)))

    type: Literal["incline"]
    load: Load
    angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)]
    friction: Friction
    static_friction: Friction | None = None
    pull_angle: Annotated[Angle, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        load, angle, friction, pull = n["load"], n["angle"], n["friction"], n["pull_angle"]
        static = n.get("static_friction", friction)

        def moving(mu: np.ndarray, way: float) -> np.ndarray:
            """Force that moves the load up (1), Q sin(α + φ)/cos(β − φ), or down (−1), Q sin(φ − α)/cos(β + φ)."""
            needed, left = load * (mu * np.cos(angle) + way * np.sin(angle)), np.cos(pull) + way * mu * np.sin(pull)
            force = np.where(left > 0.0, needed / left, np.where(needed > 0.0, np.inf, np.nan))
            # Pulled too steeply, it leaves the plane.
            return np.where(np.cos(angle + pull) > 0.0, force, np.nan)

        up, locks = moving(friction, 1.0), np.tan(angle) <= static
        yield main_result("friction_angle", "angle of friction", "rad"), np.arctan(friction)
        yield main_result("up_force", "force that moves the load up", "N"), up
        yield main_result("start_force", "force that sets the load going upwards", "N"), moving(static, 1.0)
        words = "force that moves the load down, negative where it has to be held"
        yield main_result("down_force", words, "N"), moving(friction, -1.0)
        efficiency = load * np.sin(angle) / (up * np.cos(pull))
        yield main_result("efficiency", "efficiency of moving the load up", "1", may_be_undefined=True), efficiency
        words = "whether the load holds by itself (1 or 0)"
        yield main_result("self_locking", words, "1", exact=True), locks.astype(float)
