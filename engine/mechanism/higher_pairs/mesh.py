"""The mesh of a shaft's wheel with its driver: pitch point, and directions of the tooth forces.

Relative to the common carrier, both wheels have the same velocity at the pitch point. With the ratio i of the speeds
and the line of centres D from the driver's axis to the shaft's, the pitch point is at D i/(i − 1) from the driver's
axis and at D/(i − 1) from the shaft's; for external teeth, i < 0, it is between the axes.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing and on the forces in higher pairs.
"""

from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.mechanism.assembly import Assembly
from engine.mechanism.vectors import Vector
from engine.scene.structure.trains import mesh_axis


class Toothing(NamedTuple):
    """The mesh of a wheel with another or with a rack.

    Attributes
    ----------
    pitch_point : Vector
        [m]
    along : Vector
        Direction of the common tangent of the pitch lines: of a rack, or the line of centres turned by a right angle.
    away : Vector
        Direction of the separating force on the wheel, for a rack on its pinion.
    radius : Node
        Signed radius of the wheel's pitch circle [m]: its moment is `radius` times the force along `along`.
    """

    pitch_point: Vector
    along: Vector
    away: Vector
    radius: Node


def mesh_of(assembly: Assembly, name: str) -> Toothing:
    """Mesh of the shaft `name`, which has a pivot."""
    graph, centre = assembly.graph, assembly.links[name].origin.r
    ratio = assembly.number(f"shafts.{name}.ratio")
    line = centre - assembly.points[mesh_axis(assembly.scene, name)].r
    distance = line.length
    along = line * (graph.one / distance)
    radius = distance / (ratio - 1.0)
    apart = graph.derived(f"sense in which {name} is pushed apart", lambda n: -np.sign(n[f"shafts.{name}.ratio"]))
    return Toothing(centre + radius * along, along.normal, apart * along, radius)
