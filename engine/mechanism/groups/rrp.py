"""Nodes of the dyad RRP, a rod and a slider."""

from engine.laws.kinematics.rrp import rrp_closure, rrp_position, rrp_rates, rrp_reactions
from engine.mechanism.assembly import Assembly, DyadStatics, MovingPoint, Slide, Turning
from engine.mechanism.vectors import Vector


def add_dyad(assembly: Assembly, name: str) -> DyadStatics:
    """Add a group RRP of the scene to a mechanism."""
    group, apply, number = assembly.scene.groups[name], assembly.graph.apply, assembly.number
    a, guide = assembly.points[group.first.joint], assembly.guides[group.second.guide]
    r, offset = number(f"groups.{name}.first.length"), number(f"groups.{name}.second.offset")
    line = (*guide.r, *guide.u)
    bx, by, c, s, d, sine = apply(rrp_position, a.r, line, r, offset, number(f"groups.{name}.mode"))
    b, u = Vector(bx, by), Vector(c, s)
    ab, known = r * u, ((r, *u), guide.u, sine)
    under = guide.under(b)
    w, dv = apply(rrp_rates, under.v - a.v, *known)
    sliding = dv * guide.u
    carried = under.a + guide.coriolis(sliding)
    e, da = apply(rrp_rates, carried - a.a + (w * w) * ab, *known)
    joint = MovingPoint(b, under.v + sliding, carried + da * guide.u).called(group.inner)
    assembly.points[group.inner] = joint
    assembly.link(group.first.link, Turning(a, u, w, e))
    assembly.slider(group.second.link, joint, guide, Slide(d, dv, da))
    assembly.transmits(name, sine, apply(rrp_closure, a.r, line, offset, b, (r, *u), d))
    return rrp_reactions, known
