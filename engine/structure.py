"""The structure of a mechanism: ordering it into an input link and structural groups, or saying why it can't be.

A mechanism is ordered when every group hangs on points and guides that are known before it; it then has as many
degrees of freedom as input links, one. Lower pairs only: W = 3n − 2p₁ (Chebyshev), and W = 0 for each group.
"""

import difflib
from collections.abc import Iterable
from typing import NamedTuple

from engine.actions import DCMotor, InductionMotor, OnPoint, ResistingOnPoint, Tabled, TorsionSpring
from engine.parts import FRAME, CrankInput, Hinged, Sliding, Yoke
from engine.scene import Scene, SceneError


class Element(NamedTuple):
    """A step of the ordering: `kind` is "input", "shaft", "group", "point" or "guide"."""

    kind: str
    name: str


class Structure(NamedTuple):
    """An ordered mechanism.

    Attributes
    ----------
    elements : tuple of Element
        Each after all that it hangs on.
    links : tuple of str
        All moving links, shafts without a pivot left out.
    sliders : tuple of str
        Links that slide on a guide or in a slot: those with a slide coordinate.
    """

    elements: tuple[Element, ...]
    links: tuple[str, ...]
    sliders: tuple[str, ...]


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Ending of a message about an unknown name: what is allowed, and the nearest of it."""
    known = sorted(known)
    near = difflib.get_close_matches(name, known, n=1)
    listed = ", ".join(known) if known else "none"
    return f"known are: {listed}" + (f"; did you mean {near[0]!r}?" if near else "")


def group_links(scene: Scene, name: str) -> tuple[str, str]:
    """Names of the two links of a group."""
    group = scene.groups[name]
    return group.first.link, group.second.link


def _definitions(scene: Scene) -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Where each point, guide and link is defined; a name defined twice is refused."""
    problems: list[tuple[str, str]] = []
    points: dict[str, str] = {}
    guides: dict[str, str] = {}
    links: dict[str, str] = {FRAME: FRAME}
    everything: dict[str, str] = {FRAME: "the frame"}

    def define(kind: dict[str, str], name: str, path: str) -> None:
        if kind is links and name in links and name != FRAME:
            problems.append(
                (
                    path,
                    f"link {name!r} is already moved by {links[name]}: over-constrained, W < 1; a link belongs to one group",
                )
            )
        elif name in everything:
            problems.append((path, f"the name {name!r} is already taken by {everything[name]}; choose another"))
        kind.setdefault(name, path)
        everything.setdefault(name, path)

    drive = scene.input
    define(links, drive.link, "input.link")
    define(
        points,
        drive.pin if isinstance(drive, CrankInput) else drive.point,
        "input." + ("pin" if isinstance(drive, CrankInput) else "point"),
    )
    for name, group in scene.groups.items():
        for side in ("first", "second"):
            define(links, getattr(group, side).link, f"groups.{name}.{side}.link")
        if hasattr(group, "inner"):
            define(points, group.inner, f"groups.{name}.inner")
    for name in scene.shafts:
        define(links, name, f"shafts.{name}")
    for name in scene.points:
        define(points, name, f"points.{name}")
    for name in scene.guides:
        define(guides, name, f"guides.{name}")
    for table in ("forces", "moments", "springs", "cylinders"):
        for name in getattr(scene, table):
            define({}, name, f"{table}.{name}")
    if problems:
        raise SceneError(problems)
    return points, guides, links


def _references(scene: Scene) -> list[tuple[str, str, str]]:
    """Every name a scene refers to, as (path, kind, name)."""
    refs: list[tuple[str, str, str]] = []
    drive = scene.input
    if isinstance(drive, CrankInput):
        refs.append(("input.pivot", "point", drive.pivot))
    else:
        refs.append(("input.guide", "guide", drive.guide))
    for name, group in scene.groups.items():
        for side in ("first", "second"):
            part, path = getattr(group, side), f"groups.{name}.{side}"
            if isinstance(part, (Sliding, Yoke)):
                refs.append((f"{path}.guide", "guide", part.guide))
            else:
                refs.append((f"{path}.joint", "point", part.joint))
    for table in ("points", "guides", "bodies"):
        for name, part in getattr(scene, table).items():
            refs.append((f"{table}.{name}.link", "link", part.link))
    for name, shaft in scene.shafts.items():
        refs.append((f"shafts.{name}.geared_to", "link", shaft.geared_to))
        if shaft.pivot is not None:
            refs.append((f"shafts.{name}.pivot", "point", shaft.pivot))
    for name, force in scene.forces.items():
        refs.append((f"forces.{name}.on", "point", force.on))
        if isinstance(force, (OnPoint, ResistingOnPoint)):
            refs.append((f"forces.{name}.turns_with", "link", force.turns_with))
    for name, moment in scene.moments.items():
        refs.append((f"moments.{name}.on", "link", moment.on))
    for table in ("forces", "moments"):
        for name, action in getattr(scene, table).items():
            if isinstance(action, Tabled) and action.slider is not None:
                refs.append((f"{table}.{name}.slider", "link", action.slider))
    for name, spring in scene.springs.items():
        refs += [(f"springs.{name}.between", "point", end) for end in spring.between]
    for name, cylinder in scene.cylinders.items():
        refs.append((f"cylinders.{name}.piston", "link", cylinder.piston))
    return refs


def _outer(group: object) -> list[tuple[str, str]]:
    """What a group hangs on: (kind, name) of its two outer pairs."""
    parts = (group.first, group.second)
    return [("guide", p.guide) if isinstance(p, (Sliding, Yoke)) else ("point", p.joint) for p in parts]


def _ordered(scene: Scene) -> tuple[list[Element], dict[str, str | None], dict[str, str]]:
    """Elements in order as far as the ordering goes; the link of each known point and guide."""
    elements = [Element("input", scene.input.link)]
    known_links = {FRAME, scene.input.link}
    drive = scene.input
    points = {(drive.pin if isinstance(drive, CrankInput) else drive.point): drive.link}
    guides: dict[str, str] = {}
    grown = True
    while grown:
        grown = False
        for kind, table, known in (("point", scene.points, points), ("guide", scene.guides, guides)):
            for name, part in table.items():
                if name not in known and part.link in known_links:
                    known[name] = part.link
                    elements.append(Element(kind, name))
                    grown = True
        for name, shaft in scene.shafts.items():
            if (
                name not in known_links
                and shaft.geared_to in known_links
                and (shaft.pivot is None or shaft.pivot in points)
            ):
                known_links.add(name)
                elements.append(Element("shaft", name))
                grown = True
        for name, group in scene.groups.items():
            if Element("group", name) in elements:
                continue
            if all(ref in (points if kind == "point" else guides) for kind, ref in _outer(group)):
                elements.append(Element("group", name))
                known_links.update(group_links(scene, name))
                if hasattr(group, "inner"):
                    points[group.inner] = group.first.link
                grown = True
    return elements, points, guides


def _check_movable(scene: Scene, points: dict[str, str], guides: dict[str, str]) -> list[tuple[str, str]]:
    """Groups that hang on one link only: with it they are a rigid truss or parts that never move relative to it."""
    problems = []
    for name, group in scene.groups.items():
        carriers = {(points if kind == "point" else guides)[ref] for kind, ref in _outer(group)}
        if group.type in ("RRR", "RRP", "RPR", "PRP", "RPP") and carriers == {FRAME}:
            n = len(group_links(scene, name))
            problems.append(
                (
                    f"groups.{name}",
                    f"over-constrained: both outer pairs are on the frame, so its {n} links can't move "
                    f"(W = 3·{n} − 2·3 = 0); hang one of them on a moving link",
                )
            )
    return problems


def _why_unordered(scene: Scene, elements: list[Element], points: dict, guides: dict) -> list[tuple[str, str]]:
    """Reasons why some groups, points or guides could not be reached."""
    waiting = [name for name in scene.groups if Element("group", name) not in elements]
    problems = []
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
                "a structural group of class III or higher, which is not solved here, or a chain that "
                "nothing connects to the input. Hang one of them on points that are known before it",
            )
        )
    return problems


def order(scene: Scene) -> Structure:
    """Order a scene into its input link and structural groups, whatever order they are written in.

    Raises
    ------
    SceneError
        Unknown or repeated names, links moved by two groups (over-constrained), groups that hang on each
        other (higher class) or on the frame alone, and actions on what can't carry them.
    """
    points, guides, links = _definitions(scene)
    kinds = {"point": points, "guide": guides, "link": links}
    problems = [
        (path, f"{name!r} is not a {kind} of this scene; " + did_you_mean(name, kinds[kind]))
        for path, kind, name in _references(scene)
        if name not in kinds[kind]
    ]
    if problems:
        raise SceneError(problems)
    elements, known_points, known_guides = _ordered(scene)
    problems = _why_unordered(scene, elements, known_points, known_guides)
    if not problems:
        problems = _check_movable(scene, known_points, known_guides) + _check_carriers(scene)
    if problems:
        raise SceneError(problems)
    return Structure(tuple(elements), _moving_links(scene), sliders(scene))


def _moving_links(scene: Scene) -> tuple[str, ...]:
    pivoted = [name for name, shaft in scene.shafts.items() if shaft.pivot is not None]
    return (scene.input.link, *pivoted, *(link for name in scene.groups for link in group_links(scene, name)))


def sliders(scene: Scene) -> tuple[str, ...]:
    """Links with a slide coordinate: on a guide, or (a block) in the slot of the other link of its group."""
    found = [] if isinstance(scene.input, CrankInput) else [scene.input.link]
    for group in scene.groups.values():
        found += [part.link for part in (group.first, group.second) if isinstance(part, (Sliding, Yoke))]
        if group.type in ("RPR", "RPP"):
            found.append(group.first.link)
    return tuple(found)


def hinged_pairs(scene: Scene) -> tuple[tuple[str, str, str], ...]:
    """(link, joint, joint) of every bar of the groups, for drawing."""
    bars = []
    for group in scene.groups.values():
        bars += [(p.link, p.joint, group.inner) for p in (group.first, group.second) if isinstance(p, Hinged)]
    return tuple(bars)


def _check_carriers(scene: Scene) -> list[tuple[str, str]]:
    """Frame points where the frame is meant, motors on shafts of constant ratio, strokes of sliders that slide."""
    problems = []
    on_frame = {name for name, point in scene.points.items() if point.link == FRAME}
    pivots = [("input.pivot", scene.input.pivot)] if isinstance(scene.input, CrankInput) else []
    pivots += [(f"shafts.{n}.pivot", s.pivot) for n, s in scene.shafts.items() if s.pivot is not None]
    problems += [
        (path, f"{name!r} is not on the frame; " + did_you_mean(name, on_frame))
        for path, name in pivots
        if name not in on_frame
    ]
    if not isinstance(scene.input, CrankInput) and scene.guides[scene.input.guide].link != FRAME:
        problems.append(
            (
                "input.guide",
                f"{scene.input.guide!r} is on a moving link; the input's guide must be on the frame",
            )
        )
    geared = {scene.input.link} | {n for n, s in scene.shafts.items() if s.geared_to == scene.input.link}
    for name, shaft in scene.shafts.items():
        if shaft.pivot is not None and shaft.geared_to != scene.input.link:
            problems.append(
                (
                    f"shafts.{name}.pivot",
                    "only a shaft geared to the input crank can carry points; leave pivot out",
                )
            )
        if not isinstance(scene.input, CrankInput) and shaft.geared_to == scene.input.link:
            problems.append(
                (
                    f"shafts.{name}.geared_to",
                    "a shaft can't be geared to a sliding input; name a turning link",
                )
            )
    loose = {n for n, s in scene.shafts.items() if s.pivot is None}
    for table in ("points", "guides", "bodies"):
        for name, part in getattr(scene, table).items():
            if part.link in loose:
                problems.append(
                    (
                        f"{table}.{name}.link",
                        f"shaft {part.link!r} has no pivot; give it one, or use the shaft's inertia",
                    )
                )
            if table == "bodies" and part.link == FRAME:
                problems.append(
                    (
                        f"bodies.{name}.link",
                        "a body on the frame doesn't move and has no effect; name a moving link",
                    )
                )
    for name, moment in scene.moments.items():
        if isinstance(moment, (DCMotor, InductionMotor)) and moment.on not in geared:
            problems.append(
                (
                    f"moments.{name}.on",
                    f"a motor drives the crank or a shaft geared to it, not {moment.on!r}; allowed: {', '.join(sorted(geared))}",
                )
            )
        if moment.on == FRAME or (isinstance(moment, TorsionSpring) and moment.on in loose):
            problems.append((f"moments.{name}.on", f"{moment.on!r} can't carry this moment; name a moving link"))
    slide = set(sliders(scene))
    named = [(f"cylinders.{n}.piston", c.piston) for n, c in scene.cylinders.items()]
    for table in ("forces", "moments"):
        named += [
            (f"{table}.{n}.slider", a.slider)
            for n, a in getattr(scene, table).items()
            if isinstance(a, Tabled) and a.slider is not None
        ]
    problems += [
        (path, f"{link!r} doesn't slide; sliders are: {', '.join(sorted(slide)) or 'none'}")
        for path, link in named
        if link not in slide
    ]
    return problems
