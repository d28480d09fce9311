"""Where the moments of a machine jump or bend: what of a load switches where, by the machine's graph.

A Runge–Kutta step across a jump or a bend, even one of a higher derivative, loses its order, and its estimated error
falls short of the true one; with a node there it doesn't.
"""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Constant, Crossing, Given, Held, Node, Operation, reached
from engine.laws.rounding import EPS
from engine.mechanism.acting import Load
from engine.mechanism.actions.tables import kinks_of
from engine.scene.load_formulas import load_formulas
from engine.scene.scene import Numbers, Scene

# Half the width of a jump [rad]: a node on either side. Beyond the rounding of the angle, and far below all else.
JUMP = 1e-10
# Half the width of a jump in time, of the times of its table.
INSTANT = 8.0 * EPS
# The same about the time 0 [s].
LEAST_INSTANT = 1e-200


class Watch(NamedTuple):
    """A place at which moments jump or bend.

    Attributes
    ----------
    crossing : Crossing
    jumps : bool
    actions : frozenset of str
        Whose moments do.
    """

    crossing: Crossing
    jumps: bool
    actions: frozenset[str]


class Breaks(NamedTuple):
    """Places where moments jump or bend.

    Attributes
    ----------
    angles : ndarray (places, variants)
        [rad]; NaN where a variant has none.
    jumps : ndarray (places,) of bool
    actions : tuple of str
    acting : ndarray (actions, places, variants) of bool
        Which actions' moments jump or bend there.
    """

    angles: np.ndarray
    jumps: np.ndarray
    actions: tuple[str, ...]
    acting: np.ndarray

    def some(self, chosen: np.ndarray) -> "Breaks":
        """Breaks of some of the variants, by index."""
        angles, acting = (np.ascontiguousarray(rows[..., chosen]) for rows in (self.angles, self.acting))
        return Breaks(angles, self.jumps, self.actions, acting)

    def two_sided(self) -> "Breaks":
        """Breaks with places on both sides of each, as if all were jumps."""
        return self._replace(jumps=np.ones_like(self.jumps))

    def of(self, active: Iterable[str]) -> "Breaks":
        """Breaks of some of the actions."""
        chosen = [self.actions.index(name) for name in sorted(active) if name in self.actions]
        acting = self.acting[chosen]
        angles = np.where(acting.any(axis=0), self.angles, np.nan)
        kept = ~np.isnan(angles).all(axis=1)
        actions = tuple(self.actions[i] for i in chosen)
        return Breaks(angles[kept], self.jumps[kept], actions, acting[:, kept])


def watches_of(crossings: Iterable[Crossing], loads: Sequence[Load]) -> list[Watch]:
    """Where the moments of loads jump or bend.

    Parameters
    ----------
    crossings : iterable of Crossing
        All of their graph.
    loads : sequence of Load
    """
    behind = [set(reached(_held([load.characteristic, load.basis]))) for load in loads]
    crossings = list(crossings)
    # What depends on time switches at instants. Thousands of rows of a table are levels of one curve.
    curves = dict.fromkeys(crossing.curve for crossing in crossings)
    timed = {curve for curve in curves if any(isinstance(node, Given) for node in reached([curve]))}
    watches = []
    for crossing in crossings:
        if crossing.curve in timed:
            continue
        orders = {
            load: crossing.kink + _vanishes(load.velocity, crossing)
            for load, nodes in zip(loads, behind, strict=True)
            if crossing.curve in nodes
        }
        if orders:
            jumps = 0 in orders.values()
            watches.append(Watch(crossing, jumps, frozenset(load.action for load in orders)))
    return watches


def _held(nodes: Iterable[Node]) -> list[Node]:
    return [node for node in reached(nodes) if isinstance(node, Held)]


def _vanishes(velocity: Node, crossing: Crossing) -> bool:
    """Whether a velocity is zero where a curve crosses zero: it is a multiple of that curve."""
    level = crossing.level
    if not (isinstance(level, Constant) and level.value + crossing.offset == 0.0):
        return False
    if velocity is crossing.curve:
        return True
    if not isinstance(velocity, Operation) or velocity.symbol not in ("*", "/", "neg"):
        return False
    factors = velocity.operands[:1] if velocity.symbol == "/" else velocity.operands
    return any(_vanishes(factor, crossing) for factor in factors)


def instants_of(scene: Scene, active: Iterable[str], numbers: Numbers, count: int) -> np.ndarray:
    """Times at which moments over time jump or bend [s], on both sides of a jump, (instants, variants).

    Parameters
    ----------
    scene : Scene
    active : iterable of str
        Actions.
    numbers : Numbers
        Of the variants.
    count : int
        How many variants there are.
    """
    found: list[float | np.ndarray] = []
    for name, action in (scene.forces | scene.moments).items():
        if name in active and getattr(action, "over_time", None) is not None:
            width = INSTANT * (abs(action.over_time[0]) + abs(action.over_time[-1]))
            for x, kink in kinks_of(action).items():
                found += [x - width, x + width] if kink == 0 else [x]
    for name, formula in load_formulas(scene).items():
        for x in formula.switching_times(numbers) if name in active else ():
            width = INSTANT * np.abs(x) + LEAST_INSTANT
            found += [x - width, x + width]
    return np.array([np.broadcast_to(x, count) for x in found]).reshape(len(found), count)


def beside(breaks: np.ndarray, turned: np.ndarray, cycle: float) -> np.ndarray:
    """How far from angles turned, (…, variants), moments are taken [rad]: beside a break, or just there.

    Breaks (breaks, variants) come again after a cycle [rad], which is infinite if they don't.
    """
    apart = np.abs(breaks.reshape(len(breaks), *(1,) * (turned.ndim - 1), breaks.shape[1]) - turned)
    if np.isfinite(cycle):
        apart = np.minimum(np.mod(apart, cycle), cycle - np.mod(apart, cycle))
    return np.where((apart <= 2.0 * JUMP).any(axis=0), JUMP, 0.0)
