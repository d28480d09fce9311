"""The masses of a machine in its dynamics: each body, or the point masses that replace it.

Mass and moment of inertia of a body are given, or follow from its shape, or from the period of a swing.
"""

import math
import operator
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from engine import laws
from engine.laws.masses.link_inertia import (
    Value,
    bifilar_inertia,
    compound_inertia,
    disc_inertia,
    plate_inertia,
    ring_inertia,
    rod_inertia,
    trifilar_inertia,
)
from engine.parts.actions import Carried
from engine.scene.attachments import places_on
from engine.scene.scene import Numbers, Problem, Scene, scene_numbers
from engine.words.glossary import did_you_mean

Compute = Callable[[Numbers], float | np.ndarray]

CENTRE = "centre"


class LinkMass(NamedTuple):
    """A mass on a link, computed for every variant.

    Attributes
    ----------
    link : str
    mass : callable
        [kg].
    inertia : callable or None
        Moment of inertia about its centre [kg·m²]; None if it is zero in every variant.
    along, across : callable
        Its centre in the link's axes [m].
    point : str or None
        Point of the scene that coincides with the centre in every variant, if any.
    at_origin : bool
        Whether the centre is the link's origin in every variant.
    """

    link: str
    mass: Compute
    inertia: Compute | None
    along: Compute
    across: Compute
    point: str | None
    at_origin: bool


def inertia_from_swing(scene: Scene, name: str, numbers: Mapping[str, Value]) -> Value:
    """Moment of inertia of a body with a swing, about its mass centre [kg·m²], for every variant.

    Only arithmetic is used, so that numbers may carry error estimates. Negative if the body swings faster than a point
    mass.
    """
    at, mass = f"bodies.{name}.swing", numbers[f"bodies.{name}.mass"]
    period, weight = numbers[f"{at}.period"], mass * numbers[f"{at}.gravity"]
    match scene.bodies[name].swing.type:
        case "compound":
            return compound_inertia(mass, weight, numbers[f"{at}.distance"], period)
        case "bifilar":
            return bifilar_inertia(weight, numbers[f"{at}.spacing"], numbers[f"{at}.length"], period)
        case _:
            return trifilar_inertia(weight, numbers[f"{at}.radius"], numbers[f"{at}.length"], period)


class Form(NamedTuple):
    """A kind of shape: keys of its sizes in the plane of motion, its area there, and its inertia from the mass.

    The volume of a rod is its length times its `area`; that of any other shape is its area times its `thickness`.
    """

    keys: tuple[str, ...]
    extent: Callable[..., Value]
    inertia: Callable[..., Value]
    depth: str = "thickness"


_FORMS = {
    "rod": Form(("length",), lambda length: length, rod_inertia, "area"),
    "disc": Form(("diameter",), lambda outer: math.pi / 4 * outer**2, disc_inertia),
    "ring": Form(("diameter", "inner_diameter"), lambda d, inner: math.pi / 4 * (d**2 - inner**2), ring_inertia),
    "plate": Form(("length", "width"), operator.mul, plate_inertia),
}


def body_mass(scene: Scene, name: str, numbers: Mapping[str, Value]) -> Value:
    """Mass of a body [kg], given or from density and shape, for every variant."""
    body = scene.bodies[name]
    if body.mass is not None:
        return numbers[f"bodies.{name}.mass"]
    form, at = _FORMS[body.shape.type], f"bodies.{name}.shape"
    volume = form.extent(*(numbers[f"{at}.{key}"] for key in form.keys)) * numbers[f"{at}.{form.depth}"]
    return numbers[f"bodies.{name}.density"] * volume


def carried_inertia(scene: Scene, link: str, numbers: Mapping[str, Value]) -> Value:
    """Inertia m r² of all masses moved by the hoists, vehicles and conveyors on a link [kg·m²], for every variant."""
    total = 0.0
    for name, load in carried_on(scene, link).items():
        radius = numbers[f"moments.{name}.{load.radius}"]
        total = total + sum(numbers[f"moments.{name}.{mass}"] for mass in load.masses) * radius**2
    return total


def carried_on(scene: Scene, link: str) -> dict[str, Carried]:
    """Hoists, vehicles and conveyors on a link, by name."""
    return {n: moment for n, moment in scene.moments.items() if isinstance(moment, Carried) and moment.on == link}


def body_inertia(scene: Scene, name: str, numbers: Mapping[str, Value]) -> Value:
    """Moment of inertia of a body about its mass centre [kg·m²], for every variant.

    0 if none is given; NaN if a swing is faster than that of a point mass.
    """
    body, at = scene.bodies[name], f"bodies.{name}.shape"
    if body.swing is not None:
        found = inertia_from_swing(scene, name, numbers)
        return np.where(found < 0.0, np.nan, found)
    if body.shape is None:
        return 0.0 if body.inertia is None else numbers[f"bodies.{name}.inertia"]
    form = _FORMS[body.shape.type]
    return form.inertia(body_mass(scene, name, numbers), *(numbers[f"{at}.{key}"] for key in form.keys))


def centre_along(scene: Scene, body: str, numbers: Mapping[str, Value]) -> Value:
    """Coordinate of a body's mass centre along its link: as given, else the middle of a rod, or the origin."""
    part = scene.bodies[body]
    if part.x is not None:
        return numbers[f"bodies.{body}.x"]
    if part.shape is not None and part.shape.type == "rod":
        return numbers[f"bodies.{body}.shape.length"] / 2
    return 0.0


def resultant_masses(scene: Scene, varied: frozenset[str]) -> dict[str, LinkMass]:
    """The masses of a scene, combined per link.

    A single mass of a link keeps its name: that of its body, or BODY__1, BODY__2 and so on of masses that replace one.
    Combined masses are named LINK__bodies. Names in a scene can't hold two underscores in a row. Mass, centre and
    moment of inertia follow from the sums and the parallel axis theorem.

    Parameters
    ----------
    scene : Scene
    varied : frozenset of str
        Paths of the varied numbers.
    """
    on_link: dict[str, dict[str, LinkMass]] = {}
    for name, body in scene.bodies.items():
        points = {f"{name}__{i + 1}": replacement_mass(scene, name, i) for i in range(count_points(scene, name))}
        on_link.setdefault(body.link, {}).update(points or {name: whole_body(scene, name, varied)})
    found = {}
    for link, own in on_link.items():
        found |= own if len(own) == 1 else {f"{link}__bodies": _joined(link, list(own.values()))}
    return found


def _joined(link: str, parts: list[LinkMass]) -> LinkMass:
    """Combine the masses of a link."""

    def mass(n: Numbers) -> float | np.ndarray:
        return sum(part.mass(n) for part in parts)

    def centre(n: Numbers, coordinate: Callable[[LinkMass], Compute]) -> float | np.ndarray:
        total, first = np.asarray(mass(n)), coordinate(parts[0])(n)
        moment = sum(part.mass(n) * (coordinate(part)(n) - first) for part in parts)
        # Massless bodies have no centre; any position will do.
        return first + np.divide(moment, total, out=np.zeros(np.broadcast(moment, total).shape), where=total != 0.0)

    def along(n: Numbers) -> float | np.ndarray:
        return centre(n, lambda part: part.along)

    def across(n: Numbers) -> float | np.ndarray:
        return centre(n, lambda part: part.across)

    def inertia(n: Numbers) -> float | np.ndarray:
        x, y = along(n), across(n)
        about_centre = sum(part.inertia(n) for part in parts if part.inertia is not None)
        return about_centre + sum(
            part.mass(n) * ((part.along(n) - x) ** 2 + (part.across(n) - y) ** 2) for part in parts
        )

    points = {part.point for part in parts}
    point = points.pop() if len(points) == 1 else None
    at_origin = all(part.at_origin for part in parts)
    together = at_origin or point is not None
    turns = not together or any(part.inertia is not None for part in parts)
    return LinkMass(link, mass, inertia if turns else None, along, across, point, at_origin)


def whole_body(scene: Scene, name: str, varied: frozenset[str]) -> LinkMass:
    """A body itself, also where point masses replace it.

    Parameters
    ----------
    scene : Scene
    name : str
    varied : frozenset of str
        Paths of the varied numbers.
    """
    body, at = scene.bodies[name], f"bodies.{name}"
    rod = body.shape is not None and body.shape.type == "rod"
    placed = body.x or body.y or (rod and body.x is None) or {f"{at}.x", f"{at}.y"} & varied
    found = body.shape is not None or body.swing is not None
    turns = found or body.inertia or f"{at}.inertia" in varied
    return LinkMass(
        body.link,
        lambda n: body_mass(scene, name, n),
        (lambda n: body_inertia(scene, name, n)) if turns else None,
        lambda n: centre_along(scene, name, n),
        lambda n: n[f"{at}.y"],
        None,
        not placed,
    )


def replacement_mass(scene: Scene, name: str, i: int) -> LinkMass:
    """Point mass number `i`, from 0, of those that replace the body `name`."""
    body = scene.bodies[name]
    chosen = body.replace.at[i] if i < len(body.replace.at) else CENTRE
    return LinkMass(
        body.link,
        lambda n: replacement(scene, name, n).masses[i],
        None,
        lambda n: centre_along(scene, name, n) + replacement(scene, name, n).points[i][0],
        lambda n: n[f"bodies.{name}.y"] + replacement(scene, name, n).points[i][1],
        None if chosen == CENTRE else chosen,
        False,
    )


def count_points(scene: Scene, body: str) -> int:
    """Number of point masses that replace a body, chosen and computed ones; 0 without replacement."""
    replace = scene.bodies[body].replace
    if replace is None:
        return 0
    return len(replace.at) + (replace.type == "dynamic" and len(replace.at) < 3)


def replacement(scene: Scene, name: str, numbers: Numbers) -> "laws.masses.replacement_masses.PointMasses":
    """Point masses that replace a body, for every variant.

    Parameters
    ----------
    scene : Scene
    name : str
        A body with `replace`.
    numbers : Numbers
    """
    body = scene.bodies[name]
    x, y = centre_along(scene, name, numbers), numbers[f"bodies.{name}.y"]
    places = places_on(scene, body.link)
    points: list[laws.masses.replacement_masses.Vector] = []
    for at in body.replace.at:
        along, across = places.get(at, (None, None))
        place = (_number(along, numbers) - x, _number(across, numbers) - y)
        points.append((0.0, 0.0) if at == CENTRE else place)
    mass, law = body_mass(scene, name, numbers), getattr(laws.masses.replacement_masses, _method(scene, name))
    if body.replace.type == "static":
        return law(mass, *points)
    inertia, first = body_inertia(scene, name, numbers), points[:1]
    chosen = [] if body.replace.mass is None else [numbers[f"bodies.{name}.replace.mass"]]
    return law(mass, inertia, *first, *chosen, *points[1:])


def _number(path: str | None, numbers: Numbers) -> float | np.ndarray:
    return 0.0 if path is None else numbers[path]


def _method(scene: Scene, name: str) -> str:
    replace = scene.bodies[name].replace
    names = {
        "static": ("static_two", "static_three"),
        "dynamic": ("dynamic_two", "dynamic_three", "dynamic_in_line", "dynamic_four"),
    }[replace.type]
    return names[len(replace.at) - (2 if replace.type == "static" else 1)]


def replacement_problems(scene: Scene) -> list[Problem]:
    """Bodies whose replacement names points of other links, or is impossible with the scene's numbers."""
    found: list[Problem] = []
    for name, body in scene.bodies.items():
        if body.replace is None:
            continue
        at, known = f"bodies.{name}.replace", {*places_on(scene, body.link), CENTRE}
        unknown = [place for place in body.replace.at if place not in known]
        if unknown:
            hint = did_you_mean(unknown[0], known)
            found.append((f"{at}.at", f"{unknown[0]!r} is not a point of link {body.link!r}; {hint}"))
            continue
        points = replacement(scene, name, Numbers(scene_numbers(scene), {}))
        chosen, named = len(body.replace.at), ", ".join(body.replace.at)
        same = laws.masses.replacement_masses.coincident(points.points[:chosen])
        if same is not None:
            i, j = (body.replace.at[k] for k in same)
            found.append((f"{at}.at", f"{i!r} and {j!r} coincide; name points that lie apart"))
        elif not points.possible:
            found.append((f"{at}.at", f"{named}: {laws.masses.replacement_masses.CONDITIONS[_method(scene, name)]}"))
    return found
