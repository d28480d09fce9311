"""Springs with dampers between two points, and torsion springs, as nodes."""

from collections.abc import Iterator, Mapping

import numpy as np

from engine.graph.nodes import Alike, Constant, Node, Number, Return, value_of
from engine.laws.loads import spring
from engine.laws.senses import angle_on_side, side
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Characteristic, Grip, Load, load
from engine.scene.pairs import holder_of


def spring_loads(kinematics: Kinematics, name: str) -> Iterator[Load]:
    """The pull of the spring `name`, and of its damper if it has one."""
    scene, graph, at = kinematics.scene, kinematics.graph, f"springs.{name}"
    ends = scene.springs[name].between
    a, b = (kinematics.points[end] for end in ends)
    length = (b.r - a.r).length
    direction = (b.r - a.r) * (1.0 / length)
    rate = (b.v - a.v).dot(direction)
    holder, bearer = holder_of(scene, ends[1]), holder_of(scene, ends[0])
    grip = Grip(holder, b, direction, (bearer, a))
    pull = _pull(graph.number(f"{at}.free_length"), length)
    yield load(name, Characteristic(graph.number(f"{at}.stiffness"), pull), grip, rate, None)
    if scene.springs[name].damping or f"{at}.damping" in kinematics.varied:
        damping = graph.derived(f"{at} at speed", lambda n: n[f"{at}.damping"] * n["input.speed"])
        yield load(name, Characteristic(damping, -rate, 1), grip, rate, None)


def torsion_spring(kinematics: Kinematics, name: str) -> Characteristic:
    """The moment of the torsion spring `name`; it jumps where its link points along −x."""
    graph, at = kinematics.graph, f"moments.{name}"
    on = kinematics.scene.moments[name].on
    angle = _angle(kinematics, on)
    graph.returns((angle,), Return(f"{at}.on", kinematics.turns(on), none=True))
    moment = _pull(graph.number(f"{at}.free_angle"), angle)
    return Characteristic(graph.number(f"{at}.stiffness"), moment)


def _pull(free: Number, length: Node) -> Node:
    """Force divided by stiffness; parallel springs become one, with their total stiffness and mean free length."""
    graph = length.graph

    def total(springs: list[tuple[Number | Constant, Number]]) -> Node:
        stiffness = sum((k for k, _ in springs), graph.zero)
        label = " + ".join(f"{k.label} * {own.label}" for k, own in springs)

        def mean(numbers: Mapping) -> float | np.ndarray:
            whole = value_of(stiffness, numbers)
            force = sum(value_of(k, numbers) * value_of(own, numbers) for k, own in springs)
            return np.where(whole == 0.0, 0.0, force / np.where(whole == 0.0, 1.0, whole))

        return stiffness * graph.apply(spring, 1.0, graph.derived(f"mean of {label}", mean), length)

    return graph.alike(graph.apply(spring, 1.0, free, length), Alike(("spring", length), free, total))


def _angle(kinematics: Kinematics, name: str) -> Node:
    """Angle of a link in (−π, π]."""
    graph, link = kinematics.graph, kinematics.links[name]
    graph.switches(link.u.y, link.w * link.u.x)
    above = graph.held(graph.apply(side, link.u.y))
    return graph.apply(angle_on_side, above, *link.u)
