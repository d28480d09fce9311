"""The path of a group along the input in proved steps, for many variants in parallel."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.graph.at_points import Points, fill_points
from engine.graph.functions import functions_at
from engine.graph.nodes import Node, value_of
from engine.graph.values import LevelValues
from engine.laws.kinematics.seeds import CLOSE, LEAST_SHARE, PROVES, between_seeds, same_unknowns
from engine.scene.scene import Numbers

# Corrections of a step before its acceptance.
_CORRECTIONS = 3
# The shortest step before a path ends, relative to the longest.
_SHORTEST_STEP = 2.0**-24
# Limits of the change of the step length, and the share of CLOSE aimed at in the middle of the next step.
_SHORTER, _LONGER, _AIM = 0.1, 2.0, 0.3
# The error of a quintic is proportional to the sixth power of the step length.
_STEP_EXPONENT = 1.0 / 6.0
# A path is abandoned when it has this many times as many seeds as its table has intervals.
_ABANDONED = 4


class SeedPaths(NamedTuple):
    """Seed tables of some variants, and how their paths end.

    Attributes
    ----------
    seeds : ndarray (entries, variants)
        Per seed: its position as a share of the range, infinite if unused; the unknowns, their first and second rates;
        NaN beyond the end of a path.
    ends_at : ndarray (variants,)
        Position at which modes meet and a path ends; NaN if it does not.
    short_at : ndarray (variants,)
        Position beyond which the table is full; NaN if it is not.
    closes : ndarray (variants,) of bool
        Whether a turn ends as it began; also true if the input does not turn, or if the path ends earlier.
    """

    seeds: np.ndarray
    ends_at: np.ndarray
    short_at: np.ndarray
    closes: np.ndarray


class SeedWalk:
    """The path of one group, and its curves anywhere.

    Parameters
    ----------
    given : sequence of Node
        Given numbers for the values of the unknowns.
    curves : sequence of Node
        Corrections, rates, second rates, certificate, transmission index and size at given values of the unknowns.
    span : tuple of Node
        First and last position of the input.
    slides : ndarray of bool
        Which unknowns are slides.
    """

    def __init__(
        self, given: Sequence[Node], curves: Sequence[Node], span: tuple[Node, Node], slides: np.ndarray
    ) -> None:
        self._functions = functions_at(curves[0].graph, *span, curves, numbers=given)
        self._fill, self._levels = PrintedFunction(self._functions.codes["curves_at"]), LevelValues(self._functions)
        self._given = np.array([self._functions.rows[node] for node in given], np.int64)
        self._slides = slides

    def table(self, numbers: Numbers) -> np.ndarray:
        """Numbers of all variants, (numbers, variants), the ends of the range first; one variant if none varies."""
        with np.errstate(all="ignore"):
            variants = max(np.size(value_of(node, numbers)) for node in self._functions.numbers)
        return self._levels.table(numbers, variants)

    def curves(self, table: np.ndarray, q: np.ndarray, unknowns: np.ndarray) -> np.ndarray:
        """Curves (curves, points) at positions, for values of the unknowns; a table of one variant serves all points.

        Parameters
        ----------
        table : ndarray (numbers, variants)
        q : ndarray (points,)
        unknowns : ndarray (unknowns, points)
        """
        found, given = np.empty((len(self._functions.curves), q.size)), np.ascontiguousarray(unknowns)
        return fill_points(self._fill, Points(table, self._functions.memory, q, found, given, self._given))

    @np.errstate(all="ignore")
    def __call__(
        self, table: np.ndarray, start: np.ndarray, sines: np.ndarray, intervals: int, longest: float, turns: bool
    ) -> SeedPaths:
        """Seed tables over the range of the input, as dense as quintics between the seeds require.

        Parameters
        ----------
        table : ndarray (numbers, variants)
        start : ndarray (unknowns, variants)
            Unknowns at the first position.
        sines : ndarray (variants,)
            Transmission index there.
        intervals : int
            Capacity of a table.
        longest : float
            Longest interval as a share of the range.
        turns : bool
            Whether the last position coincides with the first.
        """
        (count, variants), every = start.shape, np.arange(start.shape[1])
        begin, length = table[0], table[1] - table[0]
        seeds = np.full((intervals + 1, 1 + 3 * count, variants), np.nan)
        seeds[:, 0] = np.inf
        # At the last seed: its position, the unknowns with both rates, the transmission index; and the next step. The
        # first step, of zero length, finds the rates.
        place, now, sine = np.zeros(variants), np.vstack([start, np.zeros((2 * count, variants))]), sines.copy()
        step, found = np.zeros(variants), np.zeros(variants, np.int64)
        going = every
        while going.size:
            own, at, whole = table.take(going, axis=1), place[going], length[going]
            tried = np.minimum(step[going], 1.0 - at)
            q = np.where(tried == 1.0 - at, own[1], own[0] + whole * (at + tried))
            change, seed = whole * tried, np.split(now[:, going], 3)
            unknowns = seed[0] + change * (seed[1] + 0.5 * change * seed[2])
            curves = self.curves(own, q, unknowns)
            proved = curves[3 * count] <= PROVES
            for _ in range(_CORRECTIONS - 1):
                unknowns = unknowns + curves[:count]
                curves = self.curves(own, q, unknowns)
            ahead, turned = np.vstack([unknowns + curves[:count], curves[count : 3 * count]]), curves[3 * count + 1]
            # A step is as long as the quintic's error at its middle allows.
            middle = between_seeds.in_python(seed, np.split(ahead, 3), 0.5, change)
            excess = self.curves(own, own[0] + whole * (at + 0.5 * tried), middle)[3 * count] / CLOSE
            # The determinant changes sign where two modes meet: reject a step across such a position.
            sound = proved & (turned / sine[going] > LEAST_SHARE) & (excess < np.inf)
            factor = np.where(sound, (_AIM / np.maximum(excess, 1e-12)) ** _STEP_EXPONENT, _SHORTER)
            accepted = sound & (excess <= 1.0)
            # A step shortened by the end of the range says little about the length of the next.
            wanted = np.maximum(tried * np.minimum(factor, _LONGER), np.where(factor >= 1.0, step[going], 0.0))
            wanted = np.where(tried > 0.0, np.minimum(wanted, longest), longest)
            step[going] = np.where(accepted, wanted, tried * np.clip(factor, _SHORTER, 0.5))
            taken = going[accepted]
            place[taken] = np.where(q == own[1], 1.0, at + tried)[accepted]
            now[:, taken], sine[taken] = ahead[:, accepted], turned[accepted]
            kept = taken[found[taken] <= intervals]
            seeds[found[kept], 0, kept], seeds[found[kept], 1:, kept] = place[kept], now[:, kept].T
            found[taken] += 1
            followed = (place[going] < 1.0) & (found[going] <= _ABANDONED * intervals)
            going = going[np.where(accepted, followed, step[going] > _SHORTEST_STEP * longest)]
        whole, short = place == 1.0, found > intervals + 1
        last = np.clip(found - 1, 0, intervals)
        closes = same_unknowns(start, now[:count], self._slides)
        # Beyond the end of a path the seeds are unknown.
        ended = np.flatnonzero(~whole | short)
        final = np.minimum(last[ended], intervals - 1)
        seeds[final + 1, :, ended], seeds[final + 1, 0, ended] = np.nan, np.inf
        followed = whole | (found <= _ABANDONED * intervals)
        full_at = begin + length * seeds[np.minimum(last, intervals - 1), 0, every]
        return SeedPaths(
            seeds.reshape(-1, variants),
            np.where(followed & ~whole, begin + length * place, np.nan),
            np.where(short, full_at, np.nan),
            closes | ~whole | (not turns),
        )
