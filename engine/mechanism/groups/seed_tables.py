"""Seed tables of a group of free links for every variant: from the scene's assembly mode along the input.

Assembly modes have no natural order. The scene's mode is the real one at the first position that is nearest to the
points in `near`. It is continued to a variant by steps in the scene's numbers, and along the input by steps in
position. Each step is proved by the Newton–Kantorovich theorem, or halved.
"""

import math
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from engine import mechanism
from engine.graph.nodes import Node
from engine.graph.values import NodeValues
from engine.laws.kinematics.seeds import LEAST_SHARE, PROVES, SAME, same_unknowns
from engine.mechanism.input_motion import input_span
from engine.mechanism.vectors import Vector
from engine.scene.scene import Numbers, Scene, SceneError, scene_numbers
from engine.scene.structure.free_groups import FreeGroup, cutting_of
from engine.units.display import quantity_text
from engine.words.verdicts import Verdict

# Capacity of a table, in intervals per turn of the input and in addition; the longest interval as a share of a turn.
# Intervals concentrate where two modes approach each other, the more the closer they get.
_EACH_TURN, _EXTRA, _LONGEST_INTERVAL = 20, 44, 1.0 / 16.0
# Unknowns at the first position are rounded to this share before they are corrected, so that nothing depends on the
# path of continuation.
_COARSE, _FINAL_CORRECTIONS = 2.0**-26, 3
# Middle of the turn in which angles at the first position lie: its ends are no usual direction of a link [rad].
_SEAM = 0.3
# Starting points of the search for modes, and corrections of each.
_STARTS, _CORRECTIONS = 4096, 60
# Maximum correction [rad, or units of the group's size], so that none jumps across a mode.
_LONGEST = 0.5
# The nearer of two modes is selected if the other is farther by at least this share of the distance.
_NEARER = 0.02
# Continuation steps from the scene to a variant, as shares of the distance: first, longest, shortest before failure.
_FIRST_STEP, _LONGEST_STEP, _SHORTEST_STEP = 0.125, 0.25, 1e-5


class SeedAnswers(NamedTuple):
    """Seed tables of some variants.

    Attributes
    ----------
    seeds : ndarray (entries, variants)
        NaN beyond the end of a path.
    verdict : ndarray (variants,) of int
    at : ndarray (variants,)
        Position at which a path ends; NaN if it does not.
    """

    seeds: np.ndarray
    verdict: np.ndarray
    at: np.ndarray


class AssemblyMode(NamedTuple):
    """An assembly mode of a group at the first position.

    Attributes
    ----------
    unknowns : ndarray (values,)
        Angles [rad] and slides [m].
    points : dict of str to (float, float)
        Positions of the group's points [m].
    transmission : float
        Transmission index.
    chosen : bool
        Whether it is the scene's mode.
    """

    unknowns: np.ndarray
    points: dict[str, tuple[float, float]]
    transmission: float
    chosen: bool


class ModeNotGiven(SceneError):
    """A group has several assembly modes, and the scene does not select one."""


class SeedTables:
    """Seed tables of a group of free links.

    Parameters
    ----------
    scene : Scene
    group : FreeGroup
    given : sequence of Node
        Given numbers for the values of the unknowns: angles and slides.
    curves : sequence of Node
        At these values: corrections, first and second rates of all unknowns; the certificate, the transmission index,
        the group's size.
    points : mapping of str to Vector
        Positions of the group's points.

    Attributes
    ----------
    intervals, entries : int
        Capacity of a table in intervals, and in numbers.
    slides : ndarray of bool
        Which unknowns are slides; the others are angles.
    """

    def __init__(
        self,
        scene: Scene,
        group: FreeGroup,
        given: Sequence[Node],
        curves: Sequence[Node],
        points: Mapping[str, Vector],
    ) -> None:
        self.scene, self.group, self._given, self._curves, self._points = scene, group, given, curves, points
        self._revolutions = scene.input.revolutions if scene.has_cycle else 1
        self.intervals = _EACH_TURN * self._revolutions + _EXTRA
        self.entries = (self.intervals + 1) * (1 + 3 * len(given))
        self.slides = np.array([pair.kind == "prismatic" for _, pair in cutting_of(group).placed])
        self._of_thread = threading.local()

    @cached_property
    def _walk(self) -> "mechanism.groups.seed_walk.SeedWalk":
        # Compiled code is loaded on first use.
        span = input_span(self.scene, self._given[0].graph)
        return mechanism.groups.seed_walk.SeedWalk(self._given, self._curves, span, self.slides)

    @property
    def _own(self) -> Numbers:
        """The scene's numbers, unvaried."""
        return Numbers(scene_numbers(self.scene), {})

    def _at(self, numbers: Numbers) -> Callable[[np.ndarray], np.ndarray]:
        """Function that evaluates the curves at given unknowns and the first position, (curves, points)."""
        table = self._walk.table(numbers)
        return lambda unknowns: self._walk.curves(table, np.resize(table[0], unknowns.shape[1]), unknowns)

    # Modes of the scene

    @cached_property
    def modes(self) -> tuple[AssemblyMode, ...]:
        """All real assembly modes of the scene at the first position.

        Several thousand starting points are tried; each mode found is proved.
        """
        at, count = self._at(self._own), self.slides.size
        unknowns = self._starts(float(at(self._starts(1.0)[:, :1])[-1, 0]))
        # A start with a singular Jacobian is lost; the others suffice.
        with np.errstate(all="ignore"):
            for _ in range(_CORRECTIONS):
                found = at(unknowns)
                limits = _LONGEST * np.where(self.slides[:, None], found[-1], 1.0)
                unknowns = unknowns + np.clip(found[:count], -limits, limits)
            found = at(unknowns)
            proved = (found[3 * count] <= PROVES) & (np.abs(found[:count]) < SAME).all(axis=0)
        roots: list[np.ndarray] = []
        for root in unknowns[:, proved].T:
            if not any(same_unknowns(root, other, self.slides) for other in roots):
                roots.append(root)
        roots.sort(key=lambda root: np.where(self.slides, root, [np.cos(root), np.sin(root)]).T.round(6).tolist())
        return self._described(roots)

    def _starts(self, size: float) -> np.ndarray:
        random = np.random.default_rng(1)
        return np.array(
            [
                random.choice([-1.0, 1.0], _STARTS) * size * 10.0 ** random.uniform(-1.5, 1.0, _STARTS)
                if slides
                else random.uniform(-np.pi, np.pi, _STARTS)
                for slides in self.slides
            ]
        )

    def _described(self, roots: list[np.ndarray]) -> tuple[AssemblyMode, ...]:
        if not roots:
            return ()
        unknowns = np.array(roots).T
        sines, places = self._at(self._own)(unknowns)[-2], self._places(self._own, unknowns)
        chosen = self._nearest(places)
        return tuple(
            AssemblyMode(root, at, float(sine), i == chosen)
            for i, (root, at, sine) in enumerate(zip(roots, places, sines, strict=True))
        )

    def _places(self, numbers: Numbers, unknowns: np.ndarray) -> list[dict[str, tuple[float, float]]]:
        """Positions of the group's points at the first position, for each column of unknowns."""
        q, known = np.resize(self._walk.table(numbers)[0], unknowns.shape[1]), zip(self._given, unknowns, strict=True)
        nodes, values = [node for r in self._points.values() for node in r], NodeValues(self._given[0].graph, numbers)
        places = np.reshape(values(nodes, q, dict(known)), (len(self._points), 2, q.size))
        return [dict(zip(self._points, map(tuple, own.tolist()), strict=True)) for own in np.moveaxis(places, 2, 0)]

    def near_points(self, numbers: Numbers) -> dict[str, tuple[float, float]] | None:
        """Positions of the points in `near` for one variant; None if its mode isn't reached."""
        chosen = [mode for mode in self.modes if mode.chosen]
        if not chosen:
            return None
        start, _, arrived = self._carried(numbers, chosen[0])
        if not arrived.all():
            return None
        (places,) = self._places(numbers, self._polished(numbers, start))
        return {name: places[name] for name in self.scene.near if name in places}

    def _nearest(self, places: list[dict[str, tuple[float, float]]]) -> int | None:
        """Index of the mode selected by the scene; None if it is ambiguous."""
        given = [name for name in self.scene.near if name in self._points]
        if not given:
            return 0 if len(places) == 1 else None
        wanted = [x for name in given for x in (self.scene.near[name].x, self.scene.near[name].y)]
        far = [math.dist([x for name in given for x in at[name]], wanted) for at in places]
        order = np.argsort(far)
        if len(far) > 1 and not far[order[1]] > (1.0 + _NEARER) * far[order[0]]:
            return None
        return int(order[0])

    def check(self) -> None:
        """Check that the scene selects an assembly mode.

        Raises
        ------
        ModeNotGiven
            The group has several modes, and `near` selects none of them.
        """
        if self.modes and not any(mode.chosen for mode in self.modes):
            words = f"{', '.join(self.group.links)} have {len(self.modes)} assembly modes at the first position"
            if not self._points:
                mend = f'points.NAME = {{ link = "{self.group.links[0]}", x = "…", y = "…" }}, away from its joints'
                raise ModeNotGiven([("near", f"{words}, and they have no point to select one: give them {mend}")])
            point = max(self._points, key=lambda name: _least_distance([m.points[name] for m in self.modes]))
            listed = "; ".join(
                f"({quantity_text(x, 'm')}, {quantity_text(y, 'm')})"
                for x, y in (mode.points[point] for mode in self.modes)
            )
            mend = f'near.{point} = {{ x = "…", y = "…" }}'
            pointed = any(name in self.scene.near for name in self._points)
            ending = "and near is equally far from two of them" if pointed else "and the mode is ambiguous"
            raise ModeNotGiven([("near", f"{words}, {ending}: give {mend}; {point} may lie at {listed}")])

    # Tables

    def __call__(self, numbers: Numbers) -> SeedAnswers:
        """Tables of all variants; the last result is cached per thread."""
        mine = self._of_thread.__dict__
        if mine.get("numbers") is not numbers:
            mine["answers"], mine["numbers"] = self._made(numbers), numbers
        return mine["answers"]

    def _made(self, numbers: Numbers) -> SeedAnswers:
        self.check()
        first, last = self._walk.table(numbers)[:2]
        chosen = [mode for mode in self.modes if mode.chosen]
        if not chosen:
            seeds = np.full((self.entries, first.size), np.nan)
            return SeedAnswers(seeds, np.full(first.size, int(Verdict.CANNOT_ASSEMBLE)), first.copy())
        start, sines, arrived = self._carried(numbers, chosen[0])
        paths = self.walked(numbers, self._polished(numbers, start), sines)
        paths.seeds[:, ~arrived] = np.nan
        where = [~arrived, ~paths.closes, ~np.isnan(paths.ends_at), ~np.isnan(paths.short_at)]
        verdicts = [Verdict.MODE_NOT_REACHED, Verdict.OTHER_MODE, Verdict.SINGULAR, Verdict.MODE_NOT_REACHED]
        at = np.select(where, [first, last, paths.ends_at, paths.short_at], np.nan)
        return SeedAnswers(paths.seeds, np.select(where, list(map(int, verdicts)), int(Verdict.OK)), at)

    def walked(self, numbers: Numbers, start: np.ndarray, sines: np.ndarray) -> "mechanism.groups.seed_walk.SeedPaths":
        """Paths from the unknowns at the first position, with their transmission index."""
        longest = _LONGEST_INTERVAL / self._revolutions
        return self._walk(self._walk.table(numbers), start, sines, self.intervals, longest, self.scene.has_cycle)

    def _polished(self, numbers: Numbers, unknowns: np.ndarray) -> np.ndarray:
        """Unknowns at the first position, bitwise independent of the continuation: rounded, then corrected."""
        at, slides = self._at(numbers), self.slides[:, None]
        with np.errstate(all="ignore"):
            steps = _COARSE * np.where(slides, np.exp2(np.floor(np.log2(at(unknowns)[-1]))), 1.0)
            turned = np.where(slides, 0.0, math.tau * np.rint((unknowns - _SEAM) / math.tau))
            rounded = np.rint((unknowns - turned) / steps) * steps
            for _ in range(_FINAL_CORRECTIONS):
                rounded = rounded + at(rounded)[: slides.size]
        return rounded

    def _carried(self, numbers: Numbers, mode: AssemblyMode) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The scene's mode at the first position of each variant, its transmission index, whether it was reached."""
        rows, own, count = self._walk.table(numbers), self._walk.table(self._own), self.slides.size
        variants = rows.shape[1]
        unknowns, sines = np.repeat(mode.unknowns[:, None], variants, axis=1), np.full(variants, mode.transmission)
        rates, step = np.zeros_like(unknowns), np.full(variants, _FIRST_STEP)
        progress = ((rows == own) | np.isnan(own)).all(axis=0).astype(float)
        while True:
            going = (progress < 1.0) & (step > _SHORTEST_STEP)
            if not going.any():
                return unknowns, sines, progress >= 1.0
            ahead = np.where(going, np.minimum(progress + step, 1.0), progress)
            at = self._at(numbers.interpolated(ahead if variants > 1 else ahead[0]))
            with np.errstate(all="ignore"):
                moved = unknowns + rates * (ahead - progress)
                found = at(moved)
                accepted = going & (found[3 * count] <= PROVES)
                for _ in range(4 if accepted.any() else 0):
                    moved = moved + found[:count]
                    found = at(moved)
                sine = found[3 * count + 1]
                accepted &= (np.abs(found[:count]) < SAME).all(axis=0)
                accepted &= sine / sines > LEAST_SHARE
                # The next step starts from the secant through the last two points.
                rates = np.where(accepted, (moved - unknowns) / (ahead - progress), rates)
            sines = np.where(accepted, sine, sines)
            unknowns = np.where(accepted, moved, unknowns)
            progress = np.where(accepted, ahead, progress)
            step = np.where(accepted, np.minimum(2.0 * step, _LONGEST_STEP), np.where(going, 0.5 * step, step))


def _least_distance(places: Sequence[tuple[float, float]]) -> float:
    """Smallest distance between two of the points."""
    found = np.array(places) @ np.array([1.0, 1j])
    apart = np.abs(found[:, None] - found[None, :]) + np.where(np.eye(len(found), dtype=bool), np.inf, 0.0)
    return float(apart.min())
