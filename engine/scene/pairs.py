"""The lower pairs of a machine, each with the two links it connects."""

from collections.abc import Iterator
from typing import Literal, NamedTuple

from engine.parts.pair_friction import PairFriction
from engine.parts.skeleton import FRAME, CrankInput, Hinged, Sliding, Yoke
from engine.scene.names import Problem, guide_of, inner_link, joint_owners
from engine.scene.scene import Scene, once
from engine.words.glossary import did_you_mean

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
    if point in scene.points:
        return scene.points[point].link
    for group in scene.groups.values():
        if getattr(group, "inner", None) == point:
            return inner_link(group)
    return joint_owners(scene).get(point, scene.input.link)


def bearer_of(scene: Scene, slider: str) -> str:
    """Link that carries the guide or slot of a slider."""
    if slider in {**scene.links, **scene.racks, **scene.inputs}:
        return scene.guides[guide_of(scene, slider)].link
    for group in scene.groups.values():
        for part in (group.first, group.second):
            if part.link == slider:
                return scene.guides[part.guide].link if isinstance(part, (Sliding, Yoke)) else group.second.link
    return FRAME


def drive_base(scene: Scene, name: str) -> str:
    """Base of a second input's drive: the link that carries its pivot or guide."""
    second = scene.inputs[name]
    return scene.guides[second.guide].link if second.type == "slider" else holder_of(scene, second.pivot)


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
    drive = scene.input
    if isinstance(drive, CrankInput):
        found = [_joint(scene, "input", drive.link, drive.pivot)]
    else:
        found = [_on_guide(scene, "input", drive.link, drive.guide)]
    found += [_pivot_of_shaft(scene, name, s.pivot) for name, s in scene.shafts.items() if s.pivot is not None]
    found += [
        _on_guide(scene, name, name, second.guide)
        if second.type == "slider"
        else _joint(scene, name, name, second.pivot)
        for name, second in scene.inputs.items()
    ]
    for name in scene.groups:
        found += pairs_of_group(scene, name)
    found += [_joint(scene, name, name, wheel.pivot) for name, wheel in scene.noncircular_wheels.items()]
    found += [_on_guide(scene, name, name, rack.guide) for name, rack in scene.racks.items()]
    found += [_joint(scene, name, name, pinion.pivot) for name, pinion in scene.pinions.items()]
    return [*found, *free_pairs(scene), *(follower_pair(scene, name) for name in scene.cams)]


@once
def held_by_frame(scene: Scene) -> frozenset[str]:
    """Links connected to the frame by a pair."""
    return frozenset(pair.link for pair in pairs(scene) if pair.other == FRAME)


def follower_pair(scene: Scene, cam: str) -> Pair:
    """The pair that connects a cam's follower to the frame."""
    follower = scene.cams[cam].follower
    if follower.type == "translating":
        return _on_guide(scene, f"{cam}.guide", follower.link, follower.guide)
    return _joint(scene, f"{cam}.pivot", follower.link, follower.pivot)


@once
def contact_pairs(scene: Scene) -> list[Pair]:
    """Contacts of cams with their followers, `CAM.contact`: higher pairs, which may have friction."""
    return [Pair(f"{name}.contact", "contact", cam.follower.link, cam.on) for name, cam in scene.cams.items()]


@once
def free_pairs(scene: Scene) -> list[Pair]:
    """The pairs of free links: `LINK.JOINT` for each joint that another link owns, and `LINK.GUIDE`."""
    owners, found = joint_owners(scene), []
    for name, link in scene.links.items():
        found += [_joint(scene, f"{name}.{j}", name, j) for j in link.joints if owners[j] != name]
        if link.guide is not None:
            found.append(_on_guide(scene, f"{name}.{link.guide}", name, link.guide))
    return found


def pairs_of_group(scene: Scene, name: str) -> tuple[Pair, Pair, Pair]:
    """First, inner and second pair of a group."""
    group = scene.groups[name]
    one, two = group.first, group.second
    first, second = (
        _on_guide(scene, f"{name}.{side}", part.link, part.guide)
        if isinstance(part, (Sliding, Yoke))
        else _joint(scene, f"{name}.{side}", part.link, part.joint)
        for side, part in (("first", one), ("second", two))
    )
    if hasattr(group, "inner"):
        inner = Pair(f"{name}.inner", "revolute", one.link, two.link, group.inner)
    else:
        inner = Pair(f"{name}.inner", "prismatic", one.link, two.link)
    return first, inner, second


def _joint(scene: Scene, name: str, link: str, point: str) -> Pair:
    return Pair(name, "revolute", link, holder_of(scene, point), point)


def _pivot_of_shaft(scene: Scene, name: str, point: str) -> Pair:
    """The pivot pair of a shaft; in a joint of two links, the carrier holds the shaft."""
    pair, carrier = _joint(scene, name, name, point), scene.shafts[name].carrier
    return pair if carrier is None or pair.other == FRAME else pair._replace(other=carrier)


def _on_guide(scene: Scene, name: str, link: str, guide: str) -> Pair:
    return Pair(name, "prismatic", link, scene.guides[guide].link, guide=guide)


def friction_problems(scene: Scene) -> list[Problem]:
    """Friction of unknown pairs, or of pairs that already have one, and keys that don't fit the kind of pair."""
    known = {pair.name: pair for pair in [*pairs(scene), *contact_pairs(scene)]}
    problems: list[Problem] = []
    first: dict[str, str] = {}
    for name, friction in scene.friction.items():
        path = f"friction.{name}"
        if friction.pair not in known:
            message = f"{friction.pair!r} is not a pair of this scene; " + did_you_mean(friction.pair, known)
            problems.append((f"{path}.pair", message))
            continue
        if friction.pair in first:
            message = f"{friction.pair!r} has its friction already in friction.{first[friction.pair]}; keep one"
            problems.append((f"{path}.pair", message))
        if getattr(scene.shafts.get(friction.pair), "pressure_angle", None) is not None:
            message = (
                f"forces between the teeth of {friction.pair!r} and friction in its pivot aren't computed together"
            )
            problems.append((f"{path}.pair", f"{message}: leave out one, or shafts.{friction.pair}.pressure_angle"))
            continue
        if friction.pair in {*scene.noncircular_wheels, *scene.racks, *scene.pinions}:
            message = f"{friction.pair!r} has forces between teeth: friction isn't computed there; leave it out"
            problems.append((f"{path}.pair", message))
            continue
        first.setdefault(friction.pair, name)
        if known[friction.pair].kind == "contact":
            rolls = scene.cams[friction.pair.partition(".")[0]].follower.contact == "roller"
            problems += _wrong_at_cam(path, friction, rolls)
        else:
            problems += _wrong_keys(path, friction, known[friction.pair])
    return problems


def strength_problems(scene: Scene) -> Iterator[Problem]:
    """Pins of unknown or non-revolute pairs, and struts that are not rods between two joints."""
    turning = [pair.name for pair in pairs(scene) if pair.kind == "revolute"]
    for name, pin in scene.pins.items():
        if pin.pair not in turning:
            message = f"{pin.pair!r} is not a revolute pair of this scene; {did_you_mean(pin.pair, turning)}"
            yield f"pins.{name}.pair", message
    rods = rods_of(scene)
    for name, strut in scene.struts.items():
        if strut.link not in rods:
            message = f"{strut.link!r} is not a rod between two joints; {did_you_mean(strut.link, rods)}"
            yield f"struts.{name}.link", message


@once
def rods_of(scene: Scene) -> dict[str, RodPairs]:
    """Rods by their links: those of dyads, from their outer to their inner joint, and free links with two joints."""
    found = {
        part.link: (f"groups.{name}.{side}", (part.joint, group.inner))
        for name, group in scene.groups.items()
        for side, part in (("first", group.first), ("second", group.second))
        if isinstance(part, Hinged)
    }
    found |= {name: (f"links.{name}", link.joints) for name, link in scene.links.items() if len(link.joints) == 2}
    return {
        link: RodPairs(f"{path}.length", *(tuple(_pairs_in(scene, joint, link)) for joint in joints))
        for link, (path, joints) in found.items()
    }


def _pairs_in(scene: Scene, joint: str, link: str) -> Iterator[Pair]:
    """Pairs of a link in one of its joints."""
    return (pair for pair in pairs(scene) if pair.joint == joint and link in (pair.link, pair.other))


def _wrong_at_cam(path: str, friction: PairFriction, rolls: bool) -> Iterator[Problem]:
    """Keys that don't fit the contact of a cam; a roller has friction at its pin."""
    own = ("coefficient", "material", "diameter") if rolls else ("coefficient", "material")
    for key in (*OF_GUIDES, *OF_JOURNALS, "static_coefficient"):
        if key not in own and getattr(friction, key) is not None:
            yield f"{path}.{key}", f"doesn't belong to the contact of a cam: leave it out; allowed: {', '.join(own)}"
    if rolls and friction.diameter is None:
        yield f"{path}.diameter", "is missing: a roller rubs on its pin; give the pin's diameter, such as '8 mm'"


def _wrong_keys(path: str, friction: PairFriction, pair: Pair) -> Iterator[Problem]:
    turns = pair.kind == "revolute"
    own = OF_JOURNALS if turns else OF_GUIDES
    for key in OF_GUIDES if turns else OF_JOURNALS:
        if getattr(friction, key) is not None:
            message = f"doesn't belong to {pair.name!r}, which is {pair.kind}: leave it out; allowed: {', '.join(own)}"
            yield f"{path}.{key}", message
    if turns and friction.diameter is None:
        yield f"{path}.diameter", f"is missing: the moment in {pair.name!r} depends on its journal, such as '40 mm'"
