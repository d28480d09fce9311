"""Cars that brake on the point of sliding."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import PLACES, Element, NamedRows, Numbers
from engine.elements.panels import VELOCITY, Curve, Mark, Panel, PanelAxis
from engine.parts.bodies import STANDARD_GRAVITY
from engine.parts.skeleton import Acceleration, Angle, Number, Positive, Speed, Time
from engine.words.quantity import main_result

# Highest speed drawn, relative to the given one.
_FASTEST = 1.5


class CarElement(Element):
    """A car that brakes to rest with the `brakes` of its front, rear or all wheels on the point of sliding.

    `rear_distance` is the distance of its centre of mass from the rear axle, `height` that from the road. It drives
    uphill on a positive `slope`, downhill on a negative one; the brakes act after the `reaction_time`.
    """

    ascending: ClassVar = {("rear_distance", "wheelbase"): "the centre of mass lies between the axles"}
    picture: ClassVar = "braking"

    type: Literal["car"]
    brakes: Literal["front", "rear", "all"] = "all"
    speed: Annotated[Speed, Field(gt=0)]
    friction: Annotated[Number, Field(gt=0)]
    wheelbase: Positive
    rear_distance: Positive
    height: Positive
    slope: Annotated[Angle, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0
    reaction_time: Annotated[Time, Field(ge=0)] = 0.0
    gravity: Annotated[Acceleration, Field(gt=0)] = STANDARD_GRAVITY

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants; NaN for a car that does not come to rest, or tips over."""
        front, rear = (n["friction"] if self.brakes in (axle, "all") else 0.0 for axle in ("front", "rear"))
        base, behind, height, slope = (n[key] for key in ("wheelbase", "rear_distance", "height", "slope"))
        # Moments about the points of contact, with friction and inertia at the height of the centre of mass.
        kept, whole = base - behind - front * height, base + (rear - front) * height
        share = np.where(kept < 0.0, np.nan, (behind + rear * height) / whole)
        held = n["gravity"] * (np.cos(slope) * (front * share + rear * kept / whole) + np.sin(slope))
        slowing = np.where(held > 0.0, held, np.nan)
        delay, speed = n["reaction_time"], n["speed"]
        yield main_result("deceleration", "peak deceleration of the braking car", "m s-2"), slowing
        way = speed * delay + speed**2 / (2 * slowing)
        yield main_result("stopping_distance", "distance to rest, including the reaction time", "m"), way
        yield main_result("stopping_time", "time to rest, including the reaction time", "s"), delay + speed / slowing
        yield main_result("front_share", "share of the weight carried by the front wheels", "1"), share

    def panels(self) -> tuple[Panel, ...]:
        """Stopping distance over the speed for each choice of brakes, and the speed over the distance as given."""
        speed = np.linspace(1e-3, _FASTEST, PLACES) * self.speed
        curves = []
        for brakes in ("front", "rear", "all"):
            way = self.model_copy(update={"brakes": brakes}).over("speed", speed)["stopping_distance"]
            curves.append(Curve(f"brakes: {brakes}", way))
        mark = Mark("as given", self.speed, None)
        over_speed = Panel(VELOCITY, PanelAxis("stopping distance", "m", "s"), speed, curves, (mark,))
        # The brakes act from the end of the reaction time; then the square of the speed falls linearly.
        left = np.linspace(self.speed, 0.0, PLACES)
        held = self.own_values()["deceleration"]
        way = [0.0, *(self.speed * self.reaction_time + (self.speed**2 - left**2) / (2 * held))]
        along = Curve("as given", np.array([self.speed, *left]))
        return over_speed, Panel(PanelAxis("distance", "m", "s"), VELOCITY, np.array(way), (along,))
