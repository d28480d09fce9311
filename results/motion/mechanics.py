"""Reduced inertia and moment of the benchmark's machines in closed form, written by hand, independent of the engine.

The factories `slider_crank` and `shaper` take the square root to use, so that their functions work for floats, NumPy
arrays and heyoka's expressions alike; `pack_...` and `..._segments` take arrays of any precision, and π in it.

Moments on the crank, other than the motor's, depend only on the angle. Between two jumps the force on the
ram along its coordinate (`ram`) is constant; `..._segments` gives the angles of the jumps in closed form.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

Numbers = Mapping[str, Any]


class Segments(NamedTuple):
    """One revolution from the start, cut where the force on the ram jumps.

    Attributes
    ----------
    edges : list
        Angles [rad] of the cuts from the start to one revolution later; one more than there are segments.
    ram : list
        Force on the ram along its coordinate in each segment [N].
    """

    edges: list
    ram: list


# Slider-crank: r crank, rod from the pin at angle γ to the x axis, slider at x = b on a guide parallel to it


def slider_crank(sqrt: Callable) -> Callable:
    """Give the function (cos φ, sin φ, ram, p) -> (I, dI/dφ, M) of an offset slider-crank."""

    def reduced(c, s, ram, p):
        r, offset, rod2, i0, i1, ib = p[0], p[1], p[2], p[3], p[4], p[5]
        iq, mc, ms, fb, m0 = p[6], p[7], p[8], p[9], p[10]
        x, y = r * c, r * s
        h = offset - y
        w = 1 / sqrt(rod2 - h * h)
        q = -x * w
        b = -y - h * q
        inertia = i0 + i1 * s * b + ib * b * b + iq * q * q
        moment = mc * c + ms * s + (fb + ram) * b - m0
        q1 = (y + h * q * q) * w
        b1 = -x + x * q - h * q1
        inertia1 = i1 * (c * b + s * b1) + 2 * (ib * b * b1 + iq * q * q1)
        return inertia, inertia1, moment

    return reduced


def pack_slider_crank(n: Numbers, offset: Any, along: Any, across: Any, crank: str, i0: Any, force: Any) -> list:
    """Constants of `slider_crank`; components of gravity along and across the guide; `i0`: inertia on the crank."""
    r, rod = n["input.length"], n["groups.drive.first.length"]
    mass, ram = n["bodies.rod_body.mass"], n["bodies.ram_body.mass"]
    k = n["bodies.rod_body.x"] / rod
    at_pin = mass * (1 - k)
    turning = n[f"bodies.{crank}.mass"] * n[f"bodies.{crank}.x"] + at_pin * r
    inertia = i0 + n[f"bodies.{crank}.inertia"] + n[f"bodies.{crank}.mass"] * n[f"bodies.{crank}.x"] ** 2
    inertias = [inertia + at_pin * (1 - k) * r**2, -2 * at_pin * k * r, mass * k**2 + ram, n["bodies.rod_body.inertia"]]
    weights = [across * turning, -along * turning, along * (mass * k + ram) + force]
    return [r, offset, rod**2, *inertias, *weights, n["moments.friction.moment"]]


def pack_feeder(n: Numbers, scene: Any) -> list:
    """Constants of the slider-crank with DC motor."""
    g, stall, no_load = n["gravity"], n["moments.motor.stall_moment"], n["moments.motor.no_load_speed"]
    mechanism = pack_slider_crank(n, n["guides.way.y"], 0 * g, -g, "crank_body", 0 * g, n["forces.feed.force"])
    return [*mechanism, stall, stall / no_load]


def feeder_segments(n: Numbers, scene: Any, pi: Any) -> Segments:
    """No jumps: one segment."""
    return Segments([0 * pi, 2 * pi], [0 * pi])


def pack_press(n: Numbers, scene: Any) -> list:
    """Constants of the press; the x axis of its slider-crank points downwards, so that it starts at π/2."""
    shafts = sum(n[f"shafts.{s}.inertia"] * n[f"shafts.{s}.ratio"] ** 2 for s in scene.shafts)
    mechanism = pack_slider_crank(n, 0 * shafts, n["gravity"], 0 * shafts, "eccentric", shafts, 0 * shafts)
    return [*mechanism, *pack_kloss(n)]


def press_segments(n: Numbers, scene: Any, pi: Any) -> Segments:
    """The punch works on its downward stroke between two heights above the bottom: cosine rule in O, A, B."""
    r, rod, punching = n["input.length"], n["groups.drive.first.length"], scene.forces["punching"]
    low, high = (height + 0 * r for height in punching.over_stroke)
    angles = []
    for height in (high, low):
        b = r + rod - height
        angles.append(2 * pi - np.arccos((b * b + r * r - rod * rod) / (2 * r * b)))
    force = -n["forces.punching.scale"] * punching.force[0]
    return Segments([pi / 2 + 0 * force, *angles, 5 * pi / 2 + 0 * force], [0 * force, force, 0 * force])


# Shaper: crank about (0, e), lever about the origin, link from its end P to the ram at height `bed`


def shaper(sqrt: Callable) -> Callable:
    """Give the function (cos φ, sin φ, ram, p) -> (I, dI/dφ, M) of the shaper; the ram's coordinate is x."""

    def reduced(c, s, ram, p):
        r2, er, rho2, lever, bed, link2 = p[0], p[1], p[2], p[3], p[4], p[5]
        i0, ilever, ipb, ib, iq, mp, mc, m0, r, e = p[6], p[7], p[8], p[9], p[10], p[11], p[12], p[13], p[14], p[15]
        near = 1 / (rho2 + 2 * er * s)
        turn = (r2 + er * s) * near
        reach = lever * sqrt(near)
        x, y = reach * r * c, reach * (e + r * s)
        px, py = -y * turn, x * turn
        h = bed - y
        w = 1 / sqrt(link2 - h * h)
        q = py * w
        b = px - h * q
        inertia = i0 + ilever * turn * turn + ipb * px * b + ib * b * b + iq * q * q
        moment = mp * py + mc * c + ram * b - m0
        turn1 = er * c * (1 - 2 * turn) * near
        px1, py1 = -py * turn - y * turn1, px * turn + x * turn1
        q1 = (py1 - h * q * q) * w
        b1 = px1 + py * q - h * q1
        inertia1 = ipb * (px1 * b + px * b1) + 2 * (ilever * turn * turn1 + ib * b * b1 + iq * q * q1)
        return inertia, inertia1, moment

    return reduced


def pack_shaper(n: Numbers, scene: Any) -> list:
    """Constants of the shaper."""
    r, e, lever, link = n["input.length"], n["points.O.y"], n["points.P.x"], n["groups.drive.first.length"]
    g, block, mass = n["gravity"], n["bodies.block_body.mass"], n["bodies.drag_link_body.mass"]
    lever_mass, lever_x = n["bodies.lever_body.mass"], n["bodies.lever_body.x"]
    k = n["bodies.drag_link_body.x"] / link
    shafts = sum(n[f"shafts.{s}.inertia"] * n[f"shafts.{s}.ratio"] ** 2 for s in scene.shafts)
    i0 = n["bodies.bull_gear.inertia"] + shafts + block * r**2
    swinging = n["bodies.lever_body.inertia"] + lever_mass * lever_x**2 + mass * ((1 - k) * lever) ** 2
    inertias = [i0, swinging, 2 * mass * k * (1 - k), n["bodies.ram_body.mass"] + mass * k**2]
    weights = [-g * (lever_mass * lever_x / lever + mass * (1 - k)), -g * block * r]
    lengths = [r**2, e * r, r**2 + e**2, lever, n["guides.bed.y"], link**2]
    losses = n["moments.friction.moment"]
    return [*lengths, *inertias, n["bodies.drag_link_body.inertia"], *weights, losses, r, e, *pack_kloss(n)]


def shaper_segments(n: Numbers, scene: Any, pi: Any) -> Segments:
    """The crank is normal to the lever at the dead centres; at the ends of the cut two circles give P, P gives A."""
    r, e, lever, link = n["input.length"], n["points.O.y"], n["points.P.x"], n["groups.drive.first.length"]
    bed, cutting = n["guides.bed.y"], scene.forces["cutting"]
    half_return = np.arcsin(r / e)
    start = np.sqrt(link**2 - (bed - lever * np.sqrt(1 - (r / e) ** 2)) ** 2) - lever * r / e
    angles = []
    for distance in cutting.over_stroke:
        left = start + distance
        side2 = left**2 + bed**2
        at_p = np.arctan2(bed, -left) - np.arccos((lever**2 + side2 - link**2) / (2 * lever * np.sqrt(side2)))
        c, s = np.cos(at_p), np.sin(at_p)
        reach = e * s + np.sqrt((e * s) ** 2 - e**2 + r**2)
        angles.append(np.arctan2(reach * s - e, reach * c))
    rub, cut = n["forces.ways.force"] + 0 * r, n["forces.cutting.scale"] * cutting.force[0]
    edges = [0 * r, *angles, pi + half_return, 2 * pi - half_return, 2 * pi + 0 * r]
    return Segments(edges, [rub, rub + cut, rub, -rub, rub])


# Motors: moment reduced to the crank, from the last constants


def dc_motor(omega: Any, p: Sequence) -> Any:
    """Straight line from stall to no load."""
    return p[-2] - p[-1] * omega


def induction_motor(omega: Any, p: Sequence) -> Any:
    """Kloss' formula, expanded in the slip."""
    slip = 1 - p[-1] * omega
    return p[-3] * slip / (slip * slip + p[-2])


def pack_kloss(n: Numbers) -> list:
    """Constants of `induction_motor` on the shaft `rotor`."""
    ratio, slip = n["shafts.rotor.ratio"], n["moments.motor.breakdown_slip"]
    moment, speed = n["moments.motor.breakdown_moment"], n["moments.motor.synchronous_speed"]
    return [2 * ratio * moment * slip, slip**2, ratio / speed]
