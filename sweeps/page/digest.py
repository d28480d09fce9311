"""Digest of a result file of any size for the report: the best variants and a sample of all."""

from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from engine import Verdict, scene_numbers
from sweeps.optimising.optimum import front, is_front
from sweeps.report.sweep_result import SweepResult, drop_counts
from sweeps.text.conditions import Condition

MOST_BEST, MOST_SAMPLED = 500, 2000
# Ordered axes, whose variants have neighbours; samples and tables have no order.
ORDERED_AXES = ("Listed", "Linear", "Logarithmic")


class Price(NamedTuple):
    """A part of the condition, and its price.

    Attributes
    ----------
    text : str
    margin : float
        Distance from the limit at the best variant, relative to the limit; NaN without a best variant, of conditions
        joined by `or`, and if the limit is 0.
    without : int or None
        The best variant without this part.
    """

    text: str
    margin: float
    without: int | None


def _margin(part: Condition, values: Mapping[str, np.ndarray], errors: Mapping[str, np.ndarray]) -> float:
    sides = part.sides(values, errors)
    if sides is None or sides[2] == 0.0:
        return np.nan
    _, value, limit = sides
    return abs(value - limit) / abs(limit)


class Neighbour(NamedTuple):
    """The best variant's neighbours along a grid axis; None beyond the ends."""

    names: tuple[str, ...]
    below: int | None
    above: int | None


class Digest:
    """The content of a report; columns are read in parts and few rows are kept.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    result : SweepResult
        Description and record; its columns are never read whole.
    aim : Best or None
        The objective and condition; for a search its first objective and conditions.

    Raises
    ------
    StoreError
        From the properties: the file can't be read, or isn't a sweep result.
    """

    def __init__(self, path: Path) -> None:
        self.result = SweepResult(path)
        self.aim = self.result.aim

    @property
    def _where(self) -> str:
        return self.aim.condition if self.aim else ""

    @property
    def condition(self) -> Condition | None:
        """The condition of the aim, if any."""
        return Condition.parse(self._where) if self._where else None

    # Over all variants

    @cached_property
    def counts(self) -> Counter:
        """Number of variants per verdict."""
        return Counter(self.result.verdict_counts())

    @cached_property
    def missed(self) -> dict[str, tuple[int, int]]:
        """For each condition of `require`: variants that fail it, and those that fail only it."""
        texts = self.result.record["require"]
        counts, alone, _ = drop_counts(len(texts), self.result.missed())
        return {text: pair for text, *pair in zip(texts, counts.tolist(), alone.tolist(), strict=True)}

    @cached_property
    def meeting(self) -> int:
        """Number of variants that meet the condition."""
        return self.result.count_meeting(self._where)

    @cached_property
    def undecided(self) -> int:
        """Number of variants for which the condition is undecided."""
        return self.result.undecided(self._where) if self._where else 0

    @cached_property
    def rivals(self) -> int:
        """Number of variants that tie with the best within the error estimates."""
        return 0 if self.best is None else self.result.rivals(self.best, self.aim)

    def _first(self, where: str, most: int) -> np.ndarray:
        """The best variants under a condition, best first."""
        if self.aim is None:
            return np.zeros(0, int)
        found = self.result.select(where, self.aim.goal, self.aim.sign < 0, most)
        return found[np.isfinite(self.result.columns[self.aim.goal][found])]

    @cached_property
    def leaders(self) -> np.ndarray:
        """The best variants that meet the condition, best first."""
        return self._first(self._where, MOST_BEST)

    @property
    def best(self) -> int | None:
        """The best variant."""
        return int(self.leaders[0]) if self.leaders.size else None

    @cached_property
    def prices(self) -> tuple[Price, ...]:
        """The price of each part of the condition."""
        return tuple(self._prices(self.condition.parts)) if self.condition else ()

    def _prices(self, parts: tuple[Condition, ...]) -> Iterator[Price]:
        for part in parts:
            others = " and ".join(f"({other.text})" for other in parts if other is not part)
            without, margin = self._first(others, 1), np.nan
            if self.best is not None:
                margin = _margin(part, *self.result.known(np.array([self.best]), part.names))
            yield Price(part.text, margin, int(without[0]) if without.size else None)

    @cached_property
    def worst_errors(self) -> dict[str, float]:
        """Maximum relative error estimate of each summary among the feasible variants."""
        found, columns = dict.fromkeys(self.result.summaries, 0.0), self.result.columns
        for part in self.result.parts():
            ok = columns["status"][part] == Verdict.OK
            for name in found:
                values, errors = np.abs(columns[name][part][ok]), columns[f"{name}_error"][part][ok]
                shares = errors[values > 0] / values[values > 0]
                found[name] = max(found[name], float(np.nanmax(shares, initial=0.0)))
        return found

    # Of the variants kept

    @cached_property
    def front(self) -> np.ndarray:
        """The front of a search with several objectives; else nothing."""
        return front(self.result) if is_front(self.result) else np.zeros(0, int)

    @cached_property
    def shown(self) -> np.ndarray:
        """Variants in the figures, ascending: the leaders, the front and a random sample of all that work."""
        # The smallest of random numbers select a sample without replacement.
        random, chances, numbers = np.random.default_rng(0), np.zeros(0), np.zeros(0, int)
        for part in self.result.parts():
            ok = self.result.columns["status"][part] == Verdict.OK
            chances = np.append(chances, random.random(ok.size)[ok])
            numbers = np.append(numbers, part.start + np.flatnonzero(ok))
            least = np.argsort(chances, kind="stable")[:MOST_SAMPLED]
            chances, numbers = chances[least], numbers[least]
        return np.union1d(np.union1d(self.leaders, self.front), numbers)

    @cached_property
    def neighbours(self) -> tuple[Neighbour, ...]:
        """The grid neighbours of the best variant."""
        return _neighbours(self.result, self.best)

    @cached_property
    def numbers(self) -> np.ndarray:
        """Variants kept, ascending."""
        beside = [v for n in self.neighbours for v in (n.below, n.above)]
        others = [*beside, *(price.without for price in self.prices), 0 if self.is_one else None]
        return np.union1d(self.shown, np.array([v for v in others if v is not None], int))

    @cached_property
    def rows(self) -> Mapping[str, np.ndarray]:
        """All columns of the variants `numbers`."""
        return self.result.taken(self.numbers)

    def value(self, name: str, variant: int) -> float:
        """A column's value for a kept variant; NaN if there is no such column."""
        if name not in self.rows:
            return np.nan
        return float(self.rows[name][self.place(variant)])

    def place(self, variant: int) -> int:
        """Row of a kept variant."""
        return int(np.searchsorted(self.numbers, variant))

    def values(self, variant: int) -> dict[str, float]:
        """Numbers (SI) of a kept variant that replace the scene's."""
        known = scene_numbers(self.result.scene)
        return {name: self.value(name, variant) for name in self.result.parameters if name in known}

    @property
    def shown_places(self) -> np.ndarray:
        """Rows of the variants in the figures."""
        return np.searchsorted(self.numbers, self.shown)

    @cached_property
    def meets(self) -> np.ndarray:
        """Which kept rows work and meet the condition."""
        ok = self.rows["status"] == Verdict.OK
        if not self.condition:
            return ok
        return ok & self.condition.judged(*self.result.requirements.known(self.rows), ok.size).met

    @property
    def is_one(self) -> bool:
        """Whether there is only one variant."""
        return self.result.description.variants == 1

    @cached_property
    def drawn(self) -> int | None:
        """The variant to draw: the only one, the best, or without an aim the first that works."""
        if self.is_one:
            return 0
        if self.best is not None or self.aim is not None:
            return self.best
        return int(self.shown[0]) if self.shown.size else None


def _neighbours(result: SweepResult, best: int | None) -> tuple[Neighbour, ...]:
    if best is None or "search" in result.record:
        return ()
    found, place = [], np.unravel_index(best, result.shape)
    for i, axis in enumerate(result.record["vary"]):
        if axis["kind"] in ORDERED_AXES and axis["size"] > 1:
            stride = int(np.prod(result.shape[i + 1 :], dtype=int))
            below = best - stride if place[i] > 0 else None
            above = best + stride if place[i] + 1 < axis["size"] else None
            found.append(Neighbour(tuple(axis["names"]), below, above))
    return tuple(found)
