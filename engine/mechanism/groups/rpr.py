"""Nodes of the dyad RPR, a pivoted block and a slotted rocker."""

from engine.laws.kinematics.rpr import rpr_closure, rpr_position, rpr_rates, rpr_reactions
from engine.mechanism.assembly import Assembly, DyadStatics, Slide, Turning, Vanishing
from engine.mechanism.vectors import Vector


def add_dyad(assembly: Assembly, name: str) -> DyadStatics:
    """Add a group RPR of the scene to a mechanism."""
    group, apply, number = assembly.scene.groups[name], assembly.graph.apply, assembly.number
    a, d = assembly.points[group.first.joint], assembly.points[group.second.joint]
    offset = number(f"groups.{name}.second.offset")
    c, s, slide, sine = apply(rpr_position, a.r, d.r, offset, number(f"groups.{name}.mode"))
    u = Vector(c, s)
    known = (u, offset, slide)
    w, dv = apply(rpr_rates, a.v - d.v, *known)
    coriolis = (w + w) * (dv * u).normal
    e, da = apply(rpr_rates, a.a - d.a + (w * w) * (a.r - d.r) - coriolis, *known)
    rocker = Turning(d, u, w, e)
    assembly.link(group.second.link, rocker)
    assembly.links[group.first.link] = rocker._replace(origin=a)
    assembly.slides[group.first.link] = Slide(slide, dv, da).called(group.first.link)
    # The slot has no direction where A passes through D, at any angle between DA and the slot before.
    assembly.arms[name] = Vanishing(slide, offset)
    assembly.transmits(name, sine, apply(rpr_closure, a.r, d.r, offset, u, slide))
    return rpr_reactions, (u, slide)
