"""The structure of a mechanism: ordering it into an input link and structural groups, or saying why it can't be.

A mechanism is ordered when every group hangs on points and guides that are known before it; it then has as many
degrees of freedom as input links, one. Lower pairs only: W = 3n − 2p₁ (Chebyshev), and W = 0 for each group.
"""

from typing import NamedTuple

from engine.scene.formulas.load_formulas import formula_problems
from engine.scene.masses import replacement_problems
from engine.scene.names import acting, definitions, did_you_mean, input_point, misplaced, references, sliders
from engine.scene.pairs import friction_problems
from engine.scene.parts import FRAME, Sliding, Yoke
from engine.scene.scene import Scene, SceneError


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


def group_links(scene: Scene, name: str) -> tuple[str, str]:
    """Names of the two links of a group."""
    group = scene.groups[name]
    return group.first.link, group.second.link


def _outer(group: object) -> list[tuple[str, str]]:
    """What a group hangs on: (kind, name) of its two outer pairs."""
    parts = (group.first, group.second)
    return [("guide", p.guide) if isinstance(p, (Sliding, Yoke)) else ("point", p.joint) for p in parts]


def _ordered(scene: Scene) -> tuple[list[Element], dict[str, str | None], dict[str, str]]:
    """Elements in order as far as the ordering goes; the link of each known point and guide."""
    elements = [Element("input", scene.input.link)]
    known_links = {FRAME, scene.input.link}
    points = {input_point(scene): scene.input.link}
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
    problems = []
    shafts = [name for name in scene.shafts if Element("shaft", name) not in elements]
    if shafts:
        chain = ", ".join(f"{name!r} on {scene.shafts[name].geared_to!r}" for name in shafts)
        problems.append(
            (f"shafts.{shafts[0]}.geared_to", f"gears that nothing drives: {chain}; gear one to a link that moves")
        )
    waiting = [name for name in scene.groups if Element("group", name) not in elements]
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
        No input, unknown or repeated names, links moved by two groups (over-constrained), groups that hang on each
        other (higher class) or on the frame alone, and actions on what can't carry them.
    """
    if scene.input is None:
        raise SceneError([("input", "is missing: a mechanism begins at it, and this scene has machine elements alone")])
    points, guides, links = definitions(scene)
    kinds = {"point": points, "guide": guides, "link": links, "action": acting(scene)}
    problems = [
        (
            path,
            f"{name!r} is not {'an' if kind == 'action' else 'a'} {kind} of this scene; "
            + did_you_mean(name, kinds[kind]),
        )
        for path, kind, name in references(scene)
        if name not in kinds[kind]
    ]
    if problems:
        raise SceneError(problems)
    elements, known_points, known_guides = _ordered(scene)
    problems = _why_unordered(scene, elements, known_points, known_guides)
    if not problems:
        problems = _check_movable(scene, known_points, known_guides) + misplaced(scene)
    if not problems:
        problems = replacement_problems(scene) + friction_problems(scene) + formula_problems(scene)
    if problems:
        raise SceneError(problems)
    return Structure(tuple(elements), _moving_links(scene), sliders(scene))


def _moving_links(scene: Scene) -> tuple[str, ...]:
    pivoted = [name for name, shaft in scene.shafts.items() if shaft.pivot is not None]
    return (scene.input.link, *pivoted, *(link for name in scene.groups for link in group_links(scene, name)))
