"""The names in a scene: what each denotes, and what may refer to what."""

from collections.abc import Callable, Collection, Iterator, Mapping
from typing import NamedTuple

from engine.parts.skeleton import FRAME
from engine.scene.attachments import (
    attachments,
    crank_of,
    driven_by_gears,
    geared_to_input,
    input_points,
    sliders,
    still_links,
)
from engine.scene.pairs import contact_pairs, pairs, rods_of
from engine.scene.scene import Problem, Scene, SceneError, once
from engine.words.glossary import listed

# Tables whose names nothing else may have.
_TABLES = ("cams", "forces", "moments", "springs", "cylinders", "couplings", "pins", "struts", "wanted", "elements")


@once
def definitions(scene: Scene) -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Path at which each point, guide and link is defined.

    Raises
    ------
    SceneError
        A name is defined twice, or a link is moved by two groups (over-constrained).
    """
    problems: list[Problem] = []
    points: dict[str, str] = {}
    guides: dict[str, str] = {}
    links: dict[str, str] = {FRAME: FRAME}
    everything: dict[str, str] = {FRAME: "the frame"}
    named = [(links, one.link, one.path) for one in attachments(scene)]
    named += [(points, name, path) for name, path in input_points(scene).items()]
    named += [(points, g.inner, f"groups.{name}.inner") for name, g in scene.groups.items() if hasattr(g, "inner")]
    named += [(points, name, f"points.{name}") for name in scene.points]
    defined = {name for kind, name, _ in named if kind is points}
    for name, link in scene.links.items():
        named += [(points, joint, f"links.{name}.joints") for joint in link.joints if joint not in defined]
        defined |= set(link.joints)
    named += [(guides, name, f"guides.{name}") for name in scene.guides]
    named += [({}, name, f"{table}.{name}") for table in _TABLES for name in getattr(scene, table)]
    for kind, name, path in named:
        if kind is links and name in links and name != FRAME:
            words = f"link {name!r} is already moved by {links[name]}: over-constrained (W < 1); "
            problems.append((path, words + "a link belongs to one group"))
        elif name in everything:
            problems.append((path, f"the name {name!r} is already taken by {everything[name]}; choose another"))
        kind.setdefault(name, path)
        everything.setdefault(name, path)
    if problems:
        raise SceneError(problems)
    return points, guides, links


def acting(scene: Scene) -> set[str]:
    """Names of all actions on the machine, which a regime may switch off."""
    return {"gravity", *scene.forces, *scene.moments, *scene.springs, *scene.cylinders, *scene.couplings}


class Referable(NamedTuple):
    """What a reference may name: the message for a wrong name, the allowed names, and a heading for their list."""

    wrong: str
    names: Callable[[Scene], Collection[str]]
    heading: str = "known are"
    sample: str = ""


def _on_frame(scene: Scene) -> set[str]:
    return {name for name, point in scene.points.items() if point.link == FRAME}


def _without_pivot(scene: Scene) -> set[str]:
    return {name for name, shaft in scene.shafts.items() if shaft.pivot is None}


def _links(scene: Scene) -> set[str]:
    return set(definitions(scene)[2])


# Kinds of `Refers`; those of the first table are known before the machine is ordered.
DEFINED = {
    "point": Referable(
        "is not a point of this scene", lambda scene: definitions(scene)[0], sample='x = "0 mm", y = "0 mm"'
    ),
    "guide": Referable("is not a guide of this scene", lambda scene: definitions(scene)[1], sample='angle = "0 deg"'),
    "link": Referable("is not a link of this scene", _links),
    "action": Referable("is not an action of this scene", acting),
}
FITTING = {
    "point of the frame": Referable("is not on the frame", _on_frame),
    "moving point": Referable("is at rest on the frame", lambda scene: definitions(scene)[0].keys() - _on_frame(scene)),
    "point of one link": Referable(
        "is a joint of two links, but a drive must be mounted on one",
        lambda scene: {*input_points(scene), *scene.points},
    ),
    "guide of the frame": Referable(
        "is on a moving link, and must be on the frame",
        lambda scene: {name for name, guide in scene.guides.items() if guide.link == FRAME},
    ),
    "moving link": Referable("doesn't move; name a moving link", lambda scene: _links(scene) - {FRAME}),
    "link with axes": Referable(
        "has no pivot; give it one, or use its inertia",
        lambda scene: _links(scene) - _without_pivot(scene),
    ),
    "turning link": Referable(
        "doesn't turn, and a moment on it does no work", lambda scene: _links(scene) - still_links(scene)
    ),
    "link with an angle": Referable(
        "has no pivot and so no angle; give it one", lambda scene: _links(scene) - _without_pivot(scene)
    ),
    "slider": Referable("doesn't slide", sliders, "sliders are"),
    "geared shaft": Referable("is not a shaft geared to the crank", geared_to_input),
    "driven shaft": Referable(
        "can't have one: a motor drives the crank or a shaft geared to it",
        lambda scene: crank_of(scene) | driven_by_gears(scene),
        "allowed",
    ),
    "crank or shaft": Referable(
        "is neither the crank nor a shaft", lambda scene: {*crank_of(scene), *scene.shafts}, "allowed"
    ),
    "cam shaft": Referable(
        "can't have one: a cam sits on the crank or on a shaft with a pivot that is geared to it",
        lambda scene: crank_of(scene) | geared_to_input(scene) - _without_pivot(scene),
        "allowed",
    ),
    "pair": Referable(
        "is not a pair of this scene", lambda scene: [p.name for p in [*pairs(scene), *contact_pairs(scene)]]
    ),
    "revolute pair": Referable(
        "is not a revolute pair of this scene", lambda scene: [p.name for p in pairs(scene) if p.kind == "revolute"]
    ),
    "rod": Referable("is not a rod between two joints", rods_of),
}


def wrong_reference(scene: Scene, path: str, kind: str, name: str) -> Iterator[Problem]:
    """The problem of a reference to something of the wrong kind, if any."""
    what = (DEFINED | FITTING)[kind]
    known = what.names(scene)
    if name not in known:
        others = listed(name, sorted(known), what.heading)
        if what.sample and not known:
            others = f"there are none; add [{kind}s.{name}] with {what.sample}"
        yield path, f"{name!r} {what.wrong}; {others}"


def wrong_references(scene: Scene, kinds: Mapping[str, Referable]) -> list[Problem]:
    """References to something of the wrong kind, among some kinds."""
    asked = [reference for reference in scene.references() if reference[1] in kinds]
    known = {kind: kinds[kind].names(scene) for kind in {kind for _, kind, _ in asked}}
    wrong = (reference for reference in asked if reference[2] not in known[reference[1]])
    return [problem for reference in wrong for problem in wrong_reference(scene, *reference)]
