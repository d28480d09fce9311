"""A governor at one position, as nodes of a graph: everything that statics and motion need, for every type.

The numbers of a governor and its engine are named by their keys, such as "ball_mass" or "engine.load".
"""

from collections.abc import Sequence
from typing import NamedTuple

from engine.elements.element import Element
from engine.elements.governors.governed_engine import TableThrottle
from engine.graph.nodes import Graph, Node, Number
from engine.laws.governors import equilibrium
from engine.laws.rounding import EPS
from engine.laws.senses import past
from engine.laws.tables import Table, in_memory, on_piece, table_segment

# Key of a factor 1 of the sleeve's height at the inner stop: its rounding is that of lifts.
DATUM = "datum"


class Linkage(NamedTuple):
    """Motion of balls and sleeve: r, r', r''; h', h'' of the balls' height; z, z', z'' of the sleeve's."""

    radius: Node
    radius_rate: Node
    radius_rate_rate: Node
    rise: Node
    rise_rate: Node
    height: Node
    lift_rate: Node
    lift_rate_rate: Node


class Holding(NamedTuple):
    """Potential that holds the balls: V', V'', and the sum of the magnitudes of the terms of V'."""

    slope: Node
    curvature: Node
    size: Node


def numbers(graph: Graph, *keys: str) -> tuple[Number, ...]:
    """Numbers of the governor and its engine, or those given to their motion."""
    return tuple(map(graph.number, keys))


def held_by_weights(graph: Graph, link: Linkage, lift: Node) -> Holding:
    """Potential of the weights of balls and sleeve and of a spring on the sleeve."""
    keys = ("ball_mass", "sleeve_mass", "gravity", "preload", "stiffness")
    mass, sleeve_mass, gravity, preload, stiffness = numbers(graph, *keys)
    ball, weight = mass * gravity, sleeve_mass * gravity
    loads = ball, weight + preload + stiffness * lift, stiffness
    rates = link.rise, link.rise_rate, link.lift_rate, link.lift_rate_rate
    slope, curvature = graph.apply(equilibrium.holding, *loads, *rates)
    whole = weight + abs(preload) + stiffness * (abs(link.height) + abs(link.height - lift))
    return Holding(slope, curvature, 2.0 * ball * abs(link.rise) + whole * abs(link.lift_rate))


def by_table(graph: Graph, table: Table, u: Node) -> tuple[Node, Node]:
    """Value and slope of a table."""
    return on_piece(u, *graph.apply(table_segment, graph.memory, graph.store(in_memory(table)), u))


class States(NamedTuple):
    """A governor in equilibrium at positions, as nodes, or as arrays (...,).

    Attributes
    ----------
    radius, lift, force, speed, sleeve, margin
        r, z from the inner stop, controlling force, spindle speed, force at the sleeve, stability μ.
    lift_rate, mass, stiffness, balls
        z'; inertia and stiffness at the sleeve; 2 m r² of the balls.
    radius_rate, rounding
        r'; error estimate of μ.
    driving, gain
        Engine torque at the governor's mean speed, and its decrease per metre of lift; 0 without an engine.
    """

    radius: Node
    lift: Node
    force: Node
    speed: Node
    sleeve: Node
    margin: Node
    lift_rate: Node
    mass: Node
    stiffness: Node
    balls: Node
    radius_rate: Node
    rounding: Node
    driving: Node
    gain: Node

    def each(self) -> list["States"]:
        """States along the first axis, one after another."""
        return [States(*parts) for parts in zip(*self, strict=True)]

    @property
    def works(self) -> object:
        """Whether the force that holds the balls presses the sleeve down."""
        return (self.sleeve > 0.0) & (self.radius * self.radius_rate > 0.0)

    @property
    def stable(self) -> object:
        """Whether governors are stable or isochronous there, within rounding."""
        return self.works & (self.margin >= -self.rounding)


def throttled(governor: Element, graph: Graph, lift: Node, whole: Node, opens: Node | None) -> tuple[Node, Node]:
    """Engine torque at the governor's mean speed, and its decrease per metre of lift.

    Parameters
    ----------
    governor : Governor
    graph : Graph
    lift, whole : Node
        Of the sleeve, and at its outer stop [m].
    opens : Node or None
        As in `equilibrium_nodes`.
    """
    if governor.engine is None:
        return graph.zero, graph.zero
    if isinstance(governor.engine.throttle, TableThrottle):
        moment, rise = by_table(graph, governor.engine.throttle.table, lift)
        return moment, -rise
    full, closed = numbers(graph, "engine.throttle.full", "engine.throttle.closed")
    if governor.has_valve:
        if opens is None:
            opens = graph.apply(past, graph.number("engine.throttle.switch") - lift, graph.one, -graph.one)
        return 0.5 * (full + closed) + 0.5 * (full - closed) * opens, graph.zero
    gain = (full - closed) / whole
    return full - gain * lift, gain


def equilibrium_nodes(
    governor: Element, graph: Graph, x: Node, stops: Sequence[Node], opens: Node | None = None
) -> States:
    """A governor in equilibrium at a position, its lift measured from the inner stop.

    Parameters
    ----------
    governor : Governor
    graph : Graph
    x : Node
    stops : sequence of Node
        Positions of the inner and the outer stop.
    opens : Node, optional
        +1 or −1: whether an on-off valve is open; by default as the lift says.
    """
    link, datum = governor.linkage(graph, x), graph.number(DATUM)
    inner, outer = (governor.linkage(graph, stop).height for stop in stops)
    lift = link.height - datum * inner
    slope, curvature, size = governor.held(graph, x, link, lift)
    (mass, sleeve_mass), radius = numbers(graph, "ball_mass", "sleeve_mass"), link.radius
    force = graph.apply(equilibrium.controlling_force, slope, link.radius_rate)
    sleeve = graph.apply(equilibrium.sleeve_equivalent, slope, link.lift_rate)
    margin = graph.apply(equilibrium.stability_margin, *link[:3], slope, curvature)
    driving, gain = throttled(governor, graph, lift, outer - datum * inner, opens)
    inertia = graph.apply(equilibrium.moving_inertia, mass, sleeve_mass, link.radius_rate, link.rise, link.lift_rate)
    return States(
        radius=radius,
        lift=lift,
        force=force,
        speed=graph.apply(equilibrium.equilibrium_speed, force, mass, radius),
        sleeve=sleeve,
        margin=margin,
        lift_rate=link.lift_rate,
        mass=inertia / (link.lift_rate * link.lift_rate),
        stiffness=graph.apply(equilibrium.sleeve_stiffness, sleeve, margin, radius, link.radius_rate, link.lift_rate),
        balls=2.0 * mass * radius * radius,
        radius_rate=link.radius_rate,
        rounding=32.0 * EPS * (1.0 + abs(margin + 1.0)) * (1.0 + size / abs(slope)),
        driving=driving,
        gain=gain,
    )
