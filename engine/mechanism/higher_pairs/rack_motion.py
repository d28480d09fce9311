"""Racks and pinions, put together from nodes: motion of what is driven, and where the pitch circle rolls on the rack.

The velocities of pinion and rack at the pitch point P agree. With u the direction of the guide, n the normal to its
left and r the signed radius, P = C − r n beside the pinion's axis C; along the guide, seen from what carries it,

    ṡ = ṡ_C + r (ω − ω_carrier)

where ṡ_C is the velocity of the axis along the guide. Place and acceleration follow in the same way.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing.
"""

from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node, Return
from engine.laws.elementary import direction_of
from engine.laws.kinematics.racks import pinion_turn, rack_slide
from engine.mechanism.assembly import Assembly, Slide, Turning
from engine.mechanism.vectors import Vector
from engine.scene.names import guide_of
from engine.scene.scene import Scene
from engine.scene.structure.meshes import carrier_of, rides_along


class Toothing(NamedTuple):
    """Where a pinion meshes with a rack.

    Attributes
    ----------
    pitch_point : Vector
        [m]
    along : Vector
        Direction of the rack.
    away : Vector
        Direction in which teeth push the pinion away from the rack.
    radius : Node
        Of the pitch circle, signed [m].
    """

    pitch_point: Vector
    along: Vector
    away: Vector
    radius: Node


def rack_guide(scene: Scene, name: str) -> str:
    """Guide along which the teeth of a rack, or those that a pinion meshes with, lie."""
    if name in scene.racks:
        return scene.racks[name].guide
    pinion = scene.pinions[name]
    return pinion.guide or guide_of(scene, pinion.rack)


def angle_of_link(assembly: Assembly, link: str) -> Node:
    """Angle of a link over all its turns [rad], against that which it is known against.

    Of what is geared to the crank that is the frame. Links of structural groups, which pinions, second inputs and
    sliders may hang on, have none: against themselves it is zero.
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
    """Add a rack that a pinion drives to a mechanism.

    Parameters
    ----------
    assembly : Assembly
    name : str
        Of the rack.
    """
    rack = assembly.scene.racks[name]
    carrier, line = assembly.scene.guides[rack.guide].link, assembly.guides[rack.guide]
    radius, start = (assembly.number(f"racks.{name}.{key}") for key in ("radius", "start"))
    axis, pinion = _axis_along(assembly, rack.pivot, rack.guide), assembly.links[rack.pinion]
    turned = angle_of_link(assembly, rack.pinion) - angle_of_link(assembly, carrier)
    turns = assembly.turns(rack.pinion) - assembly.turns(carrier)
    assembly.graph.returns((turned,), Return(f"racks.{name}.pinion", turns, none=True))
    slide = Slide(
        assembly.graph.apply(rack_slide, axis.d, start, radius, turned),
        axis.v + radius * (pinion.w - line.carrier.w),
        axis.a + radius * (pinion.e - line.carrier.e),
    )
    assembly.slider(name, line.along(slide), line, slide)


def add_pinion(assembly: Assembly, name: str) -> None:
    """Add a pinion that a rack drives, or that rolls on one, to a mechanism.

    Parameters
    ----------
    assembly : Assembly
    name : str
        Of the pinion.
    """
    scene, graph = assembly.scene, assembly.graph
    pinion, guide = scene.pinions[name], rack_guide(scene, name)
    line = assembly.guides[guide]
    radius, phase = (assembly.number(f"pinions.{name}.{key}") for key in ("radius", "phase"))
    axis = _axis_along(assembly, pinion.pivot, guide)
    still = Slide(graph.zero, graph.zero, graph.zero)
    rack = still if pinion.rack is None else assembly.slides[pinion.rack]
    angle, w, e = (graph.apply(pinion_turn, *ends, radius) for ends in zip(rack, axis, strict=True))
    assembly.turned[name] = phase + angle
    u = Vector(*graph.apply(direction_of, assembly.turned[name])).in_axes(line.carrier.u)
    assembly.link(name, Turning(assembly.points[pinion.pivot], u, line.carrier.w + w, line.carrier.e + e))


def toothing(assembly: Assembly, name: str) -> Toothing:
    """Mesh of a rack with the pinion that drives it, or of a pinion with the rack that does.

    Parameters
    ----------
    assembly : Assembly
    name : str
        Of what is driven.
    """
    scene, graph = assembly.scene, assembly.graph
    kind, part = ("racks", scene.racks[name]) if name in scene.racks else ("pinions", scene.pinions[name])
    u, path = assembly.guides[rack_guide(scene, name)].u, f"{kind}.{name}.radius"
    radius = assembly.number(path)
    side = graph.derived(f"side of {name} on which its pinion lies", lambda n: np.where(n[path] > 0.0, 1.0, -1.0))
    centre = assembly.points[part.pivot].r
    return Toothing(centre - radius * u.normal, u, side * u.normal, radius)


def _axis_along(assembly: Assembly, pivot: str, guide: str) -> Slide:
    """Place of a pinion's axis along a guide, and its rates against what carries that."""
    line, zero = assembly.guides[guide], assembly.graph.zero
    place = line.u.dot(assembly.points[pivot].r - line.r)
    riding = rides_along(assembly.scene, pivot, guide)
    if riding is None:
        return Slide(place, zero, zero)
    return assembly.slides[riding]._replace(d=place)
