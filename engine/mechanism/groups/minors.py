"""Inverse of a small matrix of nodes by minors: it divides once, by the determinant, so no pivot can vanish.

A group of class III has two unknowns, a group of six links three. For matrices this small, minors take the fewest
operations, and zero entries fold away.
"""

from collections.abc import Sequence
from typing import NamedTuple

from engine.graph.nodes import Graph, Node

Matrix = Sequence[Sequence[Node]]


class Inverse(NamedTuple):
    """Inverse and determinant of a matrix.

    Attributes
    ----------
    rows : list of list of Node
    determinant : Node
    """

    rows: list[list[Node]]
    determinant: Node

    def times(self, vector: Sequence[Node]) -> list[Node]:
        """Product with a column vector."""
        return [sum(a * b for a, b in zip(row, vector, strict=True)) for row in self.rows]

    def transposed_times(self, vector: Sequence[Node]) -> list[Node]:
        """Product of the transposed inverse with a column vector."""
        return [sum(a * b for a, b in zip(column, vector, strict=True)) for column in zip(*self.rows, strict=True)]


def inverse(matrix: Matrix) -> Inverse:
    """Inverse of a square matrix of nodes."""
    graph, size = matrix[0][0].graph, range(len(matrix))
    everything = tuple(size)
    whole = _minor(graph, matrix, everything, everything)
    per = graph.one / whole

    def cofactor(i: int, j: int) -> Node:
        minor = _minor(graph, matrix, _without(everything, i), _without(everything, j))
        return -minor if (i + j) % 2 else minor

    return Inverse([[cofactor(j, i) * per for j in size] for i in size], whole)


def _minor(graph: Graph, matrix: Matrix, rows: tuple[int, ...], columns: tuple[int, ...]) -> Node:
    """Determinant of the given rows and columns, expanded along the first row; equal minors share a node."""
    if not rows:
        return graph.one
    total = graph.zero
    for k, column in enumerate(columns):
        term = matrix[rows[0]][column] * _minor(graph, matrix, rows[1:], _without(columns, column))
        total = total - term if k % 2 else total + term
    return total


def _without(numbers: tuple[int, ...], number: int) -> tuple[int, ...]:
    return tuple(n for n in numbers if n != number)
