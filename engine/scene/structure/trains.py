"""Wheels on carriers that turn unevenly: on a joint of the carrier, in mesh with a wheel on another joint of it.

By Willis, the speeds of both wheels relative to the carrier have a constant ratio, however the carrier moves. A wheel
geared to the crank, on a carrier with a constant ratio to the crank, also has a constant ratio to it.
"""

from engine.parts.higher_pairs import Shaft
from engine.parts.skeleton import FRAME
from engine.scene.attachments import places_on, still_links
from engine.scene.scene import Problem, Scene
from engine.scene.structure.meshes import has_known_angle
from engine.words.glossary import did_you_mean


def train_problems(scene: Scene) -> list[Problem]:
    """Reasons why wheels on unevenly turning carriers can't mesh."""
    return [problem for name, shaft in scene.shafts.items() for problem in _wrong_train(scene, name, shaft)]


def mesh_axis(scene: Scene, name: str) -> str | None:
    """Axis of the wheel to which the pivoted shaft `name` is geared; None if its distance from the shaft varies."""
    shaft = scene.shafts[name]
    carried, driven = _axes_on(scene, shaft.carrier or FRAME), _axes_on(scene, shaft.geared_to)
    if shaft.geared_to == FRAME:
        driven = [point for point in carried if _on_frame(scene, point)]
    return next((point for point in driven if _is_one_of(scene, point, carried)), None)


def _axes_on(scene: Scene, link: str) -> list[str]:
    """Points of a link, its joints with other links first."""
    places = list(places_on(scene, link))
    own = [point for point in places if point in scene.points and scene.points[point].link == link]
    return [point for point in places if point not in own] + own


def _on_frame(scene: Scene, point: str) -> bool:
    return point in scene.points and scene.points[point].link == FRAME


def _is_one_of(scene: Scene, point: str, points: list[str]) -> bool:
    """Whether a point is one of some points, or a frame point that coincides with one of them."""
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
        return [(f"{at}.pressure_angle", "without a pivot its mesh has no position; give pivot")]
    if shaft.pivot is None and shaft.carrier is None:
        return []
    if {carrier, shaft.geared_to} <= still:
        message = f"neither {shaft.geared_to!r} nor {carrier!r} turns, so this wheel wouldn't; name a link that turns"
        return [(f"{at}.geared_to", message)]
    if shaft.pivot is None:
        return []
    unknown = sorted({carrier, shaft.geared_to} & loose)
    if unknown:
        message = f"shaft {unknown[0]!r} has no pivot and so no angle, on which the position of this one depends: give "
        return [(f"{at}.geared_to", f"{message}it a pivot, or omit that of {name!r}")]
    points = _axes_on(scene, carrier)
    if not _is_one_of(scene, shaft.pivot, points):
        message = f"{shaft.pivot!r} is not a point of the carrier {carrier!r}; {did_you_mean(shaft.pivot, points)}"
        return [(f"{at}.pivot", message)]
    axis = mesh_axis(scene, name)
    if axis is None:
        message = f"no joint holds {shaft.geared_to!r} on {carrier!r}, which carries this wheel: the distance of their "
        return [(f"{at}.geared_to", f"{message}axes would change; name a link that is hinged to it")]
    if shaft.pressure_angle is not None and _is_one_of(scene, axis, [shaft.pivot]):
        message = f"it is coaxial with {shaft.geared_to!r}, so it has no mesh; omit the pressure angle"
        return [(f"{at}.pressure_angle", message)]
    apart = shaft.carrier is not None and not _is_one_of(scene, axis, [shaft.pivot])
    if shaft.ratio == 1.0 and (apart or shaft.pressure_angle is not None):
        return [(f"{at}.ratio", "1 is not a ratio of two wheels whose axes lie apart, as in a belt; change the ratio")]
    if shaft.gives("around") and has_known_angle(scene, name):
        return [(f"{at}.around", f"the angle of {name!r} is known over all turns, so around has no effect; omit it")]
    return []
