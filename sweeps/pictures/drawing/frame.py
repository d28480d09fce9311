"""Fixed parts of a drawing: pivots, guides of the frame, pitch circles."""

import cmath
import math
from functools import lru_cache

import numpy as np

from engine import FRAME, mesh_axis
from sweeps.pictures.drawing.guides import rails_of
from sweeps.pictures.drawing.higher_pairs import follower_guides
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.symbols import Primitive, bush, fixed_pivot, line

# Links within this angle of a stand's axis cover it; the stand turns to a clearer direction.
NEAR_STAND = math.radians(45)
CLEARLY = 0.1


# Fixed parts are requested at every position of a motion.
@lru_cache(1)
def frame_parts(m: DrawnMotion) -> tuple[Primitive, ...]:
    """Guides of the frame and pitch circles, painted below moving links."""
    scene, found = m.scene, []
    for slider in m.sliders:
        if scene.guides[slider.guide].link == FRAME:
            found += rails_of(m, slider).figures
    for group in scene.groups.values():
        if group.type == "RPP" and scene.guides[group.second.guide].link == FRAME:
            place, along = (values[0] for values in m.guides[group.second.guide])
            found += bush(place + bush_at(m, group) * along, along, m.radius)
    found += follower_guides(m)
    for name, shaft in scene.shafts.items():
        if shaft.pivot is not None and shaft.carrier is None:
            ends = (m.points[p][0] for p in (mesh_axis(scene, name), shaft.pivot))
            found += _gearing((shaft.geared_to, name), *ends, m.numbers[f"shafts.{name}.ratio"])
    return tuple(found)


@lru_cache(1)
def stands(m: DrawnMotion) -> tuple[Primitive, ...]:
    """Stands of the fixed pivots, each on the side least often covered by its links; painted above plates."""
    anchors = m.hinges | {end for s in m.scene.springs.values() for end in s.between}
    fixed = [name for name in sorted(anchors) if name in m.scene.points and m.scene.points[name].link == FRAME]
    return tuple(p for name in fixed for p in fixed_pivot(m.points[name][0], m.radius, _free_side(m, name)))


def _free_side(m: DrawnMotion, pivot: str) -> complex:
    """Direction from a fixed pivot that its links cover least often: down unless another is clearly better."""
    members = [m.members(link) for link in m.links[:-1]]
    # A block's rod counts as a link.
    members += [[g.second.joint, g.first.joint] for g in m.scene.groups.values() if g.type == "RPR"]
    ends = {name for names in members if pivot in names for name in names} - {pivot}
    arms = [m.points[name] - m.points[pivot] for name in ends]
    arms = [arm[np.isfinite(arm)] for arm in arms]

    def share(side: complex) -> float:
        return sum(float(np.mean((arm / side).real > math.cos(NEAR_STAND) * np.abs(arm))) for arm in arms if arm.size)

    return min((-1j, 1j, -1, 1), key=lambda side: share(side) + (0.0 if side == -1j else CLEARLY))


def bush_at(m: DrawnMotion, group: object) -> float:
    """Position of a yoke's bushes along its guide, beyond the stroke."""
    return m.range_of(group.second.link)[1] + 12 * m.radius


def _gearing(links: tuple[str, str], a: complex, b: complex, ratio: float) -> list[Primitive]:
    """Pitch circles of two wheels in mesh, or of a belt or chain if both turn the same way."""
    d = abs(b - a)
    if d == 0:
        return []
    r1, r2 = (d * share / (1 + abs(ratio)) for share in (abs(ratio), 1))
    straps = []
    if ratio > 0:
        r1, r2 = r1 / 2, r2 / 2
        for side in (1, -1):
            n = (b - a) / d * cmath.exp(1j * side * math.acos((r1 - r2) / d))
            straps.append(line(a + r1 * n, b + r2 * n, layer="pitch"))
    wheels = zip(links, (a, b), (r1, r2), strict=True)
    return [Primitive("pitch", "circle", (c,), radius, link=link) for link, c, radius in wheels] + straps
