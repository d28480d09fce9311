"""Racks and pinions at a position: pitch circles, and bars along the pitch lines."""

import numpy as np

from engine import FRAME, guide_of
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.symbols import HALF_HEIGHT, HALF_LENGTH, Primitive, box, hatched, line, of_link


def rack_shapes(m: DrawnMotion, k: int) -> list[Primitive]:
    """Rack bars at a node, with the pitch circles of their pinions and a rotating spoke in each.

    Parameters
    ----------
    m : DrawnMotion
    k : int
        Node index.
    """
    found = []
    for name, rack in m.scene.racks.items():
        found += _meshing(m, k, f"racks.{name}.radius", name, rack.pinion, rack.guide, rack.pivot)
    for name, pinion in m.scene.pinions.items():
        guide = pinion.guide or guide_of(m.scene, pinion.rack)
        found += _meshing(m, k, f"pinions.{name}.radius", pinion.rack, name, guide, pinion.pivot)
    return found


def _meshing(
    m: DrawnMotion, k: int, path: str, rack: str | None, pinion: str, guide: str, pivot: str
) -> list[Primitive]:
    radius, axis = m.numbers[path], m.points[pivot][k]
    spoke = axis + abs(radius) * m.axes[pinion][1][k]
    circle = Primitive("pitch", "circle", (complex(axis),), abs(radius))
    found, bar = of_link(pinion, circle, line(axis, spoke)), _bar(m, k, path, rack, guide, pivot)
    carrier = rack or m.scene.guides[guide].link
    if carrier == FRAME:
        ends = bar[-1].points
        return found + hatched(*(ends if radius > 0 else ends[::-1]), m.radius)
    return [*of_link(carrier, *bar), *found]


def _bar(m: DrawnMotion, k: int, path: str, rack: str | None, guide: str, pivot: str) -> list[Primitive]:
    """The stem of a bar, if any, and the bar; for a fixed rack its pitch line."""
    radius, axis = m.numbers[path], m.points[pivot]
    place, u = m.guides[guide]
    touches = axis - 1j * radius * u
    carried = place if rack is None else m.axes[rack][0]
    reach = ((touches - carried) / u).real
    reached = [reach]
    if rack is not None and rack not in m.scene.racks:
        # The bar starts at the stem from the slider.
        reached.append(np.zeros(1))
    if rack in m.scene.racks:
        # The bar extends over the points of its link.
        reached += [((m.points[name] - carried) / u).real for name in m.members(rack)]
    low = min(np.nanmin(some) for some in reached) - HALF_LENGTH * m.radius
    high = max(np.nanmax(some) for some in reached) + HALF_LENGTH * m.radius
    ends = [touches[k] + (end - reach[k]) * u[k] for end in (low, high)]
    if rack is None and m.scene.guides[guide].link == FRAME:
        return [line(*ends)]
    half, away = 0.5 * HALF_HEIGHT * m.radius, -1j * np.sign(radius) * u[k]
    bar = box(sum(ends) / 2 + half * away, u[k], abs(ends[1] - ends[0]) / 2, half)
    if rack is None or rack in m.scene.racks:
        return [bar]
    foot = carried[k] + 1j * ((touches[k] - carried[k]) / u[k]).imag * u[k]
    return [line(carried[k], foot), bar]
