"""Cars that brake on the point of sliding."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.compiling.decorators import scalar
from engine.elements.element import PLACES, Columns, Element, ElementResult, Numbers
from engine.elements.panels import VELOCITY, Curve, Mark, Panel, PanelAxis
from engine.graph.over_arrays import over_arrays
from engine.laws.brakes import axle_shares
from engine.parts.bodies import STANDARD_GRAVITY
from engine.parts.skeleton import Acceleration, Angle, Number, Positive, Speed, Time

# Highest speed drawn, relative to the given one.
_FASTEST = 1.5


@scalar
def car(
    speed: float, front: float, rear: float, base: float, behind: float, height: float, slope: float, g: float
) -> tuple[float, float, float, float]:
    """Braking car without reaction time: its results in order; NaN if it does not come to rest."""
    on_front, on_rear = axle_shares(base, behind, height, front, rear)
    held = g * (math.cos(slope) * (front * on_front + rear * on_rear) + math.sin(slope))
    slowing = held if held > 0.0 else math.nan
    return slowing, speed * speed / (2 * slowing), speed / slowing, on_front


class CarElement(Element):
    """A car that brakes to rest with the `brakes` of its front, rear or all wheels on the point of sliding.

    `rear_distance` is the distance of its centre of mass from the rear axle, `height` that from the road. It drives
    uphill on a positive `slope`, downhill on a negative one; the brakes act after the `reaction_time`.
    """

    ascending: ClassVar = {("rear_distance", "wheelbase"): "the centre of mass lies between the axles"}
    picture: ClassVar = "braking"
    RESULTS: ClassVar = (
        ElementResult("deceleration", "peak deceleration of the braking car", "m s-2"),
        ElementResult("stopping_distance", "way to rest, that of the reaction time with it", "m"),
        ElementResult("stopping_time", "time to rest, the reaction time with it", "s"),
        ElementResult("front_share", "share of the load on the road that the front wheels bear", "1"),
    )

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

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        front, rear = (n["friction"] if self.brakes in (axle, "all") else 0.0 for axle in ("front", "rear"))
        keys = ("wheelbase", "rear_distance", "height", "slope", "gravity")
        slowing, way, time, share = over_arrays(car, n["speed"], front, rear, *(n[key] for key in keys))
        delay = n["reaction_time"]
        return self.in_order((slowing, n["speed"] * delay + way, delay + time, share))

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
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
