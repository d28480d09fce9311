"""Groups of free links, of any class, as nodes: seeds, Newton corrections with their proof, and rates."""

from collections.abc import Sequence
from typing import NamedTuple

from engine.graph.nodes import Node
from engine.laws.elementary import direction_of
from engine.laws.kinematics.closure import greater
from engine.laws.kinematics.seeds import between_seeds, place_in_range, place_in_table, proved, turned, two_seeds
from engine.mechanism.assembly import Assembly, Slide, Turning
from engine.mechanism.groups.closure_of_free import (
    ClosureOfFree,
    CutLink,
    Direction,
    LoopResidual,
    Unknown,
    hinged,
    point_on,
)
from engine.mechanism.groups.minors import Inverse, inverse
from engine.mechanism.groups.seed_tables import SeedTables
from engine.mechanism.input_motion import input_span
from engine.mechanism.vectors import Vector, named
from engine.scene.attachments import joint_owners
from engine.scene.structure.free_groups import FreeGroup

# Newton corrections of a seed; see `engine.laws.kinematics.seeds`.
_CORRECTIONS = 2

Place = Vector | Node


class Linearised(NamedTuple):
    """A group's loops, linearised at given values of its unknowns.

    Attributes
    ----------
    rest : list of Direction or Slide
        The unknowns, at rest.
    misses : list of LoopResidual
        Residuals of the loops, with their rates for fixed unknowns.
    units : list of dict of str to Turning
        For each unknown, the motion of all links if only that unknown moved, by 1 rad or by the group's size.
    inverse : Inverse
        Inverse of the Jacobian.
    """

    rest: list[Unknown]
    misses: list[LoopResidual]
    units: list[dict[str, Turning]]
    inverse: Inverse


class FreeMotion(NamedTuple):
    """A solved group, for the forces in it.

    Attributes
    ----------
    closure : ClosureOfFree
    links : dict of str to Turning
        The placed links, and the links that carry them.
    linearised : Linearised
    """

    closure: ClosureOfFree
    links: dict[str, Turning]
    linearised: Linearised


def add_free_group(assembly: Assembly, group: FreeGroup) -> FreeMotion:
    """Add a group of free links to a mechanism.

    Parameters
    ----------
    assembly : Assembly
    group : FreeGroup
    """
    closure = ClosureOfFree(assembly, group)
    tables = assembly.seed_tables[group.name] = _tables_of(closure)
    places = _seeded(closure, tables)
    for step in range(_CORRECTIONS):
        linear = linearised(closure, places)
        deltas = linear.inverse.times([-miss.r for miss in linear.misses])
        if step == 0:
            h = named(certificate(closure, linear, deltas), f"{group.name}_certificate")
            assembly.certificates[group.name] = h
            deltas = [assembly.graph.apply(proved, h, delta) for delta in deltas]
            assembly.solutions[group.name] = tuple(deltas)
        places = corrected(closure, places, deltas)
    linear = linearised(closure, places)
    motions = with_rates(closure, linear)
    links = closure.placed(motions)
    _register(closure, links, motions)
    graph, measures = assembly.graph, closure.measures()
    misses = [abs(m.r) / (size * closure.size) for m, size in zip(linear.misses, measures, strict=True)]
    assembly.transmits(group.name, transmission(closure, linear), _maximum(graph, misses))
    return FreeMotion(closure, links, linear)


def _tables_of(closure: ClosureOfFree) -> SeedTables:
    """Seed tables of a group, with the curves that make them: one correction and the rates, at given unknowns."""
    given = [closure.graph.given(f"{closure.group.name} unknown {i}") for i in range(len(closure.units))]
    linear = linearised(closure, _places_of(closure, given))
    deltas = linear.inverse.times([-miss.r for miss in linear.misses])
    curves = [delta * unit for delta, unit in zip(deltas, closure.units, strict=True)]
    _, first, second = zip(*with_rates(closure, linear), strict=True)
    curves += [*first, *second]
    curves += [certificate(closure, linear, deltas), transmission(closure, linear), closure.size]
    points = _points(closure, closure.placed(linear.rest))
    return SeedTables(closure.assembly.scene, closure.group, given, curves, points)


def _points(closure: ClosureOfFree, links: dict[str, Turning]) -> dict[str, Vector]:
    """Positions of all points of the group."""
    scene, own = closure.assembly.scene, set(closure.group.links)
    whole = links | {cut.name: _cut_link(closure, links, cut) for cut in closure.cut_links}
    found = {joint: (link, closure.local(link, joint)) for joint, link in joint_owners(scene).items() if link in own}
    found |= {p: (part.link, closure.local(part.link, p)) for p, part in scene.points.items() if part.link in own}
    coordinates = closure.assembly.coordinates
    return {name: coordinates(whole[link].at(place.to_frame(whole[link].u)).r) for name, (link, place) in found.items()}


def _places_of(closure: ClosureOfFree, unknowns: Sequence[Node]) -> list[Place]:
    """Directions of the unknowns that are angles; slides as they are."""
    apply, placed = closure.graph.apply, zip(unknowns, closure.cutting.placed, strict=True)
    return [node if pair.kind == "prismatic" else Vector(*apply(direction_of, node)) for node, (_, pair) in placed]


def _unknown(place: Place, first: Node, second: Node) -> Unknown:
    """An unknown with its rates."""
    return (Direction if isinstance(place, Vector) else Slide)(place, first, second)


def _seeded(closure: ClosureOfFree, tables: SeedTables) -> list[Place]:
    """Interpolate the unknowns between two seeds of the table."""
    graph, name = closure.graph, closure.group.name
    first, last = input_span(closure.assembly.scene, graph)
    whole, turns = last - first, float(closure.assembly.scene.has_cycle)
    table = graph.number_table(
        f"seeds of {name}",
        [graph.derived(f"{name} seed {i}", lambda n, i=i: tables(n).seeds[i]) for i in range(tables.entries)],
    )
    x = graph.apply(place_in_range, graph.q, first, graph.one / whole, turns)
    count = len(closure.units)
    interval, share, length = graph.apply(place_in_table, table, float(tables.intervals), float(count), x)
    step = whole * length
    seeds = [graph.apply(two_seeds, table, float(i), float(count), interval) for i in range(count)]
    return _places_of(closure, [graph.apply(between_seeds, both[:3], both[3:], share, step) for both in seeds])


def linearised(closure: ClosureOfFree, places: Sequence[Place]) -> Linearised:
    """Linearise the loops at given values of the unknowns."""
    zero, rest = closure.graph.zero, [_unknown(place, closure.graph.zero, closure.graph.zero) for place in places]
    units = []
    for k, unit in enumerate(closure.units):
        moving = [_unknown(place, unit, zero) if i == k else rest[i] for i, place in enumerate(places)]
        units.append(closure.placed(moving, still=True))
    columns = [[miss.v for miss in closure.misses(links)] for links in units]
    return Linearised(rest, closure.misses(closure.placed(rest)), units, inverse([*zip(*columns, strict=True)]))


def corrected(closure: ClosureOfFree, places: Sequence[Place], deltas: Sequence[Node]) -> list[Place]:
    """Apply a correction to the unknowns."""
    return [
        Vector(*closure.graph.apply(turned, *place, delta))
        if isinstance(place, Vector)
        else place + closure.size * delta
        for place, delta in zip(places, deltas, strict=True)
    ]


def with_rates(closure: ClosureOfFree, linear: Linearised) -> list[Unknown]:
    """Add first and second rates to the unknowns."""

    def motions(first: Sequence[Node], second: Sequence[Node]) -> list[Unknown]:
        each = zip(linear.rest, closure.units, first, second, strict=True)
        return [_unknown(rest[0], unit * v, unit * a) for rest, unit, v, a in each]

    first = linear.inverse.times([-miss.v for miss in linear.misses])
    carried = closure.misses(closure.placed(motions(first, [closure.graph.zero] * len(first))))
    return motions(first, linear.inverse.times([-miss.a for miss in carried]))


def certificate(closure: ClosureOfFree, linear: Linearised, deltas: Sequence[Node]) -> Node:
    """H of the Newton–Kantorovich theorem: a value up to ½ proves a root near these unknowns."""
    graph = closure.graph
    step = _maximum(graph, [abs(delta) for delta in deltas])
    # For h ≤ ½ the root is within twice the first correction.
    _, second = closure.bounds(linear.rest, linear.misses, step + step)
    rows = linear.inverse.rows
    changes = [sum(abs(entry) * bound for entry, bound in zip(row, second, strict=True)) for row in rows]
    return step * _maximum(graph, changes)


def _maximum(graph: object, nodes: Sequence[Node]) -> Node:
    worst = nodes[0]
    for node in nodes[1:]:
        worst = graph.apply(greater, worst, node)
    return worst


def transmission(closure: ClosureOfFree, linear: Linearised) -> Node:
    """Transmission index: the Jacobian's determinant, divided by the largest that the bounds of its rows allow.

    For a dyad RRR this is the sine of the transmission angle.
    """
    first, _ = closure.bounds(linear.rest, linear.misses, closure.graph.zero)
    largest = closure.graph.one
    for row in first:
        largest = largest * closure.graph.function("sqrt", sum(bound * bound for bound in row))
    return linear.inverse.determinant * (closure.graph.one / largest)


# Registering the solution


def _register(closure: ClosureOfFree, links: dict[str, Turning], motions: Sequence[Unknown]) -> None:
    """Register the group's links, sliders and joints."""
    assembly, group = closure.assembly, closure.group
    for name, _ in closure.cutting.placed:
        assembly.link(name, links[name])
    for cut in closure.cut_links:
        assembly.link(cut.name, _cut_link(closure, links, cut))
    for joint, owner in joint_owners(assembly.scene).items():
        if owner in group.links and joint not in assembly.scene.points:
            assembly.points[joint] = point_on(assembly.links[owner], closure.local(owner, joint)).called(joint)
    found = {pair.name: m for (_, pair), m in zip(closure.cutting.placed, motions, strict=True) if isinstance(m, Slide)}
    for pair in group.pairs:
        if pair.kind == "prismatic":
            slide = found.get(pair.name) or _slide(closure, pair.link, pair.other, closure.slider_guide(pair))
            assembly.slides[pair.link] = slide.called(pair.link)


def _slide(closure: ClosureOfFree, slider: str, carrier: str, guide: str) -> Slide:
    links = closure.assembly.links
    line, origin = closure.assembly.guide_on(guide, links[carrier]), links[slider].origin
    under = line.under(origin.r)
    v = line.u.dot(origin.v - under.v)
    return Slide(line.u.dot(origin.r - line.r), v, line.u.dot(origin.a - under.a - line.coriolis(v * line.u)))


def _cut_link(closure: ClosureOfFree, links: dict[str, Turning], cut: CutLink) -> Turning:
    """Motion of a cut link."""
    joint = closure.local(cut.name, cut.one.joint)
    if cut.other.kind == "revolute":
        one, other = closure.ends(links, cut)
        r, v, a = (two - first for first, two in zip(one, other, strict=True))
        bar = closure.bar(cut)
        per_square = closure.graph.one / bar.dot(bar)
        share = bar * per_square
        u = Vector(r.dot(share), share.cross(r))
        return hinged(Turning(one, u, r.cross(v) * per_square, r.cross(a) * per_square), joint)
    point = closure.joint_on(links, cut.one.beyond(cut.name), cut.one.joint)
    line, _ = closure.line(links, cut)
    u = line.u
    if cut.other.link != cut.name:
        angle = closure.assembly.direction(f"guides.{closure.slider_guide(cut.other)}.angle")
        u = Vector(angle.x, -angle.y).to_frame(line.u)
    return hinged(Turning(point, u, line.carrier.w, line.carrier.e), joint)
