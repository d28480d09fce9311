"""Ordering of a mechanism into an input link and structural groups, or the reasons why that is impossible.

A mechanism is ordered if every group is attached to points and guides known before it; it then has as many degrees of
freedom as input links. Lower pairs only: W = 3n − 2p₁ (Chebyshev), and W = 0 for each group.
"""

from collections.abc import Iterator
from typing import NamedTuple

from engine.parts.higher_pairs import Pinion, Rack
from engine.parts.skeleton import FRAME
from engine.scene import structure
from engine.scene.attachments import (
    Attachment,
    attached,
    attachments,
    carriers,
    guide_of,
    input_points,
    joint_owners,
    sliders,
)
from engine.scene.load_formulas import formula_problems
from engine.scene.masses import replacement_problems
from engine.scene.misplaced import misplaced
from engine.scene.names import DEFINED, FITTING, wrong_references
from engine.scene.pairs import friction_problems, pairs
from engine.scene.scene import Problem, Scene, SceneError, once
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


class _Step(NamedTuple):
    """A part to be ordered: its kind and name, its path in the scene, its needs, and what is known after it.

    Things needed and known are ("point" | "guide" | "link", name).
    """

    kind: str
    name: str
    path: str
    needs: set[tuple[str, str]]
    gives: set[tuple[str, str]]


def _outer(one: Attachment) -> tuple[str, str]:
    return ("point", one.joint) if one.guide is None else ("guide", one.guide)


def _steps(scene: Scene) -> Iterator[_Step]:
    """All parts but groups of free links, in order of preference where several could come next."""
    for kind, table in (("point", scene.points), ("guide", scene.guides)):
        for name, part in table.items():
            yield _Step(kind, name, f"{kind}s.{name}", {("link", part.link)}, {(kind, name)})
    for name, shaft in scene.shafts.items():
        needs = {("link", shaft.geared_to), ("link", shaft.carrier or FRAME)}
        needs |= {("point", shaft.pivot)} if shaft.pivot is not None else set()
        yield _Step("shaft", name, f"shafts.{name}.geared_to", needs, {("link", name)})
    for name, second in scene.inputs.items():
        path = f"inputs.{name}.{'guide' if second.type == 'slider' else 'pivot'}"
        yield _Step("second input", name, path, {_outer(attached(scene)[name])}, {("link", name)})
    for name, wheel in scene.noncircular_wheels.items():
        needs = {("link", wheel.geared_to), ("point", wheel.pivot)}
        yield _Step("noncircular wheel", name, f"noncircular_wheels.{name}.geared_to", needs, {("link", name)})
    for kind, table in (("rack", scene.racks), ("pinion", scene.pinions)):
        for name, part in table.items():
            yield _Step(kind, name, f"{kind}s.{name}", _needs_of_mesh(scene, part), {("link", name)})
    for name, cam in scene.cams.items():
        needs = {("link", cam.on), _outer(attached(scene)[cam.follower.link])}
        yield _Step("cam", name, f"cams.{name}.on", needs, {("link", cam.follower.link)})
    for name, group in scene.groups.items():
        links = group_links(scene, name)
        known = {("link", link) for link in links} | ({("point", group.inner)} if hasattr(group, "inner") else set())
        yield _Step("group", name, f"groups.{name}", {_outer(attached(scene)[link]) for link in links}, known)


def _needs_of_mesh(scene: Scene, part: Rack | Pinion) -> set[tuple[str, str]]:
    """Parts to which a rack or pinion is attached."""
    driver = part.pinion if isinstance(part, Rack) else part.rack
    guide = part.guide or guide_of(scene, driver)
    riding = None if guide is None else structure.meshes.rides_along(scene, part.pivot, guide)
    needs = {("point", part.pivot)} | ({("guide", guide)} if guide is not None else set())
    return needs | {("link", link) for link in (driver, riding) if link is not None}


class _Ordering(NamedTuple):
    """Parts in order, what is known after them, groups of free links, and the steps that could not be taken."""

    elements: list[OrderedPart]
    known: set[tuple[str, str]]
    free_groups: dict[str, "structure.free_groups.FreeGroup"]
    waiting: list[_Step]

    @property
    def links(self) -> set[str]:
        """Links known."""
        return {name for kind, name in self.known if kind == "link"}


@once
def _ordered(scene: Scene) -> _Ordering:
    known = {("link", FRAME), ("link", scene.input.link), *(("point", name) for name in input_points(scene))}
    found = _Ordering([OrderedPart("input", scene.input.link)], known, {}, list(_steps(scene)))
    while True:
        before = len(found.elements)
        for step in list(found.waiting):
            if step.needs <= known:
                found.elements.append(OrderedPart(step.kind, step.name))
                found.waiting.remove(step)
                known |= step.gives
        if len(found.elements) > before:
            continue
        group = structure.free_matching.next_free_group(scene, found.links) if scene.links else None
        if group is None:
            return found
        found.free_groups[group.name] = group
        found.elements.append(OrderedPart("free group", group.name))
        known |= {("link", link) for link in group.links}
        owned = {j for j, link in joint_owners(scene).items() if link in group.links and j not in scene.points}
        known |= {("point", joint) for joint in owned}


def _immovable(scene: Scene) -> Iterator[Problem]:
    """Groups attached to the frame only: a rigid truss, or parts that never move."""
    for name in scene.groups:
        outer = [_outer(attached(scene)[link]) for link in group_links(scene, name)]
        if {carriers(scene)[ref] if kind == "point" else scene.guides[ref].link for kind, ref in outer} == {FRAME}:
            words = "both outer pairs are on the frame, so its 2 links can't move (W = 3·2 − 2·3 = 0)"
            yield f"groups.{name}", f"over-constrained: {words}; attach one of them to a moving link"


def _sliding_loops(scene: Scene, ordering: _Ordering) -> list[Problem]:
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
                f"{links} form a loop of sliding pairs only, closed by {pair.name}: its links can't turn relative to "
            )
            words += "each other, so its pairs constrain less than W = 0 says; replace one of these pairs by a joint"
            problems.append((f"links.{pair.link}.guide", words))
    return problems


def _free_problems(scene: Scene, ordering: _Ordering) -> Iterator[Problem]:
    """Groups of free links that can't move, names already taken, and points in `near` that are not on free links."""
    for name, group in ordering.free_groups.items():
        outer = {link for pair in group.pairs for link in (pair.link, pair.other)} - set(group.links)
        at, n, p = f"links.{group.links[0]}", len(group.links), len(group.pairs)
        if outer == {FRAME}:
            words = f"{', '.join(group.links)} are joined to the frame only, so they can't move (W = 3·{n} − 2·{p} = 0)"
            yield at, f"over-constrained: {words}; attach one of them to a moving link"
        if name in {*scene.groups, *scene.links, *scene.points, *scene.regimes, *scene.cams}:
            yield at, f"the name {name!r} belongs to the group found here; rename the other part"
    moving = {link for group in ordering.free_groups.values() for link in group.links}
    on_links = {point for point, link in carriers(scene).items() if link in moving}
    for point in scene.near:
        if point not in on_links:
            message = "is not a point of a free link, whose position would distinguish modes; "
            yield f"near.{point}", message + did_you_mean(point, on_links)


# Why a part of each kind can't be ordered; only the first of a kind is reported.
_WAITING = {
    "shaft": "gears that nothing drives: {chain}; gear one to a link that moves",
    "noncircular wheel": "a wheel that nothing drives; gear it to the crank, a shaft with a pivot, or such a wheel",
    "rack": "a rack that nothing drives, or whose axis or guide nothing holds; attach it to a moving part",
    "pinion": "a pinion that nothing drives, or whose axis or guide nothing holds; attach it to a moving part",
    "second input": "{held!r} is on a link that this input drives, or that nothing drives; name one known before it",
    "cam": "a cam that nothing turns, or whose follower nothing holds; put it on the crank or a shaft",
    "group": "can't be ordered: {lacks}. These {count} groups ({links} links, {pairs} pairs) depend on each other: a "
    "structural group of class III or higher, which is given as free links, [links], or a chain that nothing connects "
    "to the input. Attach one of them to points that are known before it",
}


def _why_unordered(scene: Scene, ordering: _Ordering) -> Iterator[Problem]:
    """Reasons why some parts could not be reached."""
    for kind, words in _WAITING.items():
        waiting = [step for step in ordering.waiting if step.kind == kind]
        if not waiting:
            continue
        lacks = {step.name: [name for _, name in sorted(step.needs - ordering.known)] for step in waiting}
        yield (
            waiting[0].path,
            words.format(
                chain=", ".join(f"{n!r} on {scene.shafts[n].geared_to!r}" for n in lacks if n in scene.shafts),
                held=next(iter(waiting[0].needs))[1],
                lacks="; ".join(f"{name} needs {' and '.join(refs)}" for name, refs in lacks.items()),
                count=len(waiting),
                links=2 * len(waiting),
                pairs=3 * len(waiting),
            ),
        )


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
        raise SceneError([("input", "is missing: add one; this scene has only machine elements and no mechanism")])
    for problems in _phases(scene):
        if problems:
            raise SceneError(problems)
    ordering = _ordered(scene)
    moving = tuple(one.link for one in attachments(scene) if one.pair or one.link in scene.links)
    return Structure(tuple(ordering.elements), moving, sliders(scene), ordering.free_groups)


def _phases(scene: Scene) -> Iterator[list[Problem]]:
    """Problems by phases: checking ends with the first that finds any, as these cause others in the next."""
    yield wrong_references(scene, DEFINED)
    ordering = _ordered(scene)
    ungrouped = structure.free_matching.why_not_grouped(scene, ordering.links) if scene.links else []
    yield [*_why_unordered(scene, ordering), *ungrouped]
    misfits = wrong_references(scene, FITTING) or misplaced(scene)
    yield [*_immovable(scene), *misfits, *_free_problems(scene, ordering), *_sliding_loops(scene, ordering)]
    yield structure.trains.train_problems(scene) if scene.shafts else []
    toothed = scene.noncircular_wheels or scene.racks or scene.pinions
    yield structure.meshes.mesh_problems(scene) if toothed else []
    yield [*replacement_problems(scene), *friction_problems(scene), *formula_problems(scene)]
