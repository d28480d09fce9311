"""The mesh of a shaft's wheel with its driver: pitch point, and directions of the tooth forces.

Relative to the common carrier, both wheels have the same velocity at the pitch point. With the ratio i of the speeds
and the line of centres D from the driver's axis to the shaft's, the pitch point is at D i/(i − 1) from the driver's
axis and at D/(i − 1) from the shaft's; for external teeth, i < 0, it is between the axes.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing and on the forces in higher pairs.
"""

from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.vectors import Vector
from engine.scene.structure.trains import mesh_axis


class Mesh(NamedTuple):
    """The mesh of two wheels.

    Attributes
    ----------
    pitch_point : Vector
    radius : Node
        Signed radius of the shaft's pitch circle; `radius` × `along` is the arm from the shaft to the pitch point.
    across : Vector
        Direction in which a force on the shaft at the pitch point has the moment `radius` × force.
    along : Vector
        Direction of the line of centres, from the driver's axis to the shaft's.
    away : Vector
        Direction of the separating force on the shaft: away from the driver for external teeth.
    slope : Node
        Tangent of the pressure angle.
    """

    pitch_point: Vector
    radius: Node
    across: Vector
    along: Vector
    away: Vector
    slope: Node


def mesh_of(kinematics: Kinematics, name: str) -> Mesh:
    """Mesh of the shaft `name`, which has a pivot."""
    graph, centre = kinematics.graph, kinematics.links[name].origin.r
    ratio = kinematics.number(f"shafts.{name}.ratio")
    line = centre - kinematics.points[mesh_axis(kinematics.scene, name)].r
    distance = line.length
    along = line * (graph.one / distance)
    radius = distance / (ratio - 1.0)
    slope = graph.derived(f"slope of the teeth of {name}", lambda n: np.tan(n[f"shafts.{name}.pressure_angle"]))
    apart = graph.derived(f"sense in which {name} is pushed apart", lambda n: -np.sign(n[f"shafts.{name}.ratio"]))
    return Mesh(centre + radius * along, radius, along.normal, along, apart * along, slope)
