"""Warnings as columns: their number, and a flag for each kind, for a set of variants."""

from collections.abc import Callable, Iterable
from functools import reduce

import numpy as np

from engine.cycle.measured import Measured
from engine.scene.scene import Numbers, Scene
from engine.warnings import COUNT, is_warning
from engine.warnings.kinds import KINDS, rules_by_kind
from engine.warnings.rule import Rule
from engine.words.quantity import Quantity
from engine.words.verdicts import Verdict


def _computable_rules(scene: Scene, has: Callable[[str], bool]) -> dict[str, tuple[Rule, ...]]:
    """Rules of a scene whose quantities exist, by the names of their kinds."""
    found = {kind: tuple(r for r in rules if all(map(has, r.reads))) for kind, rules in rules_by_kind(scene).items()}
    return {kind: rules for kind, rules in found.items() if rules}


def warning_summaries(scene: Scene, has: Callable[[str], bool]) -> list[Quantity]:
    """Summaries for the warnings of a scene whose quantities exist, by `has`."""
    kinds = _computable_rules(scene, has)
    words = {kind.name: kind.long_name for kind in KINDS}
    flags = [Quantity(f"{COUNT}.{kind}", f"1 where the warning applies: {words[kind]}", "1") for kind in kinds]
    return [Quantity(COUNT, "number of warnings", "1"), *flags] if flags else []


class AskedWarnings:
    """Warnings among the requested summaries.

    Parameters
    ----------
    scene : Scene
    asked : iterable of str
        Names of summaries; those of other subjects are ignored.
    has : callable
        Whether a summary exists.

    Attributes
    ----------
    names : list of str
        Requested summaries that are warnings.
    reads : list of str
        Summaries that they require.
    """

    def __init__(self, scene: Scene, asked: Iterable[str], has: Callable[[str], bool]) -> None:
        wished = [name for name in asked if is_warning(name)]
        self._rules = _computable_rules(scene, has) if wished else {}
        known = [COUNT, *(f"{COUNT}.{kind}" for kind in self._rules)] if self._rules else []
        self.names = [name for name in wished if name in known]
        self.reads = list(dict.fromkeys(s for name in self.names for rule in self._of(name) for s in rule.reads))

    def _of(self, name: str) -> list[Rule]:
        kinds = self._rules if name == COUNT else [name.partition(".")[2]]
        return [rule for kind in kinds for rule in self._rules[kind]]

    def fill(
        self, status: np.ndarray, summaries: dict[str, np.ndarray], errors: dict[str, np.ndarray], numbers: Numbers
    ) -> None:
        """Write the requested columns of all variants; NaN where a variant failed.

        Parameters
        ----------
        status : ndarray (variants,) of uint8
        summaries, errors : dict of str to ndarray (variants,)
            Read from and written to.
        numbers : Numbers
        """
        known = {name: Measured(summaries[name], errors[name]) for name in self.reads}
        works = status == Verdict.OK
        for name in self.names:
            join = np.add if name == COUNT else np.maximum
            found = [rule.broken(numbers, known) for rule in self._of(name)]
            for rows, parts in ((summaries, [b.value for b in found]), (errors, [b.error for b in found])):
                rows[name][:] = np.where(works, reduce(join, parts), np.nan)
