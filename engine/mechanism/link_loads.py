"""What acts on each link: forces and moments one by one, and summed about the link's origin."""

from typing import Literal, NamedTuple

from engine.graph.nodes import Node
from engine.mechanism.assembly import Assembly, MovingPoint
from engine.mechanism.vectors import Vector

# Components of a reaction: x and y in a joint, normal force and moment in a guide.
Components = tuple[Node, Node]


class LinkForce(NamedTuple):
    """A force or a moment on a link.

    Attributes
    ----------
    kind : {"weight", "inertia", "load", "reaction", "friction", "gears", "drive"}
        Of journals friction is a moment; "gears" are moments between wheels whose teeth have no pressure angle.
    name : str
        Of the body, load, pair or wheel that it belongs to; `WHEEL.teeth` of a force between teeth.
    link : str
        On which it acts.
    source : str or None
        Link from which it comes; None where it comes from outside the machine.
    at : Vector or None
        Point of a force [m]; None of a moment.
    force : Vector or None
        [N]
    moment : Node or None
        [N·m]
    """

    kind: Literal["weight", "inertia", "load", "reaction", "friction", "gears", "drive"]
    name: str
    link: str
    source: str | None
    at: Vector | None = None
    force: Vector | None = None
    moment: Node | None = None

    def __add__(self, other: "LinkForce") -> "LinkForce":
        """What another one like it at the same point adds up to."""
        if self.moment is not None:
            return self._replace(moment=self.moment + other.moment)
        return self._replace(force=self.force + other.force)

    @property
    def opposite(self) -> "LinkForce":
        """What acts on the link that it comes from."""
        force, moment = (None if part is None else -part for part in (self.force, self.moment))
        return self._replace(link=self.source, source=self.link, force=force, moment=moment)


class Wrench(NamedTuple):
    """A force [N] and its moment [N·m] about the origin of the link it acts on."""

    force: Vector
    moment: Node

    def __add__(self, other: "Wrench") -> "Wrench":
        return Wrench(self.force + other.force, self.moment + other.moment)

    @property
    def is_nothing(self) -> bool:
        """Whether it is zero at all positions of all variants."""
        zero = self.moment.graph.zero
        return self.moment is zero and self.force == (zero, zero)


class LinkLoads:
    """The forces and moments on every link of a mechanism.

    Parameters
    ----------
    assembly : Assembly
    """

    def __init__(self, assembly: Assembly) -> None:
        self._links, zero = assembly.links, assembly.graph.zero
        self._nothing = Wrench(assembly.nowhere, zero)
        self._of: dict[str, list[Wrench]] = {name: [] for name in assembly.links}

    def add(self, link: str, wrench: Wrench) -> None:
        """Add a force and its moment about the link's origin."""
        if not wrench.is_nothing:
            self._of[link].append(wrench)

    def push(self, link: str, at: MovingPoint, force: Vector) -> None:
        """Add a force at a point."""
        arm = at.r - self._links[link].origin.r
        self.add(link, Wrench(force, arm.cross(force)))

    def twist(self, link: str, moment: Node) -> None:
        """Add a moment."""
        self.add(link, self._nothing._replace(moment=moment))

    def total(self, link: str) -> Wrench:
        """Sum of what acts on a link."""
        return sum(self._of[link], self._nothing)

    def moments(self, link: str) -> list[Node]:
        """The moments about a link's origin, one of each load."""
        return [wrench.moment for wrench in self._of[link]]
