"""Special points of Assur, from which plans of class III groups start.

Where the lines of two bars meet, the ternary link has a point whose velocity along each line equals that of the bar's
other end. Two directions give its image, as for a dyad's inner joint, and then the images of the link's joints.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on plans of groups of class III.
"""

from itertools import combinations
from typing import NamedTuple

from engine import FreeGroup
from sweeps.pictures.plans.pose import Pose

# Bars with a smaller sine of their angle meet too far away to draw.
_PARALLEL = 0.05


class PlanBar(NamedTuple):
    """A bar between the ternary link and a known joint.

    Attributes
    ----------
    link : str
    outer, inner : str
        Joints; the inner one is on the ternary link.
    """

    link: str
    outer: str
    inner: str


class SpecialPoint(NamedTuple):
    """A special point of a class III group.

    Attributes
    ----------
    name : str
        Unused letter as its name in plans.
    link : str
        Its ternary link.
    place : complex
        [m]
    bars : tuple of PlanBar
        The two bars that it is in line with.
    joint : str or None
        The ternary link's third joint; None if that pair is prismatic.
    """

    name: str
    link: str
    place: complex
    bars: tuple[PlanBar, PlanBar]
    joint: str | None


def special_point(pose: Pose, group: FreeGroup) -> SpecialPoint | None:
    """The special point nearest to the ternary link of a class III group; None if there is none to draw.

    Parameters
    ----------
    pose : Pose
    group : FreeGroup
    """
    ternary = [link for link in group.links if len(group.pairs_of(link)) == 3]
    if len(group.links) != 4 or len(ternary) != 1:
        return None
    (link,) = ternary
    found = []
    for one, two in combinations(_bars(group, link), 2):
        place = _crossing(pose, one, two)
        if place is not None:
            others = [p for p in group.pairs_of(link) if not {p.link, p.other} & {one.link, two.link}]
            joint = others[0].joint or None
            name = "W"
            while name in pose.motion.points:
                name += "w"
            found.append(SpecialPoint(name, link, place, (one, two), joint))
    middle = complex(pose.motion.axes[link][0][pose.k])
    return min(found, key=lambda special: abs(special.place - middle), default=None)


def _bars(group: FreeGroup, ternary: str) -> list[PlanBar]:
    found = []
    for link in group.links:
        around = group.pairs_of(link)
        if link == ternary or any(pair.kind != "revolute" for pair in around):
            continue
        inner = next(pair for pair in around if ternary in (pair.link, pair.other))
        (outer,) = [pair for pair in around if pair is not inner]
        found.append(PlanBar(link, outer.joint, inner.joint))
    return found


def _crossing(pose: Pose, one: PlanBar, two: PlanBar) -> complex | None:
    """Intersection of the lines of two bars."""
    (a, b), (p, c) = ([pose.point(name).place for name in (bar.outer, bar.inner)] for bar in (one, two))
    u, v = (b - a) / abs(b - a), (c - p) / abs(c - p)
    sine = (u.conjugate() * v).imag
    return None if abs(sine) < _PARALLEL else a + ((p - a).conjugate() * v).imag / sine * u
