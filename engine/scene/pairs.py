"""The lower pairs of a machine, each with the two links it connects."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

from engine.parts.pair_friction import PairFriction
from engine.parts.skeleton import FRAME
from engine.scene.attachments import attached, attachments, carriers
from engine.scene.scene import Problem, Scene, once

OF_JOURNALS = ("diameter", "contact", "above_prismatic")
OF_GUIDES = ("form", "vee_angle", "length")


class Pair(NamedTuple):
    """A lower pair: `GROUP.first`, `GROUP.inner`, `GROUP.second`, `LINK.JOINT`, `LINK.GUIDE`, `input`.

    Shafts, second inputs, non-circular wheels, racks and pinions have one pair each, of the same name. The pair of a
    cam's follower is `CAM.guide` or `CAM.pivot`.

    Attributes
    ----------
    name : str
    kind : {"revolute", "prismatic", "contact"}
    link : str
        Link on which its reaction acts.
    other : str
        Link that exerts the reaction.
    joint, guide : str
        Joint of a revolute pair, guide of a prismatic one; "" otherwise.
    """

    name: str
    kind: Literal["revolute", "prismatic", "contact"]
    link: str
    other: str
    joint: str = ""
    guide: str = ""

    @property
    def place(self) -> str:
        """Description: "joint A", "guide way", "the slot of rocker"."""
        if self.kind == "contact":
            return f"the contact of cam {self.name.partition('.')[0]}"
        if self.joint:
            return f"joint {self.joint}"
        return f"guide {self.guide}" if self.guide else f"the slot of {self.other}"

    def beyond(self, link: str) -> str:
        """The link on the other side."""
        return self.other if link == self.link else self.link


class RodPairs(NamedTuple):
    """A rod between two joints: the path of its length, and its pairs at its origin and at its other end."""

    length: str
    outer: tuple[Pair, ...]
    inner: tuple[Pair, ...]


def holder_of(scene: Scene, point: str) -> str:
    """Link that takes a force on a point; of the two links of an inner joint the sliding one, else the first."""
    return carriers(scene)[point]


def drive_base(scene: Scene, name: str) -> str:
    """Base of a second input's drive: the link that carries its pivot or guide."""
    return outer_pair(scene, name).other


def own_drives(scene: Scene) -> list[str]:
    """Second inputs with a separate drive."""
    return [name for name, second in scene.inputs.items() if second.drive == "own"]


@once
def lossy_meshes(scene: Scene) -> list[str]:
    """Shafts, non-circular wheels, racks and pinions with mesh losses."""
    driven = {**scene.shafts, **scene.noncircular_wheels, **scene.racks, **scene.pinions}
    return [name for name, part in driven.items() if part.efficiency is not None]


def mesh_driver(scene: Scene, name: str) -> str:
    """Driver of a shaft, non-circular wheel, rack or pinion; for a fixed rack, the link that carries it."""
    if name in scene.racks:
        return scene.racks[name].pinion
    if name in scene.pinions:
        pinion = scene.pinions[name]
        return pinion.rack or scene.guides[pinion.guide].link
    return {**scene.shafts, **scene.noncircular_wheels}[name].geared_to


def has_friction(scene: Scene) -> bool:
    """Whether a machine loses power to friction, in pairs or meshes."""
    return bool(scene.friction or lossy_meshes(scene))


def driving_field(scene: Scene, name: str) -> str:
    """Name of the field for the drive force or moment of a second input."""
    return f"{name}.driving_force" if scene.inputs[name].type == "slider" else f"{name}.driving_moment"


@once
def pairs(scene: Scene) -> list[Pair]:
    """All lower pairs of a scene: of inputs, shafts, groups, gears, free links and cam followers."""
    found: list[Pair] = []
    for one in attachments(scene):
        if one.pair:
            found.append(outer_pair(scene, one.link))
        elif one.link in scene.links:
            found += _pairs_of_free(scene, one.link)
        group = one.pair.removesuffix(".first")
        if group != one.pair and group in scene.groups:
            found.append(_inner_pair(scene, group))
    return found


def outer_pair(scene: Scene, link: str) -> Pair:
    """The pair that connects a link of a dyad or one with a single pair to what carries it."""
    one = attached(scene)[link]
    if one.guide is not None:
        return _on_guide(scene, one.pair, link, one.guide)
    pair, carrier = _joint(scene, one.pair, link, one.joint), getattr(scene.shafts.get(link), "carrier", None)
    # In a joint of two links, the carrier holds the shaft.
    return pair if carrier is None or pair.other == FRAME else pair._replace(other=carrier)


@once
def held_by_frame(scene: Scene) -> frozenset[str]:
    """Links connected to the frame by a pair."""
    return frozenset(pair.link for pair in pairs(scene) if pair.other == FRAME)


@once
def contact_pairs(scene: Scene) -> list[Pair]:
    """Contacts of cams with their followers, `CAM.contact`: higher pairs, which may have friction."""
    return [Pair(f"{name}.contact", "contact", cam.follower.link, cam.on) for name, cam in scene.cams.items()]


@once
def free_pairs(scene: Scene) -> list[Pair]:
    """The pairs of free links: `LINK.JOINT` for each joint that another link owns, and `LINK.GUIDE`."""
    return [pair for name in scene.links for pair in _pairs_of_free(scene, name)]


def _pairs_of_free(scene: Scene, name: str) -> Iterator[Pair]:
    link = scene.links[name]
    yield from (_joint(scene, f"{name}.{j}", name, j) for j in link.joints if carriers(scene)[j] != name)
    if link.guide is not None:
        yield _on_guide(scene, f"{name}.{link.guide}", name, link.guide)


def pairs_of_group(scene: Scene, name: str) -> tuple[Pair, Pair, Pair]:
    """First, inner and second pair of a group."""
    first, second = (outer_pair(scene, part.link) for part in (scene.groups[name].first, scene.groups[name].second))
    return first, _inner_pair(scene, name), second


def _inner_pair(scene: Scene, name: str) -> Pair:
    group = scene.groups[name]
    kind, joint = ("revolute", group.inner) if hasattr(group, "inner") else ("prismatic", "")
    return Pair(f"{name}.inner", kind, group.first.link, group.second.link, joint)


def _joint(scene: Scene, name: str, link: str, point: str) -> Pair:
    return Pair(name, "revolute", link, holder_of(scene, point), point)


def _on_guide(scene: Scene, name: str, link: str, guide: str) -> Pair:
    return Pair(name, "prismatic", link, scene.guides[guide].link, guide=guide)


def friction_problems(scene: Scene) -> Iterator[Problem]:
    """Friction of pairs that have one already, or whose teeth carry forces, and keys that don't fit the pair."""
    known = {pair.name: pair for pair in [*pairs(scene), *contact_pairs(scene)]}
    first: dict[str, str] = {}
    for name, friction in scene.friction.items():
        path, pair = f"friction.{name}", friction.pair
        if first.setdefault(pair, name) != name:
            yield f"{path}.pair", f"{pair!r} has its friction already in friction.{first[pair]}; keep one"
        if getattr(scene.shafts.get(pair), "pressure_angle", None) is not None:
            message = f"forces between the teeth of {pair!r} and friction in its pivot aren't computed together"
            yield f"{path}.pair", f"{message}: leave out one, or shafts.{pair}.pressure_angle"
        elif pair in {*scene.noncircular_wheels, *scene.racks, *scene.pinions}:
            yield f"{path}.pair", f"{pair!r} has forces between teeth: friction isn't computed there; leave it out"
        else:
            yield from _wrong_keys(scene, path, friction, known[pair])


@once
def rods_of(scene: Scene) -> dict[str, RodPairs]:
    """Rods by their links: those of dyads, from their outer to their inner joint, and free links with two joints."""
    rods = [one for one in attachments(scene) if one.far is not None and one.link != scene.input.link]
    pairs_in = {rod.link: [tuple(_pairs_in(scene, j, rod.link)) for j in (rod.origin, rod.far[0])] for rod in rods}
    return {rod.link: RodPairs(rod.far[1], *pairs_in[rod.link]) for rod in rods}


def _pairs_in(scene: Scene, joint: str, link: str) -> Iterator[Pair]:
    """Pairs of a link in one of its joints."""
    return (pair for pair in pairs(scene) if pair.joint == joint and link in (pair.link, pair.other))


def _wrong_keys(scene: Scene, path: str, friction: PairFriction, pair: Pair) -> Iterator[Problem]:
    """Keys that don't fit the kind of pair, and the diameter of a journal or a roller's pin where it is missing."""
    turns, what, lacks = pair.kind == "revolute", f"{pair.name!r}, which is {pair.kind}", ""
    own = OF_JOURNALS if turns else OF_GUIDES
    if turns:
        lacks = f"the friction moment in {pair.name!r} depends on its journal; give the diameter, such as '40 mm'"
    elif pair.kind == "contact":
        rolls = scene.cams[pair.name.partition(".")[0]].follower.contact == "roller"
        own, what = ("coefficient", "material", *(["diameter"] if rolls else [])), "the contact of a cam"
        lacks = "a roller rubs on its pin; give the pin's diameter, such as '8 mm'" if rolls else ""
    for key in (*OF_GUIDES, *OF_JOURNALS, *(["static_coefficient"] if pair.kind == "contact" else [])):
        if key not in own and getattr(friction, key) is not None:
            yield f"{path}.{key}", f"doesn't belong to {what}: leave it out; allowed: {', '.join(own)}"
    if lacks and friction.diameter is None:
        yield f"{path}.diameter", f"is missing: {lacks}"
