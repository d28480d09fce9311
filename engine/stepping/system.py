"""A motion as a system of rates: states, accumulated integrals and guards, as nodes; printed and integrated."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numba import types

from engine.compiling.ahead import compile_ahead, wait_until_compiled
from engine.compiling.blocks import LANES
from engine.compiling.packed import Packed, PackedRecord
from engine.compiling.printed_functions import PrintedFunction
from engine.compiling.running import address_of, spread
from engine.compiling.threads import kept_by_thread
from engine.graph.functions import Functions, functions_in_motion, places_of
from engine.graph.nodes import Given, Graph, Node, Stage
from engine.graph.values import LevelValues
from engine.laws.runge_kutta import DENSE_PARTS, part_at
from engine.stepping.at_states import GivenStates, evaluate_states
from engine.stepping.closed_cycle import OUTCOME, CycleBatch, find_cycles, new_cycle_room
from engine.stepping.methods import EIGHT, EIGHT_IN_TIME, METHODS
from engine.stepping.steps.implicit_stages import find_stages
from engine.stepping.steps.step_guards import ROOT
from engine.stepping.steps.step_lanes import FOUND, GIVEN, RESPONSES, STEEPNESS, Printed, WalkBatch, new_room
from engine.stepping.walk import STEEPEST, StepAddresses, attempt, lay_steps, repeat_steps, walk
from engine.stepping.walk_task import DISPLACED, WALKS, WalkTask

# Fractions of a step at which its polynomial of degree seven is recorded.
RECORDED_AT = 0.5 - 0.5 * np.cos(np.pi * np.arange(8) / 7.0)
RECORDED_PARTS = np.array([part_at(part, RECORDED_AT) for part in range(DENSE_PARTS)]).T

# Edges of a motion that nothing bounds.
NO_EDGES = np.array([[-1e300], [1e300], [0.0], [0.0]])
# Numbers of lanes that aren't given.
NEVER = dict.fromkeys(("other_goal", "farthest", "longest"), np.inf)
ORDINARY = NEVER | {"start": 0.0, "direction": 1.0, "facing": 1.0, "clock": 0.0, "turned": 0.0, "floor": 0.0}


class System(NamedTuple):
    """A system of ordinary differential equations.

    Attributes
    ----------
    along : {"angle", "time"}
        Independent variable.
    states : tuple of Given
    rates : tuple of Node
        Derivatives of the states.
    speed, slope : Node
        Speed, and a node with the sign of its derivative.
    clock : Given
        The time.
    size, steepness : Node, optional
        Magnitude of the terms of the first rate, and its derivative with respect to the first state; otherwise 0.
    unknown : dict of Given to Given
        For a state whose rate is implicit: the node of that rate. At most one.
    gathered : dict of str to Node
        Integrands of accumulated integrals: time, works, …
    slopes : tuple of Node
        Jacobian of the rates of the energy or the speeds, where an implicit method may pay.
    responses : tuple of Node
        Derivatives of the integrands with respect to the first state, where errors are propagated.
    guards : tuple of Node
        Numbers that are positive until an event ends the walk, `Why.GUARD` and the next ones.
    switches : tuple of Node
        Numbers that are positive until an event ends a step and changes what is held.
    held : dict of Given to Node
        Numbers and states held until a switch, and the new value of each after that.
    signed : bool
        Whether speeds may be negative; else each side faces in its direction of motion.
    scales : tuple of Node
        Scales of the states' errors along time; without them, the states themselves.
    further : dict of str to Node
        Nodes that only `PrintedSystem.at` evaluates.
    """

    along: str
    states: tuple[Given, ...]
    rates: tuple[Node, ...]
    speed: Node
    slope: Node
    clock: Given
    size: Node | None = None
    steepness: Node | None = None
    unknown: Mapping[Given, Given] = MappingProxyType({})
    gathered: Mapping[str, Node] = MappingProxyType({})
    slopes: tuple[Node, ...] = ()
    responses: tuple[Node, ...] = ()
    guards: tuple[Node, ...] = ()
    switches: tuple[Node, ...] = ()
    held: Mapping[Given, Node] = MappingProxyType({})
    signed: bool = False
    scales: tuple[Node, ...] = ()
    further: Mapping[str, Node] = MappingProxyType({})


class Start(NamedTuple):
    """Where a number of walks start, (…, variants) each.

    Attributes
    ----------
    numbers, states, edges, instants, carried_errors : ndarray
        As in `WalkBatch`; by default, there are no edges, instants and errors.
    lanes : dict of str to ndarray or float
        Inputs of `Lane` by name.
    recorded : int
        Number of steps to record.
    """

    numbers: np.ndarray
    lanes: Mapping[str, np.ndarray | float]
    states: np.ndarray
    edges: np.ndarray | None = None
    instants: np.ndarray | None = None
    carried_errors: np.ndarray | None = None
    recorded: int = 0


class Walks(NamedTuple):
    """Results of a number of walks, (variants,) each.

    `states`, `carried_errors`, `ending` (states and gathered, variants) and `recorded` are as in
    `WalkBatch`, others as in `Lane`; `numbers` are those of the variants,
    with the held values at the end.
    """

    states: np.ndarray
    carried_errors: np.ndarray
    ending: np.ndarray
    turned: np.ndarray
    pace: np.ndarray
    at: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray
    slow_off: np.ndarray
    fast_off: np.ndarray
    slope: np.ndarray
    why: np.ndarray
    steps: np.ndarray
    recorded: np.ndarray
    numbers: np.ndarray


class Closed(NamedTuple):
    """Cycles that return to their own energies; meaningless for variants without one.

    Attributes
    ----------
    cycle : Walks
        Meaningless without a last cycle.
    energy : ndarray (variants,)
        At its start [J].
    off : ndarray (variants,)
        |P(E) − E|/E.
    verdict : ndarray (variants,)
        Numbers of `Verdict`, or `TOO_STEEP`.
    carried_error : ndarray (variants,)
        Error estimate of the energy [J].
    """

    cycle: Walks
    energy: np.ndarray
    off: np.ndarray
    verdict: np.ndarray
    carried_error: np.ndarray


class PrintedSystem:
    """A system with its printed functions.

    Parameters
    ----------
    system : System
    graph : Graph
        Graph of its nodes.
    first, last : Node
        Range of the position.

    Attributes
    ----------
    names : dict of str to int
        Rows of the integrals, by name; the rows of the states precede them.
    rows_of : dict of str to int
        Rows of the further nodes, of the steepness and of the slopes among the results of `at`, after those of `names`.
    """

    def __init__(self, system: System, graph: Graph, first: Node, last: Node) -> None:
        self.system = system
        self.rates = [*system.rates, *system.gathered.values()]
        size, steepness = (graph.zero if node is None else node for node in (system.size, system.steepness))
        before = system.speed, size, steepness, system.slope
        ends = *system.held.values(), *system.guards, *system.switches
        shown = [*before, *system.responses, *system.slopes, *system.scales, *system.further.values()]
        kinks = graph.kinks_behind(system.rates)
        self.watched, self._kinks = [*shown, *kinks, *ends], len(shown) + np.arange(len(kinks))
        self.last = (*system.states, *system.unknown.values())
        self.functions: Functions = functions_in_motion(graph, first, last, self.rates, self.watched, self.last)
        self.levels = LevelValues(self.functions)
        self._tasks: dict[tuple, Packed] = {}
        self._rated = len(places_of(self.rates))
        self.names = {name: len(system.states) + i for i, name in enumerate(system.gathered)}
        slope = len(self.rates) + RESPONSES + len(system.responses)
        first_further = slope + len(system.slopes) + len(system.scales)
        self.rows_of = {name: first_further + i for i, name in enumerate(system.further)}
        self.rows_of |= {"steepness": len(self.rates) + STEEPNESS}
        self.rows_of |= {f"slope {i}": slope + i for i in range(len(system.slopes))}

    def task(self, cycle: float, method: int = EIGHT, **others: bool | float) -> Packed:
        """Settings of a walk, a `WalkTask`.

        Parameters
        ----------
        cycle : float
        method : int
        others : bool or float
            `extremes`, `longer` and `root` as in `WalkTask`; `timed`: whether loads may depend on time.
        """
        asked = cycle, method, *sorted(others.items())
        if asked not in self._tasks:
            self._tasks[asked] = Packed(self._task(cycle, method, **others))
        return self._tasks[asked]

    def _task(
        self,
        cycle: float,
        method: int,
        extremes: bool = False,
        longer: float = 1.0,
        root: float = ROOT,
        timed: bool = True,
    ) -> WalkTask:
        system, rows = self.system, self.functions.rows
        method = EIGHT_IN_TIME if method == EIGHT and system.along == "time" else method
        made = METHODS[method]
        timed = timed and system.clock in rows
        return WalkTask(
            along_time=system.along == "time",
            method=method,
            stages=made.stages,
            fixed=not made.fine.any(),
            longer=longer,
            displaces=DISPLACED[WALKS.index(longer)] if system.unknown and not made.implicit else 0.0,
            steepest=STEEPEST if system.along == "angle" else STEEPEST / max(WALKS) * longer,
            implicit=made.implicit,
            solved=math.isqrt(len(system.slopes)),
            slopes=RESPONSES + len(system.responses),
            scales=RESPONSES + len(system.responses) + len(system.slopes) if system.scales else -1,
            solves=next(map(system.states.index, system.unknown), -1),
            nodes=made.nodes,
            matrix=made.matrix,
            inverse=made.inverse,
            states=len(system.states),
            width=len(self.rates),
            watched=len(self.watched),
            guards=len(system.guards) + len(system.switches),
            endings=len(system.guards),
            kinks=self._kinks,
            carries=len(system.responses) > 0 and bool(made.fine.any()),
            first_place=len(rows) - len(self.last) - len(self.functions.curves),
            places=len(self.functions.curves),
            rated=self._rated,
            clock=rows[system.clock] if timed else -1,
            extremes=extremes,
            root=root,
            recorded=np.vstack([RECORDED_PARTS @ made.parts, RECORDED_PARTS[:, -1].max() * made.parts[-1]]),
            cycle=cycle,
            held=np.array([rows[node] for node in system.held], int),
            signed=system.signed,
        )

    def run(self, asked: Packed, start: Start) -> Walks:
        """Walk with the settings of a task."""
        task, batch = asked.record, self._batch(asked.record, start)
        repeats = not (task.along_time or task.implicit or start.recorded) and np.isfinite(task.cycle)
        self._go(walk, asked, batch, room_of, bool(repeats))
        return _walks(batch)

    def at(
        self,
        numbers: np.ndarray,
        places: np.ndarray,
        states: Sequence[np.ndarray],
        wanted: Sequence[int],
        clock: np.ndarray | float = 0.0,
        who: np.ndarray | None = None,
    ) -> np.ndarray:
        """Evaluate the system at states of many variants.

        Parameters
        ----------
        numbers : ndarray (numbers, variants)
        places : ndarray (…, columns)
            Positions of the input [rad].
        states : sequence of ndarray (…, columns)
        wanted : sequence of int
            Rows of the results, from `names` and `rows_of`; the first ones are the rates of the states.
        clock : ndarray (…, columns), optional
            Time [s].
        who : ndarray (columns,) of int, optional
            Variant of each column; by default, each variant has one.

        Returns
        -------
        ndarray (wanted, …, columns)
            NaN where an implicit rate has no solution.
        """
        found = np.empty((len(wanted), places.size))
        rows = (np.array(np.broadcast_to(row, places.shape), float).ravel() for row in (places, clock))
        flat = np.array([np.broadcast_to(state, places.shape) for state in states]).reshape(len(states), places.size)
        numbers, who = np.require(numbers, requirements="CW"), np.arange(numbers.shape[1]) if who is None else who
        variants = np.array(np.broadcast_to(who, places.shape)).ravel()
        batch = GivenStates(self._printed, numbers, variants, *rows, flat, np.array(wanted, int), found)
        given, asked = Packed(batch), self.task(np.inf)
        spread(evaluate_states, -(-places.size // LANES), lambda: (given, asked, room_of(asked, len(numbers), 1)))
        return found.reshape(len(wanted), *places.shape)

    def close(self, asked: Packed, start: Start, last: Packed, farthest: float) -> Closed:
        """Find the cycles that return to their own energies, from energies at which loads should dominate.

        Other parameters are those of `run` and `CycleBatch`.
        """
        walks = self._batch(asked.record, start)
        outcome = np.empty((len(OUTCOME), start.states.shape[1]))
        batch = CycleBatch(walks, last.record, farthest, outcome, self.names["fading"])
        self._go(find_cycles, asked, batch, cycle_room_of, not asked.record.implicit)
        return Closed(_walks(walks), *outcome)

    def _batch(self, task: WalkTask, start: Start) -> WalkBatch:
        """Memory of walks; numbers that don't change are shared with their start."""
        numbers, states = start.numbers, np.array(start.states, float, order="C")
        numbers, count = numbers.copy() if self.system.held else numbers, states.shape[1]
        edges = np.repeat(NO_EDGES, count, axis=1) if start.edges is None else start.edges
        instants = np.zeros((0, count)) if start.instants is None else start.instants
        errors = np.zeros_like(states) if start.carried_errors is None else start.carried_errors
        lanes = ORDINARY | start.lanes
        rows = np.array([np.broadcast_to(lanes[name], (count,)) for name in GIVEN], float)
        parts = (np.require(part, float, "CW") for part in (numbers, edges, instants, rows))
        kept = np.empty((start.recorded, 3 + (task.states + 1) * (1 + RECORDED_AT.size), count))
        ending, found, errors = np.empty_like(states), np.empty((len(FOUND), count)), np.array(errors, float, order="C")
        return WalkBatch(self._printed, *parts, states, errors, ending, found, kept)

    def _go(
        self, driver: Callable, asked: Packed, batch: WalkBatch | CycleBatch, room_of: Callable, repeats: bool
    ) -> None:
        """Run a driver over all blocks of a batch."""
        given, walks = Packed(batch), batch if driver is walk else batch.walks
        sizes = len(walks.numbers), len(walks.edges) // 2, len(walks.instants), repeats

        def arguments() -> tuple:
            own = room_of(asked, *sizes)
            kinds = (
                (given.kind, own.kind) if driver is walk else (given.kind.kind_of("walks"), own.kind.kind_of("walk"))
            )
            return _addresses(kinds[0], asked, kinds[1]), given, asked, own

        wait_until_compiled(walk)
        spread(driver, -(-walks.states.shape[1] // LANES), arguments)

    @cached_property
    def _printed(self) -> Printed:
        codes = map(self.functions.codes.get, ("places", "rates", "watch"))
        return Printed(*map(PrintedFunction, codes), self.functions.memory)

    def limited(self, numbers: np.ndarray, limits: Mapping[Given, np.ndarray | float]) -> np.ndarray:
        """Numbers of variants with `limits` set, which only guards use, and with what follows from them."""
        numbers = numbers.copy()
        for node, values in limits.items():
            if node in self.functions.rows:
                numbers[self.functions.rows[node]] = values
        if self.levels.depend_on(limits):
            self.levels.fill(numbers)
        return numbers


def _walks(batch: WalkBatch) -> Walks:
    """Results of walks from their memory."""
    errors, parts = batch.carried_errors, (batch.recorded, batch.numbers)
    return Walks(batch.states, errors, batch.ending, *batch.found, *parts)


@kept_by_thread
def room_of(asked: Packed, numbers: int, edges: int, instants: int = 0, repeats: bool = False) -> Packed:
    """Scratch memory of the calling thread for one block of a walk; parameters as for `new_room`."""
    return Packed(new_room(asked.record, numbers, edges, instants, repeats))


@kept_by_thread
def cycle_room_of(asked: Packed, *sizes: int) -> Packed:
    """Scratch memory of the calling thread for one block of a search for closed cycles; parameters as for `room_of`."""
    return Packed(new_cycle_room(new_room(asked.record, *sizes)))


def _addresses(walks: PackedRecord, task: Packed, room: PackedRecord) -> Packed:
    """Addresses of the functions that all walks share, compiled now or loaded from the cache."""
    stages = address_of(find_stages, walks.kind_of("printed"), task.kind, room) if task.record.implicit else 0
    kinds = Packed(StepAddresses(0, 0, 0, 0)).kind, walks, task.kind, room
    steps = (address_of(part, types.intp, *kinds) for part in (lay_steps, repeat_steps))
    return Packed(StepAddresses(stages, address_of(attempt, types.intp, types.boolean, *kinds), *steps))


def compile_walks_ahead() -> None:
    """Compile what all systems share in another process."""
    compile_ahead(walk, compile_walks)


def compile_walks() -> None:
    """Compile walks and the search for closed cycles, or load them from the cache, with a body without loads."""
    graph = Graph()
    zero, one, energy = graph.zero, graph.one, graph.given("kinetic energy", Stage.STATE)
    clock = graph.given("time of a state", Stage.STATE)
    integrals = {"gathered": {"fading": zero}, "responses": (zero,)}
    system = System("angle", (energy,), rates=(zero,), speed=one, slope=zero, clock=clock, slopes=(zero,), **integrals)
    body = PrintedSystem(system, graph, zero, one)
    task, numbers = body.task(1.0), np.zeros((len(body.functions.rows), 1))
    one_radian = {"goal": 1.0, "tolerance": 1e-3, "pace": 1.0, "farthest": 1.0}
    start = Start(numbers, one_radian, np.ones((2, 1)))
    body.run(task, start)
    body.close(task, start, task, np.inf)
