"""Forces and moments on a machine: magnitude, characteristic and point of application."""

from typing import NamedTuple

from engine.graph.nodes import Node
from engine.mechanism.assembly import MovingPoint
from engine.mechanism.vectors import Vector


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
