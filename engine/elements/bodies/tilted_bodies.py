"""Moments and products of inertia of a body about fixed axes to which its own are tilted, and its principal ones.

In matrices J = diag(∫r² dm) − ∫r rᵀ dm: turned by R, whose columns are the body's axes in fixed coordinates, it is
R J Rᵀ, and about a point from which the centre of mass is away by c, J + m(c² E − c cᵀ) (Steiner). The principal
moments are its eigenvalues, the greatest first. Turning about the fixed z axis, the body presses its bearings by the
couple ω² √(J_xz² + J_yz²), that of its products of inertia.

Source: H. Goldstein, C. Poole and J. Safko, Classical Mechanics, chapter 5.
"""

import math

import numpy as np

from engine.elements.bodies.body_elements import MOMENTS, SEMI_AXES, TiltedBody
from engine.elements.element_laws import ElementResult, LawOfArrays, with_nudges

_PRODUCTS = ("product_xy", "product_yz", "product_zx")
_PLACE = ("yaw", "pitch", "roll", "x", "y", "z")
# By so much a plate's moments may miss their sum, as rounded numbers of a text do.
_PLATE = 1e-6
_RESULTS = (
    *(
        ElementResult(f"fixed_inertia_{axis}", f"moment of inertia about the fixed {axis} axis", "kg m2")
        for axis in "xyz"
    ),
    *(
        ElementResult(f"fixed_{name}", f"product of inertia {name[-2:]} of the fixed axes", "kg m2")
        for name in _PRODUCTS
    ),
    ElementResult("greatest_inertia", "greatest principal moment of inertia", "kg m2"),
    ElementResult("middle_inertia", "middle principal moment of inertia", "kg m2"),
    ElementResult("least_inertia", "least principal moment of inertia", "kg m2"),
    ElementResult("principal_tilt", "angle between the fixed z axis and the nearest principal axis", "rad"),
    ElementResult("tilting_couple", "couple of the inertia forces on the bearings of the fixed z axis", "N m", "speed"),
    ElementResult("centrifugal_force", "force of inertia of the centre of mass", "N", "speed"),
)


def tilted_body_law(element: TiltedBody) -> LawOfArrays:
    """The law of a body tilted to the fixed axes.

    Parameters
    ----------
    element : TiltedBody
        Its numbers are not used.
    """
    shape = (*MOMENTS, *_PRODUCTS) if element.inertia_x is not None else SEMI_AXES
    keys = ("mass", *shape, *_PLACE, *(() if element.speed is None else ("speed",)))

    def rows(table: np.ndarray) -> np.ndarray:
        return _tilted(dict(zip(keys, table, strict=True)))

    return LawOfArrays(with_nudges(rows), lambda given_element, given: tuple(given(key) for key in keys), _RESULTS)


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
    """The uniform ellipsoid that has the mass and the moments of inertia of a body.

    Parameters
    ----------
    element : TiltedBody

    Returns
    -------
    semi_axes : ndarray (3,)
        a, of which J = m(b² + c²)/5 and so on; NaN where no body has such moments [m].
    axes : ndarray (3, 3)
        Its columns are their directions, in fixed coordinates.
    """
    shape = (*MOMENTS, *_PRODUCTS) if element.inertia_x is not None else SEMI_AXES
    inertia = _about_centre({key: np.array([getattr(element, key)], float) for key in ("mass", *shape, *_PLACE)})[0]
    moments, axes = np.linalg.eigh(inertia)
    squares = 2.5 / element.mass * (moments.sum() - 2.0 * moments)
    if squares.min() < -5.0 * _PLATE * moments.max() / element.mass:
        squares = np.full(3, math.nan)
    return np.sqrt(np.maximum(squares, 0.0)), axes


def _about_centre(n: dict[str, np.ndarray]) -> np.ndarray:
    """Moments of inertia about fixed directions through the centre of mass, (variants, 3, 3)."""
    mass = n["mass"]
    own = np.zeros((mass.size, 3, 3))
    if "inertia_x" in n:
        moments = [n[key] for key in MOMENTS]
        for (i, j), key in zip(((0, 1), (1, 2), (2, 0)), _PRODUCTS, strict=True):
            own[:, i, j] = own[:, j, i] = -n[key]
    else:
        a, b, c = (n[key] ** 2 for key in SEMI_AXES)
        moments = [mass * (b + c) / 5.0, mass * (c + a) / 5.0, mass * (a + b) / 5.0]
    for i in range(3):
        own[:, i, i] = moments[i]
    turned = _turned(n["yaw"], n["pitch"], n["roll"])
    return turned @ own @ turned.transpose(0, 2, 1)


def _tilted(n: dict[str, np.ndarray]) -> np.ndarray:
    mass = n["mass"]
    away = np.stack([n["x"], n["y"], n["z"]], axis=1)
    square = (away**2).sum(axis=1)[:, None, None] * np.eye(3) - away[:, :, None] * away[:, None, :]
    fixed = _about_centre(n) + mass[:, None, None] * square
    principal, axes = np.linalg.eigh(fixed)
    # Of an axis and its opposite the one along z; across it for the tangent, as a cosine near 1 says little.
    across = np.hypot(axes[:, 0], axes[:, 1])
    tilt = np.arctan2(across, np.abs(axes[:, 2])).min(axis=1)
    products = [-fixed[:, 0, 1], -fixed[:, 1, 2], -fixed[:, 2, 0]]
    # Beside the greatest moment, of which it is a difference, such a product is rounding.
    products = [np.where(np.abs(p) < 16.0 * np.finfo(float).eps * principal[:, 2], 0.0, p) for p in products]
    # No body, not even a plate, has a moment greater than the sum of the two others.
    sound = principal[:, 0] + principal[:, 1] >= principal[:, 2] * (1.0 - _PLATE)
    speed = n.get("speed", np.full(mass.shape, math.nan))
    rows = [
        *(fixed[:, i, i] for i in range(3)),
        *products,
        principal[:, 2],
        principal[:, 1],
        principal[:, 0],
        tilt,
        speed**2 * np.hypot(products[1], products[2]),
        mass * speed**2 * np.hypot(n["x"], n["y"]),
    ]
    return np.where(sound, np.stack(rows), math.nan)
