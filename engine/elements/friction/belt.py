"""Belts on a pulley on the point of slipping.

There the tension of the tight strand is e^(f α) times that of the slack one, by Euler's, Eytelwein's or the capstan
formula. A running belt with mass q per unit length presses less: q v² of the tension of each strand only provides the
centripetal force.

Sources: L. Euler, 1769; R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 11.
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import NamedRows, Numbers
from engine.elements.friction.friction_element import FORCE, RATIO, FrictionElement, Load
from engine.laws.friction.inclines import in_groove
from engine.parts.skeleton import Angle, Moment, Number, Positive, Speed, quantity
from engine.words.quantity import main_result
from engine.words.verdicts import Verdict


class BeltElement(FrictionElement):
    """A belt on a pulley on the point of slipping: the torque that its `tension` transmits, or the tension required.

    `tension` is that of the tight strand; `groove_angle` is the angle between the faces of a V groove. A moving belt
    has a `speed` and, with its `linear_density`, a centrifugal tension.
    """

    # Its friction can't jam; the ratio of its tensions overflows.
    infinite: ClassVar = Verdict.NOT_FINITE
    one_of: ClassVar = (("tension", "moment"),)
    needs: ClassVar = {"linear_density": ("speed",)}
    shown: ClassVar = ((FORCE, ("tight_tension", "slack_tension", "shaft_force")), (RATIO, ("tension_ratio",)))

    type: Literal["belt"]
    diameter: Positive
    wrap: Annotated[Angle, Field(gt=0)]
    friction: Annotated[Number, Field(gt=0)]
    groove_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    tension: Load | None = None
    moment: Annotated[Moment, Field(gt=0)] | None = None
    speed: Annotated[Speed, Field(ge=0)] | None = None
    linear_density: Annotated[quantity("linear_density"), Field(gt=0)] | None = None

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        radius, wrap, q, speed = n["diameter"] / 2, n["wrap"], n.get("linear_density", 0.0), n.get("speed", 0.0)
        mu = in_groove(n["friction"], n.get("groove_angle", math.pi))
        grip, centrifugal = -np.expm1(-mu * wrap), q * speed**2
        if "tension" in n:
            tight, pressing = n["tension"], np.maximum(n["tension"] - centrifugal, 0.0)
        else:
            pressing = n["moment"] / (radius * grip)
            tight = pressing + centrifugal
        # Differences of tensions, or the cosine of the wrap, lose digits where the strands nearly balance.
        pull, slack = pressing * grip, pressing * np.exp(-mu * wrap)
        on_shaft = np.sqrt(pull**2 + 4 * pressing * slack * np.sin(wrap / 2) ** 2)
        words = "tight over slack tension, both without the centrifugal tension"
        yield main_result("tension_ratio", words, "1"), np.exp(mu * wrap)
        yield main_result("tight_tension", "tension of the tight strand", "N"), tight
        yield main_result("slack_tension", "tension of the slack strand", "N"), np.minimum(tight, centrifugal) + slack
        yield main_result("moment", "maximum torque without slip", "N m"), pull * radius
        yield main_result("shaft_force", "force of the belt on the shaft", "N"), on_shaft
        if "speed" in n:
            yield main_result("power", "maximum power without slip", "W"), pull * speed
        if "linear_density" in n:
            words = "centrifugal tension of the belt"
            yield main_result("centrifugal_tension", words, "N"), centrifugal
            # There the centrifugal tension is a third of the whole.
            words = "speed of maximum power at this tension"
            yield main_result("speed_of_most_power", words, "m s-1"), np.sqrt(tight / (3 * q))
