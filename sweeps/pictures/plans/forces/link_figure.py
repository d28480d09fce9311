"""A single link as drawn in the mechanism."""

from engine import RPP, RPR, mesh_axis
from sweeps.pictures.drawing import Primitive
from sweeps.pictures.drawing.higher_pairs import cam_profile, follower_shape
from sweeps.pictures.drawing.links import slider_body
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.racks import rack_bar
from sweeps.pictures.drawing.symbols import HALF_HEIGHT, HALF_LENGTH, box, line, link_shape
from sweeps.pictures.plans.contacts import Rolling, rolling
from sweeps.pictures.plans.pose import Pose


def link_figure(pose: Pose, link: str) -> list[Primitive]:
    """A single link as drawn in the mechanism, with its joints and its cam or wheel.

    Parameters
    ----------
    pose : Pose
    link : str
    """
    m, k = pose.motion, pose.k
    r, places = m.radius, [complex(m.points[n][k]) for n in m.members(link)]
    found = [*_in_higher_pairs(pose, link), *link_shape(places, r)]
    for group in m.scene.groups.values():
        found = [*_slotted(m, group, link, k), *found]
    for slider in m.sliders:
        if slider.link == link:
            found = [*slider_body(m, slider, k, HALF_HEIGHT * r), *found]
    hinges = [n for n in m.members(link) if n in m.hinges]
    others = [n for n in m.members(link) if n not in m.hinges]
    found += [Primitive("joints", "circle", (complex(m.points[n][k]),), r, "paper", n) for n in hinges]
    return found + [Primitive("joints", "circle", (complex(m.points[n][k]),), 0.55 * r, "solid", n) for n in others]


def _in_higher_pairs(pose: Pose, link: str) -> list[Primitive]:
    """Profiles, rollers, faces, pitch circles and curves, and racks of a link."""
    m, k, scene, found = pose.motion, pose.k, pose.scene, []
    for name, cam in scene.cams.items():
        if link == cam.on:
            found.append(cam_profile(m, name, k))
        elif link == cam.follower.link:
            found += follower_shape(m, name, k)
    for name in (*scene.shafts, *scene.noncircular_wheels, *scene.racks, *scene.pinions):
        contact = rolling(pose, name)
        if contact is not None and link in (contact.link, contact.driver):
            found += _rolling_body(pose, name, contact, link)
    return found


def _rolling_body(pose: Pose, name: str, contact: Rolling, link: str) -> list[Primitive]:
    """Pitch circle or curve of a wheel in mesh, or a rack."""
    m, scene = pose.motion, pose.scene
    if name in scene.noncircular_wheels:
        place, along = (values[pose.k] for values in m.axes(link))
        curve = m.pitch_curves[name][link == contact.driver]
        return [line(*(place + curve * along), layer="pitch")]
    if name in scene.shafts:
        axis = scene.shafts[name].pivot if link == name else mesh_axis(scene, name)
    else:
        part = scene.racks.get(name) or scene.pinions[name]
        if (link == name) == (name in scene.racks):
            return rack_bar(m, pose.k, name)
        axis = part.pivot
    centre = pose.point(axis).place
    return [Primitive("pitch", "circle", (centre,), abs(contact.place - centre))]


def _slotted(m: DrawnMotion, group: object, link: str, k: int) -> list[Primitive]:
    """A block of a group, or its slotted link."""
    if not isinstance(group, (RPR, RPP)) or link not in (group.first.link, group.second.link):
        return []
    r = m.radius
    origin, u = (complex(values[k]) for values in m.axes(link))
    if link == group.first.link:
        return [box(origin, u, HALF_LENGTH * r, HALF_HEIGHT * r)]
    low, high = m.range_of(group.first.link)
    margin = (HALF_LENGTH + 1.5) * r
    if isinstance(group, RPR):
        return [line(origin + min(low - margin, 0) * u, origin + max(high + margin, 0) * u)]
    slot = complex(m.axes(group.first.link)[1][k])
    reach = [((m.points[n][k] - origin) / u).real for n in m.members(link)]
    stem = line(origin + min([0.0, *reach]) * u, origin + max([12 * r, *reach]) * u)
    return [stem, box(origin + (low + high) / 2 * slot, slot, (high - low) / 2 + margin, HALF_HEIGHT * r, "paper")]
