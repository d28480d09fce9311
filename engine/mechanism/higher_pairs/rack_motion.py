"""Racks and pinions as nodes: motion of the driven part, and the pitch point.

Pinion and rack have the same velocity at the pitch point P. With u the direction of the guide, n its normal to the left
and r the signed radius, P = C − r n, where C is the pinion's axis. Relative to the carrier, along the guide,

    ṡ = ṡ_C + r (ω − ω_carrier)

with ṡ_C the velocity of the axis along the guide. Displacement and acceleration follow in the same way.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing.
"""

import numpy as np

from engine.graph.nodes import Node, Return
from engine.laws.elementary import direction_of
from engine.mechanism.assembly import Assembly, Slide, Turning
from engine.mechanism.higher_pairs.mesh import Toothing
from engine.mechanism.vectors import Vector
from engine.scene.attachments import guide_of
from engine.scene.scene import Scene
from engine.scene.structure.meshes import carrier_of, rides_along


def rack_guide(scene: Scene, name: str) -> str:
    """Guide parallel to the teeth of a rack, or of the rack that a pinion meshes with."""
    if name in scene.racks:
        return scene.racks[name].guide
    pinion = scene.pinions[name]
    return pinion.guide or guide_of(scene, pinion.rack)


def angle_of_link(assembly: Assembly, link: str) -> Node:
    """Total angle of a link over all turns [rad], relative to its reference.

    The reference is the frame for links geared to the crank. A link of a structural group, which may carry pinions,
    second inputs and sliders, is its own reference: its angle is zero.
    """
    if link in assembly.angles:
        return assembly.angles[link]
    carrier = carrier_of(assembly.scene, link)
    if carrier is None:
        return assembly.graph.zero
    guide = guide_of(assembly.scene, link)
    own = assembly.turned[link] if guide is None else assembly.number(f"guides.{guide}.angle")
    return angle_of_link(assembly, carrier) + own


def add_rack(assembly: Assembly, name: str) -> None:
    """Add the rack `name`, driven by a pinion, to a mechanism."""
    rack = assembly.scene.racks[name]
    carrier, line = assembly.scene.guides[rack.guide].link, assembly.guides[rack.guide]
    radius, start = (assembly.number(f"racks.{name}.{key}") for key in ("radius", "start"))
    axis, pinion = _axis_along(assembly, rack.pivot, rack.guide), assembly.links[rack.pinion]
    turned = angle_of_link(assembly, rack.pinion) - angle_of_link(assembly, carrier)
    turns = assembly.turns(rack.pinion) - assembly.turns(carrier)
    assembly.graph.returns((turned,), Return(f"racks.{name}.pinion", turns, none=True))
    slide = Slide(
        axis.d + start + radius * turned,
        axis.v + radius * (pinion.w - line.carrier.w),
        axis.a + radius * (pinion.e - line.carrier.e),
    )
    assembly.slider(name, line.along(slide), line, slide)


def add_pinion(assembly: Assembly, name: str) -> None:
    """Add the pinion `name`, driven by a rack or rolling on one, to a mechanism."""
    scene, graph = assembly.scene, assembly.graph
    pinion, guide = scene.pinions[name], rack_guide(scene, name)
    line = assembly.guides[guide]
    radius, phase = (assembly.number(f"pinions.{name}.{key}") for key in ("radius", "phase"))
    axis = _axis_along(assembly, pinion.pivot, guide)
    still = Slide(graph.zero, graph.zero, graph.zero)
    rack = still if pinion.rack is None else assembly.slides[pinion.rack]
    angle, w, e = ((slide - own) / radius for slide, own in zip(rack, axis, strict=True))
    assembly.turned[name] = phase + angle
    u = Vector(*graph.apply(direction_of, assembly.turned[name])).to_frame(line.carrier.u)
    assembly.link(name, Turning(assembly.points[pinion.pivot], u, line.carrier.w + w, line.carrier.e + e))


def toothing(assembly: Assembly, name: str) -> Toothing:
    """Mesh of the driven rack or pinion `name`."""
    scene, graph = assembly.scene, assembly.graph
    kind, part = ("racks", scene.racks[name]) if name in scene.racks else ("pinions", scene.pinions[name])
    u, path = assembly.guides[rack_guide(scene, name)].u, f"{kind}.{name}.radius"
    radius = assembly.number(path)
    side = graph.derived(f"side of {name} on which its pinion lies", lambda n: np.where(n[path] > 0.0, 1.0, -1.0))
    centre = assembly.points[part.pivot].r
    return Toothing(centre - radius * u.normal, u, side * u.normal, radius)


def _axis_along(assembly: Assembly, pivot: str, guide: str) -> Slide:
    """Position of a pinion's axis along a guide, and its rates relative to the guide's carrier."""
    line, zero = assembly.guides[guide], assembly.graph.zero
    place = line.u.dot(assembly.points[pivot].r - line.r)
    riding = rides_along(assembly.scene, pivot, guide)
    if riding is None:
        return Slide(place, zero, zero)
    return assembly.slides[riding]._replace(d=place)
