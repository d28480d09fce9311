"""Tables of seeds of a group of free links, for every variant: from the scene's own assembly mode along the input.

Modes have no natural numbers. The mode of the scene is that of its real ones at the first position that lies nearest to
what `near` tells. It is carried to a variant by steps in the scene's numbers, and along the input by steps in its
position; every step is one that the theorem of Newton and Kantorovich proves, or it is halved.
"""

import threading
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from engine import mechanism
from engine.graph.nodes import Node, Number, reached
from engine.graph.values import NodeValues
from engine.laws.kinematics.seeds import LEAST_SHARE, PROVES
from engine.mechanism.vectors import Vector
from engine.scene.scene import Numbers, Scene, SceneError, scene_numbers
from engine.scene.structure.free_groups import FreeGroup
from engine.units.display import quantity_text
from engine.words.verdicts import Verdict

# Intervals of a table that there is room for, in each turn of the input and in addition, and the longest, as a share of
# a turn: a few beside each place where two modes come near to each other, the more the nearer they come.
_EACH_TURN, _BESIDE, _LONGEST_INTERVAL = 20, 44, 1.0 / 16.0
# Unknowns at the first position are rounded to this share before they are corrected, so that nothing depends on the way
# that led there.
_COARSELY, _SETTLING = 2.0**-26, 3
# Starts from which modes are looked for, and corrections of each.
_STARTS, _CORRECTIONS = 4096, 60
# Corrections no longer than this [rad, or shares of the group's size], so that none leaps across a mode.
_LONGEST = 0.5
# Modes are the same whose unknowns differ by no more.
_SAME = 1e-6
# Of two modes the nearer one is meant where the other is farther by this share of its distance.
_NEARER = 0.02
# Steps from the scene to a variant, as shares of the way: the first, the longest, and the shortest before giving up.
_FIRST_STEP, _LONGEST_STEP, _SHORTEST_STEP = 0.125, 0.25, 1e-5


class SeedAnswers(NamedTuple):
    """Tables of some variants.

    Attributes
    ----------
    seeds : ndarray (entries, variants)
        NaN from where a path ends.
    verdict : ndarray (variants,) of int
    at : ndarray (variants,)
        Position at which a path ends; NaN where none does.
    """

    seeds: np.ndarray
    verdict: np.ndarray
    at: np.ndarray


class AssemblyMode(NamedTuple):
    """A way to put a group together at the first position.

    Attributes
    ----------
    unknowns : ndarray (values,)
        Cosines and sines of angles, slides.
    points : dict of str to (float, float)
        Where the group's points lie [m].
    transmission : float
        Its quality of transmission.
    chosen : bool
        Whether it is the scene's.
    """

    unknowns: np.ndarray
    points: dict[str, tuple[float, float]]
    transmission: float
    chosen: bool


class ModeNotTold(SceneError):
    """A scene doesn't tell the assembly mode of a group that has several."""


class SeedTables:
    """Tables of seeds of a group of free links.

    Parameters
    ----------
    scene : Scene
    group : FreeGroup
    given : sequence of tuple of Node
        Of each unknown the given numbers that hold its value: cosine and sine, or the slide.
    curves : sequence of Node
        At these values: corrections, first and second rates of all unknowns; the certificate, the quality of
        transmission, the group's size.
    points : mapping of str to Vector
        Where the group's points are.
    span : tuple of Node
        First and last position of the input.
    turns : bool
        Whether the last position is the first again.

    Attributes
    ----------
    width, intervals, entries : int
        Numbers of a seed, intervals that a table has room for, and numbers of a table.
    """

    def __init__(
        self,
        scene: Scene,
        group: FreeGroup,
        given: Sequence[tuple[Node, ...]],
        curves: Sequence[Node],
        points: Mapping[str, Vector],
        span: tuple[Node, Node],
        turns: bool,
    ) -> None:
        self.scene, self.group, self._turns = scene, group, turns
        self._given, self._curves, self._points, self._span = given, curves, points, span
        self.width = 1 + sum(len(nodes) + 2 for nodes in given)
        self._revolutions = getattr(scene.input, "revolutions", 1) if turns else 1
        self.intervals = _EACH_TURN * self._revolutions + _BESIDE
        self.entries = (self.intervals + 1) * self.width
        self._slides = np.array([len(nodes) == 1 for nodes in given])
        self._of_thread = threading.local()

    @cached_property
    def _walk(self) -> "mechanism.groups.seed_walk.SeedWalk":
        # Compiled code is loaded with the first table.
        words = f"One correction of the group {self.group.name}."
        return mechanism.groups.seed_walk.SeedWalk(words, self._given, self._curves, self._span)

    @property
    def _own(self) -> Numbers:
        """The scene's own numbers."""
        return Numbers(scene_numbers(self.scene), {})

    @cached_property
    def _needed(self) -> list[Number]:
        """Numbers that the group depends on, the ends of the input's range first."""
        return list(dict.fromkeys([*self._span, *(n for n in reached(self._curves) if isinstance(n, Number))]))

    def _rows(self, numbers: Numbers) -> np.ndarray:
        """These numbers of all variants, (numbers, variants); one variant where none of them differs."""
        with np.errstate(all="ignore"):
            return np.stack(np.broadcast_arrays(np.zeros(1), *(n.compute(numbers) for n in self._needed)))[1:]

    def _at(self, numbers: Numbers, unknowns: np.ndarray, curves: Sequence[Node] | None = None) -> np.ndarray:
        """Curves at given values of the unknowns and the first position, (curves, variants)."""
        values, given = NodeValues(self._curves[0].graph, numbers), [node for nodes in self._given for node in nodes]
        with np.errstate(all="ignore"):
            q = np.broadcast_to(self._span[0].compute(numbers), unknowns.shape[1:])
        return np.array(values(curves or self._curves, q, dict(zip(given, unknowns, strict=True))))

    # Modes of the scene

    @cached_property
    def modes(self) -> tuple[AssemblyMode, ...]:
        """All real assembly modes of the scene as it is at the first position.

        They are looked for from some thousand starts; each that is found is proved.
        """
        own, count = self._own, self._slides.size
        unknowns = self._starts(float(self._at(own, self._starts(1.0)[:, :1])[-1, 0]))
        # A start at which the Jacobian is singular by chance leads nowhere.
        with np.errstate(all="ignore"):
            for _ in range(_CORRECTIONS):
                found = self._at(own, unknowns)
                limits = _LONGEST * np.where(self._slides[:, None], found[-1], 1.0)
                unknowns = self._moved(unknowns, np.clip(found[:count], -limits, limits))
            found = self._at(own, unknowns)
            proved = (found[3 * count] <= PROVES) & (np.abs(found[:count]) < _SAME).all(axis=0)
        roots: list[np.ndarray] = []
        for root in unknowns[:, proved].T:
            if not any(np.abs(root - other).max() < _SAME * max(1.0, np.abs(root).max()) for other in roots):
                roots.append(root)
        roots.sort(key=lambda root: tuple(np.round(root, 6)))
        return self._described(roots)

    def _starts(self, size: float) -> np.ndarray:
        random = np.random.default_rng(1)
        rows = []
        for slides in self._slides:
            if slides:
                rows.append(random.choice([-1.0, 1.0], _STARTS) * size * 10.0 ** random.uniform(-1.5, 1.0, _STARTS))
            else:
                angle = random.uniform(-np.pi, np.pi, _STARTS)
                rows += [np.cos(angle), np.sin(angle)]
        return np.array(rows)

    def _moved(self, unknowns: np.ndarray, deltas: np.ndarray) -> np.ndarray:
        rows, i = [], 0
        for slides, delta in zip(self._slides, deltas, strict=True):
            if slides:
                rows.append(unknowns[i] + delta)
                i += 1
            else:
                c, s = unknowns[i], unknowns[i + 1]
                rows += [c * np.cos(delta) - s * np.sin(delta), s * np.cos(delta) + c * np.sin(delta)]
                i += 2
        return np.array(rows)

    def _described(self, roots: list[np.ndarray]) -> tuple[AssemblyMode, ...]:
        if not roots:
            return ()
        unknowns = np.array(roots).T
        sines, places = self._at(self._own, unknowns)[-2], self._places(self._own, unknowns)
        chosen = self._nearest(places)
        return tuple(
            AssemblyMode(root, at, float(sine), i == chosen)
            for i, (root, at, sine) in enumerate(zip(roots, places, sines, strict=True))
        )

    def _places(self, numbers: Numbers, unknowns: np.ndarray) -> list[dict[str, tuple[float, float]]]:
        """Where the group's points lie at the first position, for each column of unknowns."""
        if not self._points:
            return [{} for _ in range(unknowns.shape[1])]
        found = self._at(numbers, unknowns, [node for point in self._points.values() for node in point])
        pairs = found.reshape(len(self._points), 2, -1)
        return [
            {name: (float(x[i]), float(y[i])) for name, (x, y) in zip(self._points, pairs, strict=True)}
            for i in range(unknowns.shape[1])
        ]

    def told_places(self, numbers: Numbers) -> dict[str, tuple[float, float]] | None:
        """Where the points that tell the scene's mode lie in one variant; None where that isn't reached.

        Parameters
        ----------
        numbers : Numbers
        """
        chosen = [mode for mode in self.modes if mode.chosen]
        if not chosen:
            return None
        start, _, arrived = self._carried(numbers, chosen[0])
        if not arrived.all():
            return None
        (places,) = self._places(numbers, self._settled(numbers, start))
        return {name: places[name] for name in self.scene.near if name in places}

    def _nearest(self, places: list[dict[str, tuple[float, float]]]) -> int | None:
        """Which mode the scene points at; None where it doesn't tell."""
        told = [name for name in self.scene.near if name in self._points]
        if not told:
            return 0 if len(places) == 1 else None
        wanted = self.scene.near
        far = [
            sum((at[name][0] - wanted[name].x) ** 2 + (at[name][1] - wanted[name].y) ** 2 for name in told) ** 0.5
            for at in places
        ]
        order = np.argsort(far)
        if len(far) > 1 and not far[order[1]] > (1.0 + _NEARER) * far[order[0]]:
            return None
        return int(order[0])

    def check(self) -> None:
        """See that the scene tells its assembly mode.

        Raises
        ------
        ModeNotTold
            It has several, and `near` tells none of them.
        """
        if self.modes and not any(mode.chosen for mode in self.modes):
            words = f"{', '.join(self.group.links)} have {len(self.modes)} assembly modes at the first position"
            if not self._points:
                mend = f'points.NAME = {{ link = "{self.group.links[0]}", x = "…", y = "…" }}, away from its joints'
                raise ModeNotTold([("near", f"{words}, and they have no point to select one: give them {mend}")])
            point = max(self._points, key=lambda name: _least_distance([m.points[name] for m in self.modes]))
            listed = "; ".join(
                f"({quantity_text(x, 'm')}, {quantity_text(y, 'm')})"
                for x, y in (mode.points[point] for mode in self.modes)
            )
            mend = f'near.{point} = {{ x = "…", y = "…" }}'
            pointed = any(name in self.scene.near for name in self._points)
            told = "and near is equally far from two of them" if pointed else "and the mode is ambiguous"
            raise ModeNotTold([("near", f"{words}, {told}: give {mend}; {point} may lie at {listed}")])

    # Tables

    def __call__(self, numbers: Numbers) -> SeedAnswers:
        """Tables of all variants; those of the last numbers are kept.

        Parameters
        ----------
        numbers : Numbers
        """
        mine = self._of_thread.__dict__
        if mine.get("numbers") is not numbers:
            mine["answers"], mine["numbers"] = self._made(numbers), numbers
        return mine["answers"]

    def _made(self, numbers: Numbers) -> SeedAnswers:
        self.check()
        first, last = self._rows(numbers)[:2]
        variants = first.size
        chosen = [mode for mode in self.modes if mode.chosen]
        verdict = np.full(variants, int(Verdict.OK))
        if not chosen:
            seeds = np.full((self.entries, variants), np.nan)
            return SeedAnswers(seeds, np.full(variants, int(Verdict.CANNOT_ASSEMBLE)), first.copy())
        start, sines, arrived = self._carried(numbers, chosen[0])
        paths = self.walked(numbers, self._settled(numbers, start), sines)
        verdict[~np.isnan(paths.short_at)] = Verdict.MODE_NOT_REACHED
        verdict[~np.isnan(paths.ends_at)] = Verdict.SINGULAR
        at = np.where(np.isnan(paths.ends_at), paths.short_at, paths.ends_at)
        verdict[~paths.closes] = Verdict.OTHER_MODE
        at[~paths.closes] = last[~paths.closes]
        verdict[~arrived] = Verdict.MODE_NOT_REACHED
        at[~arrived] = first[~arrived]
        paths.seeds[:, ~arrived] = np.nan
        return SeedAnswers(paths.seeds, verdict, at)

    def walked(self, numbers: Numbers, start: np.ndarray, sines: np.ndarray) -> "mechanism.groups.seed_walk.SeedPaths":
        """Paths from unknowns at the first position with their quality of transmission."""
        longest = _LONGEST_INTERVAL / self._revolutions
        return self._walk(numbers, start, sines, self.intervals, longest, self._turns)

    def _settled(self, numbers: Numbers, unknowns: np.ndarray) -> np.ndarray:
        """Unknowns at the first position to the last bit, whatever way led there: rounded coarsely, then corrected."""
        count, i = self._slides.size, 0
        with np.errstate(all="ignore"):
            size = self._at(numbers, unknowns)[-1]
            rounded = np.array(unknowns)
            for slides in self._slides:
                if slides:
                    step = _COARSELY * np.exp2(np.floor(np.log2(size)))
                    rounded[i] = np.rint(unknowns[i] / step) * step
                else:
                    c, s = np.rint(unknowns[i : i + 2] / _COARSELY) * _COARSELY
                    rounded[i : i + 2] = np.array((c, s)) / np.hypot(c, s)
                i += 1 if slides else 2
            for _ in range(_SETTLING):
                rounded = self._moved(rounded, self._at(numbers, rounded)[:count])
        return rounded

    def _carried(self, numbers: Numbers, mode: AssemblyMode) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The scene's mode in every variant at its first position, its quality, and whether it was reached."""
        rows, count = self._rows(numbers), self._slides.size
        variants = rows.shape[1]
        unknowns, sines = np.repeat(mode.unknowns[:, None], variants, axis=1), np.full(variants, mode.transmission)
        own = self._rows(self._own)
        step = np.full(variants, _FIRST_STEP)
        way = ((rows == own) | np.isnan(own)).all(axis=0).astype(float)
        while True:
            going = (way < 1.0) & (step > _SHORTEST_STEP)
            if not going.any():
                return unknowns, sines, way >= 1.0
            ahead = np.where(going, np.minimum(way + step, 1.0), way)
            there = numbers.on_the_way(ahead if variants > 1 else ahead[0])
            with np.errstate(all="ignore"):
                found = self._at(there, unknowns)
                accepted = going & (found[3 * count] <= PROVES)
                moved = unknowns
                for _ in range(4):
                    moved = self._moved(moved, found[:count])
                    found = self._at(there, moved)
                accepted &= (np.abs(found[:count]) < _SAME).all(axis=0)
                accepted &= found[-2] / sines > LEAST_SHARE
            sines = np.where(accepted, found[-2], sines)
            unknowns = np.where(accepted, moved, unknowns)
            way = np.where(accepted, ahead, way)
            step = np.where(accepted, np.minimum(2.0 * step, _LONGEST_STEP), np.where(going, 0.5 * step, step))


def _least_distance(places: Sequence[tuple[float, float]]) -> float:
    """Distance of the two nearest of some places."""
    found = np.array(places) @ np.array([1.0, 1j])
    apart = np.abs(found[:, None] - found[None, :]) + np.where(np.eye(len(found), dtype=bool), np.inf, 0.0)
    return float(apart.min())
