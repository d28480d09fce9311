"""Forces and moments on a machine: magnitude and point of application; on each link one by one, and their sum."""

from collections.abc import Collection
from typing import Literal, NamedTuple

from engine.graph.nodes import Node
from engine.mechanism.assembly import Assembly, MovingPoint
from engine.mechanism.vectors import Vector

# Components of a reaction: x and y in a joint; normal force and moment in a guide.
Components = tuple[Node, Node]


class Grip(NamedTuple):
    """Where a force or moment is applied.

    Attributes
    ----------
    link : str
        Loaded link.
    at : MovingPoint or None
        Point of application of a force; None for a moment.
    direction : Vector or None
        Unit vector of a force; None for a moment.
    bearer : tuple of (str, MovingPoint) or None
        Link and point that take the reaction; None for an external load.
    """

    link: str
    at: MovingPoint | None
    direction: Vector | None
    bearer: tuple[str, MovingPoint] | None = None


class Load(NamedTuple):
    """A force or moment, coefficient × characteristic, and its reduced moment, coefficient × basis.

    Attributes
    ----------
    action : str
        Name in the scene, or "gravity".
    coefficient : Node
        Per-variant number: a force, an area, a drag coefficient at the input speed.
    characteristic : Node
        Variation over the motion, along the grip's direction.
    grip : Grip
    velocity : Node
        Transfer velocity of the grip along the direction; for a moment, of its link.
    basis : Node
        Velocity × characteristic.
    role : str or None
        "useful", "driving", "harmful" or "braking".
    order : int, float or str
        Power of the input speed in the load; for a power-law drag, the path of its exponent.
    """

    action: str
    coefficient: Node
    characteristic: Node
    grip: Grip
    velocity: Node
    basis: Node
    role: str | None
    order: float | str


class Characteristic(NamedTuple):
    """Magnitude of a load: `coefficient` (a per-variant number) × `value`; `order` as in `Load`.

    `role` overrides the action's role for a part of it, such as the transmission losses of a hoist.
    """

    coefficient: Node
    value: Node
    order: float | str = 0
    role: str | None = None


def load(action: str, size: Characteristic, grip: Grip, velocity: Node, role: str | None) -> Load:
    """Build a load; its basis is velocity × characteristic."""
    return Load(
        action, size.coefficient, size.value, grip, velocity, velocity * size.value, size.role or role, size.order
    )


class LinkForce(NamedTuple):
    """A force or moment on a link.

    Attributes
    ----------
    kind : {"weight", "inertia", "load", "reaction", "friction", "gears", "drive"}
        Journal "friction" is a moment; "gears" are moments between wheels whose teeth have no pressure angle.
    name : str
        Its body, load, pair or wheel; `WHEEL.teeth` for a tooth force.
    link : str
        Loaded link.
    source : str or None
        Link that exerts it; None for an external load.
    at : Vector or None
        Point of application of a force [m]; None for a moment.
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
        """Add another force or moment of the same kind at the same point."""
        if self.moment is not None:
            return self._replace(moment=self.moment + other.moment)
        return self._replace(force=self.force + other.force)

    @property
    def opposite(self) -> "LinkForce":
        """The reaction on the link that exerts it."""
        force, moment = (None if part is None else -part for part in (self.force, self.moment))
        return self._replace(link=self.source, source=self.link, force=force, moment=moment)


class Wrench(NamedTuple):
    """A force [N] and its moment [N·m] about the origin of the loaded link."""

    force: Vector
    moment: Node

    def __add__(self, other: "Wrench") -> "Wrench":
        return Wrench(self.force + other.force, self.moment + other.moment)

    @property
    def is_nothing(self) -> bool:
        """Whether it vanishes at all positions of all variants."""
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

    def apply(self, found: LinkForce, at: MovingPoint | None = None, within: Collection[str] = ()) -> None:
        """Add a force at a point, or a moment, and its reaction to their links, except those within a group."""
        for one in (found, found.opposite):
            if one.link not in within:
                if at is None:
                    self.twist(one.link, one.moment)
                else:
                    self.push(one.link, at, one.force)

    def total(self, link: str) -> Wrench:
        """Resultant of all loads on a link."""
        return sum(self._of[link], self._nothing)

    def moments(self, link: str) -> list[Node]:
        """Moment of each load about the link's origin."""
        return [wrench.moment for wrench in self._of[link]]
