"""Forces between a cam and its follower, by the equilibrium of the follower.

A follower that slides is held by the contact force N against all that acts on it along its guide, N cos α = P; one that
oscillates against all moments about its pivot. Without friction N acts along the normal.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on cam mechanisms.
"""

from typing import NamedTuple

from engine.graph.nodes import Node
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import LinkLoads


class CamForces(NamedTuple):
    """Forces at a cam.

    Attributes
    ----------
    contact : Node
        Force between cam and follower along the normal, positive where they press on each other [N].
    closing : Node
        What presses the follower on the cam, along its motion: a force [N], or a moment about its pivot [N·m].
    """

    contact: Node
    closing: Node


def cam_forces(kinematics: Kinematics, name: str, loads: LinkLoads) -> CamForces:
    """Forces at a cam of the scene.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        Of the cam.
    loads : LinkLoads
        All that acts on the follower but its cam and what guides it.
    """
    cam, motion = kinematics.scene.cams[name], kinematics.cams[name]
    link, load = kinematics.links[cam.follower.link], loads.total(cam.follower.link)
    if cam.translating:
        closing = -load.force.dot(link.u)
        return CamForces(closing / motion.along, closing)
    lever = (motion.contact - link.origin.r).cross(motion.normal)
    return CamForces(-(load.moment / lever), -(kinematics.number(f"cams.{name}.follower.mode") * load.moment))
