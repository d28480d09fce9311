"""Nodes of the dyad RPP, a pivoted block and a sliding slotted link (Scotch yoke)."""

from engine.laws.kinematics.rpp import rpp_closure, rpp_position, rpp_rates, rpp_reactions
from engine.mechanism.assembly import Assembly, DyadStatics, MovingPoint, Slide, Turning
from engine.mechanism.vectors import Vector


def add_dyad(assembly: Assembly, name: str) -> DyadStatics:
    """Add a group RPP of the scene to a mechanism."""
    group, apply = assembly.scene.groups[name], assembly.graph.apply
    a, guide = assembly.points[group.first.joint], assembly.guides[group.second.guide]
    beta = assembly.direction(f"groups.{name}.second.slot_angle")
    line = (*guide.r, *guide.u)
    kx, ky, slot_c, slot_s, d, slide = apply(rpp_position, a.r, line, beta)
    crossing, slot = Vector(kx, ky), Vector(slot_c, slot_s)
    under_pin, under = guide.under(a.r), guide.under(crossing)
    relative = a.v - under_pin.v
    dv, slide_v = apply(rpp_rates, relative, guide.u, slot)
    da, slide_a = apply(rpp_rates, a.a - under_pin.a - guide.coriolis(relative), guide.u, slot)
    sliding = dv * guide.u
    origin = MovingPoint(crossing, under.v + sliding, under.a + guide.coriolis(sliding) + da * guide.u)
    assembly.slider(group.second.link, origin, guide, Slide(d, dv, da))
    assembly.links[group.first.link] = Turning(a, slot, guide.carrier.w, guide.carrier.e)
    assembly.slides[group.first.link] = Slide(slide, slide_v, slide_a).called(group.first.link)
    # The angle between slot and guide is constant, and so is the transmission index.
    assembly.transmits(name, beta.y, apply(rpp_closure, a.r, line, beta, crossing, slot, d, slide))
    return rpp_reactions, (guide.u, slot, slide)
