"""Quantities requested of a machine, and those available."""

from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import NamedTuple

from engine import machine, motion, warnings
from engine.graph.nodes import Node
from engine.machine.checks import check_names, full_names, names_of
from engine.machine.results import AskError
from engine.mechanism.mechanics import Mechanics
from engine.quantities.all_chapters import register_of
from engine.quantities.register import Field, Summary
from engine.words.quantity import STATISTICS, Quantity, Rank

POSITIONS_USED = Quantity("positions_used", "number of input positions evaluated", "1", rank=Rank.CHECK)
ACCURACY_REACHED = Quantity(
    "accuracy_reached",
    "1 where every error estimate is within the requested accuracy, else 0",
    "1",
    rank=Rank.CHECK,
)
OF_ACCURACY = (POSITIONS_USED.name, ACCURACY_REACHED.name)


class _NoRegimes(NamedTuple):
    """Stand-in for `motion.regimes.Regimes` in a scene without regimes: most machines don't need the motion package."""

    summaries: Mapping[str, Quantity] = {}
    fields: Mapping[str, Quantity] = {}
    asked: tuple[str, ...] = ()
    kept_at: Mapping[str, "motion.quantities.KeptAt"] = {}
    in_order: None = None
    nodes: tuple[Node, ...] = ()


class AskedQuantities:
    """Quantities requested of a machine, by the parts that compute them.

    Parameters
    ----------
    mechanics : Mechanics
    summaries, fields : str or iterable of str
        Their names.
    positions : int
    accuracy : float or None
        As in `Machine`.

    Attributes
    ----------
    register : Register
        Quantities of the mechanism.
    summaries, fields : list of str
        Requested names.
    other_names : dict of str to str
        The full name for each name of a force by its joint.
    warnings : AskedWarnings or None
        Requested warnings.
    computed : list of str
        Requested summaries, and those that the warnings read.
    regimes : Regimes
    measured : dict of str to Summary
        Summaries of the mechanism.
    of_mechanism : dict of str to Field
        Fields of the mechanism.

    Raises
    ------
    AskError
        A name is unknown; the message lists similar ones.
    """

    def __init__(
        self,
        mechanics: Mechanics,
        summaries: str | Iterable[str],
        fields: str | Iterable[str],
        positions: int,
        accuracy: float | None,
    ) -> None:
        self._scene, self.register = mechanics.scene, register_of(mechanics)
        summaries, fields = names_of(summaries), names_of(fields)
        full = {name: full_names(self._scene, name) for name in (*summaries, *fields)}
        self.summaries = list(dict.fromkeys(full[name] for name in summaries))
        self.fields = list(dict.fromkeys(full[name] for name in fields))
        self.other_names = {name: own for name, own in full.items() if name != own}
        self.warnings = self._asked_warnings()
        # Warnings read summaries that may not have been requested.
        self.computed = list(dict.fromkeys([*self.summaries, *(self.warnings.reads if self.warnings else ())]))
        of_elements = {q.name for q in self._of_elements}
        asked = (*self.computed, *self.fields)
        regimes = self._scene.regimes
        self.regimes = motion.regimes.Regimes(mechanics, asked, positions, accuracy) if regimes else _NoRegimes()
        of_warnings = self.warnings.names if self.warnings else ()
        of_others = {*of_elements, *OF_ACCURACY, *self.regimes.asked, *of_warnings}
        self._check(of_others)
        self.measured: dict[str, Summary] = {
            name: self.register.summary(name) for name in self.computed if name not in of_others
        }
        self.of_mechanism: dict[str, Field] = {
            name: self.register.fields[name] for name in self.fields if name not in of_others
        }

    def _asked_warnings(self) -> "warnings.asked_warnings.AskedWarnings | None":
        if not any(map(warnings.is_warning, self.summaries)):
            return None
        return warnings.asked_warnings.AskedWarnings(self._scene, self.summaries, self._has_summary)

    def _has_summary(self, name: str) -> bool:
        """Whether a summary of the cycle or of a regime exists."""
        if self.register.summary(name) is not None:
            return self.register.why_not(name) is None
        return bool(self._scene.regimes) and name in {q.name for q in motion.quantities.motion_summaries(self._scene)}

    def _check(self, of_others: set[str]) -> None:
        """Reject unknown names; `of_others` are the requested ones that the mechanism's register doesn't have."""
        fields = {**self.register.fields, **self.regimes.fields}
        for name in self.summaries:
            if name in fields and name not in self.available_summaries:
                statistics = ", ".join(f"{name}.{statistic}" for statistic in STATISTICS)
                raise AskError(f"{name!r} is a field, a curve: ask for it as a field, or for its {statistics}")
        for name in self.fields:
            if name not in fields and self.register.summary(name) is not None:
                raise AskError(f"{name!r} is a summary, a single number: ask for it as a summary")
        check_names(self.fields, fields, "field")
        unknown = [n for n in self.summaries if n not in of_others and self.register.summary(n) is None]
        if unknown:
            statistics = [f"{field}.{statistic}" for field in self.register.fields for statistic in STATISTICS]
            check_names(unknown, [*self.available_summaries, *statistics], "summary")
        for name in (*self.summaries, *self.fields):
            why = self.register.why_not(name)
            if why is not None:
                raise AskError(why)

    @property
    def available_fields(self) -> dict[str, Quantity]:
        """Every field of the scene."""
        own = {name: field.quantity for name, field in self.register.available_fields.items()}
        return own | self.regimes.fields

    @cached_property
    def available_summaries(self) -> dict[str, Quantity]:
        """Every summary, except those statistics of fields that aren't requested."""
        of_warnings = warnings.asked_warnings.warning_summaries(self._scene, self._has_summary)
        return self._without_warnings | {q.name: q for q in of_warnings}

    @property
    def _of_elements(self) -> list[Quantity]:
        return machine.elements.asked_elements.element_summaries(self._scene) if self._scene.elements else []

    @property
    def _without_warnings(self) -> dict[str, Quantity]:
        names = [name for name in self.register.summaries if self.register.why_not(name) is None]
        summaries = {name: self.register.summary(name) for name in (*names, *self.summaries)}
        own = {name: summary.quantity for name, summary in summaries.items() if summary is not None}
        others = {q.name: q for q in (*self._of_elements, POSITIONS_USED, ACCURACY_REACHED)}
        return own | self.regimes.summaries | others

    @cached_property
    def units(self) -> dict[str, str]:
        """SI unit of every requested quantity; warnings are plain numbers."""
        known = self._without_warnings | self.available_fields
        return {name: known[name].units if name in known else "1" for name in (*self.summaries, *self.fields)}
