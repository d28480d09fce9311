"""Plane vectors of nodes, so that kinematics reads as in the textbook."""

from typing import NamedTuple

from engine.graph.nodes import Node


class Vector(NamedTuple):
    """A vector by its components in frame axes."""

    x: Node
    y: Node

    def __add__(self, other: "Vector") -> "Vector":
        return Vector(self.x + other.x, self.y + other.y)

    def __sub__(self, other: "Vector") -> "Vector":
        return Vector(self.x - other.x, self.y - other.y)

    def __neg__(self) -> "Vector":
        return Vector(-self.x, -self.y)

    def __mul__(self, factor: Node | float) -> "Vector":
        return Vector(self.x * factor, self.y * factor)

    __rmul__ = __mul__

    @property
    def normal(self) -> "Vector":
        """The vector turned left by 90°, k × v."""
        return Vector(-self.y, self.x)

    def dot(self, other: "Vector") -> Node:
        """Scalar product."""
        return self.x * other.x + self.y * other.y

    def cross(self, other: "Vector") -> Node:
        """The z component of the vector product."""
        return self.x * other.y - self.y * other.x

    def to_frame(self, direction: "Vector") -> "Vector":
        """Transform from link axes to frame axes; `direction` is the link's x axis."""
        return direction * self.x + direction.normal * self.y

    @property
    def length(self) -> Node:
        """Magnitude."""
        return self.x.graph.function("sqrt", self.dot(self))

    def called(self, name: str) -> "Vector":
        """Label the nodes for the printed function."""
        for axis, node in zip("xy", self, strict=True):
            named(node, f"{name}_{axis}")
        return self


def named(node: Node, name: str) -> Node:
    """Label a node, unless it already has a label."""
    node.label = node.label or name
    return node
