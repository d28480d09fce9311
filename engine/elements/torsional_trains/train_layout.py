"""Structure of a torsional train: nodes of masses connected by gears, and the tree of shafts between the nodes.

Everything is reduced to the shaft of the first mass. With g the speed of a mass over that of the first one for rigid
shafts, its inertia is multiplied by g², as are the stiffness and damping of a shaft at that speed, and a torque by g.
Masses connected by gears then form one node, and a twist is the difference of two nodes' angles.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple

FRAME_END = "frame"


class LayoutProblem(ValueError):
    """Masses, shafts and gears that do not form a tree."""


class Joint(NamedTuple):
    """A shaft or a gear: its name, the masses (or the frame) at its ends, whether it is a gear."""

    name: str
    first: str
    second: str
    rigid: bool


class TrainLayout(NamedTuple):
    """The tree of a train.

    Attributes
    ----------
    masses : tuple of str
    node_of : dict of str to int
        Node of each mass; 0 for the first mass. Parents have lower indices than their children.
    parents : tuple of int
        Parent of each node; -1 for node 0.
    shaft_to : tuple of str
        Shaft between each node and its parent; "" for node 0.
    grounded : dict of str to str
        Masses at the other end of shafts to the frame.
    path : tuple of (str, str, str, bool)
        Masses in the order of the traversal: the mass, the previous mass, the joint, and whether it is traversed from
        its first end to its second.
    """

    masses: tuple[str, ...]
    node_of: dict[str, int]
    parents: tuple[int, ...]
    shaft_to: tuple[str, ...]
    grounded: dict[str, str]
    path: tuple[tuple[str, str, str, bool], ...]

    @property
    def is_free(self) -> bool:
        """Whether the whole train can rotate: no shaft holds it to the frame."""
        return not self.grounded


def train_layout(masses: Sequence[str], joints: Sequence[Joint]) -> TrainLayout:
    """The tree that shafts and gears form between a train's masses.

    Parameters
    ----------
    masses : sequence of str
    joints : sequence of Joint
        Between masses, or from a mass to the frame.

    Raises
    ------
    LayoutProblem
        The joints close a loop, leave masses unconnected, or name an unknown mass.
    """
    beside: Mapping[str, list[tuple[Joint, str]]] = {mass: [] for mass in masses}
    grounded: dict[str, str] = {}
    for joint in joints:
        ends = [end for end in (joint.first, joint.second) if end != FRAME_END]
        unknown = [end for end in ends if end not in beside]
        if unknown:
            raise LayoutProblem(f"{joint.name}: there is no mass {unknown[0]!r}; masses are {', '.join(masses)}")
        if len(ends) == 2:
            beside[ends[0]].append((joint, ends[1]))
            beside[ends[1]].append((joint, ends[0]))
        elif len(ends) == 1 and not joint.rigid:
            grounded[joint.name] = ends[0]
        else:
            raise LayoutProblem(f"{joint.name}: one end must be a mass, and of a gear both")
    node_of, parents, shaft_to, path = {masses[0]: 0}, [-1], [""], []
    # Collect the masses joined by gears in the node before following its shafts.
    passed, waiting = set(), [masses[0]]
    while waiting:
        mass = waiting.pop(0)
        for joint, other in sorted(beside[mass], key=lambda found: not found[0].rigid):
            if joint.name in passed:
                continue
            passed.add(joint.name)
            if other in node_of:
                raise LayoutProblem(
                    f"{joint.name} closes a loop of shafts and gears: a train is a chain or a tree; combine "
                    "parallel shafts into one with parts in parallel"
                )
            path.append((other, mass, joint.name, joint.first == mass))
            if joint.rigid:
                node_of[other] = node_of[mass]
                waiting.insert(0, other)
            else:
                node_of[other] = len(parents)
                parents.append(node_of[mass])
                shaft_to.append(joint.name)
                waiting.append(other)
    apart = [mass for mass in masses if mass not in node_of]
    if apart:
        raise LayoutProblem(f"{', '.join(apart)}: no shafts or gears join them to {masses[0]!r}; add one")
    in_order = {mass: node_of[mass] for mass in masses}
    return TrainLayout(tuple(masses), in_order, tuple(parents), tuple(shaft_to), grounded, tuple(path))
