"""Positions, velocities and accelerations of points, links and sliders."""

from collections.abc import Callable
from functools import partial

from engine import mechanism
from engine.graph.nodes import Node
from engine.mechanism.mechanics import Mechanics
from engine.mechanism.vectors import Vector
from engine.parts.skeleton import FRAME
from engine.quantities.expressions import Angle
from engine.quantities.register import Declared, Field, InputUnits, detail, known
from engine.scene.attachments import input_points, joint_owners
from engine.scene.pairs import held_by_frame

_WORDS = (
    "{}",
    "first derivative of the {} with respect to the input",
    "second derivative of the {} with respect to the input",
)
_SUFFIXES = ("", "_phi", "_phiphi")
# Symbols of a coordinate and of its time derivatives, words for the derivatives, and their names.
_KINDS = {
    "x": (("x_{owner}", "v_{owner}x", "a_{owner}x"), "x component of the {rate} of point {owner}", ("vx", "ax")),
    "y": (("y_{owner}", "v_{owner}y", "a_{owner}y"), "y component of the {rate} of point {owner}", ("vy", "ay")),
    "angle": (
        ("φ_{owner}", "ω_{owner}", "ε_{owner}"),
        "angular {rate} of link {owner}",
        ("angular_velocity", "angular_acceleration"),
    ),
    "slide": (("s_{owner}", "v_{owner}", "a_{owner}"), "{rate} of slider {owner}", ("velocity", "acceleration")),
}


def declare(mechanics: Mechanics) -> Declared:
    """Fields of every moving point, link, slider and group."""
    k, scene = mechanics.kinematics, mechanics.scene
    for name in _moving_points(mechanics):
        point = k.points[name]
        for i, axis in enumerate("xy"):
            nodes = (k.coordinates(point.r)[i], point.v[i], point.a[i])
            yield from _coordinate(mechanics, name, axis, f"{axis} coordinate of point {name}", "m", nodes)
    for name in mechanics.structure.links:
        link = k.links[name]
        nodes = (Angle(link.u), link.w, link.e)
        yield from _coordinate(mechanics, name, "angle", f"angle of link {name}", "rad", nodes)
    for name in mechanics.structure.sliders:
        words = f"displacement of slider {name}"
        yield from _coordinate(mechanics, name, "slide", words, "m", tuple(k.slides[name]))
    for name in scene.groups:
        words = f"sine of the transmission angle of group {name}"
        yield Field(f"{name}.transmission", words, "1", known(k.sines[name]), "sin γ")
    for name, h in k.certificates.items():
        words = f"determinant of the loop equations of {name}, relative to its maximum"
        yield Field(f"{name}.transmission", words, "1", known(k.sines[name]))
        words = f"Newton–Kantorovich h of {name}: up to 1/2 proves its assembly mode"
        yield Field(f"{name}.certificate", words, "1", known(h))
    for name, motion in k.noncircular.items():
        yield from _of_wheel(name, scene.noncircular_wheels[name].geared_to, motion, k.coordinates)


def _of_wheel(
    name: str,
    driver: str,
    motion: "mechanism.higher_pairs.noncircular_motion.NoncircularMotion",
    coordinates: Callable[[Vector], Vector],
) -> Declared:
    """Fields of a non-circular wheel."""
    words = f"ratio of the speed of {name} to that of {driver}, by magnitude"
    yield Field(f"{name}.ratio", words, "1", known(motion.rate), "i")
    for axis, node in zip("xy", coordinates(motion.pitch_point), strict=True):
        yield Field(f"{name}.pitch_{axis}", f"{axis} coordinate of the pitch point of {name}", "m", known(node))
    for axis, node in zip("xy", motion.tangent, strict=True):
        words = (
            f"{axis} component of the common unit tangent of the pitch curves of {name} and {driver} at the pitch point"
        )
        yield Field(f"{name}.tangent_{axis}", words, "1", known(node))
    wheels = (
        ("", name, motion.radius, motion.curvature),
        ("driver_", driver, motion.driver_radius, motion.driver_curvature),
    )
    for prefix, wheel, radius, curvature in wheels:
        words = f"radius of the pitch curve of {wheel} at the pitch point with {name if prefix else driver}"
        yield Field(f"{name}.{prefix}pitch_radius", words, "m", known(radius), "r")
        words = f"curvature of the pitch curve of {wheel} at the pitch point, positive if convex"
        yield Field(f"{name}.{prefix}curvature", words, "m-1", known(curvature), "κ")


def _moving_points(mechanics: Mechanics) -> list[str]:
    scene = mechanics.scene
    names = [name for name, point in scene.points.items() if point.link != FRAME]
    names += [group.inner for group in scene.groups.values() if hasattr(group, "inner")]
    names += [joint for joint, link in joint_owners(scene).items() if link in scene.links and joint not in names]
    return [*names, *input_points(scene)]


def _coordinate(
    mechanics: Mechanics, owner: str, kind: str, words: str, unit: str, nodes: tuple[Node | Angle, Node, Node]
) -> Declared:
    """A coordinate, its derivatives with respect to the input, and its time derivatives at constant input speed."""
    q, graph = InputUnits.of(mechanics.scene).q, mechanics.graph
    symbols, rates, (first, second) = _KINDS[kind]
    symbol, of_first, of_second = (text.format(owner=owner) for text in symbols)
    for order, (suffix, word, node) in enumerate(zip(_SUFFIXES, _WORDS, nodes, strict=True)):
        units = f"{unit} {q}-{order}" if order else unit
        field = detail if order else Field
        yield field(f"{owner}.{kind}{suffix}", word.format(words), units, known(node), symbol + "′" * order)
    guided = kind in ("angle", "slide") and owner in held_by_frame(mechanics.scene) and nodes[2] is not graph.zero
    answers = ("peak",) if guided else ()
    speed, squared = mechanics.speed, mechanics.speed_squared
    velocity, acceleration = (rates.format(rate=rate, owner=owner) for rate in ("velocity", "acceleration"))
    timed = partial(graph.combination, [(speed, nodes[1])])
    field = detail if kind in "xy" else Field
    yield field(f"{owner}.{first}", velocity, f"{unit} s-1", timed, of_first, answers)
    timed = partial(graph.combination, [(squared, nodes[2])])
    yield field(f"{owner}.{second}", f"{acceleration} at constant speed", f"{unit} s-2", timed, of_second, answers)
