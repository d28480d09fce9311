"""Moments and products of inertia of a body about fixed axes, to which its own axes are inclined; principal moments.

The inertia matrix is J = diag(∫r² dm) − ∫r rᵀ dm. Rotated by R, whose columns are the body's axes in fixed coordinates,
it is R J Rᵀ; about a point at the distance c from the centre of mass it is J + m(c² E − c cᵀ) (Steiner). The principal
moments are its eigenvalues, the largest first. Rotating about the fixed z axis, the body loads its bearings with the
couple ω² √(J_xz² + J_yz²) of its products of inertia.

Source: H. Goldstein, C. Poole and J. Safko, Classical Mechanics, chapter 5.
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Answers, Element, NamedRows, Numbers, nudged
from engine.elements.panels import Panel, path, plan
from engine.laws.rounding import EPS
from engine.parts.skeleton import Angle, AngularSpeed, Faults, Inertia, Length, Mass, Positive
from engine.words.quantity import main_result

MOMENTS = ("inertia_x", "inertia_y", "inertia_z")
SEMI_AXES = ("semi_axis_x", "semi_axis_y", "semi_axis_z")
_PRODUCTS = ("product_xy", "product_yz", "product_zx")
_PLACES_OF_PRODUCTS = ((0, 1), (1, 2), (2, 0))
_PRINCIPAL = {"greatest_inertia": "maximum", "middle_inertia": "middle", "least_inertia": "minimum"}
# Roundings of a term of the matrices, and of the maximum principal moment.
_ROUNDINGS = 8.0
# Relative amount by which a plate's moment may exceed the sum of the two others: input numbers are rounded.
_GREATEST_INERTIA = 1e150
_PLATE = 1e-6


class TiltedBody(Element):
    """A body whose own axes are inclined to the fixed axes.

    It is rotated by `yaw` about z, then by `pitch` about its new y axis, then by `roll` about its x axis. It has
    moments of inertia about its own axes through its centre of mass, with products such as ∫xy dm unless these are
    principal axes, or it is an ellipsoid of given semi-axes. `x`, `y`, `z` are the fixed coordinates of the centre of
    mass. With a `speed` it rotates about the fixed z axis.
    """

    picture: ClassVar = "views"

    type: Literal["tilted_body"]
    mass: Annotated[Mass, Field(gt=0)]
    inertia_x: Annotated[Inertia, Field(gt=0)] | None = None
    inertia_y: Annotated[Inertia, Field(gt=0)] | None = None
    inertia_z: Annotated[Inertia, Field(gt=0)] | None = None
    product_xy: Inertia = 0.0
    product_yz: Inertia = 0.0
    product_zx: Inertia = 0.0
    semi_axis_x: Positive | None = None
    semi_axis_y: Positive | None = None
    semi_axis_z: Positive | None = None
    yaw: Angle = 0.0
    pitch: Angle = 0.0
    roll: Angle = 0.0
    x: Length = 0.0
    y: Length = 0.0
    z: Length = 0.0
    speed: AngularSpeed | None = None

    def _faults(self) -> Faults:
        moments, axes = ([getattr(self, key) is not None for key in keys] for keys in (MOMENTS, SEMI_AXES))
        if not (all(moments) and not any(axes)) and not (all(axes) and not any(moments)):
            yield f"give {', '.join(MOMENTS)}, or {', '.join(SEMI_AXES)} of an ellipsoid: all three of one"
        if all(axes) and (self.product_xy or self.product_yz or self.product_zx):
            yield "products belong to given moments: an ellipsoid has none about its own axes; leave them out"

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants; NaN if no body has such moments of inertia."""
        mass, (fixed, rounding) = n["mass"], _about_fixed_axes(n)
        usable, principal, axes = _principal(fixed)
        # Take the end of an axis that points along z; use the tangent, as a cosine near 1 is inaccurate.
        tilt = _tilts(axes).min(axis=1)
        # A product below the rounding of its terms is 0.
        products = [
            np.where(np.abs(fixed[:, i, j]) < rounding[:, i, j], 0.0, -fixed[:, i, j]) for i, j in _PLACES_OF_PRODUCTS
        ]
        # No body has a moment greater than the sum of the two others; a plate reaches it.
        sound = usable & (principal[:, 0] + principal[:, 1] >= principal[:, 2] * (1.0 - _PLATE))
        defined = np.where(sound, 1.0, math.nan)
        for i, axis in enumerate("xyz"):
            words = f"moment of inertia about the fixed {axis} axis"
            yield main_result(f"fixed_inertia_{axis}", words, "kg m2"), fixed[:, i, i] * defined
        for name, product in zip(_PRODUCTS, products, strict=True):
            words = f"product of inertia {name[-2:]} of the fixed axes"
            yield main_result(f"fixed_{name}", words, "kg m2"), product * defined
        for (name, size), row in zip(_PRINCIPAL.items(), principal.T[::-1], strict=True):
            yield main_result(name, f"{size} principal moment of inertia", "kg m2"), row * defined
        words = "angle between the fixed z axis and the nearest principal axis"
        yield main_result("principal_tilt", words, "rad"), tilt * defined
        if "speed" in n:
            square = n["speed"] ** 2 * defined
            words = "couple of the inertia forces on the bearings of the fixed z axis"
            yield main_result("tilting_couple", words, "N m"), square * np.hypot(products[1], products[2])
            words = "inertia force at the centre of mass"
            yield main_result("centrifugal_force", words, "N"), mass * square * np.hypot(n["x"], n["y"])

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates, which contain the rounding of the terms that cancel in them, and verdicts."""
        found, errors = nudged(self.values, n)
        fixed, rounding = _about_fixed_axes(n)
        _, principal, axes = _principal(fixed)
        off = np.linalg.norm(rounding, axis=(1, 2)) + _ROUNDINGS * EPS * principal[:, 2]
        apart = np.abs(principal[:, :, None] - principal[:, None, :]) + np.where(np.eye(3), np.inf, 0.0)
        nearest = np.take_along_axis(apart.min(axis=2), _tilts(axes).argmin(axis=1)[:, None], axis=1)[:, 0]
        added = {f"fixed_inertia_{axis}": rounding[:, i, i] for i, axis in enumerate("xyz")}
        added |= {f"fixed_{key}": rounding[:, *at] for key, at in zip(_PRODUCTS, _PLACES_OF_PRODUCTS, strict=True)}
        added |= dict.fromkeys(_PRINCIPAL, off)
        # An axis turns by the rounding over the distance of its moment from the next.
        with np.errstate(divide="ignore", invalid="ignore"):
            added["principal_tilt"] = np.fmin(off / nearest, 0.5 * math.pi)
        if self.speed is not None:
            added["tilting_couple"] = n["speed"] ** 2 * np.hypot(rounding[:, 1, 2], rounding[:, 2, 0])
        return Answers(found, {name: row + added.get(name, 0.0) for name, row in errors.items()})

    def panels(self) -> tuple[Panel, ...]:
        """Three views, in fixed axes, of the uniform ellipsoid with the body's inertia; none if it does not exist."""
        semi_axes, axes = body_ellipsoid(self)
        if np.isnan(semi_axes).any():
            return ()
        centre, found = np.array([self.x, self.y, self.z]), []
        outwards = np.exp(1j * np.linspace(0.0, math.tau, 361))
        for title, across, up in (("the front", 0, 2), ("the side", 1, 2), ("above", 0, 1)):
            seen = (axes[across] + 1j * axes[up]) * semi_axes
            # Of points c + A u on the ellipsoid, the outermost in a direction has u parallel to Aᵀ times the direction.
            reach = (np.conj(seen) * outwards[:, None]).real
            size = np.linalg.norm(reach, axis=1)
            middle = centre[across] + 1j * centre[up]
            outline = middle + np.divide(reach @ seen, size, out=np.zeros(size.size, complex), where=size > 0.0)
            lines = [path("", (middle - 1.25 * end, middle + 1.25 * end), True) for end in seen]
            words = "xyz"[across], "xyz"[up]
            found.append(plan((path("outline", outline), *lines), f"From {title}", words=words))
        return tuple(found)


def _turned(yaw: np.ndarray, pitch: np.ndarray, roll: np.ndarray) -> np.ndarray:
    """Matrices R_z(yaw) R_y(pitch) R_x(roll), (variants, 3, 3)."""
    turned = np.broadcast_to(np.eye(3), (yaw.size, 3, 3))
    for angle, (i, j) in ((yaw, (0, 1)), (pitch, (2, 0)), (roll, (1, 2))):
        about = np.broadcast_to(np.eye(3), turned.shape).copy()
        about[:, i, i] = about[:, j, j] = np.cos(angle)
        about[:, j, i], about[:, i, j] = np.sin(angle), -np.sin(angle)
        turned = turned @ about
    return turned


def body_ellipsoid(element: TiltedBody) -> tuple[np.ndarray, np.ndarray]:
    """The uniform ellipsoid with the mass and the moments of inertia of a body.

    Parameters
    ----------
    element : TiltedBody

    Returns
    -------
    semi_axes : ndarray (3,)
        a, b, c of J = m(b² + c²)/5 and so on [m]; NaN if no body has such moments.
    axes : ndarray (3, 3)
        Directions of the semi-axes as columns, in fixed coordinates.
    """
    inertia = _about_centre(element.own_numbers())[0][0]
    moments, axes = np.linalg.eigh(inertia)
    squares = 2.5 / element.mass * (moments.sum() - 2.0 * moments)
    if squares.min() < -5.0 * _PLATE * moments.max() / element.mass:
        squares = np.full(3, math.nan)
    return np.sqrt(np.maximum(squares, 0.0)), axes


def _tilts(axes: np.ndarray) -> np.ndarray:
    """Angles between the fixed z axis and principal axes (variants, 3)."""
    return np.arctan2(np.hypot(axes[:, 0], axes[:, 1]), np.abs(axes[:, 2]))


def _principal(fixed: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Whether matrices can be used (variants,); principal moments (variants, 3) and axes as columns."""
    # LAPACK abandons the whole batch if the squares of one matrix overflow.
    usable = np.abs(fixed).max(axis=(1, 2)) < _GREATEST_INERTIA
    return usable, *np.linalg.eigh(np.where(usable[:, None, None], fixed, np.eye(3)))


def _about_fixed_axes(n: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Inertia matrices about the fixed axes (variants, 3, 3), and the rounding of their entries."""
    x, y, z = away = n["x"], n["y"], n["z"]
    square = -np.array([[i * j for j in away] for i in away])
    square[np.arange(3), np.arange(3)] = y * y + z * z, z * z + x * x, x * x + y * y
    moved = (n["mass"] * square).transpose(2, 0, 1)
    centred, size = _about_centre(n)
    return centred + moved, _ROUNDINGS * EPS * (size + np.abs(moved))


def _about_centre(n: Numbers) -> tuple[np.ndarray, np.ndarray]:
    """Inertia matrices about fixed directions through the centre of mass (variants, 3, 3), and sums of their terms."""
    mass = n["mass"]
    own = np.zeros((mass.size, 3, 3))
    if "inertia_x" in n:
        moments = [n[key] for key in MOMENTS]
        for (i, j), key in zip(_PLACES_OF_PRODUCTS, _PRODUCTS, strict=True):
            own[:, i, j] = own[:, j, i] = -n[key]
    else:
        a, b, c = (n[key] ** 2 for key in SEMI_AXES)
        moments = [mass * (b + c) / 5.0, mass * (c + a) / 5.0, mass * (a + b) / 5.0]
    for i in range(3):
        own[:, i, i] = moments[i]
    turned = _turned(n["yaw"], n["pitch"], n["roll"])
    size = np.abs(turned) @ np.abs(own) @ np.abs(turned).transpose(0, 2, 1)
    return turned @ own @ turned.transpose(0, 2, 1), size
