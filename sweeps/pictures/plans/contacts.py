"""Higher pairs of a machine at a position: where wheels, racks and cams touch, and what joins the motion there.

Pitch circles and curves roll on each other: both bodies have one velocity at the pitch point, and their accelerations
differ there along the common normal alone. With curvatures κ, κ' of the pitch curves, positive where they are convex,
and the relative angular velocity ω it is ω²/(κ + κ'), towards the body whose acceleration is meant.

A cam is replaced by what it is for a moment. A roller or knife edge B slides along the pitch curve: its velocity
relative to the cam lies along the tangent, its relative acceleration is v²κ to the curve's centre, besides that along
the tangent and Coriolis's. A flat face carries the centre of curvature C of the cam's profile along.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing, on cam mechanisms and on the
replacement of higher pairs.
"""

from typing import NamedTuple

from engine import guide_of, mesh_axis, mesh_driver
from sweeps.pictures.plans.pose import Pose


class Rolling(NamedTuple):
    """A pitch point, where a wheel or rack rolls on what drives it.

    Attributes
    ----------
    name : str
        Its letter in plans.
    driver, link : str
        What drives, and what is driven.
    place : complex
        [m]
    drift : complex
        What times the square of the relative angular velocity is the acceleration of `link`'s place relative to the
        driver's [m].
    """

    name: str
    driver: str
    link: str
    place: complex
    drift: complex


class Touching(NamedTuple):
    """Where a cam touches its follower.

    Attributes
    ----------
    name : str
        In plans, the letter of the roller's centre or edge, B, or of the profile's centre of curvature, C.
    cam, follower : str
        Links.
    place : complex
        Of that point [m].
    normal : complex
        Unit vector from the cam to the follower.
    curvature : float or None
        Of the curve that the follower's point describes on the cam [1/m]; None where the face of the follower is flat,
        and the cam's point moves along it.
    """

    name: str
    cam: str
    follower: str
    place: complex
    normal: complex
    curvature: float | None


def lettered(pose: Pose, letter: str, link: str) -> str:
    """Name in plans of a place that the scene has none for: a letter with the number of a link."""
    name = f"{letter}{pose.number(link)}"
    while name in pose.motion.points:
        name += letter.lower()
    return name


def rolling(pose: Pose, name: str) -> Rolling | None:
    """Pitch point of a shaft, non-circular wheel, rack or pinion with its driver; None for a shaft that meshes nowhere.

    Parameters
    ----------
    pose : Pose
    name : str
    """
    scene, letter = pose.scene, lettered(pose, "P", name)
    if name in scene.shafts:
        return _of_shaft(pose, name, letter)
    if name in scene.noncircular_wheels:
        wheel, k = pose.cycle.rates.noncircular[name], pose.k
        drift = complex(wheel.away[k] / (wheel.curvature[k] + wheel.driver_curvature[k]))
        return Rolling(letter, mesh_driver(scene, name), name, complex(wheel.pitch_point[k]), drift)
    if name in scene.racks:
        rack = scene.racks[name]
        arm = 1j * pose.cycle.numbers[f"racks.{name}.radius"] * pose.guide(rack.guide)
        return Rolling(letter, mesh_driver(scene, name), name, _at(pose, rack.pivot) - arm, -arm)
    pinion = scene.pinions[name]
    guide = pinion.guide or guide_of(scene, pinion.rack)
    arm = 1j * pose.cycle.numbers[f"pinions.{name}.radius"] * pose.guide(guide)
    return Rolling(letter, mesh_driver(scene, name), name, _at(pose, pinion.pivot) - arm, arm)


def _of_shaft(pose: Pose, name: str, letter: str) -> Rolling | None:
    """Of a shaft whose wheel meshes with its driver's, and doesn't go by a belt or turn about the same axis."""
    shaft, ratio = pose.scene.shafts[name], pose.cycle.numbers[f"shafts.{name}.ratio"]
    toothed = shaft.carrier is not None or shaft.pressure_angle is not None or ratio < 0
    if shaft.pivot is None or not toothed:
        return None
    centre, axis = _at(pose, shaft.pivot), _at(pose, mesh_axis(pose.scene, name))
    line = centre - axis
    if line == 0:
        return None
    return Rolling(letter, shaft.geared_to, name, centre + line / (ratio - 1), -line * ratio / (1 - ratio) ** 2)


def _at(pose: Pose, point: str) -> complex:
    return complex(pose.motion.points[point][pose.k])


def touching(pose: Pose, name: str) -> Touching:
    """Contact of a cam with its follower.

    Parameters
    ----------
    pose : Pose
    name : str
        Of the cam.
    """
    cam = pose.scene.cams[name]
    follower, link = cam.follower, cam.follower.link
    motion = pose.cycle.rates.cams[name]
    normal, curvature = complex(motion.normal[pose.k]), float(motion.curvature[pose.k])
    if follower.contact == "flat":
        centre = complex(pose.motion.contacts[name][pose.k]) - normal / curvature
        return Touching(lettered(pose, "C", link), cam.on, link, centre, normal, None)
    place = complex(pose.motion.axes(link)[0][pose.k])
    if follower.type == "oscillating":
        place += pose.cycle.numbers[f"cams.{name}.follower.arm"] * pose.direction(link)
    radius = pose.cycle.numbers[f"cams.{name}.follower.roller_radius"] if follower.contact == "roller" else 0.0
    # The pitch curve runs beside the profile at the roller's radius.
    of_pitch_curve = curvature / (1 + curvature * radius)
    return Touching(lettered(pose, "B", link), cam.on, link, place, normal, of_pitch_curve)
