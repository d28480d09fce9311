"""A single link as drawn in the mechanism."""

from sweeps.pictures.drawing import Primitive
from sweeps.pictures.drawing.frame import frame_parts
from sweeps.pictures.drawing.links import plates_and_bars
from sweeps.pictures.plans.pose import Pose


def link_figure(pose: Pose, link: str) -> list[Primitive]:
    """A single link as drawn in the mechanism, with its joints and its cam or wheel.

    Parameters
    ----------
    pose : Pose
    link : str
    """
    plates, bars = plates_and_bars(pose.motion, pose.k)
    joints = pose.motion.members(link)
    whole = (*frame_parts(pose.motion), *plates, *bars)
    return [p for p in whole if p.link == link or (p.layer == "joints" and p.text in joints)]
