"""What has to hold in a machine that works: groups are assembled, margins stay positive, springs unwind."""

from collections.abc import Iterable
from typing import NamedTuple

from engine.graph.nodes import Node, Stage, reached
from engine.mechanism.mechanics import Mechanics
from engine.scene.pairs import has_friction
from engine.words.verdicts import Verdict

# A group whose transmission quality falls below this is singular: about the root of the rounding error.
SINGULAR_SINE = 1e-7


class Margin(NamedTuple):
    """A curve that stays positive in a machine that works; where it doesn't, the verdict, and the group to blame."""

    group: str
    verdict: Verdict
    curve: Node


def taking_part(mechanics: Mechanics, nodes: Iterable[Node]) -> tuple[str, ...]:
    """Groups on whose position some nodes depend, in the order of the scene."""
    behind, kinematics = set(reached(nodes)), mechanics.kinematics
    return tuple(group for group in kinematics.sines if behind.intersection(kinematics.solution(group)))


def wound_springs(mechanics: Mechanics, nodes: Iterable[Node]) -> list[Node]:
    """Rates of the angles that torsion springs follow on which some nodes depend."""
    if not mechanics.sprung:
        return []
    behind = set(reached(nodes))
    wound = (rate for spring, rate in mechanics.sprung if spring in behind and rate.stage == Stage.POSITION)
    return list(dict.fromkeys(wound))


def margins_against_jamming(mechanics: Mechanics, nodes: Iterable[Node]) -> list[Margin]:
    """Margins of the groups on whose friction some nodes depend."""
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
    """What must stay positive at the cams on which some nodes depend."""
    kinematics, found = mechanics.kinematics, []
    for name in taking_part(mechanics, nodes) if kinematics.cams else ():
        if name not in kinematics.cams:
            continue
        found += [Margin(name, Verdict.UNDERCUT, curve) for curve in kinematics.cams[name].undercut]
        if mechanics.scene.cams[name].closure == "spring":
            force = mechanics.reactions.variables[f"{name}.contact_force"]
            # Where nothing has a mass and nothing acts, nothing is said of forces.
            found += [Margin(name, Verdict.LIFTS_OFF, force)] if force.stage == Stage.POSITION else []
    return found
