"""Levels of a machine's kinematics and statics that are computed at a position, in words."""

from collections.abc import Iterable

from engine.graph.nodes import Node, Stage, reached
from engine.mechanism.mechanics import Mechanics
from engine.scene.pairs import Pair, pairs


def all_levels(mechanics: Mechanics) -> dict[str, list[str]]:
    """Every level of every moving point, link and group, and the reactions in the pairs."""
    return {subject: list(levels) for subject, levels in _levels(mechanics).items()}


def computed_levels(mechanics: Mechanics, curves: Iterable[Node]) -> dict[str, list[str]]:
    """Levels on which some curves depend.

    Parameters
    ----------
    mechanics : Mechanics
    curves : iterable of Node
    """
    behind = set(reached(curves))
    found = {
        subject: [level for level, nodes in levels.items() if behind.intersection(nodes)]
        for subject, levels in _levels(mechanics).items()
    }
    return {subject: levels for subject, levels in found.items() if levels}


def _levels(mechanics: Mechanics) -> dict[str, dict[str, tuple[Node, ...]]]:
    """Position-dependent nodes of each level of each subject."""
    k = mechanics.kinematics
    found = {
        f"group {name} ({_kind(mechanics, name)})": {
            "position": k.solution(name),
            "velocity": tuple(k.links[link].w for link in _links(mechanics, name)),
            "acceleration": tuple(k.links[link].e for link in _links(mechanics, name)),
        }
        for name in k.sines
    }
    found |= {
        f"point {name}": {"position": tuple(p.r), "velocity": tuple(p.v), "acceleration": tuple(p.a)}
        for name, p in k.points.items()
    }
    found |= {
        f"slider {name}": {"position": (s.d,), "velocity": (s.v,), "acceleration": (s.a,)}
        for name, s in k.slides.items()
    }
    found |= {f"pair {pair.name}": {"reaction": _reaction(mechanics, pair)} for pair in pairs(mechanics.scene)}
    moving = {
        subject: {level: tuple(n for n in nodes if n.stage == Stage.POSITION) for level, nodes in levels.items()}
        for subject, levels in found.items()
    }
    return {
        subject: {level: nodes for level, nodes in levels.items() if nodes}
        for subject, levels in moving.items()
        if any(levels.values())
    }


def _reaction(mechanics: Mechanics, pair: Pair) -> tuple[Node, ...]:
    """Components of the reaction in a pair: of a force; of a guide, normal force and moment."""
    parts = ("reaction_x", "reaction_y") if pair.kind == "revolute" else ("reaction", "reaction_moment")
    return tuple(mechanics.reactions.variables[f"{pair.name}.{part}"] for part in parts)


def _kind(mechanics: Mechanics, group: str) -> str:
    """Type of a dyad; class of a group of free links."""
    if group in mechanics.scene.cams:
        return "cam"
    if group in mechanics.scene.noncircular_wheels:
        return "non-circular wheel"
    if group in mechanics.scene.shafts:
        return "wheel"
    free = mechanics.structure.free_groups.get(group)
    return mechanics.scene.groups[group].type if free is None else f"class {free.group_class}"


def _links(mechanics: Mechanics, group: str) -> tuple[str, ...]:
    if group in mechanics.scene.cams:
        return (mechanics.scene.cams[group].follower.link,)
    if group in {**mechanics.scene.noncircular_wheels, **mechanics.scene.shafts}:
        return (group,)
    if group in mechanics.structure.free_groups:
        return mechanics.structure.free_groups[group].links
    parts = mechanics.scene.groups[group]
    return parts.first.link, parts.second.link
