"""Friction in the pairs of a mechanism as nodes: friction per newton of pressing force, and the pressing forces.

Friction opposes the relative motion in a pair and is proportional to the pressing force: in a journal it is a moment
(friction circle), in a guide a force. The direction of the relative motion is held over each panel; the pressing forces
are solved group by group.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.laws.friction.coefficients import BUSHES, GAUSS, MATERIALS, stribeck
from engine.laws.friction.feedback import (
    GUIDE,
    JOURNAL,
    bearing,
    change_of,
    margin_against_jamming,
    unless_jammed,
)
from engine.laws.senses import sense
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.higher_pairs.rack_motion import rack_guide
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Components
from engine.mechanism.vectors import named
from engine.parts.pair_friction import PairFriction
from engine.parts.skeleton import FRAME
from engine.scene.pairs import Pair, contact_pairs, pairs
from engine.scene.scene import Numbers

# Iterations of `engine.laws.friction.feedback`.
_PASSES = 6


class Rub(NamedTuple):
    """Friction in a pair.

    Attributes
    ----------
    kind : float
        `JOURNAL` or `GUIDE`.
    drag : Node
        Friction moment [N·m] or force [N] on the pair's link per newton of pressing force; it opposes the motion.
    lost : Node
        Work lost per newton of pressing force and unit of input motion.
    edge : Node
        For a guide, reciprocal of half the slider's length [1/m]; 0 for a journal and for a slider that never tilts.
    """

    kind: float
    drag: Node
    lost: Node
    edge: Node


class Settled(NamedTuple):
    """Pressing forces in the pairs of a group with friction.

    Attributes
    ----------
    pressing : tuple of Node
        Pressing force in each pair [N]; NaN where the group jams.
    margin : Node
        Margin against jamming: 1 without friction; 0 or less where no force can move the group.
    residual : Node
        Relative change of the pressing forces in the last iteration.
    """

    pressing: tuple[Node, ...]
    margin: Node
    residual: Node


def rubbing_pairs(kinematics: Kinematics, motion: InputMotion) -> dict[str, Rub]:
    """Friction in each pair that has friction and moves, by the pair's name."""
    scene = kinematics.scene
    paths = {friction.pair: f"friction.{name}" for name, friction in scene.friction.items()}
    found = {}
    for pair in [*pairs(scene), *contact_pairs(scene)]:
        if pair.name in paths:
            rate, slope = relative_motion(kinematics, pair)
            if rate is not kinematics.graph.zero:
                path = paths[pair.name]
                friction = scene.friction[path.removeprefix("friction.")]
                kinematics.graph.switches(rate, slope)
                found[pair.name] = _rub(kinematics, motion, pair, path, friction, rate)
    return found


def relative_motion(kinematics: Kinematics, pair: Pair) -> tuple[Node, Node]:
    """Rate of rotation or sliding in a pair with respect to the input, and its derivative."""
    if pair.kind == "prismatic":
        slide = kinematics.slides[pair.link]
        return slide.v, slide.a
    if pair.kind == "contact":
        return _sliding_at_cam(kinematics, pair)
    one, other = kinematics.links[pair.link], kinematics.links[pair.other]
    return one.w - other.w, one.e - other.e


def _sliding_at_cam(kinematics: Kinematics, pair: Pair) -> tuple[Node, Node]:
    """Sliding rate of a follower along its cam's tangent at the contact, and its derivative."""
    motion, links = kinematics.cams[pair.name.partition(".")[0]], kinematics.links
    follower, cam = (links[name].at(motion.contact - links[name].origin.r) for name in (pair.link, pair.other))
    along, against = motion.normal.normal, follower.v - cam.v
    rotation = links[pair.link].w * along.normal.dot(against) - links[pair.other].w * along.dot(against.normal)
    return along.dot(against), along.dot(follower.a - cam.a) + rotation


def rolling_rate(kinematics: Kinematics, name: str) -> tuple[Node, Node]:
    """Rolling rate of a mesh, relative to its carrier, with respect to the input, and its derivative.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        A shaft, non-circular wheel or pinion: its rotation relative to its carrier or rack. A rack: its travel past
        the pinion's axis.
    """
    scene, links = kinematics.scene, kinematics.links
    if name in scene.racks:
        rack, radius = scene.racks[name], kinematics.number(f"racks.{name}.radius")
        pinion, carrier = links[rack.pinion], links[scene.guides[rack.guide].link]
        return radius * (pinion.w - carrier.w), radius * (pinion.e - carrier.e)
    if name in scene.pinions:
        carrier = kinematics.guides[rack_guide(scene, name)].carrier
    else:
        carrier = links[getattr(scene.shafts.get(name), "carrier", None) or FRAME]
    return links[name].w - carrier.w, links[name].e - carrier.e


def pressing_in_group(
    rubs: Sequence[Rub], free: Sequence[Components], backs: Sequence[Sequence[Components]]
) -> Settled:
    """Solve for the pressing forces in a group with friction.

    Parameters
    ----------
    rubs : sequence of Rub
        At least one.
    free : sequence of (Node, Node)
        Reaction in each pair without friction in the group.
    backs : sequence of sequence of (Node, Node)
        [i][j]: change of the reaction in pair i per newton of pressing force in pair j.
    """
    graph = rubs[0].drag.graph
    old, pressing, determinants = (), [graph.zero] * len(rubs), []
    for _ in range(_PASSES):
        old, rows, forces, lengths = pressing, [], [], []
        for i, (rub, reaction, row) in enumerate(zip(rubs, free, backs, strict=True)):
            x, y = (sum((back[axis] * n for back, n in zip(row, old, strict=True)), reaction[axis]) for axis in (0, 1))
            p, q, r = graph.apply(bearing, rub.kind, rub.edge, x, y)
            rows.append([(r if i == j else graph.zero) - (p * back[0] + q * back[1]) for j, back in enumerate(row)])
            forces.append(p * reaction[0] + q * reaction[1])
            lengths.append(r)
        pressing, determinant = _eliminated(rows, forces, lengths)
        determinants.append(determinant)
    change = sum((abs(new - n) for new, n in zip(pressing, old, strict=True)), graph.zero)
    residual = graph.apply(change_of, change, sum((abs(n) for n in pressing), graph.zero))
    margin = graph.apply(margin_against_jamming, determinants[0], determinants[-1], residual)
    return Settled(tuple(graph.apply(unless_jammed, n, margin) for n in pressing), margin, residual)


def _eliminated(rows: list[list[Node]], forces: list[Node], lengths: Sequence[Node]) -> tuple[list[Node], Node]:
    """Solve the equations of an iteration; also their determinant, divided by the lengths of the reactions.

    Pivots stay on the diagonal: each is a length times the margin against jamming of the pairs up to it.
    """
    graph, count = forces[0].graph, len(forces)
    determinant = graph.one
    for k in range(count):
        determinant = determinant * (rows[k][k] / lengths[k])
        for i in range(k + 1, count):
            share = rows[i][k] / rows[k][k]
            rows[i] = [entry - share * above for entry, above in zip(rows[i], rows[k], strict=True)]
            forces[i] = forces[i] - share * forces[k]
    found: list[Node] = []
    for k in reversed(range(count)):
        known = sum((a * n for a, n in zip(rows[k][k + 1 :], found, strict=True)), graph.zero)
        found.insert(0, (forces[k] - known) / rows[k][k])
    return found, determinant


def _rub(kinematics: Kinematics, motion: InputMotion, pair: Pair, path: str, friction: PairFriction, rate: Node) -> Rub:
    graph, turns = kinematics.graph, pair.kind == "revolute"
    drag = _drag(motion, pair, path, friction, rate)
    moves = graph.held(graph.apply(sense, rate))
    edge = graph.zero
    if friction.length is not None:
        edge = graph.derived(f"edge of {path}", lambda n: 2.0 / n[f"{path}.length"])
    return Rub(
        JOURNAL if turns else GUIDE,
        named(-(drag * moves * input_sense(kinematics)), f"drag in {pair.name}"),
        (moves * rate) * drag,
        edge,
    )


def _drag(motion: InputMotion, pair: Pair, path: str, friction: PairFriction, rate: Node) -> Node:
    """Magnitude of friction per newton of pressing force: a number, or a curve over sliding speed (Stribeck)."""
    graph, turns = rate.graph, pair.kind == "revolute"
    factor, arm = _factor(pair, path, friction), _arm(pair, path, friction)

    def raised(n: Numbers, coefficient: float | np.ndarray) -> float | np.ndarray:
        return coefficient if friction.above_prismatic is None else (1.0 + n[f"{path}.above_prismatic"]) * coefficient

    def kinetic(n: Numbers) -> float | np.ndarray:
        return raised(n, n[f"{path}.coefficient"] if friction.material is None else MATERIALS[friction.material])

    def drag(n: Numbers) -> float | np.ndarray:
        f = kinetic(n)
        # The normal and the friction force of a journal are perpendicular; their resultant is the reaction.
        return factor(n) * arm(n) * f / (np.sqrt(1.0 + f * f) if turns else 1.0)

    if friction.stribeck_speed is None:
        return graph.derived(f"drag of {path}", drag)
    arm_of_sliding = graph.derived(f"arm of {path}", arm)
    limit = graph.number(f"{path}.stribeck_speed")
    rest = graph.derived(f"static coefficient of {path}", lambda n: raised(n, n[f"{path}.static_coefficient"]))
    at_speed = graph.derived(f"kinetic coefficient of {path}", kinetic)
    f = graph.apply(stribeck, rest, at_speed, motion.speed * arm_of_sliding * rate, limit, GAUSS)
    scaled = graph.derived(f"scale of {path}", lambda n: factor(n) * arm(n)) * f
    return scaled / graph.function("sqrt", 1.0 + f * f) if turns else scaled


def _factor(pair: Pair, path: str, friction: PairFriction) -> Callable[[Numbers], float | np.ndarray]:
    """Ratio of the sum of the contact pressures in a pair to their resultant."""
    if friction.form == "vee":
        return lambda n: 1.0 / np.sin(n[f"{path}.vee_angle"] / 2)
    bush = BUSHES.get((friction.contact if pair.kind == "revolute" else friction.form) or "line", 1.0)
    return lambda n: bush


def _arm(pair: Pair, path: str, friction: PairFriction) -> Callable[[Numbers], float | np.ndarray]:
    """Lever arm of friction: radius of a journal; pin radius over roller radius of a cam roller; 1 for a guide."""
    if pair.kind == "contact" and friction.diameter is not None:
        roller = f"cams.{pair.name.partition('.')[0]}.follower.roller_radius"
        return lambda n: n[f"{path}.diameter"] / 2 / n[roller]
    return (lambda n: n[f"{path}.diameter"] / 2) if pair.kind == "revolute" else (lambda n: 1.0)
