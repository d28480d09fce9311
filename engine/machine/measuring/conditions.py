"""Conditions for a working machine: groups are assembled, margins are positive, springs unwind."""

from collections.abc import Iterable
from typing import NamedTuple

from engine.graph.nodes import Node, Stage, reached
from engine.mechanism.mechanics import Mechanics
from engine.scene.pairs import has_friction
from engine.words.verdicts import Verdict

# Transmission index or relative arm below which a group counts as singular: about the root of the rounding error.
SINGULAR_SINE = 1e-7

# Verdicts on margins, in order of precedence.
ON_MARGINS = (Verdict.UNDERCUT, Verdict.JAMS, Verdict.LIFTS_OFF)


class Margin(NamedTuple):
    """A curve that is positive in a working machine; the verdict if it is not, and the group responsible."""

    group: str
    verdict: Verdict
    curve: Node


def taking_part(mechanics: Mechanics, nodes: Iterable[Node]) -> tuple[str, ...]:
    """Groups on whose position the nodes depend, in the order of the scene."""
    behind, kinematics = set(reached(nodes)), mechanics.kinematics
    return tuple(group for group in kinematics.sines if behind.intersection(kinematics.solution(group)))


def wound_springs(mechanics: Mechanics, nodes: Iterable[Node]) -> list[Node]:
    """Angular rates of the links whose torsion springs the nodes depend on."""
    if not mechanics.sprung:
        return []
    behind = set(reached(nodes))
    wound = (rate for spring, rate in mechanics.sprung if spring in behind and rate.stage == Stage.POSITION)
    return list(dict.fromkeys(wound))


def margins_against_jamming(mechanics: Mechanics, nodes: Iterable[Node]) -> list[Margin]:
    """Margins against jamming of the groups on whose friction the nodes depend."""
    if not has_friction(mechanics.scene):
        return []
    behind = set(reached(nodes))
    settled = mechanics.reactions.settlings.items()
    return [
        Margin(group, Verdict.JAMS, s.margin)
        for group, s in settled
        if behind.intersection((s.margin, *s.margin.operands))
    ]


def margins_at_cams(mechanics: Mechanics, nodes: Iterable[Node]) -> list[Margin]:
    """Margins of the cams on which the nodes depend, against undercut and lift-off."""
    kinematics, found = mechanics.kinematics, []
    for name in taking_part(mechanics, nodes) if kinematics.cams else ():
        if name not in kinematics.cams:
            continue
        found += [Margin(name, Verdict.UNDERCUT, curve) for curve in kinematics.cams[name].undercut]
        if mechanics.scene.cams[name].closure == "spring":
            force = mechanics.reactions.variables[f"{name}.contact_force"]
            # Without masses and loads there is no contact force to judge.
            found += [Margin(name, Verdict.LIFTS_OFF, force)] if force.stage == Stage.POSITION else []
    return found
