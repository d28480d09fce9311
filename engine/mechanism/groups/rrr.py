"""Nodes of the dyad RRR, two bars."""

from engine.laws.kinematics.rrr import rrr_closure, rrr_position, rrr_rates, rrr_reactions
from engine.mechanism.assembly import Assembly, DyadStatics, MovingPoint, Turning
from engine.mechanism.vectors import Vector


def add_dyad(assembly: Assembly, name: str) -> DyadStatics:
    """Add a group RRR of the scene to a mechanism."""
    group, apply, number = assembly.scene.groups[name], assembly.graph.apply, assembly.number
    a, d = assembly.points[group.first.joint], assembly.points[group.second.joint]
    r1, r2 = number(f"groups.{name}.first.length"), number(f"groups.{name}.second.length")
    bx, by, c1, s1, c2, s2, sine = apply(rrr_position, a.r, d.r, r1, r2, number(f"groups.{name}.mode"))
    u1, u2 = Vector(c1, s1), Vector(c2, s2)
    ab, db = r1 * u1, r2 * u2
    known = ((r1, *u1), (r2, *u2), sine)
    w1, w2 = apply(rrr_rates, d.v - a.v, *known)
    e1, e2 = apply(rrr_rates, d.a - a.a + (w1 * w1) * ab - (w2 * w2) * db, *known)
    first, second = Turning(a, u1, w1, e1), Turning(d, u2, w2, e2)
    assembly.link(group.first.link, first)
    assembly.link(group.second.link, second)
    # Derived from the side whose outer joint is fixed, the joint's motion takes fewer operations.
    b = second.at(db) if d.v == assembly.nowhere else first.at(ab)
    assembly.points[group.inner] = MovingPoint(Vector(bx, by), b.v, b.a).called(group.inner)
    assembly.transmits(name, sine, apply(rrr_closure, a.r, d.r, (bx, by), (r1, *u1), (r2, *u2)))
    return rrr_reactions, known
