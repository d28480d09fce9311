"""Plane vectors of nodes, so that kinematics read as in the textbook."""

from typing import NamedTuple

from engine.graph.nodes import Node


class Vector(NamedTuple):
    """A vector by its components in the axes of the frame."""

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
        """The vector turned left by a right angle, k × v."""
        return Vector(-self.y, self.x)

    def dot(self, other: "Vector") -> Node:
        """Scalar product."""
        return self.x * other.x + self.y * other.y

    def cross(self, other: "Vector") -> Node:
        """The z component of the vector product."""
        return self.x * other.y - self.y * other.x

    def in_axes(self, direction: "Vector") -> "Vector":
        """Of a vector given in a link's own axes its components in those of the frame; `direction` is the link's."""
        return direction * self.x + direction.normal * self.y

    @property
    def length(self) -> Node:
        """Magnitude."""
        return self.x.graph.function("sqrt", self.dot(self))

    def called(self, name: str) -> "Vector":
        """The same with names that a reader of the printed function will see."""
        for axis, node in zip("xy", self, strict=True):
            named(node, f"{name}_{axis}")
        return self


def named(node: Node, name: str) -> Node:
    """The node, called by a name unless it has one."""
    node.label = node.label or name
    return node
