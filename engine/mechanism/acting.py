"""What a force or moment on a machine is made of: its size, its characteristic, and where it takes hold."""

from typing import NamedTuple

from engine.graph.nodes import Node
from engine.mechanism.assembly import MovingPoint
from engine.mechanism.vectors import Vector


class Grip(NamedTuple):
    """Where a force or moment takes hold.

    Attributes
    ----------
    link : str
    at : MovingPoint or None
        Point of a force; None for a moment.
    direction : Vector or None
        Unit vector of a force; None for a moment.
    bearer : tuple of (str, MovingPoint) or None
        Link and point that bear its counterpart; None where it comes from outside the machine.
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
        Its name in the scene, or "gravity".
    coefficient : Node
        A number of the variant: a force, an area, a drag coefficient at the input's speed.
    characteristic : Node
        Its course over the motion, along the grip's direction.
    grip : Grip
    velocity : Node
        Transfer velocity of the grip along the direction, of a moment that of its link.
    basis : Node
        Velocity × characteristic.
    role : str or None
        "useful", "driving", "harmful" or "braking".
    order : int, float or str
        Power of the input's speed with which it grows; of a power-law drag the path of its exponent.
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
    """How large a load is: `coefficient` (a number of the variant) × `value`; `order` as for `Load`.

    `role` is that of a part of an action that has another one than the whole: what is lost on the way to it.
    """

    coefficient: Node
    value: Node
    order: float | str = 0
    role: str | None = None


def load(action: str, size: Characteristic, grip: Grip, velocity: Node, role: str | None) -> Load:
    """A load and its reduced moment."""
    return Load(
        action, size.coefficient, size.value, grip, velocity, velocity * size.value, size.role or role, size.order
    )
