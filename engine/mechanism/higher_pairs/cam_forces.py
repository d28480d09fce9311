"""Forces between a cam and its follower, from the equilibrium of the follower.

The contact force N balances all loads along the guide of a translating follower, N cos α = P, or all moments about the
pivot of an oscillating one. N acts along the contact normal; friction is one of the loads.

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
        Force between cam and follower along the normal, positive in compression [N].
    closing : Node
        Load that presses the follower on the cam, along its motion: a force [N], or a moment about its pivot [N·m].
    held : (Node, Node)
        Reaction on the follower: normal force [N] and moment [N·m] of a guide; x and y of a pivot [N].
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
    load : Wrench
        All loads on the follower except the forces of its cam and of its guide or pivot.
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
