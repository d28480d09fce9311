"""What holds each moving link: its outer pair, its origin, and the points it carries by definition."""

from collections.abc import Callable, Iterator
from typing import NamedTuple

from engine.parts.skeleton import FRAME, CrankInput, Group, Hinged, Sliding, Yoke
from engine.scene.scene import Scene, once


class Attachment(NamedTuple):
    """A moving link and what holds it.

    Attributes
    ----------
    link : str
    path : str
        Where the link is named.
    pair : str
        Name of its outer pair; "" for shafts without a pivot, and for free links, whose pairs are in `free_pairs`.
    joint, guide : str or None
        Point or guide of its outer pair; of a free link, its guide.
    slot : str or None
        Link in whose slot it slides, for a block.
    origin : str or None
        Point at its origin.
    far : tuple of (str, str) or None
        Point on its x axis, and the path of the distance from the origin.
    """

    link: str
    path: str
    pair: str = ""
    joint: str | None = None
    guide: str | None = None
    slot: str | None = None
    origin: str | None = None
    far: tuple[str, str] | None = None


@once
def attachments(scene: Scene) -> tuple[Attachment, ...]:
    """All moving links in the order of their pairs; a link moved by two parts is listed twice."""
    return tuple(_attachments(scene))


@once
def attached(scene: Scene) -> dict[str, Attachment]:
    """The attachments by their links."""
    return {one.link: one for one in attachments(scene)}


def _attachments(scene: Scene) -> Iterator[Attachment]:
    drive = scene.input
    if isinstance(drive, CrankInput):
        far = None if drive.pin is None else (drive.pin, "input.length")
        yield _turning(drive.link, "input.link", "input", drive.pivot)._replace(far=far)
    else:
        yield Attachment(drive.link, "input.link", "input", guide=drive.guide, origin=drive.point)
    for name, shaft in scene.shafts.items():
        pair = "" if shaft.pivot is None else name
        yield _turning(name, f"shafts.{name}", pair, shaft.pivot)
    for name, second in scene.inputs.items():
        if second.type == "slider":
            yield Attachment(name, f"inputs.{name}", name, guide=second.guide)
        else:
            yield _turning(name, f"inputs.{name}", name, second.pivot)
    for name, group in scene.groups.items():
        yield from _of_group(name, group)
    for name, wheel in scene.noncircular_wheels.items():
        yield _turning(name, f"noncircular_wheels.{name}", name, wheel.pivot)
    for name, rack in scene.racks.items():
        yield Attachment(name, f"racks.{name}", name, guide=rack.guide)
    for name, pinion in scene.pinions.items():
        yield _turning(name, f"pinions.{name}", name, pinion.pivot)
    for name, link in scene.links.items():
        origin = link.joints[0] if link.joints else None
        far = (link.joints[1], f"links.{name}.length") if len(link.joints) == 2 else None
        yield Attachment(name, f"links.{name}", guide=link.guide, origin=origin, far=far)
    for name, cam in scene.cams.items():
        follower, path = cam.follower, f"cams.{name}.follower.link"
        if cam.translating:
            yield Attachment(follower.link, path, f"{name}.guide", guide=follower.guide)
        else:
            yield _turning(follower.link, path, f"{name}.pivot", follower.pivot)


def _turning(link: str, path: str, pair: str, pivot: str | None) -> Attachment:
    return Attachment(link, path, pair, joint=pivot, origin=pivot)


def _of_group(name: str, group: Group) -> Iterator[Attachment]:
    for side in ("first", "second"):
        part, pair = getattr(group, side), f"{name}.{side}"
        path = f"groups.{pair}.link"
        if isinstance(part, (Sliding, Yoke)):
            # A yoke's origin is on the axis of its slot, where it crosses the guide.
            origin = group.inner if isinstance(part, Sliding) else None
            yield Attachment(part.link, path, pair, guide=part.guide, origin=origin)
        else:
            found = _turning(part.link, path, pair, part.joint)
            if isinstance(part, Hinged):
                found = found._replace(far=(group.inner, f"groups.{pair}.length"))
            elif side == "first":
                found = found._replace(slot=group.second.link)
            yield found


def input_points(scene: Scene) -> dict[str, str]:
    """Point moved by the input link, with its path: the crank's pin, if it has one, or the sliding input's point."""
    key = "pin" if isinstance(scene.input, CrankInput) else "point"
    name = getattr(scene.input, key)
    return {} if name is None else {name: f"input.{key}"}


def inner_link(group: Group) -> str:
    """Link that carries the inner joint of a group: of the two that meet there, the sliding one, else the first."""
    return group.second.link if group.type == "RRP" else group.first.link


@once
def carriers(scene: Scene) -> dict[str, str]:
    """Link that takes a force on each point: of the two links of an inner joint the sliding one, else the first.

    A joint that only free links name belongs to the first of these.
    """
    found = dict.fromkeys(input_points(scene), scene.input.link)
    found |= {group.inner: inner_link(group) for group in scene.groups.values() if hasattr(group, "inner")}
    found |= {name: point.link for name, point in scene.points.items()}
    for name, link in scene.links.items():
        for joint in link.joints:
            found.setdefault(joint, name)
    return found


@once
def joint_owners(scene: Scene) -> dict[str, str]:
    """Link that carries each joint named by free links."""
    return {joint: carriers(scene)[joint] for link in scene.links.values() for joint in link.joints}


@once
def sliders(scene: Scene) -> tuple[str, ...]:
    """Links with a slide coordinate: on a guide, or, for a block, in the slot of the other link of its group."""
    place = {one.link: i for i, one in enumerate(attachments(scene))}
    sliding = [one for one in attachments(scene) if one.guide is not None or one.slot is not None]
    # A yoke comes before the block in its slot.
    return tuple(one.link for one in sorted(sliding, key=lambda one: (place[one.slot or one.link], one.slot or "")))


def guide_of(scene: Scene, link: str) -> str | None:
    """Guide on which a link slides; None for a turning link, and for a block in a slot."""
    return attached(scene)[link].guide if link in attached(scene) else None


def bearer_of(scene: Scene, slider: str) -> str:
    """Link that carries the guide or slot of a slider."""
    one = attached(scene)[slider]
    return one.slot or scene.guides[one.guide].link


def places_on(scene: Scene, link: str) -> dict[str, tuple[str | None, str | None]]:
    """Points of a link, with the paths of their coordinates in the link's axes; None for zero."""
    found: dict[str, tuple[str | None, str | None]] = {}
    one = attached(scene).get(link)
    if one is not None and one.origin is not None:
        found[one.origin] = (None, None)
    if one is not None and one.far is not None:
        found[one.far[0]] = (one.far[1], None)
    return found | {p: (f"points.{p}.x", f"points.{p}.y") for p, part in scene.points.items() if part.link == link}


@once
def still_links(scene: Scene) -> set[str]:
    """Links that never turn: the frame, and links that slide on guides or in slots of links that never turn."""
    return _grown({FRAME}, lambda still: {one.link for one in attachments(scene) if _bearer(scene, one) in still})


def _bearer(scene: Scene, one: Attachment) -> str | None:
    return one.slot if one.guide is None else scene.guides[one.guide].link


def crank_of(scene: Scene) -> set[str]:
    """The crank, if the input turns."""
    return {scene.input.link} if isinstance(scene.input, CrankInput) else set()


def geared_to_input(scene: Scene) -> set[str]:
    """Shafts geared to the input on the frame."""
    return {n for n, s in scene.shafts.items() if s.geared_to == scene.input.link and s.carrier is None}


def driven_by_gears(scene: Scene) -> set[str]:
    """Shafts geared to the input on the frame, also through other shafts."""
    return _grown(
        geared_to_input(scene),
        lambda found: {n for n, s in scene.shafts.items() if s.geared_to in found and s.carrier is None},
    )


@once
def turning_evenly(scene: Scene) -> set[str]:
    """Links whose angle is a multiple of the crank's: the crank, and pivoted shafts geared to it through all gears."""
    even = _grown(
        {FRAME, *crank_of(scene)},
        lambda known: {n for n, s in scene.shafts.items() if s.pivot and {s.geared_to, s.carrier or FRAME} <= known},
    )
    return even - {FRAME}


def _grown(known: set[str], attached_to: Callable[[set[str]], set[str]]) -> set[str]:
    """The known names, and all attached to them directly or through others."""
    while not (further := attached_to(known)) <= known:
        known = known | further
    return known
