"""What a page tells of a result file, found in two passes over its rows, whatever their number.

The first pass judges every variant and chooses rows: the best ones, and a random sample of those that work. The
second keeps these rows whole, and counts over all of them.
"""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from engine import Verdict, any_quantity, parse_expression, scene_numbers
from sweeps.report.sweep_result import SweepResult
from sweeps.store import MappedResult, mapped_columns
from sweeps.text.conditions import Condition, errors_in

# Numbers that are held in memory of a file at a time.
NUMBERS_AT_A_TIME = 4_000_000
MOST_BEST, MOST_SAMPLED = 500, 2000
# Axes of a design along which a neighbour is a step away; samples and tables have no order.
ORDERED_AXES = ("Listed", "Linear", "Logarithmic")


class Aim(NamedTuple):
    """What decides among variants.

    Attributes
    ----------
    name : str
        The column to be least (sign +1) or greatest (−1).
    sign : float
    where : str
        Condition, "" for none.
    """

    name: str
    sign: float
    where: str

    @property
    def word(self) -> str:
        """Whether the minimum or the maximum is sought."""
        return "minimum" if self.sign > 0 else "maximum"


class Price(NamedTuple):
    """A part of the condition, and what it costs.

    Attributes
    ----------
    text : str
    margin : float
        Room left at the best variant as a share of the magnitudes compared, 0 on the limit, negative where missed; NaN
        without a best variant.
    without : int or None
        The best variant if this part were not asked.
    """

    text: str
    margin: float
    without: int | None


class Neighbour(NamedTuple):
    """The variants a step below and above the best one along an axis of the grid; None beyond its ends."""

    names: tuple[str, ...]
    below: int | None
    above: int | None


@dataclass(frozen=True, eq=False)
class Digest:
    """What a page tells of a result file.

    Attributes
    ----------
    result : SweepResult
        Its description and record; the columns it would read whole are not asked for.
    aim : Aim or None
    counts : Counter of Verdict
    missed : mapping of str to (int, int)
        For each condition of `require` how many variants fail it, and how many of them no other.
    meeting, undecided, rivals : int
        Variants that meet the condition; for which it is undecided; that are as good as the best within the error
        figures.
    best : int or None
    leaders : ndarray of int
        The best variants that meet the condition, the best first.
    shown : ndarray of int
        Variants of the figures: the leaders and a random sample of all that work, ascending.
    prices : tuple of Price
    neighbours : tuple of Neighbour
    ranges : mapping of str to (float, float)
        Least and greatest value of what varies, over all variants.
    worst_errors : mapping of str to float
        Greatest error figure of each summary among the variants that work, as a share of the value.
    rows : mapping of str to ndarray
        All columns over variants, of the variants `numbers`.
    numbers : ndarray of int
        Variants kept, ascending.
    """

    result: SweepResult
    aim: Aim | None
    counts: Counter
    missed: Mapping[str, tuple[int, int]]
    meeting: int
    undecided: int
    rivals: int
    best: int | None
    leaders: np.ndarray
    shown: np.ndarray
    prices: tuple[Price, ...]
    neighbours: tuple[Neighbour, ...]
    ranges: Mapping[str, tuple[float, float]]
    worst_errors: Mapping[str, float]
    rows: Mapping[str, np.ndarray]
    numbers: np.ndarray

    def value(self, name: str, variant: int) -> float:
        """A column's value of a variant that is kept; NaN where there is no such column."""
        if name not in self.rows:
            return np.nan
        return float(self.rows[name][self.place(variant)])

    def place(self, variant: int) -> int:
        """Row of a variant that is kept."""
        return int(np.searchsorted(self.numbers, variant))

    def values(self, variant: int) -> dict[str, float]:
        """Numbers of the scene (SI) that a variant that is kept has in place of the scene's own."""
        known = scene_numbers(self.result.scene)
        return {name: self.value(name, variant) for name in self.result.parameters if name in known}

    @property
    def shown_places(self) -> np.ndarray:
        """Rows of the variants that figures show."""
        return np.searchsorted(self.numbers, self.shown)

    @cached_property
    def meets(self) -> np.ndarray:
        """Which of the rows kept work and meet the condition."""
        ok = self.rows["status"] == Verdict.OK
        condition = condition_of(self.aim)
        return ok & condition.judged(self.rows, errors_in(self.rows), ok.size).met if condition else ok

    @property
    def is_one(self) -> bool:
        """Whether there is one variant alone."""
        return self.result.description.variants == 1

    @cached_property
    def drawn(self) -> int | None:
        """The variant whose machine is drawn: the only one, the best, or without an aim the first that works."""
        if self.is_one:
            return 0
        if self.best is not None or self.aim is not None:
            return self.best
        return int(self.shown[0]) if self.shown.size else None


def digest_of(path: Path) -> Digest:
    """Look through a result file.

    Parameters
    ----------
    path : Path

    Raises
    ------
    StoreError
        The file can't be read, or is no result of a sweep.
    """
    result = SweepResult(path)
    mapped = mapped_columns(path)
    first = _Choosing(result, aim_of(result))
    for start, rows in _pieces(mapped, first.names):
        first.take(start, rows)
    second = _Gathering(first)
    for start, rows in _pieces(mapped, second.names):
        second.take(start, rows)
    return second.digest()


def aim_of(result: SweepResult) -> Aim | None:
    """What decides among the variants of a result; of a search its first objective and conditions."""
    if "search" in result.record:
        search = result.record["search"]
        objective = search["objectives"][0]
        where = " and ".join(f"({text})" if " or " in text else text for text in search["subject_to"])
        return Aim(objective["name"], 1.0 if objective["way"] == "minimise" else -1.0, where)
    goal = result.goal
    return Aim(goal.goal, goal.sign, goal.where or "") if goal else None


def condition_of(aim: Aim | None) -> Condition | None:
    """The condition of an aim, if it has one."""
    return Condition(parse_expression(aim.where, any_quantity)) if aim and aim.where else None


def _pieces(mapped: MappedResult, names: list[str]) -> Iterator[tuple[int, dict[str, np.ndarray]]]:
    """Number of the first variant, and the named columns, of one piece of the rows after another."""
    block = max(1, NUMBERS_AT_A_TIME // len(names))
    for start in range(0, mapped.variants, block):
        yield start, {name: np.array(mapped.columns[name][start : start + block]) for name in names}
        mapped.release()


class _Judge:
    """Which variants of a piece work, meet the condition and each of its parts, and what they are worth."""

    def __init__(self, result: SweepResult, aim: Aim | None) -> None:
        self.aim, self.condition = aim, condition_of(aim)
        self.parts = self.condition.parts if self.condition else ()
        wanted = [aim.name, *(self.condition.names if self.condition else ())] if aim else []
        pairs = (name for wish in wanted for name in (wish, f"{wish}_error"))
        self.names = list(dict.fromkeys(["status", *(name for name in pairs if name in result.units)]))

    def judge(self, rows: Mapping[str, np.ndarray]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Whether each row works, whether it meets each part (parts, rows), and whether it may meet all of them."""
        ok = rows["status"] == Verdict.OK
        errors = errors_in(rows)
        judged = [part.judged(rows, errors, ok.size) for part in self.parts]
        met = np.array([j.met for j in judged]).reshape(len(judged), ok.size)
        open_ = ok & self.condition.judged(rows, errors, ok.size).undecided if self.condition else np.zeros_like(ok)
        return ok, met, open_

    def costs(self, rows: Mapping[str, np.ndarray], chosen: np.ndarray) -> np.ndarray:
        """What is to be least; infinite for rows that aren't chosen."""
        if self.aim is None:
            return np.full(chosen.size, np.inf)
        costs = self.aim.sign * rows[self.aim.name]
        return np.where(chosen & np.isfinite(costs), costs, np.inf)

    def errors(self, rows: Mapping[str, np.ndarray]) -> np.ndarray:
        """Error figures of what is to be least; 0 where it has none."""
        return rows.get(f"{self.aim.name}_error", np.zeros(rows["status"].size))


class _Choosing:
    """The first pass."""

    def __init__(self, result: SweepResult, aim: Aim | None) -> None:
        self.result, self.judge = result, _Judge(result, aim)
        self.names = list(dict.fromkeys([*self.judge.names, *result.varied]))
        self.meeting = self.undecided = 0
        self.leaders = (np.zeros(0), np.zeros(0, int))
        self.sample = (np.zeros(0), np.zeros(0, int))
        self.without: list[tuple[float, int]] = [(np.inf, -1)] * len(self.judge.parts)
        self.ranges: dict[str, tuple[float, float]] = {}
        self.random = np.random.default_rng(0)
        self.best_error = 0.0

    def take(self, start: int, rows: Mapping[str, np.ndarray]) -> None:
        ok, met, undecided = self.judge.judge(rows)
        chosen = ok & met.all(axis=0)
        numbers = start + np.arange(ok.size)
        self.meeting += int(chosen.sum())
        self.undecided += int(undecided.sum())
        self.leaders = _least(MOST_BEST, self.leaders, self.judge.costs(rows, chosen), numbers)
        if self.best is not None and self.best >= start:
            self.best_error = float(self.judge.errors(rows)[self.best - start])
        # Those with the least of random numbers are a sample without replacement.
        chance = np.where(ok, self.random.random(ok.size), np.inf)
        self.sample = _least(MOST_SAMPLED, self.sample, chance, numbers)
        for i, found in enumerate(self.without):
            costs = self.judge.costs(rows, ok & np.delete(met, i, axis=0).all(axis=0))
            k = int(np.argmin(costs))
            self.without[i] = min(found, (float(costs[k]), start + k))
        for name in self.result.varied:
            low, high = self.ranges.get(name, (np.inf, -np.inf))
            self.ranges[name] = (min(low, float(rows[name].min())), max(high, float(rows[name].max())))

    @property
    def best(self) -> int | None:
        return int(self.leaders[1][0]) if self.leaders[1].size else None


def _least(
    most: int, kept: tuple[np.ndarray, np.ndarray], costs: np.ndarray, numbers: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """The least costs so far, and whose they are; of equal ones the first."""
    costs, numbers = np.append(kept[0], costs), np.append(kept[1], numbers)
    order = np.argsort(costs, kind="stable")[:most]
    order = order[np.isfinite(costs[order])]
    return costs[order], numbers[order]


class _Gathering:
    """The second pass."""

    def __init__(self, first: _Choosing) -> None:
        self.first, self.result = first, first.result
        self.neighbours = _neighbours(self.result, first.best)
        self.shown = np.union1d(first.leaders[1], first.sample[1])
        beside = [v for n in self.neighbours for v in (n.below, n.above) if v is not None]
        without = [v for cost, v in first.without if np.isfinite(cost)]
        only = [0] if self.result.description.variants == 1 else []
        self.numbers = np.union1d(self.shown, np.array([*beside, *without, *only], int))
        self.names = [c.name for c in self.result.description.columns if c.dims == ("variant",)]
        self.kept: dict[str, list[np.ndarray]] = {name: [] for name in self.names}
        self.counts = Counter()
        self.missed = np.zeros((2, len(self.result.requirements.conditions)), int)
        self.worst = dict.fromkeys(self.result.summaries, 0.0)
        self.as_good = 0

    def take(self, start: int, rows: Mapping[str, np.ndarray]) -> None:
        status = rows["status"]
        here = self.numbers[(self.numbers >= start) & (self.numbers < start + status.size)] - start
        for name in self.names:
            self.kept[name].append(rows[name][here])
        for code, count in zip(*np.unique(status, return_counts=True), strict=True):
            self.counts[Verdict(int(code))] += int(count)
        if self.result.requirements.conditions:
            fails = self.result.requirements.misses(rows, status.size) & (status != Verdict.NOT_COMPUTED)
            self.missed += [fails.sum(axis=1), (fails & (fails.sum(axis=0) == 1)).sum(axis=1)]
        for name, worst in self.worst.items():
            self.worst[name] = max(worst, _worst_error(rows, name))
        if self.first.best is not None:
            judge = self.first.judge
            ok, met, _ = judge.judge(rows)
            gap = judge.costs(rows, ok & met.all(axis=0)) - self.first.leaders[0][0]
            self.as_good += int((gap <= judge.errors(rows) + self.first.best_error).sum())

    def digest(self) -> Digest:
        first = self.first
        rows = {name: np.concatenate(pieces) for name, pieces in self.kept.items()}
        return Digest(
            result=self.result,
            aim=first.judge.aim,
            counts=self.counts,
            missed={
                c.text: (int(n), int(m))
                for c, n, m in zip(self.result.requirements.conditions, *self.missed, strict=True)
            },
            meeting=first.meeting,
            undecided=first.undecided,
            rivals=max(self.as_good - 1, 0),
            best=first.best,
            leaders=first.leaders[1],
            shown=self.shown,
            prices=tuple(self._prices(rows)),
            neighbours=self.neighbours,
            ranges=first.ranges,
            worst_errors=self.worst,
            rows=rows,
            numbers=self.numbers,
        )

    def _prices(self, rows: Mapping[str, np.ndarray]) -> Iterator[Price]:
        best = self.first.best
        for part, (cost, without) in zip(self.first.judge.parts, self.first.without, strict=True):
            margin = np.nan
            if best is not None:
                k = np.searchsorted(self.numbers, best)
                here = {name: column[k : k + 1] for name, column in rows.items()}
                margin = -float(part.margins(here, errors_in(here), 1).max())
            yield Price(part.text, margin, without if np.isfinite(cost) else None)


def _worst_error(rows: Mapping[str, np.ndarray], name: str) -> float:
    """Greatest error figure of a summary over its value, among rows that work."""
    ok = rows["status"] == Verdict.OK
    values, errors = np.abs(rows[name][ok]), rows[f"{name}_error"][ok]
    shares = errors[values > 0] / values[values > 0]
    return float(np.nanmax(shares, initial=0.0))


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
