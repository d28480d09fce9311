"""Landmarks of a cycle: the ends of strokes, and where the reduced moment jumps or bends.

A Runge–Kutta step across a jump or a bend loses its order; with a node there it doesn't. What switches in a load, and
where, is known to the machine's graph: where a curve (a slide coordinate, a velocity) crosses a level. The curves are
sampled over the cycle; within the interval where one crosses its level, regula falsi finds the place.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from engine.compiling.jit import over_variants
from engine.graph.nodes import Constant, Crossing, Found, Given, Held, Node, Operation, Position, reached
from engine.mechanism.acting import Load
from engine.mechanism.tables import kinks_of
from engine.motion.moments.tabulation import Ends, Tabulation
from engine.scene.scene import Numbers, Scene

# Of a curve with more places at which something only bends, the first and the last count.
MOST_BENDS = 24
SAMPLES_PER_TURN = 60
ITERATIONS = 20
# A last step of this share of the bracket: the error it leaves is smaller by the share that is left of the other end.
LAST_STEP = 4e-14
# Half the width of a jump [rad]: a node on either side. Beyond the rounding of the angle, and far below all else.
JUMP = 1e-10
# Half the width of a jump in time, of the times of its table.
INSTANT = 1e-12


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
    watches, bends = [], {}
    for crossing in crossings:
        # What depends on time switches at instants.
        if any(isinstance(node, Given) for node in reached([crossing.curve])):
            continue
        orders = {
            load: crossing.kink + _vanishes(load.velocity, crossing)
            for load, nodes in zip(loads, behind, strict=True)
            if crossing.curve in nodes
        }
        kept = [load for load, order in orders.items() if order <= 1]
        if kept:
            jumps = any(orders[load] == 0 for load in kept)
            watches.append(Watch(crossing, jumps, frozenset(load.action for load in kept)))
            if crossing.kink == 1:
                bends.setdefault(crossing.curve, []).append(crossing)
    dropped = {id(c) for many in bends.values() if len(many) > MOST_BENDS for c in many[1:-1]}
    return [watch for watch in watches if id(watch.crossing) not in dropped]


def _held(nodes: Iterable[Node]) -> list[Node]:
    return [node for node in reached(nodes) if isinstance(node, Held)]


def _vanishes(velocity: Node, crossing: Crossing) -> bool:
    """Whether a velocity is zero where a curve crosses zero: it is a multiple of that curve."""
    level = crossing.level
    if not (isinstance(level, Constant) and level.value == 0.0):
        return False
    if velocity is crossing.curve:
        return True
    if not isinstance(velocity, Operation) or velocity.symbol not in ("*", "/", "neg"):
        return False
    factors = velocity.operands[:1] if velocity.symbol == "/" else velocity.operands
    return any(_vanishes(factor, crossing) for factor in factors)


class Landmarks:
    """Finds the ends of strokes and the breaks of a machine's moments.

    Parameters
    ----------
    tabulation : Tabulation
        Of the machine, every curve that switches something among its events.
    loads : sequence of Load
    moments : sequence of (str, int)
        Actions, and the curve of the tabulation with a moment of each.
    cycle : float
        [rad].
    """

    def __init__(
        self, tabulation: Tabulation, loads: Sequence[Load], moments: Sequence[tuple[str, int]], cycle: float
    ) -> None:
        self.tabulation, self.moments, self.cycle = tabulation, tuple(moments), cycle
        functions = tabulation.functions
        graph = next(iter(functions.rows)).graph
        self.watches = watches_of(graph.crossings, loads)
        self._level_rows = [functions.rows[watch.crossing.level] for watch in self.watches]
        events = {curve: i for i, (curve, _) in enumerate(functions.events)}
        self._events = [events[watch.crossing.curve] for watch in self.watches]
        self._found = [node for node in functions.rows if isinstance(node, Found)]
        self._found_events = [events[node.curve] for node in self._found]
        # Between its turning points a curve crosses a level once at most: none is missed, however near to them.
        levelled = [
            event
            for event, watch in zip(self._events, self.watches, strict=True)
            if not isinstance(watch.crossing.level, Constant) or watch.crossing.level.value != 0.0
        ]
        itself = {events[curve] for curve in events if isinstance(curve, Position)}
        self._turning = [e for e in dict.fromkeys([*self._found_events, *levelled]) if e not in itself]
        self._by_angle = np.array([event in itself for event in self._events], bool)
        # What depends on time, or does no work, isn't judged by its moment.
        self._unjudged = {load.action for load in loads if any(isinstance(n, Given) for n in reached([load.basis]))}
        self._unjudged |= {watch for w in self.watches for watch in w.actions} - {action for action, _ in moments}

    def __call__(self, numbers: Numbers, direction: np.ndarray) -> tuple[Ends, Breaks]:
        """Ends of strokes that something depends on, and the breaks of all actions.

        Parameters
        ----------
        numbers : Numbers
        direction : ndarray (variants,)
            +1 or −1, the sign of the crank's speed.
        """
        parameters = self.tabulation.parameters(numbers, direction)
        ends: dict[Found, np.ndarray] = {}
        q, values = self._samples(parameters)
        if self._turning:
            # Rates follow their curves.
            rates = 2 * np.array(self._turning) + 1
            turns, which = self._places(parameters, rates, np.zeros((rates.size, direction.size)), q, values)
            at_turns = self.tabulation.events(parameters, turns)
            q, values = _merged(q, values, turns, at_turns)
            for node, event in zip(self._found, self._found_events, strict=True):
                own = which == self._turning.index(event)
                ends[node] = _end(node.which, at_turns[2 * event, own], turns[own])
            parameters = self.tabulation.parameters(numbers, direction, ends)
        angles, which = self._crossed(parameters, q, values)
        jumps = np.array([self.watches[i].jumps for i in which], bool)
        actions, acting = self._acting(parameters, angles, which)
        return ends, Breaks(angles, jumps, actions, acting)

    def _samples(self, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions over the cycle, and all curves there."""
        samples = max(8, int(SAMPLES_PER_TURN * self.cycle / (2 * math.pi)))
        q = np.repeat(np.linspace(0.0, self.cycle, samples + 1)[:, None], parameters.shape[1], axis=1)
        searched = bool(self._turning) or not self._by_angle.all()
        return q, self.tabulation.events(parameters, q) if searched else np.empty((0, *q.shape))

    def _places(
        self, parameters: np.ndarray, rows: np.ndarray, levels: np.ndarray, q: np.ndarray, values: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Angles at which rows of the events pass their levels, and which of them each is of."""
        left, right, which = brackets(values, rows, levels, q)

        def excess(at: np.ndarray) -> np.ndarray:
            found = self.tabulation.events(parameters, at)
            return found[rows[which], np.arange(which.size)] - levels[which]

        return (regula_falsi(excess, left, right) if which.size else left), which

    def _crossed(self, parameters: np.ndarray, q: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Angles of all places, (places, variants), and the watch of each."""
        fixed, searched = np.flatnonzero(self._by_angle), np.flatnonzero(~self._by_angle)
        levels = parameters[self._level_rows]
        angles, which = levels[fixed], fixed
        if searched.size:
            rows = 2 * np.array(self._events)[searched]
            found, of = self._places(parameters, rows, levels[searched], q, values)
            angles, which = np.concatenate((angles, found)), np.concatenate((which, searched[of]))
        return angles, which

    def _acting(
        self, parameters: np.ndarray, angles: np.ndarray, which: np.ndarray
    ) -> tuple[tuple[str, ...], np.ndarray]:
        """Actions that have a break at all, and where their moments aren't zero on both sides of it."""
        actions = tuple(sorted(frozenset().union(*(watch.actions for watch in self.watches))))
        acting = np.zeros((len(actions), *angles.shape), bool)
        if not angles.size:
            return actions, acting
        beside = np.concatenate((angles - JUMP, angles + JUMP))
        still = [np.zeros_like(beside)] * len(self.tabulation.given)
        rows = self.tabulation(parameters, beside, still).reshape(-1, 2, *angles.shape)
        for i, name in enumerate(actions):
            owned = np.array([name in self.watches[w].actions for w in which])
            moves = np.zeros(angles.shape, bool)
            for action, row in self.moments:
                if action == name:
                    moves |= (rows[row] != 0.0).any(axis=0)
            acting[i] = owned[:, None] & (moves | (name in self._unjudged)) & ~np.isnan(angles)
        return actions, acting


def instants_of(scene: Scene, active: Iterable[str]) -> np.ndarray:
    """Times at which moments over time jump or bend [s], on both sides of a jump, in order."""
    found = []
    for name, action in (scene.forces | scene.moments).items():
        if name in active and getattr(action, "over_time", None) is not None:
            width = INSTANT * (abs(action.over_time[0]) + abs(action.over_time[-1]))
            for x, kink in _instants(kinks_of(action)).items():
                found += [x - width, x + width] if kink == 0 else [x]
    return np.unique(found)


def _instants(kinks: Mapping[float, int]) -> dict[float, int]:
    """Rows of a table at which it jumps or bends."""
    bends = [x for x, kink in kinks.items() if kink == 1]
    dropped = bends[1:-1] if len(bends) > MOST_BENDS else []
    return {x: kink for x, kink in kinks.items() if kink <= 1 and x not in dropped}


def _end(which: str, reached_values: np.ndarray, turns: np.ndarray) -> np.ndarray:
    """An end of a stroke, or its place, from the coordinate at its dead centres, (dead centres, variants)."""
    high = which.startswith("high")
    values = np.where(np.isnan(reached_values), -np.inf if high else np.inf, reached_values)
    at = values.argmax(axis=0) if high else values.argmin(axis=0)
    columns = np.arange(values.shape[1])
    return (turns if which.endswith("_at") else reached_values)[at, columns]


@over_variants
def merge(
    begin: int,
    end: int,
    q: np.ndarray,
    values: np.ndarray,
    others: np.ndarray,
    at_others: np.ndarray,
    every: np.ndarray,
    at_every: np.ndarray,
) -> None:
    """Put samples of each variant and others into one order; variants innermost, as they lie in memory.

    Parameters
    ----------
    begin, end : int
        Variants to work on, `end` not among them.
    q, others : ndarray (samples or others, variants)
        Angles in rising order; of the others, NaN comes last, where a variant has none.
    values, at_others : ndarray (variables, samples or others, variants)
    every, at_every : ndarray
        Receive as many angles as both together, and the values there; what is left over repeats the last one.
    """
    samples, more = q.shape[0], others.shape[0]
    taken, from_others = np.zeros(end - begin, np.int64), np.empty(end - begin, np.bool_)
    for j in range(samples + more):
        for v in range(begin, end):
            k = taken[v - begin]
            last = min(j - k, samples - 1)
            # NaN is before nothing.
            one_more = k < more and (others[k, v] < q[last, v] or (j - k >= samples and others[k, v] >= q[last, v]))
            every[j, v] = others[k, v] if one_more else q[last, v]
            from_others[v - begin] = one_more
        for r in range(values.shape[0]):
            for v in range(begin, end):
                k = taken[v - begin]
                last = min(j - k, samples - 1)
                at_every[r, j, v] = at_others[r, k, v] if from_others[v - begin] else values[r, last, v]
        for i in range(end - begin):
            taken[i] += from_others[i]


def _merged(
    q: np.ndarray, values: np.ndarray, others: np.ndarray, at_others: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Samples and values in order, with others among them; as of `merge`."""
    samples = q.shape[0] + others.shape[0]
    every, at_every = np.empty((samples, q.shape[1])), np.empty((values.shape[0], samples, q.shape[1]))
    order = np.argsort(others, axis=0)
    others, at_others = np.take_along_axis(others, order, 0), np.take_along_axis(at_others, order[None], 1)
    merge(q.shape[1], q, values, others, at_others, every, at_every)
    return every, at_every


def brackets(
    values: np.ndarray, rows: np.ndarray, levels: np.ndarray, q: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Intervals in which rows pass their levels.

    Parameters
    ----------
    values : ndarray (rows, samples, variants)
    rows : ndarray (watches,) of int
        Row of each watch.
    levels : ndarray (watches, variants)
    q : ndarray (samples, variants)

    Returns
    -------
    left, right : ndarray (places, variants)
        NaN where a variant has no such place.
    which : ndarray (places,) of int
        Watch of each place.
    """
    watches, count = levels.shape
    counts = np.zeros((watches, count), np.int64)
    nothing = np.zeros((watches, 0, count))
    crossings(count, values, rows, levels, q, counts, nothing, nothing)
    most = counts.max(axis=1, initial=0)
    left, right = np.full((2, watches, int(most.max(initial=0)), count), np.nan)
    crossings(count, values, rows, levels, q, counts, left, right)
    kept = [(i, k) for i in range(watches) for k in range(most[i])]
    index = np.array(kept, int).reshape(-1, 2).T
    return left[index[0], index[1]], right[index[0], index[1]], index[0]


@over_variants
def crossings(
    begin: int,
    end: int,
    values: np.ndarray,
    rows: np.ndarray,
    levels: np.ndarray,
    q: np.ndarray,
    counts: np.ndarray,
    left: np.ndarray,
    right: np.ndarray,
) -> None:
    """Count the intervals in which each row passes its level, and write down as many as there is room for."""
    for i in range(rows.shape[0]):
        row = values[rows[i]]
        counts[i, begin:end] = 0
        for j in range(q.shape[0] - 1):
            for v in range(begin, end):
                if (row[j, v] > levels[i, v]) != (row[j + 1, v] > levels[i, v]):
                    k = counts[i, v]
                    if k < left.shape[1]:
                        left[i, k, v], right[i, k, v] = q[j, v], q[j + 1, v]
                    counts[i, v] = k + 1


def regula_falsi(f: Callable[[np.ndarray], np.ndarray], a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Roots between a and b, where f changes sign, by regula falsi with Anderson's and Björck's weights.

    Parameters
    ----------
    f : callable
        Of an array like a, to an array like a.
    a, b : ndarray
        NaN stays.
    """
    fa, fb = f(a), f(b)
    moving, small = np.isfinite(fa + fb), LAST_STEP * np.abs(b - a)
    for _ in range(ITERATIONS):
        with np.errstate(all="ignore"):
            c = b - fb * (b - a) / (fb - fa)
        # A root that is found stays as it is, however long the others take.
        c = np.where(moving & np.isfinite(c), c, b)
        fc = f(c)
        moving &= np.abs(c - b) > small
        crossed = (fc > 0.0) != (fb > 0.0)
        with np.errstate(all="ignore"):
            less = 1.0 - fc / fb
        a, fa = np.where(crossed, b, a), np.where(crossed, fb, np.where(less > 0.0, less, 0.5) * fa)
        b, fb = c, fc
        if not moving.any():
            break
    return b
