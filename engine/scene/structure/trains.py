"""Wheels on links that turn unevenly: about a joint of their carrier, in mesh with a wheel about another joint of it.

By Willis the speeds of both relative to the carrier have a constant ratio, however that moves. What is geared to the
crank and carried by what turns evenly itself turns evenly.
"""

import numpy as np

from engine.parts.skeleton import FRAME, CrankInput, Shaft
from engine.scene.masses import places_on
from engine.scene.names import WHOLE, Problem, did_you_mean, still_links
from engine.scene.scene import Numbers, Scene
from engine.scene.structure.meshes import has_known_angle, net_turns


def train_problems(scene: Scene) -> list[Problem]:
    """Everything that keeps wheels in mesh with those of links that turn unevenly from meshing.

    Parameters
    ----------
    scene : Scene
    """
    found = [problem for name, shaft in scene.shafts.items() for problem in _wrong_train(scene, name, shaft)]
    return found or _open_shafts(scene)


def comes_back(scene: Scene, numbers: Numbers) -> bool | np.ndarray:
    """Whether all shafts that joints or guides of groups lie on are in their place again after a cycle.

    Parameters
    ----------
    scene : Scene
    numbers : Numbers
        Of variants.

    Returns
    -------
    bool or ndarray (variants,) of bool
    """
    whole: bool | np.ndarray = True
    for name in _bearing(scene):
        turns = net_turns(scene, name, numbers) * scene.input.revolutions
        whole = whole & (np.abs(turns - np.round(turns)) <= WHOLE)
    return whole


def _bearing(scene: Scene) -> list[str]:
    """Shafts of known angle that joints or guides of groups lie on, under a crank that turns fully."""
    drive = scene.input
    if not isinstance(drive, CrankInput) or drive.start is not None:
        return []
    hung = [part for group in scene.groups.values() for part in (group.first, group.second)]
    points = {part.joint for part in hung if hasattr(part, "joint")}
    points |= {joint for link in scene.links.values() for joint in link.joints}
    guides = {part.guide for part in hung if hasattr(part, "guide")} | {link.guide for link in scene.links.values()}
    bearing = {part.link for name, part in scene.points.items() if name in points}
    bearing |= {part.link for name, part in scene.guides.items() if name in guides}
    return sorted(name for name in bearing & set(scene.shafts) if has_known_angle(scene, name))


def _open_shafts(scene: Scene) -> list[Problem]:
    """Shafts on which joints or guides of groups lie, and that don't come back to where they were in a cycle."""
    problems = []
    for name in _bearing(scene):
        turns = net_turns(scene, name) * scene.input.revolutions
        if abs(turns - round(turns)) > WHOLE:
            message = (
                f"{name!r} makes {turns:g} turns in a cycle of {scene.input.revolutions} of the crank, and what hangs "
                "on it doesn't come back to its place: set input.revolutions to the denominator of its ratio to the "
                "crank"
            )
            problems.append((f"shafts.{name}.ratio", message))
    return problems


def mesh_axis(scene: Scene, name: str) -> str | None:
    """Point about which the wheel lies that a shaft is geared to; None where it keeps no distance from the shaft's.

    Parameters
    ----------
    scene : Scene
    name : str
        Of a shaft with a pivot.
    """
    shaft = scene.shafts[name]
    carried, driven = _axes_on(scene, shaft.carrier or FRAME), _axes_on(scene, shaft.geared_to)
    if shaft.geared_to == FRAME:
        driven = [point for point in carried if _on_frame(scene, point)]
    return next((point for point in driven if _is_one_of(scene, point, carried)), None)


def _axes_on(scene: Scene, link: str) -> list[str]:
    """Points of a link, those first at which it is hinged to others."""
    places = list(places_on(scene, link))
    own = [point for point in places if point in scene.points and scene.points[point].link == link]
    return [point for point in places if point not in own] + own


def _on_frame(scene: Scene, point: str) -> bool:
    return point in scene.points and scene.points[point].link == FRAME


def _is_one_of(scene: Scene, point: str, points: list[str]) -> bool:
    """Whether a point is one of some, or lies in the same place of the frame as one of them."""
    if point in points or not _on_frame(scene, point):
        return point in points
    return any(_on_frame(scene, other) and scene.points[other] == scene.points[point] for other in points)


def _wrong_train(scene: Scene, name: str, shaft: Shaft) -> list[Problem]:
    at, still, loose = f"shafts.{name}", still_links(scene), {n for n, s in scene.shafts.items() if s.pivot is None}
    carrier = shaft.carrier or FRAME
    if carrier == shaft.geared_to:
        message = f"{carrier!r} carries this wheel, and can't be geared to it; name another link that is hinged to it"
        return [(f"{at}.geared_to", message)]
    if shaft.pivot is None and shaft.pressure_angle is not None:
        return [(f"{at}.pressure_angle", "its teeth have no place without a pivot; give pivot")]
    if shaft.pivot is None and shaft.carrier is None:
        return []
    if {carrier, shaft.geared_to} <= still:
        message = f"neither {shaft.geared_to!r} nor {carrier!r} turns, so this wheel wouldn't; name a link that turns"
        return [(f"{at}.geared_to", message)]
    if shaft.pivot is None:
        return []
    unknown = sorted({carrier, shaft.geared_to} & loose)
    if unknown:
        message = f"shaft {unknown[0]!r} has no pivot and so no angle, which the place of this one follows from: give "
        return [(f"{at}.geared_to", f"{message}it a pivot, or leave that of {name!r} out")]
    points = _axes_on(scene, carrier)
    if not _is_one_of(scene, shaft.pivot, points):
        message = f"{shaft.pivot!r} is no point of the carrier {carrier!r}; {did_you_mean(shaft.pivot, points)}"
        return [(f"{at}.pivot", message)]
    axis = mesh_axis(scene, name)
    if axis is None:
        message = f"no joint holds {shaft.geared_to!r} on {carrier!r}, which carries this wheel: the distance of their "
        return [(f"{at}.geared_to", f"{message}axes would change; name a link that is hinged to it")]
    if shaft.pressure_angle is not None and _is_one_of(scene, axis, [shaft.pivot]):
        message = f"its teeth have no place, as it is about the axis of {shaft.geared_to!r}; leave the angle out"
        return [(f"{at}.pressure_angle", message)]
    apart = shaft.carrier is not None and not _is_one_of(scene, axis, [shaft.pivot])
    if shaft.ratio == 1.0 and (apart or shaft.pressure_angle is not None):
        return [(f"{at}.ratio", "1 is no ratio of two wheels whose axes lie apart, as in a belt; change the ratio")]
    return []
