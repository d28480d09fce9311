"""Nodes of the dyad PRP, two sliders."""

from engine.laws.kinematics.prp import prp_closure, prp_position, prp_rates, prp_reactions
from engine.mechanism.assembly import Assembly, DyadStatics, MovingPoint, Slide
from engine.mechanism.vectors import Vector


def add_dyad(assembly: Assembly, name: str) -> DyadStatics:
    """Add a group PRP of the scene to a mechanism."""
    group, apply = assembly.scene.groups[name], assembly.graph.apply
    one, two = assembly.guides[group.first.guide], assembly.guides[group.second.guide]
    offset1, offset2 = (assembly.number(f"groups.{name}.{side}.offset") for side in ("first", "second"))
    lines = ((*one.r, *one.u), offset1, (*two.r, *two.u), offset2)
    bx, by, d1, d2 = apply(prp_position, *lines)
    b = Vector(bx, by)
    under1, under2 = one.under(b), two.under(b)
    v1, v2 = apply(prp_rates, under2.v - under1.v, one.u, two.u)
    carried1 = under1.a + one.coriolis(v1 * one.u)
    carried2 = under2.a + two.coriolis(v2 * two.u)
    a1, a2 = apply(prp_rates, carried2 - carried1, one.u, two.u)
    joint = MovingPoint(b, under1.v + v1 * one.u, carried1 + a1 * one.u).called(group.inner)
    assembly.points[group.inner] = joint
    assembly.slider(group.first.link, joint, one, Slide(d1, v1, a1))
    assembly.slider(group.second.link, joint, two, Slide(d2, v2, a2))
    # The angle between guides on one link is constant: the transmission index is then a per-variant number.
    assembly.transmits(name, one.u.cross(two.u), apply(prp_closure, *lines, b, d1, d2))
    return prp_reactions, (one.u, two.u)
