"""Wheels and racks that can't mesh: varying axis distances, unknown angles, racks that run away.

The total angle of a pinion relative to the carrier of its rack must be known over many turns. It is known relative to
the frame for links geared to the crank, and relative to their carriers for pinions, second inputs and sliders. Links of
structural groups swing or turn as their loops allow: a rack on such a link needs a pinion whose angle relative to the
link is known.
"""

import numpy as np

from engine import laws
from engine.parts.skeleton import FRAME
from engine.scene.attachments import crank_of, guide_of, places_on, sliders
from engine.scene.pairs import drive_base
from engine.scene.scene import Numbers, Problem, Scene
from engine.scene.structure.input_laws import drive_turns
from engine.words.glossary import did_you_mean


def rides_along(scene: Scene, point: str, guide: str) -> str | None:
    """Slider on a guide to which a point belongs; None if there is none."""
    on_guide = [link for link in sliders(scene) if guide_of(scene, link) == guide]
    return next((link for link in on_guide if point in places_on(scene, link)), None)


def mesh_problems(scene: Scene) -> list[Problem]:
    """Reasons why racks, pinions and non-circular wheels of a scene can't mesh."""
    # Racks are checked once all pinions have valid racks.
    problems = [problem for name in scene.noncircular_wheels for problem in _wrong_wheel(scene, name)]
    problems += [problem for name in scene.pinions for problem in _wrong_pinion(scene, name)]
    if problems:
        return problems
    for name, rack in scene.racks.items():
        at, turning = f"racks.{name}", sorted(_turning(scene))
        if rack.pinion not in turning:
            message = f"the angle of {rack.pinion!r} isn't known over its turns: a rack is driven by the crank, a "
            message += f"shaft with a pivot, a pinion, a second input or a wheel; {did_you_mean(rack.pinion, turning)}"
            problems.append((f"{at}.pinion", message))
            continue
        if rack.pivot not in places_on(scene, rack.pinion):
            message = f"{rack.pivot!r} is not a point of {rack.pinion!r}; name the axis that this pinion turns about"
            problems.append((f"{at}.pivot", message))
        problems += _unknown_angle(scene, name) or _unheld(scene, f"{at}.pivot", rack.pivot, rack.guide)
    return problems


def _wrong_wheel(scene: Scene, name: str) -> list[Problem]:
    wheel, drive, at = scene.noncircular_wheels[name], scene.input, f"noncircular_wheels.{name}"
    on_frame = {n for n, shaft in scene.shafts.items() if shaft.carrier is None and has_known_angle(scene, n)}
    on_frame |= set(scene.noncircular_wheels) | crank_of(scene)
    if wheel.geared_to not in on_frame:
        message = "is in mesh with the crank, a shaft with a pivot on the frame, or another such wheel; "
        return [(f"{at}.geared_to", message + did_you_mean(wheel.geared_to, on_frame - {name}))]
    axes = {drive.link: drive.pivot} | {n: s.pivot for n, s in (scene.shafts | scene.noncircular_wheels).items()}
    axis = axes[wheel.geared_to]
    if scene.points[wheel.pivot] == scene.points[axis]:
        return [(f"{at}.pivot", f"lies on the axis of {wheel.geared_to!r}: wheels in mesh have two axes; move it")]
    return []


def _wrong_pinion(scene: Scene, name: str) -> list[Problem]:
    pinion, at = scene.pinions[name], f"pinions.{name}"
    guide = pinion.guide if pinion.rack is None else guide_of(scene, pinion.rack)
    if guide is None:
        known = [link for link in sliders(scene) if guide_of(scene, link) is not None]
        message = f"{pinion.rack!r} doesn't slide on a guide, and can't be a rack; {did_you_mean(pinion.rack, known)}"
        return [(f"{at}.rack", message)]
    problems = _unheld(scene, f"{at}.pivot", pinion.pivot, guide)
    if problems:
        return problems
    rides = rides_along(scene, pinion.pivot, guide)
    if pinion.rack is None and rides is None:
        message = f"{pinion.pivot!r} doesn't move along {guide!r}, so the pinion wouldn't turn; name the joint "
        return [(f"{at}.pivot", f"{message}of a slider on that guide, or give the rack that moves")]
    if pinion.rack is not None and rides == pinion.rack:
        message = f"{pinion.pivot!r} moves with {pinion.rack!r}, so the pinion wouldn't turn; name another point"
        return [(f"{at}.pivot", message)]
    return []


def _unknown_angle(scene: Scene, name: str) -> list[Problem]:
    """A rack on a link relative to which the angle of its pinion isn't known."""
    rack = scene.racks[name]
    carrier = scene.guides[rack.guide].link
    if root_of(scene, carrier) == root_of(scene, rack.pinion):
        return []
    message = (
        f"{rack.guide!r} is on {carrier!r}, whose angle relative to {rack.pinion!r} isn't known over its turns; drive "
    )
    message += "the rack by a pinion that a rack on that link turns, or put the guide where the pinion's own rack lies"
    return [(f"racks.{name}.guide", message)]


def _unheld(scene: Scene, path: str, pivot: str, guide: str) -> list[Problem]:
    """An axis at a varying distance from the rack."""
    carrier = scene.guides[guide].link
    if pivot in places_on(scene, carrier) or rides_along(scene, pivot, guide) is not None:
        return []
    message = f"{pivot!r} doesn't keep its distance from guide {guide!r}: name a point of {carrier!r}, which carries "
    return [(path, f"{message}that guide, or the joint of a slider on it")]


def _turning(scene: Scene) -> set[str]:
    """Turning links whose total angle over all turns is known."""
    return (
        crank_of(scene)
        | {name for name in scene.shafts if has_known_angle(scene, name)}
        | {*scene.pinions, *scene.noncircular_wheels}
        | {name for name, second in scene.inputs.items() if second.type == "crank"}
    )


def carrier_of(scene: Scene, link: str) -> str | None:
    """Carrier of a pinion, a second input or a slider, the reference of its angle; None for other links."""
    if link in scene.pinions:
        pinion = scene.pinions[link]
        return scene.guides[pinion.guide or guide_of(scene, pinion.rack)].link
    if link in scene.inputs:
        return drive_base(scene, link)
    guide = guide_of(scene, link)
    return None if guide is None else scene.guides[guide].link


def root_of(scene: Scene, link: str) -> str:
    """Reference of a link's total angle over all turns: the frame, a link of a structural group, or the link itself."""
    while (carrier := carrier_of(scene, link)) is not None:
        link = carrier
    turning = crank_of(scene) | set(scene.noncircular_wheels)
    return FRAME if link in turning or has_known_angle(scene, link) else link


def has_known_angle(scene: Scene, shaft: str) -> bool:
    """Whether a link is a shaft whose total angle relative to the frame is known over all turns."""
    part = scene.shafts.get(shaft)
    return (
        part is not None
        and part.pivot is not None
        and all(root_of(scene, link) == FRAME for link in (part.geared_to, part.carrier or FRAME))
    )


def net_turns(scene: Scene, link: str, numbers: Numbers | None = None) -> float | np.ndarray:
    """Turns of a link per turn of the crank, relative to the reference of its angle.

    Parameters
    ----------
    scene : Scene
    link : str
    numbers : Numbers, optional
        Per-variant ratios of shafts instead of the scene's; the result is then an array (variants,) if those vary.
    """
    if link in scene.noncircular_wheels:
        wheel = scene.noncircular_wheels[link]
        return -wheel.driver_lobes / wheel.lobes * net_turns(scene, wheel.geared_to, numbers)
    carrier = carrier_of(scene, link)
    if carrier is not None:
        own = drive_turns(scene, link) if link in scene.inputs else 0.0
        return own + net_turns(scene, carrier, numbers)
    if has_known_angle(scene, link):
        shaft = scene.shafts[link]
        ratio = shaft.ratio if numbers is None else numbers[f"shafts.{link}.ratio"]
        carried = net_turns(scene, shaft.carrier or FRAME, numbers)
        return laws.kinematics.geared_links.willis(ratio, net_turns(scene, shaft.geared_to, numbers), carried)
    return float(link in crank_of(scene))
