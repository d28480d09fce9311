"""The results of a scene's machine elements for a set of variants, with error figures."""

from collections.abc import Callable, Iterable
from functools import cached_property

import numba
import numpy as np
from numba import types

from engine.compiling.decorators import driver
from engine.compiling.printed import load_printed
from engine.compiling.running import prepare, spread
from engine.compiling.threads import on_all_threads
from engine.compiling.tiles import FILLS_TILE, LANES, TileFunction
from engine.elements.bodies.body_elements import RotatingGuide, TetheredBody, TiltedBody, WoundFlywheel
from engine.elements.bodies.rotating_guides import rotating_guide_law
from engine.elements.bodies.tethered_bodies import tethered_body_law
from engine.elements.bodies.tilted_bodies import tilted_body_law
from engine.elements.bodies.wound_flywheels import wound_flywheel_law
from engine.elements.cams.cam_columns import cam_law
from engine.elements.cams.cam_elements import CamElement
from engine.elements.compliances.compliance_columns import compliance_law
from engine.elements.compliances.elastic_parts import ComplianceElement
from engine.elements.elastic_drives.machine_drive_columns import machine_drive_law
from engine.elements.elastic_drives.machine_drive_element import MachineDrive
from engine.elements.elastic_drives.two_mass_columns import drive_law
from engine.elements.elastic_drives.two_mass_element import TwoMassDrive
from engine.elements.element_laws import LAWS, NUDGE, ROUNDING, ElementLaw, ElementResult, LawOfArrays
from engine.elements.element_models import MachineElement
from engine.elements.engines.engine_columns import engine_law
from engine.elements.engines.engine_element import EngineElement
from engine.elements.engines.locomotive_balance import locomotive_law
from engine.elements.engines.locomotive_element import LocomotiveElement
from engine.elements.gears.chain_drives import chain_drive_law
from engine.elements.gears.drive_elements import ChainDrive, FrictionDrive
from engine.elements.gears.friction_wheels import friction_drive_law
from engine.elements.gears.gear_columns import gear_law
from engine.elements.gears.gear_elements import GearTrain
from engine.elements.governors.governor_columns import governor_law
from engine.elements.governors.governor_elements import Governor, governs_machine
from engine.elements.oscillators.oscillator_columns import oscillator_law
from engine.elements.oscillators.oscillator_element import OscillatorElement
from engine.elements.rotors.rotor_columns import rotor_law
from engine.elements.rotors.rotor_element import RotorElement, StaticRotor
from engine.elements.rotors.static_rotor import static_rotor_law
from engine.elements.torsional_trains.train_columns import train_law
from engine.elements.torsional_trains.train_element import TorsionalTrain
from engine.graph.functions import number_function
from engine.graph.nodes import Graph
from engine.laws.rounding import EPS
from engine.quantities.quantity import Quantity
from engine.scene.scene import Numbers, Scene
from engine.verdicts import Verdict

Columns = dict[str, np.ndarray]


def element_summaries(scene: Scene) -> list[Quantity]:
    """Summaries of a scene's machine elements."""
    return [Quantity(f"{n}.{r.name}", f"{n}: {r.long_name}", r.units) for n in scene.elements for r in _given(scene, n)]


class ElementColumns:
    """What is asked of a scene's machine elements.

    Parameters
    ----------
    scene : Scene
    asked : iterable of str
        Names of summaries; those that aren't of elements are left to others.

    Attributes
    ----------
    names : list of str
        Those that are.
    elements : tuple of str
        Elements of which something is asked.
    """

    def __init__(self, scene: Scene, asked: Iterable[str]) -> None:
        known = {q.name for q in element_summaries(scene)}
        self.scene, self.names = scene, [name for name in asked if name in known]
        self.elements = tuple(dict.fromkeys(name.partition(".")[0] for name in self.names))

    @property
    def governing(self) -> tuple[str, ...]:
        """Governors among them whose engine is the scene's mechanism."""
        return tuple(name for name in self.elements if governs_machine(self.scene.elements[name]))

    @cached_property
    def text(self) -> str:
        """Source of the function that computes what scalar laws give; nothing where there are none."""
        graph, results, rows = Graph(), [], {}
        for name, law in self._scalar_laws.items():
            given = [graph.derived(f"{name} {i}", lambda numbers: 0.0) for i in range(self._given[name])]
            rows |= {node: len(rows) + i for i, node in enumerate(given)}
            results += graph.apply(law.function, *given)
        return number_function("Machine elements.", results, rows) if results else ""

    @cached_property
    def _scalar_laws(self) -> dict[str, ElementLaw]:
        laws = {name: law_of(self.scene.elements[name]) for name in self.elements}
        return {name: law for name, law in laws.items() if isinstance(law, ElementLaw)}

    @cached_property
    def _given(self) -> dict[str, int]:
        """How many numbers each scalar law is given."""
        elements = self.scene.elements
        return {name: len(law.arguments(elements[name], lambda key: 0.0)) for name, law in self._scalar_laws.items()}

    @cached_property
    def _function(self) -> TileFunction:
        return TileFunction(load_printed(self.text).numbers)

    def fill(self, status: np.ndarray, summaries: Columns, errors: Columns, keep: np.ndarray, numbers: Numbers) -> None:
        """Write what is asked of the variants `keep`, and the verdict on those of them without a complaint so far.

        That of a law where it has one of its own; JAMS where a force or moment would have to be infinite, or what else
        an element calls it when a result is; NOT_FINITE where a law has no value.

        Parameters
        ----------
        status : ndarray (variants,) of uint8
        summaries, errors : dict of str to ndarray (variants,)
            Of an outcome, to be written to.
        keep : ndarray of int
            Indices of variants.
        numbers : Numbers
            Theirs.
        """
        if not self.elements:
            return
        values, figures, verdicts = self._values(numbers, keep.size)
        judged = (status[keep] == Verdict.OK) & (verdicts != Verdict.OK)
        status[keep[judged]] = verdicts[judged]
        every = self._every
        for name in self.elements:
            given, law = set(_given(self.scene, name)), law_of(self.scene.elements[name])
            must = [i for i, (n, r) in enumerate(every) if n == name and r in given and not r.may_be_undefined]
            well = status[keep] == Verdict.OK
            infinite, undefined = np.isinf(values[:, must]).any(axis=1), np.isnan(values[:, must]).any(axis=1)
            status[keep[well & infinite]] = law.infinite if isinstance(law, LawOfArrays) else Verdict.JAMS
            status[keep[well & undefined]] = Verdict.NOT_FINITE
        nothing = ~np.isfinite(values)
        values[nothing] = figures[nothing] = np.nan
        places = {f"{name}.{r.name}": i for i, (name, r) in enumerate(every)}
        for name in self.names:
            summaries[name][keep], errors[name][keep] = values[:, places[name]], figures[:, places[name]]

    @property
    def _every(self) -> list[tuple[str, ElementResult]]:
        """Everything that the laws give: element and result."""
        return [(name, r) for name in self.elements for r in law_of(self.scene.elements[name]).results]

    def _values(self, numbers: Numbers, variants: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """All results, their error figures, and the first verdict of a law on each variant.

        Error figures are rounding of the numbers, as the laws pass it on, and of the results.
        """
        verdicts = np.full(variants, Verdict.OK, np.uint8)
        by_name = self._by_scalar_laws(numbers, variants) if self._scalar_laws else {}
        for name in self.elements:
            law = law_of(self.scene.elements[name])
            if isinstance(law, LawOfArrays):
                value, error, verdict = _with_errors(law, self._arguments(name, numbers, variants))
                by_name[name] = value, error
                verdicts = np.where(verdicts == Verdict.OK, verdict, verdicts)
        values, errors = (np.concatenate([by_name[name][part] for name in self.elements]).T for part in range(2))
        for i, (_, result) in enumerate(self._every):
            if result.exact:
                errors[:, i] = 0.0
        return values, errors, verdicts

    def _by_scalar_laws(self, numbers: Numbers, variants: int) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Results (results, variants) of the elements with scalar laws, and their error figures."""
        laws, given = self._scalar_laws, self._given
        table = np.concatenate([self._arguments(name, numbers, variants) for name in laws])
        firsts = np.cumsum([0, *given.values()])[:-1]
        counts = [len(law.results) for law in laws.values()]
        values = evaluate_numbers(self._function, table, sum(counts))
        errors = ROUNDING * EPS * np.abs(values)
        with np.errstate(invalid="ignore"):
            for k in range(max(given.values())):
                # A number of each element at once: elements know nothing of each other.
                which = [first + k for first, n in zip(firsts, given.values(), strict=True) if k < n]
                greater = table.copy()
                greater[which] *= 1.0 + NUDGE
                errors += EPS / NUDGE * np.abs(evaluate_numbers(self._function, greater, sum(counts)) - values)
        parts = (np.split(found, np.cumsum(counts)[:-1]) for found in (values, errors))
        return {name: (value, error) for name, value, error in zip(laws, *parts, strict=True)}

    def _arguments(self, name: str, numbers: Numbers, variants: int) -> np.ndarray:
        element = self.scene.elements[name]
        found = law_of(element).arguments(element, lambda key: numbers[f"elements.{name}.{key}"])
        return np.array([np.broadcast_to(a, (variants,)) for a in found], float)


def evaluate_numbers(function: TileFunction, table: np.ndarray, count: int) -> np.ndarray:
    """What a printed function makes of the numbers of all variants.

    Parameters
    ----------
    function : TileFunction
        Fills a tile of one position from numbers alone.
    table : ndarray (numbers, variants)
    count : int
        How many results it gives.

    Returns
    -------
    ndarray (count, variants)
    """
    found = np.empty((count, table.shape[1]))
    nowhere, no_tables = np.zeros((1, LANES)), np.zeros(1)

    def arguments() -> tuple:
        block, tile = np.empty((len(table), LANES)), np.empty((count, 1, LANES))
        return (function, table, found, block, tile, nowhere, no_tables)

    prepare(_fill, [types.intp, types.intp, FILLS_TILE, *(numba.typeof(a) for a in arguments()[1:])])
    spread(_fill, -(-table.shape[1] // LANES), arguments)
    return found


@driver
def _fill(
    begin: int,
    end: int,
    function: Callable,
    table: np.ndarray,
    found: np.ndarray,
    block: np.ndarray,
    tile: np.ndarray,
    nowhere: np.ndarray,
    no_tables: np.ndarray,
) -> None:
    """Fill in what a function finds for blocks `begin` … `end` − 1 of LANES variants."""
    for b in range(begin, end):
        first = b * LANES
        count = min(LANES, table.shape[1] - first)
        for row in range(table.shape[0]):
            for lane in range(LANES):
                block[row, lane] = table[row, first + min(lane, count - 1)]
        function(block, no_tables, nowhere, nowhere, nowhere, tile)
        for row in range(found.shape[0]):
            for lane in range(count):
                found[row, first + lane] = tile[row, 0, lane]


def _with_errors(law: LawOfArrays, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Results (results, variants) of a law of arrays, their error figures, and verdicts, block by block."""
    pieces = np.array_split(numbers, max(1, -(-numbers.shape[1] // law.block)), axis=1)
    values, sizes, *verdicts = zip(*on_all_threads(law.function, pieces), strict=True)
    errors = ROUNDING * EPS * np.concatenate(sizes, axis=1)
    verdict = np.concatenate(verdicts[0]) if verdicts else np.full(numbers.shape[1], Verdict.OK, np.uint8)
    return np.concatenate(values, axis=1), errors, verdict


def law_of(element: MachineElement) -> ElementLaw | LawOfArrays:
    """What is computed of an element; of rotors, engines, governors, cams and gear trains it depends on their parts."""
    match element:
        case TetheredBody():
            return tethered_body_law(element)
        case TiltedBody():
            return tilted_body_law(element)
        case RotatingGuide():
            return rotating_guide_law(element)
        case WoundFlywheel():
            return wound_flywheel_law(element)
        case RotorElement():
            return rotor_law(element)
        case StaticRotor():
            return static_rotor_law(element)
        case EngineElement():
            return engine_law(element)
        case LocomotiveElement():
            return locomotive_law(element)
        case Governor():
            return governor_law(element)
        case CamElement():
            return cam_law(element)
        case OscillatorElement():
            return oscillator_law(element)
        case ComplianceElement():
            return compliance_law(element)
        case TorsionalTrain():
            return train_law(element)
        case TwoMassDrive():
            return drive_law(element)
        case MachineDrive():
            return machine_drive_law(element)
        case GearTrain():
            return gear_law(element)
        case FrictionDrive():
            return friction_drive_law(element)
        case ChainDrive():
            return chain_drive_law(element)
    return LAWS[element.type]


def _given(scene: Scene, name: str) -> list[ElementResult]:
    """Results that an element has with what it is given."""
    element = scene.elements[name]
    return [r for r in law_of(element).results if r.needs is None or getattr(element, r.needs) is not None]
