"""A governor at one position, as nodes of a graph: everything that statics and motion need, for every type.

A type of governor states the radius r of its balls and the heights of balls and sleeve, h and z, at a position x; their
derivatives by x, written with primes, follow along the graph. With two balls of mass m on a spindle with speed ω, the
centrifugal forces do the work 2 m ω² r dr against the potential V of weights and spring: ω² 2 m r r' = V'. The
controlling force is that of one ball, F_c = m ω² r; its equivalent at the sleeve is E = V'/z'.

The numbers of a governor and its engine are named by their keys, such as "ball_mass" or "engine.load".

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 18; T. Bevan, The Theory of Machines, chapter 10
(controlling force, stability, effort); I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on governors.
"""

from collections.abc import Sequence
from typing import NamedTuple

from engine.elements.element import Element
from engine.elements.governors.governed_engine import TableThrottle
from engine.graph.derivatives import Slopes, derivative
from engine.graph.nodes import Graph, Node, Number
from engine.laws.rounding import EPS
from engine.laws.senses import past
from engine.laws.tables import Table, in_memory, on_piece, table_segment

# Key of a factor 1 of the sleeve's height at the inner stop: nudging it gives the rounding of lifts.
DATUM = "datum"
# The pieces of a table do not depend on the position.
_OF_PIECES: Slopes = {table_segment: {2: lambda found, *_: found.graph.zero}}


def rate_by(node: Node, x: Node) -> Node:
    """Derivative of a node by a position or a lift."""
    return derivative(node, {x: x.graph.one}, _OF_PIECES)


class Linkage(NamedTuple):
    """Radius of the balls, heights of the balls and of the sleeve above fixed levels; or their derivatives."""

    radius: Node
    balls: Node
    sleeve: Node

    def rates(self, x: Node) -> "Linkage":
        """Derivatives by the position: r', h', z'."""
        return Linkage(*(rate_by(part, x) for part in self))


def along_axis(x: Node, pivot: Node, length: Node) -> Node:
    """Extent along the axis of an arm whose end has a radius, √(l² − across²); NaN if the arm is too short."""
    across = x - pivot
    return x.graph.function("sqrt", length * length - across * across)


def moving_inertia(ball_mass: Node, sleeve_mass: Node, rates: Linkage) -> Node:
    """Inertia A of the governor's motion, with kinetic energy ½ A ẋ²: 2 m (r'² + h'²) + M z'² [kg]."""
    balls = rates.radius * rates.radius + rates.balls * rates.balls
    return 2.0 * ball_mass * balls + sleeve_mass * rates.sleeve * rates.sleeve


def numbers(graph: Graph, *keys: str) -> tuple[Number, ...]:
    """Numbers of the governor and its engine, or those given to their motion."""
    return tuple(map(graph.number, keys))


def by_table(table: Table, u: Node) -> Node:
    """Value of a table."""
    return on_piece(u, *u.graph.apply(table_segment, u.graph.memory, u.graph.store(in_memory(table)), u))[0]


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
        Lift of the sleeve, and its lift at the outer stop [m].
    opens : Node or None
        As in `equilibrium_nodes`.
    """
    if governor.engine is None:
        return graph.zero, graph.zero
    if isinstance(governor.engine.throttle, TableThrottle):
        moment = by_table(governor.engine.throttle.table, lift)
        return moment, -rate_by(moment, lift)
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
    rates, radius = link.rates(x), link.radius
    inner, outer = (governor.linkage(graph, stop).sleeve for stop in stops)
    lift = link.sleeve - datum * inner
    slope, size = governor.held(link, rates, lift)
    mass, sleeve_mass = numbers(graph, "ball_mass", "sleeve_mass")
    force, sleeve = slope / (2.0 * rates.radius), slope / rates.sleeve
    # The relative slope of ω² over the radius, (dω²/dr)/(ω²/r), which is that of F_c over a ray's minus 1.
    margin = radius * (rate_by(slope, x) / slope - rate_by(rates.radius, x) / rates.radius) / rates.radius - 1.0
    driving, gain = throttled(governor, graph, lift, outer - datum * inner, opens)
    return States(
        radius=radius,
        lift=lift,
        force=force,
        speed=graph.function("sqrt", force / (mass * radius)),
        sleeve=sleeve,
        margin=margin,
        lift_rate=rates.sleeve,
        mass=moving_inertia(mass, sleeve_mass, rates) / (rates.sleeve * rates.sleeve),
        # It is (V'' − ½ ω² J'')/z'² with J = 2 m r² + J_a.
        stiffness=sleeve * margin * rates.radius / (radius * rates.sleeve),
        balls=2.0 * mass * radius * radius,
        radius_rate=rates.radius,
        rounding=32.0 * EPS * (1.0 + abs(margin + 1.0)) * (1.0 + size / abs(slope)),
        driving=driving,
        gain=gain,
    )
