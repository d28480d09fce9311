"""A cam and its follower as nodes: motion of the follower, contact point, curvature of the profile.

The contact is computed in axes at the cam's axis, with the follower placed as in `engine.laws.cams.profiles`: a
translating follower moves along y; an oscillating one has its pivot on x and its arm above. The axes may be
left-handed.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.laws.cams.profiles import (
    contact_normal,
    flat_face_support,
    least_arm_angle,
    least_face_angle,
    least_height,
    oscillating_place,
    pitch_curvature,
    sliding_face_transmission,
    swinging_face_transmission,
    translating_place,
)
from engine.laws.elementary import direction_of
from engine.mechanism.assembly import Assembly, MovingPoint, Slide, Turning
from engine.mechanism.higher_pairs.motion_program import Displacement, Turned, add_program, turns_of_input
from engine.mechanism.vectors import Vector, named
from engine.parts.skeleton import CrankInput
from engine.scene.scene import Numbers, Scene


class CamMotion(NamedTuple):
    """A cam and its follower at a position.

    Attributes
    ----------
    displacement : Node
        Displacement of the follower from its lowest position [m or rad].
    normal : Vector
        Contact normal from the cam to the follower, in frame axes.
    contact : Vector
        Contact point [m].
    along, across : Node
        Cosine and sine of the pressure angle.
    curvature : Node
        Curvature of the cam's surface, positive if convex [1/m].
    undercut : tuple of Node
        Curves that are positive where the profile is not undercut: radius of the surface over that of the pitch curve,
        also of the other wall of a groove; under a flat face, radius of the surface over the base radius.
    face : Node or None
        Distance of the contact from the follower's origin along a flat face [m].
    """

    displacement: Node
    normal: Vector
    contact: Vector
    along: Node
    across: Node
    curvature: Node
    undercut: tuple[Node, ...]
    face: Node | None


class _Contact(NamedTuple):
    """Contact in the axes at the cam; the follower moves away from the cam in the direction `moves`."""

    normal: Vector
    place: Vector
    moves: Vector
    transmission: Node
    curvature: Node
    undercut: tuple[Node, ...]
    face: Node | None


class _Turned(NamedTuple):
    """Rotation of a cam: magnitude and sign of its ratio to the input, and the position of its axis [m]."""

    rate: Node
    sense: Node
    axis: Vector


def cam_ratio(scene: Scene, cam: str) -> str | None:
    """Path of the ratio of the shaft that carries a cam; None for a cam on the crank."""
    on = scene.cams[cam].on
    return f"shafts.{on}.ratio" if on in scene.shafts else None


def add_cam(assembly: Assembly, name: str) -> CamMotion:
    """Add the cam `name` and its follower to a mechanism."""
    cam = assembly.scene.cams[name]
    turned = _turned(assembly, name)
    displacement = add_program(assembly.graph, cam, f"cams.{name}", _angle(assembly, name, turned))
    contact, x, y = (_sliding if cam.translating else _swinging)(assembly, name, turned, displacement)

    def in_frame(v: Vector) -> Vector:
        return x * v.x + y * v.y

    assembly.sines[name] = named(contact.transmission, f"{name}_transmission")
    assembly.solutions[name] = (assembly.sines[name], *displacement)
    return CamMotion(
        named(displacement.s, f"{name}_displacement"),
        in_frame(contact.normal).called(f"{name}_normal"),
        (turned.axis + in_frame(contact.place)).called(f"{name}_contact"),
        contact.normal.dot(contact.moves),
        contact.normal.dot(contact.moves.normal),
        contact.curvature,
        contact.undercut,
        contact.face,
    )


def _turned(assembly: Assembly, name: str) -> _Turned:
    scene, graph = assembly.scene, assembly.graph
    drive, on, path = scene.input, scene.cams[name].on, cam_ratio(scene, name)
    if path is None or not isinstance(drive, CrankInput):
        return _Turned(graph.one, graph.one, assembly.points[drive.pivot].r)
    sense = graph.derived(f"sense of {on}", lambda n: np.sign(n[path]))
    return _Turned(abs(graph.number(path)), sense, assembly.points[scene.shafts[on].pivot].r)


def _angle(assembly: Assembly, name: str, turned: _Turned) -> Turned:
    """Angle of a cam from the start of its first section, increasing with the input."""
    scene, path = assembly.scene, cam_ratio(assembly.scene, name)

    def ratio(numbers: Numbers) -> float | np.ndarray:
        return 1.0 if path is None else np.abs(numbers[path])

    lag = assembly.graph.derived(
        f"angle of cam {name} before its first section", lambda n: np.mod(ratio(n) * n[f"cams.{name}.begin"], math.tau)
    )
    drive = scene.input
    own = 1.0 if path is None else abs(scene.shafts[scene.cams[name].on].ratio)
    return Turned(turned.rate * assembly.graph.q - lag, turned.rate, turns_of_input(drive, own))


def _sliding(
    assembly: Assembly, name: str, turned: _Turned, displacement: Displacement
) -> tuple[_Contact, Vector, Vector]:
    """Add a translating follower to the mechanism; return its contact and the axes of the contact."""
    graph, cam, at = assembly.graph, assembly.scene.cams[name], f"cams.{name}"
    guide, (s, s1, s2) = assembly.guides[cam.follower.guide], displacement
    x, y = -guide.u.normal, guide.u
    beside, base = guide.r - turned.axis, graph.number(f"{at}.base_radius")
    offset = beside.dot(x)
    moves = Vector(graph.zero, graph.one)
    if cam.follower.contact == "flat":
        height, radius, face = base + s, base + s + s2, turned.sense * s1
        quality = graph.apply(sliding_face_transmission, height)
        place, undercut = Vector(face, height), (radius / base,)
        contact = _Contact(moves, place, moves, quality, graph.one / radius, undercut, face - offset)
    else:
        height = graph.apply(least_height, base + _roller(assembly, name), offset) + s
        place = graph.apply(translating_place, offset, height, s1, s2)
        contact = _rolling(assembly, name, place, turned.sense, moves)
    d, v, a = height - beside.dot(y), turned.rate * s1, (turned.rate * turned.rate) * s2
    origin = MovingPoint(guide.r + d * guide.u, v * guide.u, a * guide.u)
    assembly.slider(cam.follower.link, origin, guide, Slide(d, v, a))
    return contact, x, y


def _swinging(
    assembly: Assembly, name: str, turned: _Turned, displacement: Displacement
) -> tuple[_Contact, Vector, Vector]:
    """Add an oscillating follower to the mechanism; return its contact and the axes of the contact."""
    graph, cam, at = assembly.graph, assembly.scene.cams[name], f"cams.{name}"
    s, s1, s2 = displacement
    mode, base = graph.number(f"{at}.follower.mode"), graph.number(f"{at}.base_radius")
    pivot = assembly.points[cam.follower.pivot]
    away = pivot.r - turned.axis
    distance = away.length
    x = away * (graph.one / distance)
    y, sense = (-mode) * x.normal, -(mode * turned.sense)
    if cam.follower.contact == "flat":
        psi = graph.apply(least_face_angle, base, distance) + s
    else:
        length = graph.number(f"{at}.follower.arm")
        psi = graph.apply(least_arm_angle, base + _roller(assembly, name), length, distance) + s
    c, sine = graph.apply(direction_of, psi)
    arm, moves = Vector(-c, sine), Vector(sine, c)
    if cam.follower.contact == "flat":
        radius, face = graph.apply(flat_face_support, distance, psi, s1, s2, sense)
        place, quality = (
            Vector(distance, graph.zero) + face * arm,
            graph.apply(swinging_face_transmission, psi, s1, sense),
        )
        contact = _Contact(moves, place, moves, quality, graph.one / radius, (radius / base,), face)
    else:
        place = graph.apply(oscillating_place, length, distance, psi, s1, s2)
        contact = _rolling(assembly, name, place, sense, moves)
    w, e = mode * turned.rate * s1, mode * (turned.rate * turned.rate) * s2
    assembly.link(cam.follower.link, Turning(pivot, x * arm.x + y * arm.y, w, e))
    return contact, x, y


def _roller(assembly: Assembly, name: str) -> Node:
    rolls = assembly.scene.cams[name].follower.contact == "roller"
    return assembly.number(f"cams.{name}.follower.roller_radius") if rolls else assembly.graph.zero


def _rolling(assembly: Assembly, name: str, place: tuple[Node, ...], sense: Node, moves: Vector) -> _Contact:
    """Contact of a roller, or of a knife edge, from the position of its centre."""
    graph, radius = assembly.graph, _roller(assembly, name)
    centre = Vector(*place[:2])
    normal = Vector(*graph.apply(contact_normal, *place[:4], sense))
    pitch = graph.apply(pitch_curvature, place, sense)
    convex, hollow = 1.0 - pitch * radius, 1.0 + pitch * radius
    undercut = ()
    if radius is not graph.zero:
        undercut = (convex, hollow) if assembly.scene.cams[name].closure == "form" else (convex,)
    touches = centre - radius * normal
    return _Contact(normal, touches, moves, normal.dot(moves), pitch / convex, undercut, None)
