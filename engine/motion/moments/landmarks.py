"""Landmarks of a machine's cycle: ends of strokes, and crank angles at which torques have jumps or kinks."""

from collections.abc import Sequence

import numpy as np

from engine.compiling.blocks import LANES, gather, hand_out, hand_out_row, in_lanes
from engine.compiling.decorators import driver
from engine.compiling.kept_code import load_printed
from engine.compiling.packed import Packed, call_at
from engine.compiling.running import spread
from engine.compiling.tiles import TileFunction
from engine.cycle.driver import EvaluatedVariants, MachineFunctions, Task, Workspace, new_workspace
from engine.cycle.machine import MOST_DOUBLINGS, address_of_cuts
from engine.cycle.panels.walk import set_out
from engine.cycle.plan import Plan
from engine.graph.nodes import Found, Given, reached
from engine.mechanism.link_loads import Load
from engine.motion.moments.breaks import JUMP, Breaks, watches_of
from engine.motion.moments.tabulation import Ends, Tabulation
from engine.scene.scene import Numbers

# Offsets from a break at which torques are tested [rad]: close to a dead centre the stroke differs from its end by less
# than rounding, and a load that acts there may seem to vanish.
BESIDE = (JUMP, 1e-5)


class Landmarks:
    """Finds the ends of strokes and the breaks of a machine's torques.

    Parameters
    ----------
    tabulation : Tabulation
        With every switching curve of the machine among its events.
    loads : sequence of Load
    moments : dict of str to int
        Curve of the tabulation with the torque of each action.
    turns : int
        Crank revolutions in a cycle.
    """

    def __init__(self, tabulation: Tabulation, loads: Sequence[Load], moments: dict[str, int], turns: int) -> None:
        self.tabulation, self.moments = tabulation, moments
        functions = tabulation.functions
        graph = next(iter(functions.rows)).graph
        self.watches = watches_of(graph.crossings, loads)
        self.actions = tuple(sorted(frozenset().union(*(watch.actions for watch in self.watches))))
        # Actions that depend on time or do no work cannot be tested by their torques.
        self._unjudged = {load.action for load in loads if any(isinstance(n, Given) for n in reached([load.basis]))}
        self._unjudged |= set(self.actions) - moments.keys()
        self._found = [node for node in functions.rows if isinstance(node, Found)]
        self._task = self._asked(turns)

    def _asked(self, turns: int) -> Task:
        """The cycle's task: landmarks and crossings, without curves."""
        functions = self.tabulation.functions
        events = {curve: i for i, (curve, _) in enumerate(functions.events)}
        asked = [watch.crossing for watch in self.watches]
        crossings = [(events[c.curve], functions.rows[c.level], c.offset) for c in asked]
        plan = Plan(
            (0, 1),
            0,
            landmarks=functions.landmarks,
            levels=functions.found_levels,
            crossings=crossings,
            looks=functions.looks,
            turns=turns,
        )
        return plan.task([None] * 3)

    def __call__(self, numbers: Numbers, direction: np.ndarray) -> tuple[np.ndarray, Ends, Breaks]:
        """Numbers of the printed functions, the ends of strokes among them, and the breaks of all actions.

        Parameters
        ----------
        numbers : Numbers
        direction : ndarray (variants,)
            +1 or −1, the sign of the crank speed.
        """
        parameters = self.tabulation.parameters(numbers, direction)
        some_sought = len(self._task.landmarks) > 0
        found = self._find(parameters) if some_sought else np.full((0, 0, direction.size), np.nan)
        some = np.isfinite(found).any(axis=2)
        which, angles = np.nonzero(some)[0], found[some]
        ends = {node: parameters[self.tabulation.functions.rows[node]] for node in self._found}
        return parameters, ends, Breaks(angles, self.actions, self._acting(parameters, angles, which))

    def _find(self, parameters: np.ndarray) -> np.ndarray:
        """Positions of the crossings, (crossings, places, variants); writes the landmarks into the parameters."""
        task, (found, coarse) = self._task, self._found_at(self._task, parameters)
        chosen, doublings = np.flatnonzero(coarse > 0.0), 0
        while chosen.size and doublings < MOST_DOUBLINGS:
            task, doublings = task._replace(scan=2 * task.scan, most_roots=2 * task.most_roots), doublings + 1
            found = np.concatenate([found, np.full_like(found, np.nan)], axis=1)
            some = np.ascontiguousarray(parameters[:, chosen])
            found[..., chosen], coarse = self._found_at(task, some)
            parameters[:, chosen] = some
            chosen = chosen[coarse > 0.0]
        return found

    def _found_at(self, task: Task, parameters: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions found by one scan, and the variants for which the scan is too coarse."""
        functions, variants = self.tabulation.functions, parameters.shape[1]
        module = load_printed(functions.text)
        found, coarse = np.full((len(self.watches), task.most_roots, variants), np.nan), np.zeros(variants)

        given = MachineFunctions(TileFunction(module.events), TileFunction(module.levels), TileFunction(None))
        asked = Packed(task._replace(functions=given))
        chosen = Packed(EvaluatedVariants(np.zeros(0, np.int64), parameters, functions.memory))

        def arguments() -> tuple:
            room = Packed(new_workspace(task, len(parameters), 0))
            return asked, chosen, room, address_of_cuts(asked, chosen, room), found, coarse

        spread(find_places, -(-variants // LANES), arguments)
        return found, coarse

    def _acting(self, parameters: np.ndarray, angles: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Whether the torques of actions are nonzero next to their breaks, (actions, places, variants)."""
        acting = np.zeros((len(self.actions), *angles.shape), bool)
        if not angles.size:
            return acting
        owned = np.array([[name in self.watches[w].actions for w in which] for name in self.actions])[..., None]
        acting |= np.array([name in self._unjudged for name in self.actions])[:, None, None]
        for distance in BESIDE:
            # The second distance is seldom needed.
            if (acting | ~owned | np.isnan(angles)).all():
                break
            beside = np.concatenate([angles - distance, angles + distance])
            still = dict.fromkeys(self.tabulation.given, np.zeros_like(beside))
            rows = self.tabulation(parameters, beside, still).reshape(-1, 2, *angles.shape)
            for i, name in enumerate(self.actions):
                if name in self.moments:
                    acting[i] |= (rows[self.moments[name]] != 0.0).any(axis=0)
        return acting & owned & np.isfinite(angles)


@driver
def find_places(
    begin: int,
    end: int,
    task: Task,
    variants: EvaluatedVariants,
    work: Workspace,
    cuts: int,
    found: np.ndarray,
    coarse: np.ndarray,
) -> None:
    """Find the crossings in the cycles of the blocks begin … end − 1 of variants.

    `found` (crossings, roots, variants) receives the positions, NaN for missing ones; `coarse` (variants,) is set to 1
    where the scan is too coarse; `variants.numbers` receives the landmarks and numbers that depend on them.
    """
    block = in_lanes(work.block)
    numbers, crossings = variants.numbers, work.crossings
    for b in range(begin, end):
        first = b * LANES
        gather(numbers, first, block)
        set_out(block[task.ends[0]], block[task.ends[1]], task.longest, work.walk)
        for lane in range(LANES):
            work.too_many[lane] = 0.0
        call_at(cuts, (task, variants, work))
        level, slot = -1, 0
        for r in range(work.laid[0]):
            # Roots of one level are consecutive.
            slot = slot + 1 if crossings.level[r] == level else 0
            level = crossings.level[r]
            hand_out_row(crossings.rows[r].x, first, found[level, slot])
        hand_out(block, first, numbers)
        hand_out_row(work.too_many, first, coarse)
