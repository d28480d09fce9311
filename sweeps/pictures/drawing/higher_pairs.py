"""Cams, followers, planets and non-circular wheels at a position."""

import numpy as np

from engine import mesh_axis
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.symbols import Primitive, bush, line, of_link

# In hinge radii: clearance of a follower's bush beyond roller and stroke, its half length; overhang of a flat face.
CLEAR, HALF_BUSH, BEYOND = 7.0, 4.0, 3.0


def cam_shapes(m: DrawnMotion, k: int) -> list[Primitive]:
    """Cam profiles at a node, with rollers, faces and the stems of sliding followers."""
    found = []
    for name, cam in m.scene.cams.items():
        place, along = m.axes[cam.on]
        found += of_link(cam.on, line(*(place[k] + m.profiles[name] * along[k])))
        found += of_link(cam.follower.link, *_follower_shape(m, name, k))
    return found


def _follower_shape(m: DrawnMotion, name: str, k: int) -> list[Primitive]:
    """Stem of a sliding follower and its contact, at a node."""
    cam = m.scene.cams[name]
    origin, u = (values[k] for values in m.axes[cam.follower.link])
    found = []
    if cam.translating:
        top = m.guides[cam.follower.guide][0][k] + (_bush(m, name) + (HALF_BUSH + 1.5) * m.radius) * u
        low = m.range_of(cam.follower.link)[0]
        found.append(line(origin, top + (m.slides[cam.follower.link][k] - low) * u))
    return found + _touching(m, name, k, origin, u)


def _touching(m: DrawnMotion, name: str, k: int, origin: complex, u: complex) -> list[Primitive]:
    """Roller, edge or face of a follower."""
    follower, at = m.scene.cams[name].follower, f"cams.{name}.follower"
    if follower.contact == "flat":
        across = -1j * u if follower.type == "translating" else u
        reach = ((m.contacts[name] - m.axes[follower.link][0]) / (across / u * m.axes[follower.link][1])).real
        low, high = np.nanmin(reach) - BEYOND * m.radius, np.nanmax(reach) + BEYOND * m.radius
        return [line(origin + (low if follower.type == "translating" else 0.0) * across, origin + high * across)]
    centre = origin if follower.type == "translating" else origin + m.numbers[f"{at}.arm"] * u
    arm = [] if follower.type == "translating" else [line(origin, centre)]
    if follower.contact == "knife edge":
        return arm
    rim = Primitive("links", "circle", (complex(centre),), m.numbers[f"{at}.roller_radius"], "paper")
    return [*arm, rim, Primitive("joints", "circle", (complex(centre),), 0.55 * m.radius, "solid")]


def follower_guides(m: DrawnMotion) -> list[Primitive]:
    """Frame bushes of sliding followers."""
    found = []
    for name, cam in m.scene.cams.items():
        if cam.translating:
            place, u = (complex(values[0]) for values in m.guides[cam.follower.guide])
            found += bush(place + _bush(m, name) * u, u, m.radius)
    return found


def planet_circles(m: DrawnMotion, k: int) -> list[Primitive]:
    """Pitch circles of planets and their mating wheels at a node."""
    found = []
    for name, shaft in m.scene.shafts.items():
        if shaft.carrier is not None and shaft.pivot is not None:
            centre, other = (complex(m.points[point][k]) for point in (shaft.pivot, mesh_axis(m.scene, name)))
            ratio = m.numbers[f"shafts.{name}.ratio"]
            if centre == other:
                continue
            radius = abs(centre - other) / abs(ratio - 1.0)
            circles = ((name, centre, radius), (shaft.geared_to, other, abs(ratio) * radius))
            found += [Primitive("pitch", "circle", (c,), r, link=link) for link, c, r in circles]
    return found


def pitch_curves(m: DrawnMotion, k: int) -> list[Primitive]:
    """Pitch curves of non-circular wheels and their drivers at a node."""
    found = []
    for name, curves in m.pitch_curves.items():
        for link, curve in zip((name, m.scene.noncircular_wheels[name].geared_to), curves, strict=True):
            place, along = m.axes[link]
            drawn = np.append(curve, curve[:1]) if m.scene.has_cycle else curve
            found += of_link(link, line(*(place[k] + drawn * along[k]), layer="pitch"))
    return found


def _bush(m: DrawnMotion, name: str) -> float:
    """Position of a follower's bush along its guide, beyond the stroke."""
    follower = m.scene.cams[name].follower
    roller = m.numbers[f"cams.{name}.follower.roller_radius"] if follower.contact == "roller" else 0.0
    return m.range_of(follower.link)[1] + roller + CLEAR * m.radius
