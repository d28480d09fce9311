"""Governors: their characteristic, their stability with an engine, and what a change of load does.

A governor has two balls. Their radii say where the stops are; lifts of the sleeve are counted from the inner stop.
"""

from typing import Annotated, ClassVar

import numpy as np
from numba import types
from pydantic import Field, model_validator

from engine.compiling.running import prepare
from engine.elements.element import ROUNDING, Answers, Element, ElementResult, Numbers, Rank, nudged
from engine.elements.governors.equilibria import (
    governor_marks,
    governor_memory,
    governor_variants,
    near_equilibrium,
    search_errors,
)
from engine.elements.governors.governed_engine import (
    FullAndShutThrottle,
    GovernedEngine,
    LinearThrottle,
    TableThrottle,
)
from engine.elements.governors.governor_curves import governor_panels
from engine.elements.governors.places import GEOMETRY_NUMBERS, Holding, Throttling
from engine.elements.governors.transients import ANSWERS, FINE, MOTION_ROOM, Followed, follow_changes
from engine.elements.panels import Panel
from engine.laws.tables import Table
from engine.parts.actions import Force
from engine.parts.skeleton import STANDARD_GRAVITY, Acceleration, Length, Mass, Number, Positive, quantity
from engine.units.display import quantity_text
from engine.words.verdicts import Verdict

_FLAG = {"units": "1", "exact": True}
_STATICS = (
    ElementResult("inner_speed", "speed of the spindle in equilibrium at the inner stop", "rad s-1", rank=Rank.FURTHER),
    ElementResult("outer_speed", "speed of the spindle in equilibrium at the outer stop", "rad s-1", rank=Rank.FURTHER),
    ElementResult("inner_force", "controlling force of one ball at the inner stop", "N", rank=Rank.FURTHER),
    ElementResult("outer_force", "controlling force of one ball at the outer stop", "N", rank=Rank.FURTHER),
    ElementResult("stable_from", "radius at which the longest stable stretch begins", "m", rank=Rank.FURTHER),
    ElementResult("stable_to", "radius at which the longest stable stretch ends", "m", rank=Rank.FURTHER),
    ElementResult("least_speed", "minimum speed of the spindle in the stable stretch", "rad s-1"),
    ElementResult("greatest_speed", "maximum speed of the spindle in the stable stretch", "rad s-1"),
    ElementResult("mean_speed", "mean of the minimum and maximum speed", "rad s-1"),
    ElementResult("non_uniformity", "range of speeds in the stable stretch over the mean speed", "1"),
    ElementResult(
        "least_stability",
        "minimum of (dω²/dr)/(ω²/r) in equilibrium between the stops; 0 is isochronous",
        "1",
        rank=Rank.FURTHER,
    ),
    ElementResult("least_stability_radius", "radius at which the governor is least stable", "m", rank=Rank.FURTHER),
    ElementResult("isochronous", "the governor is isochronous (1 or 0)", **_FLAG),
    ElementResult("sleeve_lift", "lift of the sleeve between the stops", "m"),
    ElementResult("insensitivity", "maximum range of speeds within which friction holds the sleeve, as a share", "1"),
    ElementResult(
        "least_speed_with_friction", "speed at which the sleeve falls to its lowest", "rad s-1", rank=Rank.FURTHER
    ),
    ElementResult(
        "greatest_speed_with_friction", "speed at which the sleeve rises to its highest", "rad s-1", rank=Rank.FURTHER
    ),
    ElementResult(
        "sleeve_force", "force at the sleeve that holds the balls, at half of the lift", "N", rank=Rank.FURTHER
    ),
    ElementResult("effort", "mean force at the sleeve for the given change of speed, at half of the lift", "N"),
    ElementResult("power", "effort times the lift that the given change of speed makes", "J", None, True),
)
_OF_ENGINE = (
    ElementResult("working_lift", "lift of the sleeve at the engine's load, after its change", "m"),
    ElementResult("working_speed", "steady speed of the engine, after the change of load", "rad s-1"),
    ElementResult("steady_speed_change", "steady change of the engine's speed by the change of load", "rad s-1"),
    ElementResult("vyshnegradsky_x", "Vyshnegradsky's X", "1", None, True, rank=Rank.FURTHER),
    ElementResult("vyshnegradsky_y", "Vyshnegradsky's Y", "1", None, True, rank=Rank.FURTHER),
    ElementResult("stable", "engine and governor are stable (1) or hunt (0)", **_FLAG),
    ElementResult("gain_margin", "gain of the throttle at which they hunt, over that given", "1", None, True),
    ElementResult(
        "critical_damping", "damping at the sleeve below which they hunt", "N s m-1", None, True, rank=Rank.FURTHER
    ),
    ElementResult(
        "critical_inertia", "inertia of the engine below which they hunt", "kg m2", None, True, rank=Rank.FURTHER
    ),
    ElementResult(
        "decay_rate", "rate at which the slowest part of a disturbance decays", "s-1", None, True, rank=Rank.FURTHER
    ),
    ElementResult("hunting_frequency", "angular frequency of the oscillation", "rad s-1", None, True),
    ElementResult("oscillates", "a disturbance decays or grows in oscillations (1 or 0)", **_FLAG, rank=Rank.FURTHER),
)
_TRANSIENT = (
    ElementResult("highest_speed", "highest speed of the engine after the change of load", "rad s-1"),
    ElementResult("lowest_speed", "lowest speed of the engine after the change of load", "rad s-1"),
    ElementResult("overshoot", "maximum departure beyond the new steady speed, as a share", "1"),
    ElementResult("settling_time", "time after which the speed stays in its band", "s", None, True),
    ElementResult("hunting", "half the swing of speed that is left at the end, as a share", "1"),
    ElementResult("inner_stop_hits", "how often the sleeve runs on its inner stop", **_FLAG, rank=Rank.FURTHER),
    ElementResult("outer_stop_hits", "how often the sleeve runs on its outer stop", **_FLAG, rank=Rank.FURTHER),
)
# Keys of a governor's own numbers, and of its engine's, in the order of `engine.elements.governors.places`.
_OWN = (
    *("ball_mass", "sleeve_mass", "stiffness", "preload", "gravity", "friction", "damping"),
    *("least_radius", "greatest_radius", "speed_change"),
)
_OF_ITS_ENGINE = ("inertia", "ratio", "throttle.full", "throttle.closed", "self_regulation")
# What keys of the curves of a mechanism begin with.
CYCLE = "cycle."
# Variants whose motion is followed on one thread before the next piece of work is asked for.
TOGETHER = 32
_ROW, _TABLE = types.float64[::1], types.float64[:, ::1]
_FOLLOWED = types.NamedTuple((_TABLE, _TABLE, _TABLE, types.uint8[::1]), Followed)
_TYPES = (types.intp, types.intp, _TABLE, _ROW, types.float64, _FOLLOWED, _ROW)


# Positions follow from the numbers by roots and directions of arms, which round as much again as the numbers do.
OF_ARMS = 2.0


class Governor(Element):
    """What all governors have: two balls, a sleeve with friction, damping and a spring, stops, and perhaps an engine.

    `sleeve_mass` is that of the sleeve with its central load. The spring on the sleeve has the force `preload` at the
    inner stop. `speed_change` is the share of the speed for which effort and power are told.
    """

    picture: ClassVar = "governor"
    # Keys of what holds the balls, in the order of `engine.elements.governors.places`.
    holding: ClassVar[Holding]
    geometry: ClassVar[tuple[str, ...]]

    ball_mass: Annotated[Mass, Field(gt=0)]
    sleeve_mass: Annotated[Mass, Field(ge=0)] = 0.0
    least_radius: Positive
    greatest_radius: Positive
    friction: Annotated[Force, Field(ge=0)] = 0.0
    damping: Annotated[quantity("damping"), Field(ge=0)] = 0.0
    speed_change: Annotated[Number, Field(gt=0)] = 0.01
    engine: GovernedEngine | None = None

    @model_validator(mode="after")
    def _has_a_range(self) -> "Governor":
        if not self.least_radius < self.greatest_radius:
            raise ValueError(
                f"greatest_radius = {quantity_text(self.greatest_radius, 'm')} is not above "
                f"least_radius = {quantity_text(self.least_radius, 'm')}: "
                "give the radii of the balls at the inner and the outer stop"
            )
        if self.engine is None and self.gives("damping"):
            raise ValueError("damping matters to the motion with an engine alone; give engine, or leave damping out")
        return self

    @property
    def is_followed(self) -> bool:
        """Whether a change of load is followed over time."""
        return self.engine is not None and self.engine.duration is not None

    @property
    def governs_machine(self) -> bool:
        """Whether the engine is the scene's mechanism."""
        return self.engine is not None and self.engine.machine

    @property
    def throttling(self) -> Throttling:
        """How the moment of the engine depends on the lift."""
        match self.engine and self.engine.throttle:
            case LinearThrottle():
                return Throttling.LINEAR
            case TableThrottle():
                return Throttling.TABLE
            case FullAndShutThrottle():
                return Throttling.FULL_AND_SHUT
        return Throttling.NONE

    @property
    def controlling_table(self) -> Table | None:
        """Table of the controlling force, where there is one."""
        return None

    @property
    def variants_at_once(self) -> int:
        """Few where a change of load is followed."""
        return TOGETHER if self.is_followed else Element.variants_at_once

    def results(self) -> tuple[ElementResult, ...]:
        """Those of the governor, with an engine of its stability, followed over time of what a change of load does."""
        of_engine = _OF_ENGINE if self.engine is not None else ()
        return (*_STATICS, *of_engine, *(_TRANSIENT if self.is_followed else ()))

    def row(self, n: Numbers) -> np.ndarray:
        """Numbers in the order of `engine.elements.governors.places`, (variants, numbers); 0 where there is none.

        Parameters
        ----------
        n : mapping of str to ndarray (variants,)
        """
        load = n.get("engine.load", 0.0)
        found = [n.get(key, 0.0) for key in _OWN]
        found += [*(n[key] for key in self.geometry), *(0.0,) * (GEOMETRY_NUMBERS - len(self.geometry))]
        found += [*(n.get(f"engine.{key}", 0.0) for key in _OF_ITS_ENGINE), load, n.get("engine.new_load", load)]
        found += [n.get(f"engine.{key}", 0.0) for key in ("duration", "settling_band", "throttle.switch")]
        return np.ascontiguousarray(np.array(np.broadcast_arrays(*found), float).T)

    def evaluate(self, n: Numbers) -> Answers:
        """Results near equilibrium with errors by nudges, those of motion by steps of half the length, and verdicts."""
        cycle = np.array([n[key] for key in n if key.startswith(CYCLE)])
        n = {key: row for key, row in n.items() if not key.startswith(CYCLE)}
        g = governor_variants(self, n)
        marks, verdicts = governor_marks(g)
        found, errors = nudged(lambda m: near_equilibrium(governor_variants(self, m), marks), n)
        errors = {name: OF_ARMS * row for name, row in errors.items()}
        for name, more in search_errors(g, marks, found).items():
            errors[name] = errors[name] + ROUNDING * more
        well = verdicts == Verdict.OK
        if self.is_followed:
            answers, coarse = np.full((2, well.size, ANSWERS), np.nan)
            prepare(follow_changes, _TYPES)
            rows = np.concatenate([g.rows, cycle.T], axis=1) if cycle.size else g.rows
            tables, room = governor_memory(self), np.empty(MOTION_ROOM)
            kind, throttle = int(self.holding), int(self.throttling)
            followed = Followed(answers, coarse, marks.of_motion, verdicts)
            follow_changes(kind, throttle, rows, *tables, followed, room)
            off = np.abs(answers - coarse) + ROUNDING * np.abs(answers) * FINE
            for result, row, missed in zip(_TRANSIENT, answers.T, off.T, strict=True):
                found[result.name], errors[result.name] = row, missed
        found = {name: np.where(well, row, np.nan) for name, row in found.items()}
        return Answers(found, {name: np.where(well, row, 0.0) for name, row in errors.items()}, verdicts)

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """Its characteristic; with an engine its stability and a change of load."""
        return governor_panels(self, (given or {}).get("cycle"))

    def machine_needed(self) -> tuple[str, str]:
        """A crank that turns, where the engine is the scene's mechanism."""
        if not self.governs_machine:
            return "", ""
        words = (
            "the scene has no crank that turns fully; give it one, or leave machine out and give the engine's inertia"
        )
        return ".engine.machine", words


class LoadedGovernor(Governor):
    """A governor that is held by weights and a spring."""

    stiffness: Annotated[quantity("stiffness"), Field(ge=0)] = 0.0
    preload: Force = 0.0
    gravity: Annotated[Acceleration, Field(ge=0)] = STANDARD_GRAVITY


class ArmGovernor(LoadedGovernor):
    """A governor with upper arms on the spindle and lower arms on the sleeve.

    `upper_pivot` and `lower_pivot` are the distances of their pivots from the axis, on the side of the ball; negative
    where arms cross the axis.
    """

    holding: ClassVar = Holding.UPPER_ARMS
    geometry: ClassVar = ("upper_arm", "lower_arm", "upper_pivot", "lower_pivot", "upper_arm")

    upper_arm: Positive
    lower_arm: Positive
    upper_pivot: Length = 0.0
    lower_pivot: Length = 0.0


def cycle_key(k: int) -> str:
    """Under which key a governor is given a number of the curves of its mechanism, by its place in the row."""
    return f"{CYCLE}{k}"
