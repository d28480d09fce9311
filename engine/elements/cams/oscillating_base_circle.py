"""Minimum base circle of a cam with an oscillating follower, for limits on pressure angle and curvature.

At each cam position the pressure angle limits the arm angle ψ to an interval, known in closed form. The curvature limit
may be satisfied, violated and satisfied again as ψ grows. The minimum angle ψ₀ is therefore approached from below: at
the position of maximum curvature, find the next ψ that satisfies the limit; repeat until the whole turn satisfies it.
No step passes a feasible angle, so ψ₀ is the minimum.
"""

import numpy as np

from engine.elements.cams.over_turn import PeakPlaces, Sought, measure
from engine.elements.cams.positions import CamVariants, limit_radius, sense_of
from engine.graph.over_arrays import over_arrays
from engine.laws.cams.profiles import curvature_room, face_room, least_arm_angle
from engine.laws.rounding import EPS
from engine.words.verdicts import Verdict

# An arm almost in line with the line of centres; exactly in line, the cam would have no room.
_LEAST_ANGLE = 1e-9
# Most positions whose curvature is limited in turn, and most steps to the feasible angle of each. Both iterations
# converge as Newton's method does.
_POSITIONS, _STEPS = 60, 200


def point_angle(n: dict[str, np.ndarray], dip: np.ndarray) -> np.ndarray:
    """Arm angle at which the base circle is a point, if the arm reaches that far; otherwise a minimal angle.

    Parameters
    ----------
    n : dict of str to ndarray (variants,)
    dip : ndarray (variants,)
        How far the motion goes below zero displacement; there the arm must still be above the line of centres.
    """
    arm, d = n.get("follower.arm"), n["follower.pivot_distance"]
    least = np.fmax(dip, 0.0) + _LEAST_ANGLE
    if arm is None:
        return least
    roller = n.get("follower.roller_radius", np.zeros(d.size))
    (point,) = over_arrays(least_arm_angle, roller, arm, d)
    return np.where(roller > np.abs(d - arm), np.fmax(point, least), least)


def room_at(
    cams: CamVariants, psi: np.ndarray, p: np.ndarray, v: np.ndarray, u: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Margin of the curvature limit at given arm angles, its derivative, and a bound on its second derivative."""
    n, sense = cams.n, sense_of(cams.cam.follower)
    s, s1, s2, _ = cams.turn.motion(p, v, u)
    d = n["follower.pivot_distance"][v]
    if cams.cam.follower.contact == "flat":
        return over_arrays(face_room, psi + s, s1, s2, d, sense, limit_radius(n)[v])
    return over_arrays(curvature_room, psi + s, s1, s2, n["follower.arm"][v], d, sense, limit_radius(n)[v])


@np.errstate(all="ignore")
def least_arm_angles(cams: CamVariants, begin: np.ndarray) -> tuple[np.ndarray, PeakPlaces]:
    """Minimum arm angles, from given ones upwards, that satisfy the curvature limit.

    Parameters
    ----------
    cams : CamVariants
    begin : ndarray (variants,)
        Angles at zero displacement.

    Returns
    -------
    angles : ndarray (variants,)
        NaN where no angle satisfies the limit.
    places : PeakPlaces (variants,)
        Positions that determine the angles; u is NaN where the given angle suffices.
    """
    flat = cams.cam.follower.contact == "flat"
    sought, limit = [Sought("radius", -1) if flat else Sought("curvature", 1)], limit_radius(cams.n)
    psi, at = begin.copy(), PeakPlaces(np.zeros(begin.size, int), *np.full((3, begin.size), np.nan))
    left = np.flatnonzero(np.isfinite(begin) & (flat | (limit > 0.0)))
    # Forces and limits do not affect the curvature.
    follower = cams.cam.follower.model_copy(update={"inertia": None})
    bare = cams.cam.model_copy(update={"limits": None, "follower": follower})
    for _ in range(_POSITIONS):
        if not left.size:
            return psi, at
        here = cams._replace(cam=bare).chosen(left, psi[left])
        found = measure(here, sought)
        p, u = found.places.pieces[0], found.places.u[0]
        above = _next_angle(here, psi[left], p, u)
        above[found.verdicts != Verdict.OK] = np.nan
        raised = ~(above <= psi[left])
        some, left = left[raised], left[raised & np.isfinite(above)]
        psi[some], at.pieces[some], at.u[some] = above[raised], p[raised], u[raised]
    psi[left] = np.nan
    return psi, at


def _next_angle(cams: CamVariants, psi: np.ndarray, p: np.ndarray, u: np.ndarray) -> np.ndarray:
    """The next arm angles that satisfy the curvature limit at given positions; NaN if none does.

    The root of the parabola with the bound on the second derivative never lies beyond the true root: the step is safe.
    """
    v = np.arange(psi.size)
    s = cams.turn.motion(p, v, u)[0]
    for _ in range(_STEPS):
        room, slope, bound = room_at(cams, psi, p, v, u)
        root = np.sqrt(slope * slope - 2.0 * bound * room)
        step = np.where(slope > 0.0, -2.0 * room / (root + slope), (root - slope) / bound)
        step = np.where(room >= 0.0, 0.0, step)
        psi = np.where(psi + s + step < np.pi, psi + step, np.nan)
        if not (step > EPS * psi).any():
            break
    return psi
