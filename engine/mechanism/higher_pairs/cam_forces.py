"""Forces between a cam and its follower, by the equilibrium of the follower.

A follower that slides is held by the contact force N against all that acts on it along its guide, N cos α = P; one that
oscillates against all moments about its pivot. Without friction N acts along the normal; friction is one of the loads.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on cam mechanisms.
"""

from typing import NamedTuple

from engine.graph.nodes import Node
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Wrench


class CamForces(NamedTuple):
    """Forces at a cam.

    Attributes
    ----------
    contact : Node
        Force between cam and follower along the normal, positive where they press on each other [N].
    closing : Node
        What presses the follower on the cam, along its motion: a force [N], or a moment about its pivot [N·m].
    held : (Node, Node)
        What holds the follower: of a guide the normal force [N] and the moment [N·m]; of a pivot x and y [N].
    """

    contact: Node
    closing: Node
    held: tuple[Node, Node]


def cam_forces(kinematics: Kinematics, name: str, load: Wrench) -> CamForces:
    """Forces at a cam of the scene.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        Of the cam.
    load : Wrench
        All that acts on the follower but its cam and what holds it.
    """
    cam, motion = kinematics.scene.cams[name], kinematics.cams[name]
    link, arm = kinematics.links[cam.follower.link], motion.contact - kinematics.links[cam.follower.link].origin.r
    if cam.translating:
        closing = -load.force.dot(link.u)
        contact = closing / motion.along
        left = load.force + contact * motion.normal
        held = -left.dot(link.u.normal), -(load.moment + contact * arm.cross(motion.normal))
        return CamForces(contact, closing, held)
    contact = -(load.moment / arm.cross(motion.normal))
    closing = -(kinematics.number(f"cams.{name}.follower.mode") * load.moment)
    return CamForces(contact, closing, tuple(-(load.force + contact * motion.normal)))
