"""The mesh of a shaft's wheel with that of its driver: pitch point, and directions of the forces between the teeth.

Relative to what carries both, the pitch point has one velocity on both wheels: with the ratio i of the speeds and the
line of centres D from the driver's axis to the shaft's it lies at D i/(i − 1) from the driver's, D/(i − 1) from the
shaft's; between both axes for external teeth, i < 0.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing and on the forces in higher pairs.
"""

from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.vectors import Vector
from engine.scene.structure.trains import mesh_axis


class Mesh(NamedTuple):
    """Where two wheels mesh.

    Attributes
    ----------
    pitch_point : Vector
    radius : Node
        Of the shaft's pitch circle, signed: times the direction of the line it is the arm to the pitch point.
    across : Vector
        Direction in which a force on the shaft at the pitch point has the moment `radius` × force.
    along : Vector
        Direction of the line of centres, from the driver's axis to the shaft's.
    away : Vector
        Direction in which teeth push the shaft apart from its driver: external ones away from it.
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
    """Mesh of a shaft with a pivot.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        Of the shaft.
    """
    graph, centre = kinematics.graph, kinematics.links[name].origin.r
    ratio = kinematics.number(f"shafts.{name}.ratio")
    line = centre - kinematics.points[mesh_axis(kinematics.scene, name)].r
    distance = line.length
    along = line * (graph.one / distance)
    radius = distance / (ratio - 1.0)
    slope = graph.derived(f"slope of the teeth of {name}", lambda n: np.tan(n[f"shafts.{name}.pressure_angle"]))
    apart = graph.derived(f"sense in which {name} is pushed apart", lambda n: -np.sign(n[f"shafts.{name}.ratio"]))
    return Mesh(centre + radius * along, radius, along.normal, along, apart * along, slope)
