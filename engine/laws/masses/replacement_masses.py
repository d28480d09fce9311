"""Replacement masses: point masses with the same inertia forces as a link.

Four equations relate the masses and their points: total mass, two first moments (the centre of mass is unchanged) and
moment of inertia. A static replacement satisfies the first three, a dynamic one all four. n points have 3n unknowns, so
a dynamic replacement leaves 3n − 4 of them to choose:

| replacement | chosen | found |
|---|---|---|
| static, two points | the points, on a line through S | both masses |
| static, three points | the points, not on one line | the masses |
| dynamic, two points | one point (2 numbers) | the conjugate point and both masses |
| dynamic, three points | two points and one mass (5) | the other two masses and the third point |
| dynamic, three in line | three points on a line through S | the masses |
| dynamic, four points | the points (8), not on one circle or line | the masses |

Three points on a line through S are six numbers; they satisfy one of the four equations automatically.

Conventions
-----------
Points are (x, y) from the centre of mass S, in the link's axes [m]; every number may be an array with one value for
each variant. A mass may be negative: that is as good for computation, though no such link can be built. Where a
replacement is impossible its masses are NaN.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, the method of replacement points, equations
(12.8)–(12.15).
"""

from itertools import combinations
from typing import NamedTuple

import numpy as np

Value = float | np.ndarray
Vector = tuple[Value, Value]

# Tolerance for points that coincide or lie on one line, relative to the size of the figure.
NEGLIGIBLE = 1e-9

CONDITIONS = {
    "static_two": "two points replace a body statically only if they lie apart, on a line through its centre of mass",
    "static_three": "three points replace a body statically only if they don't lie on one line",
    "dynamic_two": "a point has a conjugate point only if it lies away from the centre of mass, and the body has mass",
    "dynamic_three": "the first mass leaves nothing that the second point and a third could replace; "
    "choose another mass, or another second point",
    "dynamic_in_line": "three points replace a body dynamically only if they lie apart, on a line through its centre "
    "of mass; or give two points and the mass at the first",
    "dynamic_four": "four points replace a body dynamically only if they don't lie on one circle or line",
}


class PointMasses(NamedTuple):
    """Point masses equivalent to a body.

    Attributes
    ----------
    masses : tuple of float or ndarray
        [kg]; NaN where the replacement is impossible.
    points : tuple of (x, y)
        From the centre of mass [m].
    possible : bool or ndarray of bool
        Whether the chosen numbers allow the replacement.
    """

    masses: tuple[Value, ...]
    points: tuple[Vector, ...]
    possible: bool | np.ndarray

    def inertia(self) -> Value:
        """Moment of inertia of the point masses about the centre of mass, Σ mᵢRᵢ² [kg·m²]."""
        return sum(m * _square(p) for m, p in zip(self.masses, self.points, strict=True))


def inertia_error(replacement: PointMasses, inertia: Value) -> Value:
    """Error of a replacement's moment of inertia, Σ mᵢRᵢ² − J_S [kg·m²]; times ε, the error of the inertia moment.

    Parameters
    ----------
    replacement : PointMasses
    inertia : float or ndarray
        J_S of the body [kg·m²].
    """
    return replacement.inertia() - inertia


@np.errstate(divide="ignore", invalid="ignore")
def static_two(mass: Value, first: Vector, second: Vector) -> PointMasses:
    """Static replacement by two points on a line through S: m₁ = m·r₂/(r₂ − r₁), m₂ = m − m₁.

    Parameters
    ----------
    mass : float or ndarray
        Mass of the body [kg].
    first, second : (x, y)
        The points [m].
    """
    line = _minus(second, first)
    length2 = _square(line)
    masses = (mass * _dot(second, line) / length2, -mass * _dot(first, line) / length2)
    off = np.abs(_cross(first, second)) / np.sqrt(length2)
    return _found(masses, (first, second), _apart(first, second) & (off <= NEGLIGIBLE * _size(first, second)))


@np.errstate(divide="ignore", invalid="ignore")
def static_three(mass: Value, first: Vector, second: Vector, third: Vector) -> PointMasses:
    """Static replacement by any three points: each mass is proportional to the triangle of S with the two other points.

    Parameters
    ----------
    mass : float or ndarray
        Mass of the body [kg].
    first, second, third : (x, y)
        The points [m].
    """
    parts = _cross(second, third), _cross(third, first), _cross(first, second)
    whole = _cross(_minus(second, first), _minus(third, first))
    masses = tuple(mass * part / whole for part in parts)
    sides2 = _square(_minus(second, first)), _square(_minus(third, first)), _square(_minus(third, second))
    longest2 = np.maximum(np.maximum(sides2[0], sides2[1]), sides2[2])
    return _found(masses, (first, second, third), np.abs(whole) > NEGLIGIBLE * longest2)


@np.errstate(divide="ignore", invalid="ignore")
def dynamic_two(mass: Value, inertia: Value, first: Vector) -> PointMasses:
    """Dynamic replacement by a chosen point at a from S and its conjugate at b = J_S/(m a) beyond S.

    The conjugate point is the link's centre of percussion for a swing about the chosen point.

    Parameters
    ----------
    mass, inertia : float or ndarray
        Mass of the body [kg] and its moment of inertia about S [kg·m²].
    first : (x, y)
        The chosen point [m].
    """
    a2 = _square(first)
    ratio = inertia / (mass * a2)
    second = (-ratio * first[0], -ratio * first[1])
    masses = (mass * ratio / (1 + ratio), mass / (1 + ratio))
    return _found(masses, (first, second), a2 * mass > NEGLIGIBLE**2 * inertia)


@np.errstate(divide="ignore", invalid="ignore")
def dynamic_three(mass: Value, inertia: Value, first: Vector, first_mass: Value, second: Vector) -> PointMasses:
    """Dynamic replacement by a chosen mass at a first point, a chosen second point, and a third.

    Removing the first mass leaves a body with another centre and moment of inertia (which may be negative); the
    second point and its conjugate replace that body.

    Parameters
    ----------
    mass, inertia : float or ndarray
        Mass of the body [kg] and its moment of inertia about S [kg·m²].
    first, second : (x, y)
        The chosen points [m].
    first_mass : float or ndarray
        Mass at the first point [kg].
    """
    rest = np.subtract(mass, first_mass)
    centre = (-first_mass * first[0] / rest, -first_mass * first[1] / rest)
    moved = rest * _square(centre)
    rest_inertia = inertia - first_mass * _square(first) - moved
    arm = _minus(second, centre)
    about_second = rest * _square(arm) + rest_inertia
    ratio = rest_inertia / (rest * _square(arm))
    third = (centre[0] - ratio * arm[0], centre[1] - ratio * arm[1])
    masses = (first_mass + 0 * rest, rest_inertia / _square(arm) / (1 + ratio), rest / (1 + ratio))
    size = _size(first, second)
    possible = (np.abs(rest) > NEGLIGIBLE * np.abs(mass)) & (_square(arm) > (NEGLIGIBLE * size) ** 2)
    possible &= np.abs(about_second) > NEGLIGIBLE * (np.abs(rest) * _square(arm) + np.abs(rest_inertia))
    return _found(masses, (first, second, third), possible)


@np.errstate(divide="ignore", invalid="ignore")
def dynamic_in_line(mass: Value, inertia: Value, first: Vector, second: Vector, third: Vector) -> PointMasses:
    """Dynamic replacement by three points on a line through S: m₁ = (J_S + m t₂t₃)/((t₁ − t₂)(t₁ − t₃)) and cyclic.

    With the second point in S these are the usual m₁ = J_S/(a(a + b)), m₃ = J_S/(b(a + b)), m₂ = m − J_S/(ab).

    Parameters
    ----------
    mass, inertia : float or ndarray
        Mass of the body [kg] and its moment of inertia about S [kg·m²].
    first, second, third : (x, y)
        The points, at t₁, t₂, t₃ from S along the line [m].
    """
    points = (first, second, third)
    # Dot products give signed products and squares of distances without a choice of direction for the line.
    masses, possible = [], True
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        to_both = _dot(_minus(points[i], points[j]), _minus(points[i], points[k]))
        masses.append((inertia + mass * _dot(points[j], points[k])) / to_both)
        line = _minus(points[j], points[k])
        off = np.abs(_cross(points[j], points[k])) / np.sqrt(_square(line))
        possible &= _apart(points[j], points[k]) & (off <= NEGLIGIBLE * _size(*points))
    return _found(tuple(masses), points, possible)


@np.errstate(divide="ignore", invalid="ignore")
def dynamic_four(mass: Value, inertia: Value, *points: Vector) -> PointMasses:
    """Dynamic replacement by four points: the four equations by Cramer's rule.

    Parameters
    ----------
    mass, inertia : float or ndarray
        Mass of the body [kg] and its moment of inertia about S [kg·m²].
    *points : (x, y)
        The four points [m].
    """
    # For every three points: determinant of (x, y, r²), and twice the area of their triangle.
    volumes, triangles, rough = [], [], 0.0
    for i in range(4):
        a, b, c = (p for j, p in enumerate(points) if j != i)
        bc, ca, ab = _cross(b, c), _cross(c, a), _cross(a, b)
        parts = _square(a) * bc, _square(b) * ca, _square(c) * ab
        volumes.append((-1) ** i * sum(parts))
        triangles.append((-1) ** i * (bc + ca + ab))
        rough = rough + sum(np.abs(part) for part in parts)
    whole = sum(volumes)
    masses = tuple((mass * v - inertia * t) / whole for v, t in zip(volumes, triangles, strict=True))
    return _found(masses, points, np.abs(whole) > NEGLIGIBLE * rough)


def coincident(points: tuple[Vector, ...]) -> tuple[int, int] | None:
    """Indices, from 0, of two coincident points of one variant; None if all are distinct.

    Parameters
    ----------
    points : tuple of (x, y)
    """
    pairs = combinations(range(len(points)), 2)
    return next(((i, j) for i, j in pairs if not _apart(points[i], points[j])), None)


def _found(masses: tuple[Value, ...], points: tuple[Vector, ...], possible: bool | np.ndarray) -> PointMasses:
    return PointMasses(tuple(np.where(possible, m, np.nan)[()] for m in masses), points, possible)


def _minus(a: Vector, b: Vector) -> Vector:
    return np.subtract(a[0], b[0]), np.subtract(a[1], b[1])


def _dot(a: Vector, b: Vector) -> Value:
    return np.multiply(a[0], b[0]) + np.multiply(a[1], b[1])


def _cross(a: Vector, b: Vector) -> Value:
    return np.multiply(a[0], b[1]) - np.multiply(a[1], b[0])


def _square(a: Vector) -> Value:
    return _dot(a, a)


def _size(*points: Vector) -> Value:
    """Distance of the farthest point from S."""
    farthest2 = _square(points[0])
    for point in points[1:]:
        farthest2 = np.maximum(farthest2, _square(point))
    return np.sqrt(farthest2)


def _apart(a: Vector, b: Vector) -> bool | np.ndarray:
    return _square(_minus(a, b)) > (NEGLIGIBLE * _size(a, b)) ** 2
