"""Machine elements of a scene with a mechanism: some of them are excited or driven by the machine, or govern it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property

import numpy as np

from engine import elements, machine
from engine.graph.nodes import Node
from engine.machine.elements.asked_elements import AskedElements
from engine.machine.judging.judgement import Failures
from engine.machine.measuring.measured_cycles import MeasuredCycles
from engine.machine.results import Outcome
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import Expression
from engine.scene.scene import Numbers
from engine.words.verdicts import Verdict

# Variants whose machine curves are computed together for governors.
GOVERNED_AT_ONCE = 1024


class AttachedElements(AskedElements):
    """Requested results of machine elements, with the machine's data for those that depend on it.

    Parameters
    ----------
    mechanics : Mechanics
    asked : iterable of str
        Names of summaries; those of other parts are ignored.
    asked_otherwise : callable
        Returns the machine with other requested summaries and fields, these at a number of positions.

    Attributes
    ----------
    need_machine : bool
        Whether any requested result depends on the machine.
    drives : ElasticDrives or None
        Elastic shafts between the machine's motors and its crank.
    """

    def __init__(self, mechanics: Mechanics, asked: Iterable[str], asked_otherwise: Callable) -> None:
        super().__init__(mechanics.scene, asked)
        self._mechanics, self._asked_otherwise = mechanics, asked_otherwise
        kinds = {name: element.type for name, element in self.elements.items() if any(element.machine_needed())}
        self.need_machine = bool(kinds)
        self._trains = [name for name, kind in kinds.items() if kind == "torsional_train"]
        drives = [name for name, kind in kinds.items() if kind == "machine_drive"]
        self._governors = [name for name in kinds if name not in (*self._trains, *drives)]
        self.drives = machine.drives.elastic_drives.ElasticDrives(mechanics, drives) if drives else None

    @property
    def nodes(self) -> list[Node]:
        """Nodes from which the motion of drives is computed at a position."""
        return self.drives.nodes if self.drives else []

    @cached_property
    def harmonics(self) -> list[Expression]:
        """Excitation of torsional trains by the machine, as expressions to be measured; empty without trains."""
        return machine.drives.excited_trains.machine_harmonics(self._mechanics) if self._trains else []

    def excitation(self, answers: MeasuredCycles, numbers: Numbers, variants: int) -> dict[str, np.ndarray]:
        """Excitation of torsional trains as numbers by key; empty without trains.

        Parameters
        ----------
        answers : MeasuredCycles
            Including `harmonics`.
        numbers : Numbers
            Numbers of the scene.
        variants : int
        """
        if not self._trains:
            return {}
        return machine.drives.excited_trains.machine_numbers(
            numbers, self._mechanics, self.harmonics, answers.value_of, variants
        )

    def fill_all(
        self,
        outcome: Outcome,
        keep: np.ndarray,
        numbers: Numbers,
        parts: Sequence[str],
        excitation: Sequence[Mapping[str, np.ndarray]],
    ) -> None:
        """Write results and verdicts as `fill` does, with the machine's data for the elements that need them.

        Parameters
        ----------
        outcome, keep, numbers, parts
            As for `fill`.
        excitation : sequence of mapping of str to ndarray
            For consecutive sets of these variants.
        """
        if not self.elements:
            return
        numbers = numbers.with_values(
            {
                f"elements.{train}.{key}": np.concatenate([found[key] for found in excitation])
                for train in self._trains
                for key in excitation[0]
            }
        )
        if self.drives is not None:
            numbers = numbers.with_values(self.drives.numbers(numbers, outcome.status[keep] == Verdict.OK))
        batch = GOVERNED_AT_ONCE if self._governors else keep.size
        for first in range(0, keep.size, batch):
            some = slice(first, first + batch)
            own = self._governed(outcome, keep[some], numbers.of_variants(some))
            self.fill(outcome, keep[some], own, parts)

    def _governed(self, outcome: Outcome, keep: np.ndarray, numbers: Numbers) -> Numbers:
        """Numbers in which the engine of each governor of this machine has the machine's inertia and curves.

        Verdicts on the machine pass to the variants `keep`.
        """
        if not self._governors:
            return numbers
        engines, mechanism = self._governed_engines
        found = mechanism.evaluate({path: np.broadcast_to(numbers[path], keep.shape) for path in mechanism.varied})
        Failures(found.status, found.status_group, found.status_at).write(outcome, keep)
        return numbers.with_values(engines.numbers(found, numbers))

    @cached_property
    def _governed_engines(self) -> tuple:
        """Engines of the governors of this machine, and the machine with the quantities they require."""
        engines = machine.drives.governed_engines.GovernedEngines(self._mechanics.scene, self._governors)
        positions = elements.governors.transients.CYCLE_POSITIONS
        return engines, self._asked_otherwise(engines.summaries, engines.fields, positions)
