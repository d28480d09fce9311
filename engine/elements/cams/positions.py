"""A cam and its follower at given positions: pressure angle, curvature, motion, forces, base circle required."""

from typing import NamedTuple

import numpy as np

from engine.elements.cams.followers import OscillatingFollower, TranslatingFollower
from engine.elements.cams.turn import CamTurn, turn_of
from engine.elements.element import Numbers
from engine.graph.over_arrays import over_arrays
from engine.laws.cams import profiles
from engine.parts.motion_programs import CamProgram

_ORDERS = range(4)
# Key of a unit factor that is nudged for the shares by which extremes are missed.
PEAK_FACTOR = "factor of peaks"


class CamVariants(NamedTuple):
    """Cams of one kind with the numbers of several variants.

    Attributes
    ----------
    cam : CamProgram
        A `CamElement`; its own numbers are not used.
    n : mapping of str to ndarray (variants,)
    turn : CamTurn
    lowest : ndarray (variants,)
        Height or arm angle of the follower at zero displacement; NaN if it cannot be assembled.
    """

    cam: CamProgram
    n: Numbers
    turn: CamTurn
    lowest: np.ndarray

    def chosen(self, some: np.ndarray, lowest: np.ndarray) -> "CamVariants":
        """A subset of the variants, with new lowest positions of their followers."""
        n = {key: row[some] for key, row in self.n.items()}
        return CamVariants(self.cam, n, turn_of(self.cam, n), lowest)


def sense_of(follower: TranslatingFollower | OscillatingFollower) -> int:
    """−1 if the arm opens with the cam's rotation, else 1."""
    return -1 if follower.type == "oscillating" and follower.opens == "with" else 1


def cam_variants(cam: CamProgram, n: Numbers) -> CamVariants:
    """Cams whose followers touch the base circle at zero displacement."""
    prime = n["base_radius"] + n.get("follower.roller_radius", 0.0)
    flat = cam.follower.contact == "flat"
    if cam.translating:
        (lowest,) = (prime,) if flat else over_arrays(profiles.least_height, prime, n["follower.offset"])
    elif flat:
        (lowest,) = over_arrays(profiles.least_face_angle, prime, n["follower.pivot_distance"])
    else:
        (lowest,) = over_arrays(profiles.least_arm_angle, prime, n["follower.arm"], n["follower.pivot_distance"])
    return CamVariants(cam, n, turn_of(cam, n), lowest)


def with_roundings(n: Numbers) -> Numbers:
    """Numbers, and unit factors, which are nudged for the rounding of the law of motion and for missed extremes."""
    return {**n, **{key: np.ones_like(n["speed"]) for key in (PEAK_FACTOR, *(f"factor of order {k}" for k in _ORDERS))}}


@np.errstate(all="ignore")
def at_positions(some: CamVariants, p: np.ndarray, v: np.ndarray, u: np.ndarray) -> dict[str, np.ndarray]:
    """All quantities at u in the pieces p of variants v, each (...).

    `reached` is true where the position exists: the arm or follower is on its side of the cam. Friction causes a kink
    in the forces where one of `kinks` changes its sign.
    """
    cam, n, turn, lowest = some
    sense, limits = sense_of(cam.follower), cam.limits is not None

    def of(key: str) -> np.ndarray | float:
        return n[key][v] if key in n else 0.0

    s, s1, s2, s3 = (
        x + turn.rounding(k, p, x) * (n[key][v] - 1.0) if (key := f"factor of order {k}") in n else x
        for k, x in enumerate(turn.motion(p, v, u))
    )
    speed, y = of("speed"), lowest[v] + s
    found = {"s": s, "s1": s1, "s2": s2, "s3": s3, "y": y, "kinks": ()}
    found |= {"velocity": speed * s1, "acceleration": speed**2 * s2, "jerk": speed**3 * s3}
    found["reached"] = (y > 0.0) & (cam.translating | (y < np.pi))
    across, along, leverage = 0.0, 1.0, 1.0
    if cam.follower.contact != "flat":
        if cam.translating:
            across, along, found["curvature"] = over_arrays(profiles.sliding_roller, of("follower.offset"), y, s1, s2)
        else:
            d, leverage = of("follower.pivot_distance"), of("follower.arm")
            across, along, found["curvature"] = over_arrays(profiles.swinging_roller, leverage, d, y, s1, s2, sense)
        found["angle"] = np.arctan2(across, along)
        found |= _limits(some, v, found) if limits else {}
    elif cam.translating:
        found |= {"radius": y + s2, "face": s1 - of("follower.offset")}
        found |= {"curved height": of("limits.convex_radius") - s - s2} if limits else {}
    else:
        d = of("follower.pivot_distance")
        found["radius"], found["face"] = over_arrays(profiles.flat_face_support, d, y, s1, s2, sense)
        found["reached"] &= 1.0 + sense * s1 > 0.0
        leverage = found["face"]
    if cam.follower.moved is not None:
        slant = np.hypot(across, along)
        found |= _forces(some, p, v, found, (across / slant, along / slant, leverage))
    return found


def _limits(some: CamVariants, v: np.ndarray, found: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Heights or arm angles at zero displacement for which a position satisfies the limits."""
    (cam, n, _, _), s, s1, rows = some, found["s"], found["s1"], {}
    offset = n["follower.offset"][v] if cam.translating else 0.0
    if cam.translating:
        radius = limit_radius(n)[v]
        (rows["curved height"],) = over_arrays(profiles.least_height_for_curvature, s, s1, found["s2"], offset, radius)
    if "limits.pressure_angle" in n:
        slope = np.tan(n["limits.pressure_angle"])[v]
        if cam.translating:
            return rows | {f"height {sign:+d}": sign * (s1 - offset) / slope - s for sign in (1, -1)}
        arm, d = n["follower.arm"][v], n["follower.pivot_distance"][v]
        low, high = over_arrays(profiles.arm_angles_for_pressure, s1, arm, d, sense_of(cam.follower), slope)
        never = ~(low < np.inf)
        rows |= {"low angle": np.where(never, np.inf, low - s), "high angle": np.where(never, -np.inf, high - s)}
    return rows


def limit_radius(n: Numbers) -> np.ndarray:
    """Minimum radius of curvature of the pitch curve (variants,)."""
    return n.get("limits.convex_radius", 0.0) + n.get("follower.roller_radius", np.zeros_like(n["speed"]))


def _forces(
    some: CamVariants, p: np.ndarray, v: np.ndarray, found: dict[str, np.ndarray], normal: tuple[np.ndarray, ...]
) -> dict[str, np.ndarray]:
    """Contact force, drive torque, lift-off terms, force times curvatures; infinite where the follower jams."""
    (cam, n, turn, _), (sine, cosine, leverage) = some, normal
    s, s1, speed = found["s"], found["s1"], n["speed"][v]
    preload, load, stiffness = (n[f"follower.{key}"][v] for key in ("preload", "load", "stiffness"))
    unsprung = stiffness * s + load
    still = preload + unsprung
    impelled = n["follower.mass" if cam.translating else "follower.inertia"][v] * found["s2"]
    total, share = still + impelled * speed**2, cosine
    if "follower.friction" in n:
        length, overhang = (n[f"follower.{key}"][v] for key in ("guide_length", "overhang"))
        leans = 1.0 + 2.0 * np.maximum(overhang - s, 0.0) / length
        # A groove may pull; friction opposes the motion all the same.
        flank = np.sign(total) if cam.closure == "form" else 1.0
        found["kinks"] = sine, overhang - s, total
        share = cosine - flank * turn.directions[p] * n["follower.friction"][v] * leans * np.abs(sine)
    force = np.where(share > 0.0, total / (share * leverage), np.where(np.isnan(share), np.nan, np.inf))
    rows = {"force": force, "moment": total * s1 * (cosine / share), "shortfall": -unsprung - impelled * speed**2}
    # Relative decrease of the contact force with the square of the speed.
    rows["growth"] = np.where(still > 0.0, -impelled / still, np.inf)
    if cam.follower.contact == "flat":
        return rows | {"inner": force / found["radius"]}
    if "follower.roller_radius" in n:
        r, curve = n["follower.roller_radius"][v], found["curvature"]
        rows |= {"inner": force / (r * (1.0 - curve * r)), "outer": -force / (r * (1.0 + curve * r))}
    return rows
