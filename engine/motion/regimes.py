"""The regimes of a machine: available results, and their values for many variants."""

from collections.abc import Iterable

import numpy as np

from engine import motion
from engine.graph.nodes import Node
from engine.mechanism.mechanics import Mechanics
from engine.motion.quantities import (
    EFFICIENCY_NOW,
    EXTREMES,
    OVER_TIME,
    Asked,
    KeptAt,
    kept_at_of,
    kept_fields,
    motion_fields,
    motion_summaries,
    statistics_of,
)
from engine.quantities.register import InputUnits
from engine.scene.scene import Numbers
from engine.words.quantity import Quantity
from engine.words.verdicts import Verdict


class Regimes:
    """Requested results of a machine's regimes.

    Parameters
    ----------
    mechanics : Mechanics
    asked : iterable of str
        Names of summaries and fields; names that belong to no regime are ignored.
    steps : int
        Even number of steps in a cycle.
    accuracy : float, optional
        Requested relative accuracy of the results.

    Attributes
    ----------
    summaries, fields : dict of str to Quantity
        Available results; only the requested ones among the statistics of fields.
    asked : tuple of str
        Requested summaries and fields.
    kept_at : dict of str to KeptAt
        Where the fields of runs are stored; those of steady regimes are stored over the cycle.
    in_order : RegimesInOrder or None
        The regimes in order; None if no result of them is requested.
    """

    def __init__(self, mechanics: Mechanics, asked: Iterable[str], steps: int, accuracy: float | None) -> None:
        self._scene = mechanics.scene
        self.summaries = {quantity.name: quantity for quantity in motion_summaries(mechanics.scene)}
        self._of_cycles = {quantity.name: quantity for quantity in motion_fields(mechanics)}
        kept, instants = {q.name: q for q in kept_fields(mechanics)}, kept_at_of(mechanics.scene)
        self.fields = self._of_cycles | kept
        self.kept_at: dict[str, KeptAt] = {name: instants[name.partition(".")[0]] for name in kept}
        self._along_runs = {quantity.name: quantity for quantity in motion_fields(mechanics, "run")}
        asked = list(dict.fromkeys(asked))
        self.summaries |= self._statistics(asked)
        self.asked = tuple(name for name in asked if name in self.summaries or name in self.fields)
        self.in_order: motion.regimes_in_order.RegimesInOrder | None = None
        if self.asked:
            self.in_order = motion.regimes_in_order.RegimesInOrder(mechanics, set(self.asked), steps, accuracy)

    def _statistics(self, names: Iterable[str]) -> dict[str, Quantity]:
        """The statistics of fields among some names."""
        # Without input power the efficiency is undefined, and so is its minimum.
        asked = (one for one in map(Asked.of, names) if one.statistic and one.field != EFFICIENCY_NOW)
        fields = {f"{one.regime}.{one.field}" for one in asked}
        q, kinds = InputUnits.of(self._scene).q, ((self._of_cycles, OVER_TIME), (self._along_runs, EXTREMES))
        known = (s for own, table in kinds for n in fields & own.keys() for s in statistics_of(own[n], table, q))
        found = {s.name: s for s in known}
        return {name: found[name] for name in names if name in found}

    @property
    def nodes(self) -> list[Node]:
        """Nodes from which the motion is computed at a position."""
        return [] if self.in_order is None else self.in_order.nodes

    def answers(self, numbers: Numbers, count: int) -> "motion.regimes_in_order.RegimeAnswers":
        """Requested results of a number of variants.

        Parameters
        ----------
        numbers : Numbers
        count : int
            Number of variants.
        """
        found = self.in_order.answers(numbers, count)
        missing = np.zeros(count, bool)
        for name, value in found.values.items():
            if not self.summaries[name].may_be_undefined:
                missing |= ~np.isfinite(value)
        verdict = np.where(missing & (found.verdict == Verdict.OK), Verdict.NOT_FINITE, found.verdict)
        return found._replace(verdict=verdict.astype(np.uint8))
