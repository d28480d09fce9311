"""Jumps and kinks of a machine's torques: which loads switch, and where, from the machine's graph.

A Runge–Kutta step across a jump or a kink, even of a higher derivative, loses its order, and its error estimate is too
small; a node there prevents that.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Crossing, Given, Held, Node, reached
from engine.laws.rounding import EPS
from engine.mechanism.actions.tables import jumps_of
from engine.mechanism.link_loads import Load
from engine.scene.load_formulas import load_formulas
from engine.scene.scene import Numbers, Scene

# Half the width of a jump [rad], with a node on either side: above the rounding of the angle, far below all else.
JUMP = 1e-10
# Steps up to this length are within a jump [rad].
GAP = 4.0 * JUMP
# Half the width of a jump in time, relative to the times of its table.
INSTANT = 8.0 * EPS
# Minimum of that width, for a jump at time 0 [s].
LEAST_INSTANT = 1e-200


class Watch(NamedTuple):
    """A curve whose zeros are jumps or kinks of torques.

    Attributes
    ----------
    crossing : Crossing
    actions : frozenset of str
        Actions whose torques are affected.
    """

    crossing: Crossing
    actions: frozenset[str]


class Breaks(NamedTuple):
    """Positions at which torques have jumps or kinks.

    Attributes
    ----------
    angles : ndarray (breaks, variants)
        [rad]; NaN where a variant has none.
    actions : tuple of str
    acting : ndarray (actions, breaks, variants) of bool
        Which actions' torques have a jump or a kink there.
    """

    angles: np.ndarray
    actions: tuple[str, ...]
    acting: np.ndarray

    def some(self, chosen: np.ndarray) -> "Breaks":
        """Breaks of a subset of the variants, by index."""
        angles, acting = (np.ascontiguousarray(rows[..., chosen]) for rows in (self.angles, self.acting))
        return Breaks(angles, self.actions, acting)

    def of(self, active: Iterable[str]) -> "Breaks":
        """Breaks of a subset of the actions."""
        chosen = [self.actions.index(name) for name in sorted(active) if name in self.actions]
        acting = self.acting[chosen]
        angles = np.where(acting.any(axis=0), self.angles, np.nan)
        kept = ~np.isnan(angles).all(axis=1)
        actions = tuple(self.actions[i] for i in chosen)
        return Breaks(angles[kept], actions, acting[:, kept])


def edges_of(
    direction: np.ndarray,
    breaks: Breaks,
    cycle: float,
    begin: float | np.ndarray = 0.0,
    bounds: np.ndarray | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Angles turned at jumps and kinks of torques, with both ends of the cycle or of the range, ascending.

    Parameters
    ----------
    direction : ndarray (variants,)
        +1 or −1.
    breaks : Breaks
    cycle : float
        [rad].
    begin : float or ndarray (variants,)
        Crank angle at which the angle turned is 0 [rad].
    bounds : ndarray (2, variants), optional
        Angles turned at the ends of the range of an input without a cycle.

    Returns
    -------
    edges, sides : ndarray (edges, variants)
        The angles, and the offset from each at which torques are evaluated, at most to the middle of an interval [rad].
    """
    count = direction.size
    if bounds is not None:
        turned = np.nan_to_num(direction * (breaks.angles - begin), nan=np.inf)
        edges = np.concatenate((bounds[:1], np.sort(np.clip(turned, *bounds), axis=0), bounds[1:]))
        return edges, np.where((edges > bounds[0]) & (edges < bounds[1]), JUMP, 0.0)
    turned = np.nan_to_num(np.mod(direction * (breaks.angles - begin), cycle), nan=cycle)
    # Rounding may move a break across the start.
    at_begin = ((turned <= GAP) | (turned >= cycle - GAP)) & ~np.isnan(breaks.angles)
    ends = np.where(at_begin.any(axis=0), JUMP, 0.0)
    edges = np.concatenate((np.zeros((1, count)), np.sort(turned, axis=0), np.full((1, count), cycle)))
    sides = np.where((edges > 0.0) & (edges < cycle), JUMP, ends)
    return edges, sides


def watches_of(crossings: Iterable[Crossing], loads: Sequence[Load]) -> list[Watch]:
    """Crossings at which the torques of loads have jumps or kinks.

    Parameters
    ----------
    crossings : iterable of Crossing
        All crossings of the graph.
    loads : sequence of Load
    """
    behind = [set(reached(_held([load.characteristic, load.basis]))) for load in loads]
    crossings = list(crossings)
    # Curves of time switch at instants, not at angles. Test each curve once: a table has thousands of levels of one.
    curves = dict.fromkeys(crossing.curve for crossing in crossings)
    timed = {curve for curve in curves if any(isinstance(node, Given) for node in reached([curve]))}
    watches = []
    for crossing in crossings:
        if crossing.curve in timed:
            continue
        actions = {load.action for load, nodes in zip(loads, behind, strict=True) if crossing.curve in nodes}
        if actions:
            watches.append(Watch(crossing, frozenset(actions)))
    return watches


def _held(nodes: Iterable[Node]) -> list[Node]:
    return [node for node in reached(nodes) if isinstance(node, Held)]


def instants_of(scene: Scene, active: Iterable[str], numbers: Numbers, count: int) -> np.ndarray:
    """Times at which torques over time have jumps or kinks [s], on both sides of a jump, (instants, variants).

    Parameters
    ----------
    scene : Scene
    active : iterable of str
        Acting actions.
    numbers : Numbers
    count : int
        Number of variants.
    """
    found: list[float | np.ndarray] = []
    for name, action in (scene.forces | scene.moments).items():
        if name in active and getattr(action, "over_time", None) is not None:
            width = INSTANT * (abs(action.over_time[0]) + abs(action.over_time[-1]))
            jumps = jumps_of(action)
            for x in dict.fromkeys(map(float, action.abscissae)):
                found += [x - width, x + width] if x in jumps else [x]
    for name, formula in load_formulas(scene).items():
        for x in formula.switching_times(numbers) if name in active else ():
            width = INSTANT * np.abs(x) + LEAST_INSTANT
            found += [x - width, x + width]
    return np.array([np.broadcast_to(x, count) for x in found]).reshape(len(found), count)
