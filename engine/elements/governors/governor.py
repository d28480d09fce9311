"""Governors: characteristic, stability with an engine, and response to a change of load.

A governor has two balls. The stops are given by radii of the balls; sleeve lifts are measured from the inner stop.
"""

import math
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from engine.elements.element import ROUNDING, Answers, Element, Numbers, by_name, nudged
from engine.elements.governors.equilibria import (
    GovernorVariants,
    governor_marks,
    governor_variants,
    near_equilibrium,
    search_errors,
)
from engine.elements.governors.governed_engine import FullAndShutThrottle, GovernedEngine
from engine.elements.governors.governor_forces import Linkage, States, along_axis, numbers
from engine.elements.governors.transients import SPEED_SCALE, TOLERANCE, follow_changes
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.graph.nodes import Graph, Node
from engine.laws.tables import Table
from engine.parts.actions import Force
from engine.parts.bodies import STANDARD_GRAVITY
from engine.parts.skeleton import Acceleration, Length, Mass, Number, Positive, quantity
from engine.stepping.walk_task import WALKS, range_of_walks
from engine.units.display import quantity_text
from engine.words.quantity import Quantity, main_result
from engine.words.verdicts import Verdict

_FLAG = {"units": "1", "exact": True}
_TRANSIENT = (
    main_result("highest_speed", "highest speed of the engine after the change of load", "rad s-1"),
    main_result("lowest_speed", "lowest speed of the engine after the change of load", "rad s-1"),
    main_result("overshoot", "maximum overshoot beyond the new steady speed, relative", "1"),
    main_result("settling_time", "time after which the speed stays in its band", "s", True),
    main_result("hunting", "amplitude of the speed at the end, over the new steady speed", "1"),
    Quantity("inner_stop_hits", "how often the sleeve hits its inner stop", **_FLAG),
    Quantity("outer_stop_hits", "how often the sleeve hits its outer stop", **_FLAG),
)
# Prefix of the keys for the curves of a mechanism.
CYCLE = "cycle."
# Keys of the arms' dimensions.
ARMS = ("upper_arm", "lower_arm", "upper_pivot", "lower_pivot")
# Positions follow from the numbers by roots and directions of arms, forces from both: each step adds as much rounding.
OF_ARMS = 3.0
# Margins this close to 0 are drawn as stable: a plotted line can't show the difference.
_FLAT = 1e-12
# Speeds whose relative difference is below this share a label: their rays would end within its height.
_APART = 0.03
# Number of positions of the curves; their extent beyond the stops, as a fraction of the range between them.
_POSITIONS, BEYOND = 401, 0.25


class Governor(Element):
    """Common to all governors: two balls, a sleeve with friction, damping and a spring, stops, optionally an engine.

    `sleeve_mass` includes the central load. The spring on the sleeve has the force `preload` at the inner stop.
    `speed_change` is the relative speed change for which effort and power are computed.
    """

    ascending: ClassVar = {("least_radius", "greatest_radius"): "they are those of the balls at the two stops"}
    needs: ClassVar = {"damping": ("engine",)}
    picture: ClassVar = "governor"

    ball_mass: Annotated[Mass, Field(gt=0)]
    sleeve_mass: Annotated[Mass, Field(ge=0)] = 0.0
    least_radius: Positive
    greatest_radius: Positive
    friction: Annotated[Force, Field(ge=0)] = 0.0
    damping: Annotated[quantity("damping"), Field(ge=0)] = 0.0
    speed_change: Annotated[Number, Field(gt=0)] = 0.01
    engine: GovernedEngine | None = None

    @property
    def is_followed(self) -> bool:
        """Whether a change of load is simulated over time."""
        return self.engine is not None and self.engine.duration is not None

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

    def held(self, link: Linkage, rates: Linkage, lift: Node) -> tuple[Node, Node]:
        """V' of the potential that holds the balls, and the sum of the magnitudes of its terms."""
        raise NotImplementedError

    def position_of(self, g: GovernorVariants, radius: np.ndarray) -> np.ndarray:
        """Positions at which the balls have a radius; NaN where they can't reach it."""
        return radius

    @cached_property
    def results(self) -> tuple[Quantity, ...]:
        """Results of the governor; with an engine, its stability; with a simulated change of load, the response."""
        g, marks, _ = governor_marks(governor_variants(self, self.own_numbers()))
        return (*near_equilibrium(g, marks), *(_TRANSIENT if self.is_followed else ()))

    def evaluate(self, n: Numbers) -> Answers:
        """Statics with errors by perturbation, motion with errors by comparison, and verdicts."""
        g = governor_variants(self, {key: row for key, row in n.items() if not key.startswith(CYCLE)})
        g, marks, verdicts = governor_marks(g)
        found, errors = nudged(lambda m: by_name(near_equilibrium(g.with_numbers(m), marks)), g.n)
        errors = {name: OF_ARMS * row for name, row in errors.items()}
        for name, more in search_errors(g, marks, found).items():
            errors[name] = errors[name] + ROUNDING * more
        if self.is_followed:
            cycle = np.array([n[key] for key in n if key.startswith(CYCLE)]).reshape(-1, verdicts.size)
            changes = [follow_changes(g, marks, verdicts, cycle, longer) for longer in WALKS]
            highest, lowest, _, settled, *_ = changes[0].answers
            # All walks may share an error of some tolerances of a step; settled engines still change by one.
            scales = SPEED_SCALE * highest, SPEED_SCALE * lowest, SPEED_SCALE, settled, 4.0 * SPEED_SCALE, 0.0, 0.0
            for result, scale, *rows in zip(_TRANSIENT, scales, *(each.answers for each in changes), strict=True):
                found[result.name] = rows[0]
                errors[result.name] = range_of_walks(rows) + ROUNDING * TOLERANCE * scale
            for each in changes:
                verdicts = np.where(verdicts == Verdict.OK, each.verdict, verdicts)
        well = verdicts == Verdict.OK
        found = {name: np.where(well, row, np.nan) for name, row in found.items()}
        return Answers(found, {name: np.where(well, row, 0.0) for name, row in errors.items()}, verdicts)

    def panels(self, cycle: np.ndarray | None = None) -> tuple[Panel, ...]:
        """Characteristic; with an engine, its stability and a change of load.

        Parameters
        ----------
        cycle : ndarray, optional
            Curves of the mechanism that is its engine, from `governed_scene`.
        """
        return _panels(self, cycle)

    def machine_needed(self) -> tuple[str, str]:
        """The scene needs a fully turning crank if the engine is its mechanism."""
        if self.engine is None or not self.engine.machine:
            return "", ""
        mend = "give it one, or leave machine out and give the engine's inertia"
        return ".engine.machine", f"the scene has no crank that turns fully; {mend}"


class LoadedGovernor(Governor):
    """A governor loaded by weights and a spring."""

    stiffness: Annotated[quantity("stiffness"), Field(ge=0)] = 0.0
    preload: Force = 0.0
    gravity: Annotated[Acceleration, Field(ge=0)] = STANDARD_GRAVITY

    def held(self, link: Linkage, rates: Linkage, lift: Node) -> tuple[Node, Node]:
        """Work of the weights of balls and sleeve, and of the spring on the sleeve."""
        keys = ("ball_mass", "sleeve_mass", "gravity", "preload", "stiffness")
        mass, sleeve_mass, gravity, preload, stiffness = numbers(lift.graph, *keys)
        ball, weight = mass * gravity, sleeve_mass * gravity
        slope = 2.0 * ball * rates.balls + (weight + preload + stiffness * lift) * rates.sleeve
        whole = weight + abs(preload) + stiffness * (abs(link.sleeve) + abs(link.sleeve - lift))
        return slope, 2.0 * ball * abs(rates.balls) + whole * abs(rates.sleeve)


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
        """Linkage of the arms at a radius of their joints, with the balls on the upper ones."""
        upper, lower, pivot, lower_pivot, ball_arm = numbers(graph, *ARMS, self.ball_arm_key)
        along, share = along_axis(x, pivot, upper), ball_arm / upper
        radius = pivot + share * (x - pivot)
        return Linkage(radius, -share * along, -along - along_axis(x, lower_pivot, lower))

    def position_of(self, g: GovernorVariants, radius: np.ndarray) -> np.ndarray:
        """Radii of the joints."""
        pivot = g.n["upper_pivot"]
        return pivot + (radius - pivot) * g.n["upper_arm"] / g.n[self.ball_arm_key]


def cycle_key(k: int) -> str:
    """Key of the k-th number of the curves of a governor's mechanism."""
    return f"{CYCLE}{k}"


def _panels(governor: Governor, cycle: np.ndarray | None) -> tuple[Panel, ...]:
    """Controlling force and equilibrium speed; with an engine, its stability and a change of load."""
    g, marks, verdicts = governor_marks(governor_variants(governor, governor.own_numbers()))
    inner, outer = marks.inner[0], marks.outer[0]
    room = BEYOND * (outer - inner)
    places = np.union1d(np.linspace(inner - room, outer + room, _POSITIONS), (inner, outer))
    found = g.some(np.zeros(places.size, int)).at(places)
    between = (places >= inner) & (places <= outer)
    # Without stops, or without equilibrium between them, there is nothing to plot.
    if not np.isfinite(found.speed[between]).any():
        return ()
    stops, verdict = g.at(np.stack([marks.inner, marks.outer])).radius[:, 0], Verdict(verdicts[0])
    title = "Controlling force" if verdict == Verdict.OK else verdict.sentence
    panels = [_characteristic(found, between, stops, title), _speeds(found, between, governor.friction)]
    if governor.engine is None or verdict != Verdict.OK:
        return tuple(panels)
    steady = {result.name: row[0] for result, row in near_equilibrium(g, marks).items()}
    # A valve has no linear stability.
    panels += [] if governor.has_valve else [_diagram(steady["vyshnegradsky_x"], steady["vyshnegradsky_y"])]
    if governor.is_followed:
        curves = np.zeros((0, 1)) if cycle is None else cycle[:, None]
        instants = follow_changes(g, marks, verdicts, curves, 1.0, records=True).instants
        # A motion that fails at once has none.
        panels += _change(instants, steady["working_speed"], governor.engine) if instants.size else ()
    return tuple(panels)


def _parts(found: States, between: np.ndarray, row: np.ndarray) -> list[Curve]:
    """A row split into its stable and unstable parts between the stops."""
    stable = found.margin >= -_FLAT
    chosen = (("stable", stable & between), ("unstable", ~stable & between))
    return [Curve(words, np.where(part, row, np.nan)) for words, part in chosen if part.any()]


def _characteristic(found: States, between: np.ndarray, stops: np.ndarray, title: str) -> Panel:
    """Controlling force of one ball, with rays of constant speed and the stops."""
    inside = found.speed[between]
    mass = np.nanmean(found.force / (found.radius * found.speed**2))
    along = np.array([0.0, stops[1] + 0.3 * (stops[1] - stops[0])])
    speeds = sorted({float(np.nanmin(inside)), float(np.nanmax(inside))})
    texts = [f"{speed * 30.0 / math.pi:.4g} rpm" for speed in speeds]
    if len(speeds) == 2 and speeds[1] - speeds[0] < _APART * speeds[1]:
        texts = ["", f"{speeds[0] * 30.0 / math.pi:.4g}, {texts[1]}"]
    rays = [Curve(text, mass * speed**2 * along, True, along) for text, speed in zip(texts, speeds, strict=True)]
    curves = [*_parts(found, between, found.force), Curve("", found.force, True), *rays]
    marks = [Mark(words, stop, None) for words, stop in zip(("stops", ""), stops, strict=True)]
    x, y = PanelAxis("radius of the balls", "m", "r"), PanelAxis("controlling force of one ball", "N", "F")
    return Panel(x, y, found.radius, curves, marks, title)


def _speeds(found: States, between: np.ndarray, friction: float) -> Panel:
    """Spindle speed over lift, with the band in which friction holds the sleeve."""
    curves = _parts(found, between, found.speed)
    if friction > 0.0:
        share = np.minimum(friction / found.sleeve, 1.0)
        edges = (("held by friction up to here", -1.0), ("", 1.0))
        curves += [Curve(words, found.speed * np.sqrt(1.0 + side * share), True) for words, side in edges]
    curves = [one._replace(values=one.values[between]) for one in curves]
    x, y = PanelAxis("lift of the sleeve", "m", "s"), PanelAxis("speed of the spindle", "rad s-1", "ω")
    return Panel(x, y, found.lift[between], curves, title="Speed in equilibrium")


def _diagram(at_x: float, at_y: float) -> Panel:
    """Vyshnegradsky's diagram: regions in which an engine with its governor hunts, oscillates, or does neither."""
    top = max(6.0, 1.25 * at_x, 1.25 * at_y)
    x = np.linspace(top / 400.0, top, 400)
    # Double roots −a, −a, −1/a²: X = 2a + 1/a², Y = a² + 2/a; the two branches meet at (3, 3).
    above, below = (
        np.where(x >= 3.0, np.interp(x, 2.0 * a + 1.0 / a**2, a**2 + 2.0 / a), np.nan)
        for a in (np.geomspace(1.0, top, 2000), np.geomspace(1.0, 1.0 / top, 2000))
    )
    curves = Curve("hunts below", 1.0 / x), Curve("no oscillation below", above), Curve("no oscillation above", below)
    marks = (Mark(f"X Y = {at_x * at_y:.3g}", at_x, at_y),)
    axes = PanelAxis("damping", "1", "X"), PanelAxis("stiffness", "1", "Y")
    return Panel(*axes, x, curves, marks, "Vyshnegradsky's diagram", (0.0, top))


def _change(instants: np.ndarray, after: float, engine: GovernedEngine) -> tuple[Panel, Panel]:
    """Engine speed and sleeve lift after a change of load, with the band about the new steady speed."""
    time, lift, speed = instants
    x, y = PanelAxis("time after the change of load", "s", "t"), PanelAxis("speed of the engine", "rad s-1", "ω")
    sides = ("settled", -1.0), ("", 1.0)
    band = [Mark(words, None, after * (1.0 + side * engine.settling_band)) for words, side in sides]
    title = f"Load from {quantity_text(engine.load, 'N m')} to {quantity_text(engine.new_load, 'N m')}"
    lifts = Panel(x, PanelAxis("lift of the sleeve", "m", "s"), time, (Curve("", lift),))
    return Panel(x, y, time, (Curve("", speed),), band, title), lifts
