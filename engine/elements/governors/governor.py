"""Governors: characteristic, stability with an engine, and response to a change of load.

A governor has two balls. The stops are given by radii of the balls; sleeve lifts are measured from the inner stop.
"""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from engine.elements.element import ROUNDING, Answers, Element, ElementResult, Numbers, further, nudged
from engine.elements.governors.equilibria import (
    GovernorVariants,
    governor_marks,
    governor_variants,
    near_equilibrium,
    search_errors,
)
from engine.elements.governors.governed_engine import FullAndShutThrottle, GovernedEngine
from engine.elements.governors.governor_curves import governor_panels
from engine.elements.governors.governor_nodes import Holding, Linkage, held_by_weights, numbers
from engine.elements.governors.transients import TOLERANCE, follow_changes
from engine.elements.panels import Panel
from engine.graph.nodes import Graph, Node
from engine.laws.governors.linkages import balls_on_upper_arms
from engine.laws.tables import Table
from engine.parts.actions import Force
from engine.parts.bodies import STANDARD_GRAVITY
from engine.parts.skeleton import Acceleration, Faults, Length, Mass, Number, Positive, quantity
from engine.stepping.walk_task import WALKS
from engine.units.display import quantity_text
from engine.words.verdicts import Verdict

_FLAG = {"units": "1", "exact": True}
_STATICS = (
    further("inner_speed", "speed of the spindle in equilibrium at the inner stop", "rad s-1"),
    further("outer_speed", "speed of the spindle in equilibrium at the outer stop", "rad s-1"),
    further("inner_force", "controlling force of one ball at the inner stop", "N"),
    further("outer_force", "controlling force of one ball at the outer stop", "N"),
    further("stable_from", "radius at which the longest stable stretch begins", "m"),
    further("stable_to", "radius at which the longest stable stretch ends", "m"),
    ElementResult("least_speed", "minimum speed of the spindle in the stable stretch", "rad s-1"),
    ElementResult("greatest_speed", "maximum speed of the spindle in the stable stretch", "rad s-1"),
    ElementResult("mean_speed", "mean of the minimum and maximum speed", "rad s-1"),
    ElementResult("non_uniformity", "range of speeds in the stable stretch over the mean speed", "1"),
    further("least_stability", "minimum of (dω²/dr)/(ω²/r) in equilibrium between the stops; 0 is isochronous", "1"),
    further("least_stability_radius", "radius at which the governor is least stable", "m"),
    ElementResult("isochronous", "the governor is isochronous (1 or 0)", **_FLAG),
    ElementResult("sleeve_lift", "lift of the sleeve between the stops", "m"),
    ElementResult("insensitivity", "maximum range of speeds within which friction holds the sleeve, relative", "1"),
    further("least_speed_with_friction", "speed at which the sleeve falls to its lowest", "rad s-1"),
    further("greatest_speed_with_friction", "speed at which the sleeve rises to its highest", "rad s-1"),
    further("sleeve_force", "force at the sleeve that holds the balls, at half of the stable lift", "N"),
    ElementResult("effort", "mean force at the sleeve for the given change of speed, at half of the stable lift", "N"),
    ElementResult("power", "effort times the lift that the given change of speed makes", "J", None, True),
)
_OF_ENGINE = (
    ElementResult("working_lift", "lift of the sleeve at the engine's load, after its change", "m"),
    ElementResult("working_speed", "steady speed of the engine, after the change of load", "rad s-1"),
    ElementResult("steady_speed_change", "steady change of the engine's speed by the change of load", "rad s-1"),
    further("vyshnegradsky_x", "Vyshnegradsky's X", "1", None, True),
    further("vyshnegradsky_y", "Vyshnegradsky's Y", "1", None, True),
    ElementResult("stable", "engine and governor are stable (1) or hunt (0)", **_FLAG),
    ElementResult("gain_margin", "gain of the throttle at which they hunt, over that given", "1", None, True),
    further("critical_damping", "damping at the sleeve below which they hunt", "N s m-1", None, True),
    further("critical_inertia", "inertia of the engine below which they hunt", "kg m2", None, True),
    further("decay_rate", "rate at which the slowest part of a disturbance decays", "s-1", None, True),
    ElementResult("hunting_frequency", "angular frequency of the oscillation", "rad s-1", None, True),
    further("oscillates", "a disturbance decays or grows in oscillations (1 or 0)", **_FLAG),
)
_TRANSIENT = (
    ElementResult("highest_speed", "highest speed of the engine after the change of load", "rad s-1"),
    ElementResult("lowest_speed", "lowest speed of the engine after the change of load", "rad s-1"),
    ElementResult("overshoot", "maximum departure beyond the new steady speed, relative", "1"),
    ElementResult("settling_time", "time after which the speed stays in its band", "s", None, True),
    ElementResult("hunting", "amplitude of the speed at the end, over the new steady speed", "1"),
    further("inner_stop_hits", "how often the sleeve runs on its inner stop", **_FLAG),
    further("outer_stop_hits", "how often the sleeve runs on its outer stop", **_FLAG),
)
# Prefix of the keys for the curves of a mechanism.
CYCLE = "cycle."
# Keys of the arms' dimensions.
ARMS = ("upper_arm", "lower_arm", "upper_pivot", "lower_pivot")
# Positions follow from the numbers by roots and directions of arms, forces from both: each step adds as much rounding.
OF_ARMS = 3.0


class Governor(Element):
    """Common to all governors: two balls, a sleeve with friction, damping and a spring, stops, optionally an engine.

    `sleeve_mass` includes the central load. The spring on the sleeve has the force `preload` at the inner stop.
    `speed_change` is the relative speed change for which effort and power are computed.
    """

    picture: ClassVar = "governor"

    ball_mass: Annotated[Mass, Field(gt=0)]
    sleeve_mass: Annotated[Mass, Field(ge=0)] = 0.0
    least_radius: Positive
    greatest_radius: Positive
    friction: Annotated[Force, Field(ge=0)] = 0.0
    damping: Annotated[quantity("damping"), Field(ge=0)] = 0.0
    speed_change: Annotated[Number, Field(gt=0)] = 0.01
    engine: GovernedEngine | None = None

    def _faults(self) -> Faults:
        if not self.least_radius < self.greatest_radius:
            yield (
                f"greatest_radius = {quantity_text(self.greatest_radius, 'm')} is not above "
                f"least_radius = {quantity_text(self.least_radius, 'm')}: "
                "give the radii of the balls at the inner and the outer stop"
            )
        if self.engine is None and self.gives("damping"):
            yield "damping matters to the motion with an engine alone; give engine, or leave damping out"

    @property
    def is_followed(self) -> bool:
        """Whether a change of load is simulated over time."""
        return self.engine is not None and self.engine.duration is not None

    @property
    def governs_machine(self) -> bool:
        """Whether the engine is the scene's mechanism."""
        return self.engine is not None and self.engine.machine

    @property
    def has_valve(self) -> bool:
        """Whether the throttle is an on-off valve."""
        return self.engine is not None and isinstance(self.engine.throttle, FullAndShutThrottle)

    @property
    def controlling_table(self) -> Table | None:
        """Table of the controlling force, if any."""
        return None

    def linkage(self, graph: Graph, x: Node) -> Linkage:
        """Linkage of balls and sleeve at a position."""
        raise NotImplementedError

    def held(self, graph: Graph, x: Node, link: Linkage, lift: Node) -> Holding:
        """Potential that holds the balls at a position."""
        raise NotImplementedError

    def position_of(self, g: GovernorVariants, radius: np.ndarray) -> np.ndarray:
        """Positions at which the balls have a radius; NaN where they can't reach it."""
        return radius

    def results(self) -> tuple[ElementResult, ...]:
        """Results of the governor; with an engine, its stability; with a simulated change of load, the response."""
        of_engine = _OF_ENGINE if self.engine is not None else ()
        return (*_STATICS, *of_engine, *(_TRANSIENT if self.is_followed else ()))

    def evaluate(self, n: Numbers) -> Answers:
        """Statics with errors by perturbation, motion with errors by comparison, and verdicts."""
        g = governor_variants(self, {key: row for key, row in n.items() if not key.startswith(CYCLE)})
        marks, verdicts = governor_marks(g)
        found, errors = nudged(lambda m: near_equilibrium(g.with_numbers(m), marks), g.n)
        errors = {name: OF_ARMS * row for name, row in errors.items()}
        for name, more in search_errors(g, marks, found).items():
            errors[name] = errors[name] + ROUNDING * more
        if self.is_followed:
            cycle = np.array([n[key] for key in n if key.startswith(CYCLE)]).reshape(-1, verdicts.size)
            changes = [follow_changes(g, marks, verdicts, cycle, longer) for longer in WALKS]
            for result, *rows in zip(_TRANSIENT, *(each.answers for each in changes), strict=True):
                found[result.name] = rows[0]
                # A motion that fails at once has infinite results.
                with np.errstate(invalid="ignore"):
                    errors[result.name] = np.ptp(rows, axis=0) + ROUNDING * np.abs(rows[0]) * TOLERANCE
            for each in changes:
                verdicts = np.where(verdicts == Verdict.OK, each.verdict, verdicts)
        well = verdicts == Verdict.OK
        found = {name: np.where(well, row, np.nan) for name, row in found.items()}
        return Answers(found, {name: np.where(well, row, 0.0) for name, row in errors.items()}, verdicts)

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """Characteristic; with an engine, its stability and a change of load."""
        return governor_panels(self, (given or {}).get("cycle"))

    def machine_needed(self) -> tuple[str, str]:
        """The scene needs a fully turning crank if the engine is its mechanism."""
        if not self.governs_machine:
            return "", ""
        words = (
            "the scene has no crank that turns fully; give it one, or leave machine out and give the engine's inertia"
        )
        return ".engine.machine", words


class LoadedGovernor(Governor):
    """A governor loaded by weights and a spring."""

    stiffness: Annotated[quantity("stiffness"), Field(ge=0)] = 0.0
    preload: Force = 0.0
    gravity: Annotated[Acceleration, Field(ge=0)] = STANDARD_GRAVITY

    def held(self, graph: Graph, x: Node, link: Linkage, lift: Node) -> Holding:
        """Potential of the weights and the spring."""
        return held_by_weights(graph, link, lift)


class ArmGovernor(LoadedGovernor):
    """A governor with upper arms on the spindle and lower arms on the sleeve.

    `upper_pivot` and `lower_pivot` are the distances of their pivots from the axis, on the side of the ball; negative
    if the arms cross the axis.
    """

    upper_arm: Positive
    lower_arm: Positive
    upper_pivot: Length = 0.0
    lower_pivot: Length = 0.0

    @property
    def ball_arm_key(self) -> str:
        """Key of the distance of the balls from the upper pivots."""
        return "upper_arm"

    def linkage(self, graph: Graph, x: Node) -> Linkage:
        """Linkage of the arms, with the balls on the upper ones."""
        return Linkage(*graph.apply(balls_on_upper_arms, x, *numbers(graph, *ARMS, self.ball_arm_key)))

    def position_of(self, g: GovernorVariants, radius: np.ndarray) -> np.ndarray:
        """Radii of the joints."""
        pivot = g.n["upper_pivot"]
        return pivot + (radius - pivot) * g.n["upper_arm"] / g.n[self.ball_arm_key]


def cycle_key(k: int) -> str:
    """Key of the k-th number of the curves of a governor's mechanism."""
    return f"{CYCLE}{k}"
