"""Landmarks of a cycle: the ends of strokes, and where the reduced moment jumps or bends.

A Runge–Kutta step across a jump or a bend loses its order; with a node there it doesn't. Each such place is where a
row of the mechanism (a slide coordinate, a velocity) passes a level, or an angle that the scene names. Rows are
sampled over the cycle; within the interval where one passes its level, regula falsi finds the place.
"""

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from engine.compiling.jit import over_variants
from engine.machine.model import Model
from engine.panels.tabulation import Ends, Tabulation
from engine.scene.actions import Tabled
from engine.scene.cylinders import Compressor, Cylinder, TwoStroke
from engine.scene.parts import CrankInput
from engine.scene.scene import Numbers

# Characteristics with more rows than this are taken as smooth but for their steps.
MOST_BENDS = 24
SAMPLES_PER_TURN = 60
ITERATIONS = 20
# A last step of this share of the bracket: the error it leaves is smaller by the share that is left of the other end.
LAST_STEP = 4e-14
# Half the width of a jump in time, of the times of its table.
INSTANT = 1e-12


class Watch(NamedTuple):
    """What makes an action's moment jump or bend.

    Attributes
    ----------
    action : str
    variable : str
        Of the program.
    level : float or ndarray (variants,)
        Value of the variable at which it does.
    jumps : bool
    along : str
        Velocity on whose sign it depends whether the action acts at all; "" where it always does.
    way : float
        That sign, of the velocity with the crank turning forward.
    """

    action: str
    variable: str
    level: float | np.ndarray
    jumps: bool
    along: str = ""
    way: float = 0.0


class Breaks(NamedTuple):
    """Angles [rad], (places, variants), NaN where a variant has none; which are jumps, and whose, each (places,)."""

    angles: np.ndarray
    jumps: np.ndarray
    actions: np.ndarray

    def some(self, chosen: np.ndarray) -> "Breaks":
        """Breaks of some of the variants, by index."""
        return Breaks(np.ascontiguousarray(self.angles[:, chosen]), self.jumps, self.actions)

    def two_sided(self) -> "Breaks":
        """Breaks with places on both sides of each, as if all were jumps."""
        return self._replace(jumps=np.ones_like(self.jumps))

    def of(self, active: frozenset[str]) -> "Breaks":
        """Breaks of some of the actions."""
        chosen = np.isin(self.actions, list(active))
        return Breaks(self.angles[chosen], self.jumps[chosen], self.actions[chosen])


class Landmarks:
    """Finds the ends of strokes and the breaks of a model's moments.

    Parameters
    ----------
    model : Model
    """

    def __init__(self, model: Model) -> None:
        self.model = model
        drive = model.scene.input
        self.cycle = 2 * math.pi * drive.revolutions if isinstance(drive, CrankInput) else math.nan
        self.sliders = sorted({s for a in self._tables().values() if (s := a.slider)} | self._pistons())
        variables = {watch.variable for watch in self._watches(None, self._no_ends())}
        slides = [model.mechanism.slides[name] for name in self.sliders]
        variables |= {v for slide in slides for v in (slide.d, slide.dv)}
        self.variables = sorted(variables)
        self.tabulation = Tabulation(model, {name: name for name in self.variables}) if variables else None

    @property
    def watches(self) -> bool:
        """Whether there is anything to watch: tables, cylinders, or actions that follow the way of motion."""
        return self.tabulation is not None or bool(self._tables())

    def _tables(self) -> dict[str, Tabled]:
        scene = self.model.scene
        return {n: a for t in (scene.forces, scene.moments) for n, a in t.items() if isinstance(a, Tabled)}

    def _pistons(self) -> set[str]:
        return {cylinder.piston for cylinder in self.model.scene.cylinders.values()}

    def _no_ends(self) -> dict[str, Ends]:
        return {name: Ends(0.0, 1.0, 0.0, 0.0) for name in self.sliders}

    # What to watch

    def _watches(self, numbers: Numbers | None, ends: Mapping[str, Ends]) -> list[Watch]:
        """What to watch; without numbers, only the variables are right."""
        scene, slides, found = self.model.scene, self.model.mechanism.slides, []
        for table in (scene.forces, scene.moments):
            for name, action in table.items():
                along = self.model.moments.along.get(name)
                turns = getattr(action, "acts", "always") != "always" or action.type == "against_motion"
                if turns and along not in (None, "one", "zero"):
                    found.append(Watch(name, along, 0.0, False))
        for name, action in self._tables().items():
            if action.over_stroke is not None:
                found += self._on_stroke(name, action, slides[action.slider].d, ends[action.slider])
        for name, cylinder in scene.cylinders.items():
            found.append(Watch(name, slides[cylinder.piston].dv, 0.0, False))
            found += self._valves(name, cylinder, slides[cylinder.piston].d, numbers, ends[cylinder.piston])
        return found

    def _on_stroke(self, name: str, action: Tabled, d: str, end: Ends) -> list[Watch]:
        along, way = self.model.moments.along.get(name, ""), {"along": 1.0, "against": -1.0}.get(action.acts, 0.0)
        if not way or along in ("one", "zero"):
            along = ""
        found = []
        for x, jumps in table_breaks(action):
            level = {"guide": x, "low end": end.low + x, "high end": end.high - x}[action.measured_from]
            found.append(Watch(name, d, level, jumps, along, way))
        return found

    @staticmethod
    def _valves(name: str, cylinder: Cylinder, d: str, n: Numbers | None, end: Ends) -> list[Watch]:
        if not isinstance(cylinder, (Compressor, TwoStroke)):
            return []
        if n is None:
            return [Watch(name, d, 0.0, False)]
        at, stroke = f"cylinders.{name}", end.high - end.low
        if isinstance(cylinder, TwoStroke):
            travels = [(n[f"{at}.port"] * stroke, True)]
        else:
            least = n[f"{at}.clearance"] * stroke
            ratio = n[f"{at}.discharge"] / n[f"{at}.suction"]
            opens = (stroke + least) * ratio ** (-1.0 / n[f"{at}.n_compression"]) - least
            travels = [(opens, False), (least * ratio ** (1.0 / n[f"{at}.n_expansion"]) - least, False)]
        sign = -1.0 if cylinder.head == "high" else 1.0
        base = end.high if cylinder.head == "high" else end.low
        return [Watch(name, d, base + sign * travel, jumps) for travel, jumps in travels]

    # Where they are

    def __call__(self, numbers: Numbers, count: int, direction: np.ndarray) -> tuple[dict[str, Ends], Breaks]:
        """Ends of stroke of the sliders that something depends on, and the breaks of all actions.

        Parameters
        ----------
        numbers : Numbers
        count : int
        direction : ndarray (variants,)
        """
        fixed = self._at_angles(count)
        if self.tabulation is None:
            return {}, fixed
        parameters = self.tabulation.parameters(numbers, count, direction)
        samples = max(8, int(SAMPLES_PER_TURN * self.cycle / (2 * math.pi)))
        q = np.repeat(np.linspace(0.0, self.cycle, samples + 1)[:, None], count, axis=1)
        values = self.tabulation(parameters, {}, q)
        slides = self.model.mechanism.slides

        def places(
            variables: list[str], levels: np.ndarray, q: np.ndarray, values: np.ndarray
        ) -> tuple[np.ndarray, np.ndarray]:
            """Angles at which variables pass their levels, and of which of them each is."""
            rows = np.array([self.variables.index(v) for v in variables])
            left, right, which = brackets(values, rows, levels, q)

            def excess(at: np.ndarray) -> np.ndarray:
                found = self.tabulation(parameters, {}, at)
                return found[rows[which], np.arange(which.size)] - levels[which]

            return (regula_falsi(excess, left, right) if which.size else left), which

        ends: dict[str, Ends] = {}
        if self.sliders:
            turns, which = places([slides[s].dv for s in self.sliders], np.zeros((len(self.sliders), count)), q, values)
            reached = self.tabulation(parameters, {}, turns)
            # Between its dead centres a slider passes a level once at most: none is missed, however near to them.
            q, values = _merged(q, values, turns, reached)
            for i, name in enumerate(self.sliders):
                ends[name] = _ends(reached[self.variables.index(slides[name].d), which == i], turns[which == i])
        watches = self._watches(numbers, ends)
        if not watches:
            return ends, fixed
        levels = np.array([np.broadcast_to(w.level, count) for w in watches])
        found, which = places([w.variable for w in watches], levels, q, values)
        if any(w.along for w in watches):
            rows = self.tabulation(parameters, {}, found)
            for i, watch in enumerate(watches):
                if watch.along:
                    acts = watch.way * direction * rows[self.variables.index(watch.along)] >= 0.0
                    found[(which == i)[:, None] & ~acts] = np.nan
        jumps = np.array([w.jumps for w in watches])[which]
        actions = np.array([w.action for w in watches])[which]
        return ends, Breaks(
            np.concatenate((fixed.angles, found)),
            np.concatenate((fixed.jumps, jumps)),
            np.concatenate((fixed.actions, actions)),
        )

    def _at_angles(self, count: int) -> Breaks:
        """Breaks of tables over the crank angle."""
        rows = [
            (x, jumps, name)
            for name, action in self._tables().items()
            if action.over_angle is not None
            for x, jumps in table_breaks(action)
        ]
        angles = np.array([x for x, _, _ in rows]).reshape(-1, 1)
        return Breaks(
            np.repeat(angles, count, axis=1),
            np.array([j for _, j, _ in rows], bool),
            np.array([a for *_, a in rows], str),
        )


def instants_of(model: Model, active: frozenset[str]) -> np.ndarray:
    """Times at which moments over time jump or bend [s], on both sides of a jump, in order."""
    scene, found = model.scene, []
    for name, action in (scene.forces | scene.moments).items():
        if name in active and getattr(action, "over_time", None) is not None:
            width = INSTANT * (abs(action.over_time[0]) + abs(action.over_time[-1]))
            for x, jumps in table_breaks(action):
                found += [x - width, x + width] if jumps else [x]
    return np.unique(found)


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


def _ends(reached: np.ndarray, turns: np.ndarray) -> Ends:
    """Ends of a stroke from the coordinate at its dead centres, (dead centres, variants)."""
    columns = np.arange(reached.shape[1])
    low, high = (np.where(np.isnan(reached), x, reached) for x in (np.inf, -np.inf))
    first, last = low.argmin(axis=0), high.argmax(axis=0)
    return Ends(reached[first, columns], reached[last, columns], turns[first, columns], turns[last, columns])


def table_breaks(action: Tabled) -> list[tuple[float, bool]]:
    """Where a table jumps (True) or bends (False)."""
    x, y = np.array(action.abscissae), np.array(action.ordinates)
    steps = {float(v) for v in x[1:][np.diff(x) == 0.0]}
    if action.over_angle is None and action.outside == "zero":
        steps |= {float(x[i]) for i in (0, -1) if y[i] != 0.0}
    bends = {float(v) for v in x} if action.interpolation == "linear" and x.size <= MOST_BENDS else {x[0], x[-1]}
    return [(v, v in steps) for v in sorted(steps | {float(b) for b in bends})]


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
