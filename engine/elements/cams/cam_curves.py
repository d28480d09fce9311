"""Curves of one cam over its turn, for drawing and manufacture: motion, pressure angle, curvature, forces, profile."""

import math
from typing import NamedTuple

import numpy as np

from engine.elements.cams.positions import at_positions, cam_variants, sense_of
from engine.parts.motion_programs import CamProgram


class CamCurves(NamedTuple):
    """Curves over a turn at ascending angles; a jump has two points at its angle. All ndarray (points,).

    Attributes
    ----------
    angle : ndarray
        Cam angle [rad].
    displacement, first, second, third : ndarray
        s [m or rad] and its derivatives with respect to the angle.
    pressure_angle : ndarray
        [rad]; 0 under a flat face.
    curvature : ndarray
        Curvature of the profile [1/m]; positive if convex, infinite at edges.
    force, moment : ndarray
        Contact force [N] and drive torque [N·m]; 0 without dynamics.
    profile, pitch, cutter : ndarray of complex
        Cam surface, path of the roller's centre or edge (under a flat face the contact) and path of the cutter's
        centre, in cam axes [m]: the frame's axes at angle 0.
    contact, follower : ndarray of complex
        Contact and roller centre in the frame [m].
    sense : int
        1 if the cam is drawn turning counter-clockwise, −1 if clockwise.
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


def cam_curves(cam: CamProgram, points: int = 720) -> CamCurves:
    """Curves of a cam with its own numbers.

    Parameters
    ----------
    cam : CamProgram
        A `CamElement`.
    points : int
        Approximate number over the turn; every smooth piece has at least nine.

    Returns
    -------
    CamCurves
        Empty if the sections do not form a closed turn, or the follower does not reach the base circle.
    """
    cams = cam_variants(cam, cam.own_numbers())
    turn, where, u = cams.turn, [np.empty(0, int)], [np.empty(0)]
    for i, (first, last) in enumerate(zip(turn.first, turn.last, strict=True)):
        share = (last - first) * turn.angle[i, 0] / math.tau
        count = max(9, math.ceil(points * share) + 1)
        where.append(np.full(count, i))
        u.append(np.linspace(first, last, count))
    p, v, u = np.concatenate(where), np.zeros(sum(map(len, u)), int), np.concatenate(u)
    found = at_positions(cams, p, v, u)
    if not (turn.whole[0] and found["reached"].all()):
        p, v, u = p[:0], v[:0], u[:0]
        found = {name: row[:0] for name, row in found.items() if name != "kinks"}
    return _courses(cam, turn.cam_angle(p, v, u), found)


@np.errstate(divide="ignore")
def _courses(cam: CamProgram, angle: np.ndarray, found: dict[str, np.ndarray]) -> CamCurves:
    """Curves from the quantities at the points; points of the plane as complex numbers."""
    follower, sense, flat = cam.follower, sense_of(cam.follower), cam.follower.contact == "flat"
    y, s1, none = found["y"], found["s1"], np.zeros(angle.size)
    radius = follower.roller_radius or 0.0
    cutter = radius if cam.cutter_radius is None else cam.cutter_radius
    arm = None if cam.translating else -np.exp(-1j * y)
    if flat:
        contact = s1 + 1j * y if cam.translating else follower.pivot_distance + found["face"] * arm
        normal = np.full(y.size, 1j) if cam.translating else -1j * arm
        centre, curvature = contact, 1.0 / found["radius"]
    else:
        if cam.translating:
            centre, rate = follower.offset + 1j * y, 1j * s1
        else:
            centre, rate = follower.pivot_distance + follower.arm * arm, -1j * follower.arm * s1 * arm
        along = rate - 1j * sense * centre
        normal = 1j * sense * along / np.abs(along)
        contact, pitch = centre - radius * normal, found["curvature"]
        curvature = pitch / (1.0 - radius * pitch)
    back = np.exp(-1j * sense * angle)
    return CamCurves(
        angle,
        *(found[key] for key in ("s", "s1", "s2", "s3")),
        *(found.get("angle", none), curvature, found.get("force", none), found.get("moment", none)),
        *((contact * back), centre * back, (contact + cutter * normal) * back, contact, centre, sense),
    )
