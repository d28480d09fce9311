"""Ordering of a mechanism into an input link and structural groups, or the reasons why that is impossible.

A mechanism is ordered if every group is attached to points and guides known before it; it then has as many degrees of
freedom as input links. Lower pairs only: W = 3n − 2p₁ (Chebyshev), and W = 0 for each group.
"""

from collections.abc import Container
from typing import NamedTuple

from engine.parts.driving_gears import Pinion, Rack
from engine.parts.skeleton import FRAME, Sliding, Yoke
from engine.scene import structure
from engine.scene.load_formulas import formula_problems
from engine.scene.masses import replacement_problems
from engine.scene.names import acting, definitions, guide_of, inner_link, input_point, joint_owners, misplaced, sliders
from engine.scene.pairs import friction_problems, pairs, strength_problems
from engine.scene.scene import Scene, SceneError, once
from engine.words.glossary import did_you_mean


class OrderedPart(NamedTuple):
    """A step of the ordering.

    Its `kind` is "input", "second input", "shaft", "noncircular wheel", "rack", "pinion", "cam", "group",
    "free group", "point" or "guide".
    """

    kind: str
    name: str


class Structure(NamedTuple):
    """An ordered mechanism.

    Attributes
    ----------
    elements : tuple of OrderedPart
        Each after all parts it is attached to.
    links : tuple of str
        All moving links except shafts without a pivot.
    sliders : tuple of str
        Links with a slide coordinate, on a guide or in a slot.
    free_groups : dict of str to FreeGroup
        Groups of free links, by name.
    """

    elements: tuple[OrderedPart, ...]
    links: tuple[str, ...]
    sliders: tuple[str, ...]
    free_groups: dict[str, "structure.free_groups.FreeGroup"]


def group_links(scene: Scene, name: str) -> tuple[str, str]:
    """Names of the two links of a group."""
    group = scene.groups[name]
    return group.first.link, group.second.link


def _outer(group: object) -> list[tuple[str, str]]:
    """(kind, name) of the points or guides of a group's two outer pairs."""
    parts = (group.first, group.second)
    return [("guide", p.guide) if isinstance(p, (Sliding, Yoke)) else ("point", p.joint) for p in parts]


class _Ordering(NamedTuple):
    """State of the ordering: elements in order, the link of each known point and guide, known links, free groups."""

    elements: list[OrderedPart]
    points: dict[str, str]
    guides: dict[str, str]
    links: set[str]
    free_groups: dict[str, "structure.free_groups.FreeGroup"]


def _in_mesh(
    scene: Scene, part: Rack | Pinion, links: Container[str], points: Container[str], guides: Container[str]
) -> bool:
    """Whether all parts that a rack or pinion is attached to are known."""
    driver = part.pinion if isinstance(part, Rack) else part.rack
    guide = part.guide or guide_of(scene, driver)
    held = part.pivot in points and (guide is None or guide in guides)
    riding = None if guide is None else structure.meshes.rides_along(scene, part.pivot, guide)
    return held and {driver, riding} - {None} <= set(links)


def _ordered(scene: Scene) -> _Ordering:
    elements = [OrderedPart("input", scene.input.link)]
    known_links = {FRAME, scene.input.link}
    points = {input_point(scene): scene.input.link}
    guides: dict[str, str] = {}
    free_groups: dict[str, structure.free_groups.FreeGroup] = {}
    owners = joint_owners(scene)
    grown = True
    while grown:
        grown = False
        for kind, table, known in (("point", scene.points, points), ("guide", scene.guides, guides)):
            for name, part in table.items():
                if name not in known and part.link in known_links:
                    known[name] = part.link
                    elements.append(OrderedPart(kind, name))
                    grown = True
        for name, shaft in scene.shafts.items():
            if (
                name not in known_links
                and {shaft.geared_to, shaft.carrier or FRAME} <= known_links
                and (shaft.pivot is None or shaft.pivot in points)
            ):
                known_links.add(name)
                elements.append(OrderedPart("shaft", name))
                grown = True
        for name, second in scene.inputs.items():
            held = second.guide in guides if second.type == "slider" else second.pivot in points
            if name not in known_links and held:
                known_links.add(name)
                elements.append(OrderedPart("second input", name))
                grown = True
        for name, wheel in scene.noncircular_wheels.items():
            if name not in known_links and wheel.geared_to in known_links and wheel.pivot in points:
                known_links.add(name)
                elements.append(OrderedPart("noncircular wheel", name))
                grown = True
        for kind, table in (("rack", scene.racks), ("pinion", scene.pinions)):
            for name, part in table.items():
                if name not in known_links and _in_mesh(scene, part, known_links, points, guides):
                    known_links.add(name)
                    elements.append(OrderedPart(kind, name))
                    grown = True
        for name, cam in scene.cams.items():
            held = cam.follower.guide in guides if cam.translating else cam.follower.pivot in points
            if cam.follower.link not in known_links and cam.on in known_links and held:
                known_links.add(cam.follower.link)
                elements.append(OrderedPart("cam", name))
                grown = True
        for name, group in scene.groups.items():
            if OrderedPart("group", name) in elements:
                continue
            if all(ref in (points if kind == "point" else guides) for kind, ref in _outer(group)):
                elements.append(OrderedPart("group", name))
                known_links.update(group_links(scene, name))
                if hasattr(group, "inner"):
                    points[group.inner] = inner_link(group)
                grown = True
        found = None if grown or not scene.links else structure.free_matching.next_free_group(scene, known_links)
        if found is not None:
            free_groups[found.name] = found
            elements.append(OrderedPart("free group", found.name))
            known_links.update(found.links)
            points |= {j: link for j, link in owners.items() if link in found.links and j not in scene.points}
            grown = True
    return _Ordering(elements, points, guides, known_links, free_groups)


def _check_movable(scene: Scene, points: dict[str, str], guides: dict[str, str]) -> list[tuple[str, str]]:
    """Groups attached to the frame only: a rigid truss, or parts that never move."""
    problems = []
    for name, group in scene.groups.items():
        carriers = {(points if kind == "point" else guides)[ref] for kind, ref in _outer(group)}
        if carriers == {FRAME}:
            n = len(group_links(scene, name))
            problems.append(
                (
                    f"groups.{name}",
                    f"over-constrained: both outer pairs are on the frame, so its {n} links can't move "
                    f"(W = 3·{n} − 2·3 = 0); hang one of them on a moving link",
                )
            )
    return problems


def _sliding_loops(scene: Scene, ordering: _Ordering) -> list[tuple[str, str]]:
    """Groups of free links with a loop of sliding pairs only.

    Links connected by a sliding pair keep their relative direction. Around such a loop one of these conditions is
    redundant, so the pairs impose fewer constraints than they count.
    """
    side: dict[str, str] = {}

    def root(link: str) -> str:
        while link in side:
            link = side[link]
        return link

    in_groups = {pair.name: name for name, group in ordering.free_groups.items() for pair in group.pairs}
    problems = []
    sliding = [pair for pair in pairs(scene) if pair.kind == "prismatic"]
    for pair in sorted(sliding, key=lambda pair: pair.name in in_groups):
        one, other = root(pair.link), root(pair.other)
        if one != other:
            side[one] = other
        elif pair.name in in_groups:
            links = ", ".join(ordering.free_groups[in_groups[pair.name]].links)
            words = (
                f"{links} have a loop of sliding pairs alone, which {pair.name} closes: its links can't turn against "
            )
            words += "each other, so its pairs hold less than W = 0 counts; replace one of these pairs by a joint"
            problems.append((f"links.{pair.link}.guide", words))
    return problems


def _free_problems(scene: Scene, ordering: _Ordering) -> list[tuple[str, str]]:
    """Groups of free links that can't move, names already taken, and points in `near` that are not on free links."""
    problems, moving = [], {link for group in ordering.free_groups.values() for link in group.links}
    for name, group in ordering.free_groups.items():
        outer = {link for pair in group.pairs for link in (pair.link, pair.other)} - set(group.links)
        at, n, p = f"links.{group.links[0]}", len(group.links), len(group.pairs)
        if outer == {FRAME}:
            words = f"{', '.join(group.links)} hang on the frame alone, so they can't move (W = 3·{n} − 2·{p} = 0)"
            problems.append((at, f"over-constrained: {words}; hang one of them on a moving link"))
        if name in {*scene.groups, *scene.links, *scene.points, *scene.regimes, *scene.cams}:
            problems.append((at, f"the name {name!r} is that of the group found here; call what has it otherwise"))
    on_links = {point for point, link in ordering.points.items() if link in moving}
    for point in scene.near:
        if point not in on_links:
            message = "is not a point of a free link, whose position would distinguish modes; " + did_you_mean(
                point, on_links
            )
            problems.append((f"near.{point}", message))
    return problems


def _why_unordered(scene: Scene, elements: list[OrderedPart], points: dict, guides: dict) -> list[tuple[str, str]]:
    """Reasons why some groups, points or guides could not be reached."""
    problems = []
    shafts = [name for name in scene.shafts if OrderedPart("shaft", name) not in elements]
    if shafts:
        chain = ", ".join(f"{name!r} on {scene.shafts[name].geared_to!r}" for name in shafts)
        problems.append(
            (f"shafts.{shafts[0]}.geared_to", f"gears that nothing drives: {chain}; gear one to a link that moves")
        )
    wheels = [name for name in scene.noncircular_wheels if OrderedPart("noncircular wheel", name) not in elements]
    if wheels:
        message = "a wheel that nothing drives; gear it to the crank, to a shaft with a pivot, or to such a wheel"
        problems.append((f"noncircular_wheels.{wheels[0]}.geared_to", message))
    for kind, table in (("rack", scene.racks), ("pinion", scene.pinions)):
        found = [name for name in table if OrderedPart(kind, name) not in elements]
        if found:
            message = f"a {kind} that nothing drives, or whose axis or guide nothing holds; hang it on what moves"
            problems.append((f"{kind}s.{found[0]}", message))
    unheld = [name for name in scene.inputs if OrderedPart("second input", name) not in elements]
    if unheld:
        second = scene.inputs[unheld[0]]
        key, held = ("guide", second.guide) if second.type == "slider" else ("pivot", second.pivot)
        message = f"{held!r} hangs on what this input would drive, or on nothing that moves; name one known before it"
        problems.append((f"inputs.{unheld[0]}.{key}", message))
    cams = [name for name in scene.cams if OrderedPart("cam", name) not in elements]
    if cams:
        message = "a cam that nothing turns, or whose follower nothing holds; put it on the crank or a shaft"
        problems.append((f"cams.{cams[0]}.on", message))
    waiting = [name for name in scene.groups if OrderedPart("group", name) not in elements]
    if waiting:
        lacks = {
            name: [
                ref for kind, ref in _outer(scene.groups[name]) if ref not in (points if kind == "point" else guides)
            ]
            for name in waiting
        }
        listed = "; ".join(f"{name} waits for {' and '.join(refs)}" for name, refs in lacks.items())
        n, p = 2 * len(waiting), 3 * len(waiting)
        problems.append(
            (
                f"groups.{waiting[0]}",
                f"can't be ordered: {listed}. These {len(waiting)} groups ({n} links, {p} pairs) hang on each other: "
                "a structural group of class III or higher, which is given by free links, [links], or a chain that "
                "nothing connects to the input. Hang one of them on points that are known before it",
            )
        )
    return problems


@once
def order(scene: Scene) -> Structure:
    """Order a scene into its input link and structural groups, in whatever order they are written.

    Raises
    ------
    SceneError
        No input, unknown or repeated names, links moved by two groups (over-constrained), dyads attached to each other
        or to the frame only, free links that can't move or move too freely, and actions on parts that can't carry them.
    """
    if scene.input is None:
        raise SceneError([("input", "is missing: a mechanism begins at it, and this scene has only machine elements")])
    points, guides, links = definitions(scene)
    kinds = {"point": points, "guide": guides, "link": links, "action": acting(scene)}
    problems = [
        (
            path,
            f"{name!r} is not {'an' if kind == 'action' else 'a'} {kind} of this scene; "
            + did_you_mean(name, kinds[kind]),
        )
        for path, kind, name in scene.references()
        if name not in kinds[kind]
    ]
    if problems:
        raise SceneError(problems)
    ordering = _ordered(scene)
    problems = _why_unordered(scene, ordering.elements, ordering.points, ordering.guides)
    if scene.links:
        problems += structure.free_matching.why_not_grouped(scene, ordering.links)
    if not problems:
        problems = _check_movable(scene, ordering.points, ordering.guides) + misplaced(scene)
        problems += _free_problems(scene, ordering) + _sliding_loops(scene, ordering)
        if scene.shafts:
            problems = problems or structure.trains.train_problems(scene)
        if scene.noncircular_wheels or scene.racks or scene.pinions:
            problems = problems or structure.meshes.mesh_problems(scene)
    if not problems:
        problems = [*replacement_problems(scene), *friction_problems(scene), *strength_problems(scene)]
        problems += formula_problems(scene)
    if problems:
        raise SceneError(problems)
    return Structure(tuple(ordering.elements), _moving_links(scene), sliders(scene), ordering.free_groups)


def _moving_links(scene: Scene) -> tuple[str, ...]:
    pivoted = [name for name, shaft in scene.shafts.items() if shaft.pivot is not None]
    in_groups = (link for name in scene.groups for link in group_links(scene, name))
    geared = (*scene.noncircular_wheels, *scene.racks, *scene.pinions)
    followers = (cam.follower.link for cam in scene.cams.values())
    return (scene.input.link, *scene.inputs, *pivoted, *in_groups, *scene.links, *geared, *followers)
