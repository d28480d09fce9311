"""Accuracy asked instead of positions: every variant gets as many positions as it takes, and no more.

All variants begin with few equally spaced positions. Where the error figure of anything asked exceeds what is allowed,
the variant goes on with more; the others are finished. Equally spaced positions are cheap but gain little from being
more: a few are tried, if they are likely to do. Then positions lie in panels, which end where loads set in
(`engine.panels.panels`). What panels don't know, such as regimes, is left to equally spaced positions however many.

The rungs a variant climbs depend on its own error figures alone, so results don't depend on what it is evaluated with.
"""

import re
from collections.abc import Iterable, Mapping

import numpy as np

from engine.equal_positions.analyses import Analyses
from engine.equal_positions.text.demand import WORD
from engine.equal_positions.rows_machine import RowsMachine
from engine.machine.quantities.quantities import STATISTICS, Quantity
from engine.machine.results import AskError, Outcome
from engine.panels import panel_rows
from engine.panels.panel_machine import USED, PanelMachine
from engine.scene.scene import Scene
from engine.verdicts import Verdict

# Equally spaced positions, and cuts of panels, from the fewest on.
POSITIONS = (48, 96, 192, 384, 768, 1536, 3072, 6144, 12_288)
CUTS = (1, 2, 4, 8, 16, 32)
# More equally spaced positions than these cost more than panels.
FEW = 384
# Orders of the error in the distance of positions: of equally spaced ones with bends and jumps, the most that is
# expected of them, and less than that of panels.
ROUGH_ORDER, EVEN_ORDER, PANEL_ORDER = 2.0, 6.0, 8.0
# More positions that don't bring the error figure below this share of what it was won't do at the next time.
GAIN = 0.7
# What compares two numbers with one of them, and is zero where they agree.
RELATIVE_ALREADY = ("_difference", "_residual", "_disagreement")
REACHED = Quantity("accuracy_reached", "1 where every error figure is within the asked accuracy, else 0", "1")

OF_ACCURACY = (USED.name, REACHED.name)

_CALL = re.compile(r"\b([A-Za-z_]\w*)\(")
# What a summary may call besides what goes over panels: functions of numbers, or of each position by itself.
_BY_POSITION = frozenset(
    (
        *("abs", "acos", "asin", "atan2", "fill", "greater", "greatest_disagreement", "hypot", "least"),
        *("least_magnitude", "less_friction", "magnitudes", "max", "mechanical_efficiency", "min", "peak_of"),
        *("quick_return_ratio", "range", "speed_row", "sqrt", "transmission_angle", "unbalanced_share"),
        "unwrap_angle",
    )
)


def excess(outcome: Outcome, accuracy: float) -> np.ndarray:
    """How many times the allowed error each error figure is, (summaries, variants).

    Statistics of a field are measured by its peak: its mean or its least magnitude may be zero. The place of an extreme
    doesn't count: beside a flat one it is hardly known, and nothing depends on it. A number that is undefined, or a
    variant that fails, has no error.
    """
    shares = np.zeros((len(outcome.errors), outcome.status.size))
    for shares_of, (name, error) in zip(shares, outcome.errors.items(), strict=True):
        value = outcome.summaries[name]
        if name.endswith("_at"):
            continue
        size = 1.0 if name.endswith(RELATIVE_ALREADY) else np.abs(outcome.summaries.get(peak_of(name), value))
        with np.errstate(all="ignore"):
            share = np.where(error == 0.0, 0.0, error / (accuracy * size))
        shares_of[:] = np.where(np.isfinite(value), share, 0.0)
    return shares


def peak_of(name: str) -> str:
    """Summary that a statistic of a field is measured by."""
    field, _, statistic = name.rpartition(".")
    return f"{field}.peak" if statistic in STATISTICS else name


def in_panels(scene: Scene, names: Iterable[str]) -> list[str]:
    """Which of some summaries can be computed in panels: those at uniform speed of the input."""
    machine = PanelMachine(scene, names)
    if not machine.possible:
        return []
    known = {*panel_rows.__all__, *_BY_POSITION}
    found = []
    for name in machine.asked_summaries:
        needed = machine.wheel_needs if name in machine.wheel_quantities else (name,)
        if all(n in machine.analyses.results and _calls(machine.analyses, n) <= known for n in needed):
            found.append(name)
    return found


def _calls(analyses: Analyses, name: str) -> set[str]:
    """Functions that a summary's value and error figure come from, but for those of the mechanism itself."""
    producers = {t.replace("$", ""): step.statement for step in analyses.steps for t in step.targets}
    result = analyses.results[name]
    texts, pending, seen = [], [f"{result.value} {result.error}"], set()
    while pending:
        text = pending.pop().replace("$", "").replace("_half", "")
        texts.append(text)
        for word in set(WORD.findall(text)) - seen:
            seen.add(word)
            if word in producers:
                pending.append(producers[word])
    return {call for text in texts for call in _CALL.findall(text)}


class Ladder:
    """Machines of ever more positions, made as they are needed.

    Parameters
    ----------
    scene : Scene
    summaries : list of str
    varied : tuple of str
    panels : bool
        Whether the higher rungs are of panels.
    """

    def __init__(self, scene: Scene, summaries: list[str], varied: tuple[str, ...], panels: bool) -> None:
        self.scene, self.summaries, self.varied = scene, summaries, varied
        few = [n for n in POSITIONS if n <= FEW] if panels else POSITIONS
        self.rungs = [(EVEN_ORDER if panels else ROUGH_ORDER, n) for n in few]
        self.rungs += [(PANEL_ORDER, n) for n in (CUTS if panels else ())]
        self._even = len(few)
        self._made: dict[int, Machine] = {}

    def machine(self, rung: int) -> Machine:
        """Machine of a rung, from 0 on."""
        if rung not in self._made:
            number = self.rungs[rung][1]
            if rung < self._even:
                self._made[rung] = Machine(self.scene, self.summaries, (), self.varied, number)
            else:
                self._made[rung] = PanelMachine(self.scene, [*self.summaries, USED.name], self.varied, number)
        return self._made[rung]

    def after(self, rung: int, share: np.ndarray, before: np.ndarray) -> np.ndarray:
        """Rung to go on with of each variant on a rung; −1 where it is finished.

        Parameters
        ----------
        rung : int
        share, before : ndarray (summaries, variants)
            Error figures by the allowed errors, on this rung and on the last one; infinite before the first.
        """
        order = self.rungs[rung][0]
        last = self._even if rung < self._even else len(self.rungs)
        unfinished = share > 1.0
        if last == len(self.rungs):
            # What more positions no longer help doesn't keep the others from going on.
            unfinished &= share < GAIN * before
        with np.errstate(all="ignore"):
            if rung == 1 and last < len(self.rungs):
                order = np.clip(np.log2(before / share), 0.5, EVEN_ORDER)
            following, safely = (self._enough(rung, last, unfinished, share, o) for o in (order, ROUGH_ORDER))
        if last < len(self.rungs):
            # Few more that do anyway; else twice as many show what more would do, and once more are tried if likely to.
            twice = np.where(following < last, 1, last)
            following = {0: np.where(safely < last, safely, twice), 1: following}.get(rung, last)
        else:
            following = np.minimum(following, last - 1) if rung + 1 < last else -1
        return np.where(unfinished.any(axis=0), following, -1)

    def _enough(
        self, rung: int, last: int, unfinished: np.ndarray, share: np.ndarray, order: float | np.ndarray
    ) -> np.ndarray:
        """First rung before the last that does if errors fall by an order; the last one if none."""
        needed = np.where(unfinished, share ** (1.0 / order) * (1.0 - 1e-9), 0.0).max(axis=0, initial=0.0)
        numbers = np.array([n for _, n in self.rungs[rung + 1 : last]])
        return rung + 1 + np.searchsorted(numbers, self.rungs[rung][1] * needed)


class AccurateMachine:
    """A machine that is asked for an accuracy; otherwise like `Machine`.

    Parameters
    ----------
    scene : Scene
    summaries, fields, varied : iterable of str
        As for `Machine`, the summaries `positions_used` and `accuracy_reached` besides.
    accuracy : float
        Allowed error of every summary, as a share of its magnitude; of a statistic of a field, of the field's peak.
    positions : int
        Of the fields.

    Raises
    ------
    SceneError, AskError
        As for `Machine`.
    """

    def __init__(
        self,
        scene: Scene,
        summaries: Iterable[str],
        fields: Iterable[str] = (),
        varied: Iterable[str] = (),
        accuracy: float = 1e-3,
        positions: int = 720,
    ) -> None:
        if not 0.0 < accuracy < 1.0:
            raise AskError(f"accuracy = {accuracy!r}: a share between 0 and 1 is needed, such as 0.001 or '0.1 %'")
        self.scene, self.accuracy, self.varied = scene, accuracy, tuple(varied)
        self.asked_summaries = list(summaries)
        names = [n for n in self.asked_summaries if n not in OF_ACCURACY]
        self.whole = Machine(scene, names, fields, self.varied, positions)
        fields = self.whole.model.fields
        peaks = [p for n in names if (p := peak_of(n)) != n and p.rpartition(".")[0] in fields]
        names = list(dict.fromkeys([*names, *peaks]))
        paneled = in_panels(scene, names)
        others = [n for n in names if n not in paneled]
        ladders = (Ladder(scene, paneled, self.varied, True), Ladder(scene, others, self.varied, False))
        self._ladders = [ladder for ladder in ladders if ladder.summaries]
        self._fields = Machine(scene, (), fields, self.varied, positions) if self.whole.asked_fields else None

    def __getattr__(self, name: str) -> object:
        # What doesn't depend on the accuracy is as of the machine of all that is asked.
        return getattr(self.whole, name)

    @property
    def available_summaries(self) -> dict[str, Quantity]:
        """Every summary one may ask, with how many positions were used."""
        return self.whole.available_summaries | {q.name: q for q in (USED, REACHED)}

    def evaluate(
        self,
        varied: Mapping[str, np.ndarray],
        drop: np.ndarray | None = None,
        buffer: np.ndarray | None = None,
    ) -> Outcome:
        """Evaluate a set of variants; parameters as of `Machine.evaluate`."""
        parts = [(self._fields.evaluate(varied, drop, buffer), self._fields)] if self._fields else []
        count = parts[0][0].status.size if parts else max((np.size(v) for v in varied.values()), default=1)
        used, reached = np.full(count, np.nan), np.ones(count)
        for ladder in self._ladders:
            outcome, machine, share = self._climb(ladder, varied, drop, used)
            reached[~(share <= 1.0).all(axis=0)] = 0.0
            parts.append((outcome, machine))
        whole = self._together(parts)
        failed = whole.status != Verdict.OK
        used[failed] = reached[failed] = np.nan
        for quantity, values in ((USED, used), (REACHED, reached)):
            whole.summaries[quantity.name], whole.errors[quantity.name] = values, np.where(failed, np.nan, 0.0)
        return whole

    def _climb(
        self, ladder: "Ladder", varied: Mapping[str, np.ndarray], drop: np.ndarray | None, used: np.ndarray
    ) -> tuple[Outcome, Machine, np.ndarray]:
        """Evaluate on the lowest rung of a ladder, then what needs it on higher ones.

        Returns
        -------
        outcome : Outcome
        machine : Machine
            Of the lowest rung.
        share : ndarray (summaries, variants)
            Error figures by the allowed errors.
        """
        lowest = ladder.machine(0)
        whole = lowest.evaluate(varied, drop)
        share, waiting = excess(whole, self.accuracy), {}
        everyone = np.arange(whole.status.size)
        _note(used, everyone, whole, lowest)
        _add(waiting, ladder.after(0, share, np.full(share.shape, np.inf)), everyone)
        while waiting:
            rung = min(waiting)
            who = np.sort(waiting.pop(rung))
            part = ladder.machine(rung).evaluate({p: np.asarray(v)[who] for p, v in varied.items()})
            _put(whole, who, part)
            _note(used, who, part, ladder.machine(rung))
            part.summaries.pop(USED.name, None), part.errors.pop(USED.name, None)
            before, share[:, who] = share[:, who], excess(part, self.accuracy)
            _add(waiting, ladder.after(rung, share[:, who], before), who)
        return whole, lowest, share

    def _together(self, parts: list[tuple[Outcome, Machine]]) -> Outcome:
        """Outcomes of several machines as one: a variant fails where any of them does."""
        first, groups = parts[0][0], self.whole.groups
        whole = Outcome(*(a.copy() for a in first[:3]), {}, {}, {})
        whole.status_group[:] = -1
        for outcome, machine in parts:
            fails = outcome.status != Verdict.OK
            fails &= (whole.status == Verdict.OK) | (outcome is first)
            whole.status[fails], whole.status_at[fails] = outcome.status[fails], outcome.status_at[fails]
            numbers = np.array([*(groups.index(g) for g in machine.groups), -1])
            whole.status_group[fails] = numbers[outcome.status_group[fails]]
            whole.fields.update(outcome.fields)
        found = {n: (o.summaries[n], o.errors[n]) for o, _ in parts for n in o.summaries}
        for name in self.asked_summaries:
            if name in found:
                whole.summaries[name], whole.errors[name] = found[name]
        return whole


def _add(waiting: dict[int, np.ndarray], rungs: np.ndarray, who: np.ndarray) -> None:
    """Let variants wait for the rungs they go on with."""
    for rung in np.unique(rungs[rungs >= 0]).tolist():
        waiting[rung] = np.concatenate((waiting.get(rung, who[:0]), who[rungs == rung]))


def _note(used: np.ndarray, who: np.ndarray, outcome: Outcome, machine: Machine) -> None:
    """Note how many positions variants had, the most of all that was asked."""
    had = outcome.summaries.get(USED.name, float(machine.positions))
    used[who] = np.fmax(used[who], had)


def _put(whole: Outcome, who: np.ndarray, part: Outcome) -> None:
    """Put the outcome of some variants in its place."""
    whole.status[who], whole.status_group[who], whole.status_at[who] = part[:3]
    for name, values in whole.summaries.items():
        values[who], whole.errors[name][who] = part.summaries[name], part.errors[name]
