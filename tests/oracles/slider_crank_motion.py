"""Motion of a slider-crank by its closed form."""

import math
from types import ModuleType


def slider_motion(
    phi: object, radius: object, rod: object, offset: object = 0.0, by: ModuleType = math
) -> tuple[object, object, object]:
    """Place of the slider and its first two derivatives by the crank's angle, in numbers of the module `by`."""
    c, s = by.cos(phi), by.sin(phi)
    y = radius * s - offset
    root = by.sqrt(rod**2 - y**2)
    bend = (radius * c * c - y * s) / root + y**2 * radius * c * c / root**3
    return radius * c + root, -radius * s - y * radius * c / root, -radius * c - radius * bend
