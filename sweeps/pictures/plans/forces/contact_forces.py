"""Forces in the higher pairs of a machine at a position: between teeth along the line of action, and on cams.

The force between teeth has a part along the common tangent of the pitch curves and one that pushes them apart. Losses
shift it along the line of centres. A cam presses along the common normal; friction acts across it.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on forces in mechanisms with higher pairs.
"""

import math
from typing import NamedTuple

from engine import FRAME, friction_in_pairs, guide_of, mesh_axis, mesh_lost_share, mesh_shifted_contact
from sweeps.pictures.plans.contacts import rolling
from sweeps.pictures.plans.pose import Pose


class ContactForce(NamedTuple):
    """A force in a higher pair.

    Attributes
    ----------
    pair : str
        What it is told by: the driven wheel, rack or pinion, or `CAM.contact`.
    link, other : str
        On which it acts, and from which.
    force : complex
        x + iy [N].
    at : complex
        [m]
    rubs : bool
        Whether it is friction.
    """

    pair: str
    link: str
    other: str
    force: complex
    at: complex
    rubs: bool = False


def contact_forces(pose: Pose) -> list[ContactForce]:
    """Forces on all cams' followers, and between all teeth that the scene gives a pressure angle or a rack.

    Parameters
    ----------
    pose : Pose
    """
    scene, found = pose.scene, []
    for name in scene.cams:
        found += _on_follower(pose, name)
    shafts = [name for name, shaft in scene.shafts.items() if shaft.pressure_angle is not None]
    found += [_on_shaft(pose, name) for name in shafts]
    wheels = [name for name, wheel in scene.noncircular_wheels.items() if wheel.pressure_angle is not None]
    return (
        found + [_on_wheel(pose, name) for name in wheels] + [_on_rack(pose, n) for n in (*scene.racks, *scene.pinions)]
    )


def share_lost_between_teeth(pose: Pose, name: str, taken: float) -> float:
    """By how much losses between teeth change what loads their driver.

    Parameters
    ----------
    pose : Pose
    name : str
        Of a shaft, non-circular wheel, rack or pinion.
    taken : float
        Moment on it from its driver [N·m], of a rack the force [N], or what has its sign.
    """
    scene, numbers = pose.scene, pose.cycle.numbers
    tables = ("shafts", "noncircular_wheels", "racks", "pinions")
    table = next(table for table in tables if name in getattr(scene, table))
    part = getattr(scene, table)[name]
    if part.efficiency is None:
        return 1.0
    if table == "racks":
        turning = pose.turn(part.pinion).omega - pose.turn(scene.guides[part.guide].link).omega
        rolling_rate = numbers[f"racks.{name}.radius"] * turning
    else:
        guide = (part.guide or guide_of(scene, part.rack)) if table == "pinions" else None
        carrier = scene.guides[guide].link if guide else getattr(part, "carrier", None) or FRAME
        rolling_rate = pose.turn(name).omega - pose.turn(carrier).omega
    return mesh_lost_share(rolling_rate * taken, numbers[f"{table}.{name}.efficiency"])


def _on_follower(pose: Pose, name: str) -> list[ContactForce]:
    cam, k, forces = pose.scene.cams[name], pose.k, pose.cycle.forces
    ends, normal = (f"{name}.contact", cam.follower.link, cam.on), pose.vector(f"{name}.normal")
    at = complex(pose.motion.contacts[name][k])
    found = [ContactForce(*ends, float(forces[f"{name}.contact_force"][k]) * normal, at)]
    rubbing = friction_in_pairs(pose.scene).get(f"{name}.contact")
    if rubbing is not None:
        found.append(ContactForce(*ends, float(forces[rubbing][k]) * 1j * normal, at, rubs=True))
    return found


def _parts(pose: Pose, name: str) -> tuple[float, float]:
    """Force between teeth along the tangent, and apart."""
    return tuple(float(pose.cycle.forces[f"{name}.{part}_force"][pose.k]) for part in ("tangential", "radial"))


def _on_shaft(pose: Pose, name: str) -> ContactForce:
    shaft, contact, ratio = pose.scene.shafts[name], rolling(pose, name), pose.cycle.numbers[f"shafts.{name}.ratio"]
    tangential, apart = _parts(pose, name)
    line = pose.point(shaft.pivot).place - pose.point(mesh_axis(pose.scene, name)).place
    along, radius = line / abs(line), abs(line) / (ratio - 1)
    shifted = mesh_shifted_contact(radius, ratio, share_lost_between_teeth(pose, name, -tangential * radius))
    force = (-1j * tangential - math.copysign(apart, ratio)) * along
    return ContactForce(name, name, contact.driver, force, contact.place + (shifted - radius) * along)


def _on_wheel(pose: Pose, name: str) -> ContactForce:
    (tangential, apart), contact = _parts(pose, name), rolling(pose, name)
    force = (tangential - 1j * apart) * pose.vector(f"{name}.tangent")
    axis, driving = (pose.origin(link).place for link in (name, contact.driver))
    along, own = (axis - driving) / abs(axis - driving), abs(axis - contact.place)
    k = share_lost_between_teeth(pose, name, ((contact.place - axis).conjugate() * force).imag)
    shifted = mesh_shifted_contact(-own, -abs(contact.place - driving) / own, k)
    return ContactForce(name, name, contact.driver, force, contact.place + (shifted + own) * along)


def _on_rack(pose: Pose, name: str) -> ContactForce:
    """On a rack, or on the pinion that a rack drives: teeth push the pinion to the side on which its axis lies."""
    (tangential, apart), contact, scene = _parts(pose, name), rolling(pose, name), pose.scene
    is_rack = name in scene.racks
    part = scene.racks[name] if is_rack else scene.pinions[name]
    radius = pose.cycle.numbers[f"{'racks' if is_rack else 'pinions'}.{name}.radius"]
    along = pose.guide(part.guide or guide_of(scene, part.rack))
    away = math.copysign(apart, radius) * (-1 if is_rack else 1)
    k = share_lost_between_teeth(pose, name, tangential if is_rack else tangential * radius)
    place = contact.place + (radius - (radius * k if is_rack else radius / k)) * 1j * along
    return ContactForce(name, name, contact.driver, (tangential + 1j * away) * along, place)
