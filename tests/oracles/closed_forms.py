"""Motion of simple mechanisms by their closed forms."""

import math
from types import ModuleType

from mpmath import mp


def slider_motion(
    phi: object, radius: object, rod: object, offset: object = 0.0, by: ModuleType = math
) -> tuple[object, object, object]:
    """Place of the slider and its first two derivatives by the crank's angle, in numbers of the module `by`."""
    c, s = by.cos(phi), by.sin(phi)
    y = radius * s - offset
    root = by.sqrt(rod**2 - y**2)
    bend = (radius * c * c - y * s) / root + y**2 * radius * c * c / root**3
    return radius * c + root, -radius * s - y * radius * c / root, -radius * c - radius * bend


def rocker_swing(crank: float, coupler: float, rocker: float, base: object) -> mp.mpf:
    """Angle of a rocker between the positions with crank and coupler in line, stretched and folded."""
    crank, coupler, rocker, base = map(mp.mpf, (crank, coupler, rocker, base))
    sides = coupler + crank, coupler - crank
    stretched, folded = (mp.acos((base**2 + rocker**2 - side**2) / (2 * base * rocker)) for side in sides)
    return stretched - folded
