"""Courses of one cam over its turn, to be drawn and made: motion, pressure angle, curvature, forces, profile."""

import math
from typing import NamedTuple

import numpy as np
from numba import types

from engine.compiling.decorators import driver
from engine.compiling.running import prepare
from engine.elements.cams.cam import CamElement, cam_sections, cam_traits
from engine.elements.cams.cam_places import (
    ALPHA,
    CURVE,
    DISTANCE,
    FACE,
    FORCE,
    MOMENT,
    NUMBERS,
    QUANTITIES,
    SENSE,
    fill_cam_place,
    first_place,
)
from engine.elements.cams.pieces import (
    BETA,
    FROM,
    ORIGIN,
    PIECE_NUMBERS,
    PIECES_OF_A_SECTION,
    TO,
    cut_sections,
    motion_in,
)


class CamCurves(NamedTuple):
    """Courses over a turn, at angles that ascend; where a law jumps, an angle stands twice. All ndarray (points,).

    Attributes
    ----------
    angle : ndarray
        Of the cam [rad].
    displacement, first, second, third : ndarray
        s [m or rad] and its derivatives by the angle.
    pressure_angle : ndarray
        [rad]; 0 under a flat face.
    curvature : ndarray
        Of the profile [1/m]; positive where it is convex, infinite at edges.
    force, moment : ndarray
        Between cam and follower [N], and that turns the cam [N·m]; 0 without dynamics.
    profile, pitch, cutter : ndarray of complex
        Surface of the cam, path of the follower's roller or edge (under a flat face the contact) and of the cutter's
        centre, in the cam's axes [m]: those of the frame at the angle 0.
    contact, follower : ndarray of complex
        Contact and the roller's centre in the frame [m].
    sense : int
        1 where the cam is drawn turning counter-clockwise, −1 clockwise.
    """

    angle: np.ndarray
    displacement: np.ndarray
    first: np.ndarray
    second: np.ndarray
    third: np.ndarray
    pressure_angle: np.ndarray
    curvature: np.ndarray
    force: np.ndarray
    moment: np.ndarray
    profile: np.ndarray
    pitch: np.ndarray
    cutter: np.ndarray
    contact: np.ndarray
    follower: np.ndarray
    sense: int


def cam_curves(cam: CamElement, points: int = 720) -> CamCurves:
    """Courses of a cam with its own numbers.

    Parameters
    ----------
    cam : CamElement
    points : int
        About how many over the turn; every smooth piece has at least nine.

    Returns
    -------
    CamCurves
        Empty where the cam's sections make no turn, or its follower doesn't reach the base circle.
    """
    kinds, directions, tabled = cam_sections(cam)
    numbers, traits = cam.row(cam.own_numbers()), cam_traits(cam)
    pieces = tabled if len(tabled) else np.empty((PIECES_OF_A_SECTION * kinds.size, PIECE_NUMBERS))
    if not len(tabled):
        pieces = pieces[: _cut(kinds, directions, numbers, pieces)]
    where, u = [], []
    for i, piece in enumerate(pieces):
        share = (piece[TO] - piece[FROM]) * piece[BETA] / (2 * math.pi)
        count = max(9, math.ceil(points * share) + 1)
        where.append(np.full(count, i))
        u.append(np.linspace(piece[FROM], piece[TO], count))
    where, u = (np.concatenate(part) if part else np.empty(0) for part in (where, u))
    found, motion = np.full((u.size, 2 * QUANTITIES), np.nan), np.empty((u.size, 4))
    start = np.empty(1)
    prepare(_trace, _TYPES)
    _trace(traits, numbers, pieces, where.astype(np.int64), u, found, motion, start)
    if math.isnan(start[0]):
        found, motion, where, u = found[:0], motion[:0], where[:0], u[:0]
    where = where.astype(int)
    angle = pieces[where, ORIGIN] + pieces[where, BETA] * u
    return _courses(cam, numbers[0], int(traits[SENSE]), angle, found, motion, start[0])


def _courses(
    cam: CamElement,
    numbers: np.ndarray,
    sense: int,
    angle: np.ndarray,
    found: np.ndarray,
    motion: np.ndarray,
    start: float,
) -> CamCurves:
    """Courses from what is found at points; places as complex numbers."""
    s, s1, _, _ = motion.T
    follower, distance, flat = cam.follower, numbers[DISTANCE], cam.follower.contact == "flat"
    radius = follower.roller_radius or 0.0
    cutter = radius if cam.cutter_radius is None else cam.cutter_radius
    back = np.exp(-1j * sense * angle)
    with np.errstate(divide="ignore"):
        if flat:
            y = start + s
            if cam.translating:
                contact, normal = s1 + 1j * y, np.full(y.size, 1j)
            else:
                arm = -np.exp(-1j * y)
                contact, normal = distance + found[:, FACE] * arm, -1j * arm
            centre, curvature = contact, 1.0 / found[:, CURVE]
        else:
            y = start + s
            if cam.translating:
                centre, rate = distance + 1j * y, 1j * s1
            else:
                centre = distance - follower.arm * np.exp(-1j * y)
                rate = 1j * follower.arm * s1 * np.exp(-1j * y)
            along = rate - 1j * sense * centre
            normal = 1j * sense * along / np.abs(along)
            contact, pitch = centre - radius * normal, found[:, CURVE]
            curvature = pitch / (1.0 - radius * pitch)
    return CamCurves(
        angle, *motion.T, found[:, ALPHA], curvature, found[:, FORCE], found[:, MOMENT],
        contact * back, centre * back, (contact + cutter * normal) * back, contact, centre, sense,
    )  # fmt: skip


_ROW, _INTEGERS, _TABLE = types.float64[::1], types.int64[::1], types.float64[:, ::1]
_TYPES = (_INTEGERS, _TABLE, _TABLE, _INTEGERS, _ROW, _TABLE, _TABLE, _ROW)


def _cut(kinds: np.ndarray, directions: np.ndarray, numbers: np.ndarray, pieces: np.ndarray) -> int:
    """How many pieces the sections of one variant make; they are written to `pieces`."""
    count = np.empty(1, np.int64)
    prepare(_cut_one, (_INTEGERS, _INTEGERS, _TABLE, _TABLE, _INTEGERS))
    _cut_one(kinds, directions, numbers, pieces, count)
    return int(count[0])


@driver
def _cut_one(
    kinds: np.ndarray, directions: np.ndarray, numbers: np.ndarray, pieces: np.ndarray, count: np.ndarray
) -> None:
    count[0] = cut_sections(kinds, directions, numbers, 0, NUMBERS, pieces)


@driver
def _trace(
    traits: np.ndarray,
    numbers: np.ndarray,
    pieces: np.ndarray,
    where: np.ndarray,
    u: np.ndarray,
    found: np.ndarray,
    motion: np.ndarray,
    start: np.ndarray,
) -> None:
    """Fill in all quantities and the motion at places of pieces; `start` is NaN where there is no such position."""
    first, size = first_place(traits, numbers, 0)
    start[0] = first
    for k in range(u.size):
        for order, value in enumerate(motion_in(pieces, where[k], u[k])):
            motion[k, order] = value
        if not fill_cam_place(traits, numbers, 0, pieces, where[k], u[k], first, size, -1, found, k):
            start[0] = math.nan
