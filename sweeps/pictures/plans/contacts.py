"""Higher pairs of a machine at a position: contacts of wheels, racks and cams, and their kinematic conditions.

Pitch circles and curves roll on each other: at the pitch point both bodies have the same velocity, and their
accelerations differ only along the common normal, by ω²/(κ + κ') towards the body considered, with the relative angular
velocity ω and the curvatures κ, κ' of the pitch curves, positive if convex.

A cam is replaced by its instantaneous equivalent. A roller or knife edge B slides along the pitch curve: its velocity
relative to the cam is tangential, its relative acceleration has the parts v²κ towards the curve's centre, tangential,
and Coriolis. A flat face moves with the centre of curvature C of the cam's profile.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on gearing, on cam mechanisms and on the
replacement of higher pairs.
"""

from typing import NamedTuple

from engine import guide_of, mesh_axis, mesh_driver
from sweeps.pictures.plans.pose import Pose


class Rolling(NamedTuple):
    """A pitch point, where a wheel or rack rolls on its driver.

    Attributes
    ----------
    name : str
        Letter in plans.
    driver, link : str
        Driving and driven link.
    place : complex
        [m]
    drift : complex
        Acceleration of `link`'s pitch point relative to the driver's, over the square of the relative angular velocity
        [m].
    """

    name: str
    driver: str
    link: str
    place: complex
    drift: complex


class Touching(NamedTuple):
    """Contact of a cam and its follower.

    Attributes
    ----------
    name : str
        Letter in plans: B for the roller centre or edge, C for the profile's centre of curvature.
    cam, follower : str
        Links.
    place : complex
        That point [m].
    normal : complex
        Unit vector from the cam to the follower.
    curvature : float or None
        Curvature of the follower point's path on the cam [1/m]; None for a flat face, along which the cam's point
        moves.
    """

    name: str
    cam: str
    follower: str
    place: complex
    normal: complex
    curvature: float | None


def lettered(pose: Pose, letter: str, link: str) -> str:
    """Name in plans of an unnamed point: a letter with a link number."""
    name = f"{letter}{pose.number(link)}"
    while name in pose.motion.points:
        name += letter.lower()
    return name


def rolling(pose: Pose, name: str) -> Rolling | None:
    """Pitch point of a shaft, non-circular wheel, rack or pinion with its driver; None for a shaft without a mesh.

    Parameters
    ----------
    pose : Pose
    name : str
    """
    scene, letter = pose.scene, lettered(pose, "P", name)
    if name in scene.shafts:
        return _of_shaft(pose, name, letter)
    if name in scene.noncircular_wheels:
        wheel, k = pose.motion.rates.noncircular[name], pose.k
        drift = complex(wheel.away[k] / (wheel.curvature[k] + wheel.driver_curvature[k]))
        return Rolling(letter, mesh_driver(scene, name), name, complex(wheel.pitch_point[k]), drift)
    if name in scene.racks:
        rack = scene.racks[name]
        arm = 1j * pose.motion.numbers[f"racks.{name}.radius"] * pose.guide(rack.guide)
        return Rolling(letter, mesh_driver(scene, name), name, pose.place(rack.pivot) - arm, -arm)
    pinion = scene.pinions[name]
    guide = pinion.guide or guide_of(scene, pinion.rack)
    arm = 1j * pose.motion.numbers[f"pinions.{name}.radius"] * pose.guide(guide)
    return Rolling(letter, mesh_driver(scene, name), name, pose.place(pinion.pivot) - arm, arm)


def _of_shaft(pose: Pose, name: str, letter: str) -> Rolling | None:
    """Pitch point of a shaft whose wheel meshes with its driver's (no belt, different axes)."""
    shaft, ratio = pose.scene.shafts[name], pose.motion.numbers[f"shafts.{name}.ratio"]
    toothed = shaft.carrier is not None or shaft.pressure_angle is not None or ratio < 0
    if shaft.pivot is None or not toothed:
        return None
    centre, axis = pose.place(shaft.pivot), pose.place(mesh_axis(pose.scene, name))
    line = centre - axis
    if line == 0:
        return None
    return Rolling(letter, shaft.geared_to, name, centre + line / (ratio - 1), -line * ratio / (1 - ratio) ** 2)


def touching(pose: Pose, name: str) -> Touching:
    """Contact of a cam with its follower.

    Parameters
    ----------
    pose : Pose
    name : str
        Name of the cam.
    """
    cam = pose.scene.cams[name]
    follower, link = cam.follower, cam.follower.link
    motion = pose.motion.rates.cams[name]
    normal, curvature = complex(motion.normal[pose.k]), float(motion.curvature[pose.k])
    if follower.contact == "flat":
        centre = complex(pose.motion.contacts[name][pose.k]) - normal / curvature
        return Touching(lettered(pose, "C", link), cam.on, link, centre, normal, None)
    place = complex(pose.motion.axes[link][0][pose.k])
    if follower.type == "oscillating":
        place += pose.motion.numbers[f"cams.{name}.follower.arm"] * pose.direction(link)
    radius = pose.motion.numbers[f"cams.{name}.follower.roller_radius"] if follower.contact == "roller" else 0.0
    # The pitch curve is offset from the profile by the roller radius.
    of_pitch_curve = curvature / (1 + curvature * radius)
    return Touching(lettered(pose, "B", link), cam.on, link, place, normal, of_pitch_curve)
