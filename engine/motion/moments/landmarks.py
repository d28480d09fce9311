"""Landmarks of a machine's cycle: ends of strokes, and crank angles at which torques have jumps or kinks."""

import math
from collections.abc import Sequence
from functools import cached_property

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.cycle.cycle_machine import CycleMachine
from engine.cycle.plan import Plan
from engine.graph.nodes import Found, Given, reached
from engine.mechanism.link_loads import Load
from engine.motion.moments.breaks import JUMP, Breaks, watches_of
from engine.motion.moments.tabulation import Ends, Tabulation
from engine.scene.scene import Numbers

# Offset from a break at which torques are tested [rad]: closer to a dead centre the stroke differs from its end by less
# than rounding, and a load that acts there may seem to vanish.
CLEAR = 1e-5


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
        self._turns = turns

    @cached_property
    def _cycle(self) -> CycleMachine:
        """The cycle with its landmarks and crossings, without curves."""
        functions = self.tabulation.functions
        events = {curve: i for i, (curve, _) in enumerate(functions.events)}
        asked = [watch.crossing for watch in self.watches]
        plan = Plan(
            (0, 1),
            0,
            landmarks=functions.landmarks,
            levels=functions.found_levels,
            crossings=[(events[c.curve], functions.rows[c.level], c.offset) for c in asked],
            tells_crossings=True,
            looks=functions.looks,
            turns=self._turns,
        )
        return CycleMachine(plan, None, *(PrintedFunction(functions.codes.get(name)) for name in ("events", "levels")))

    def __call__(self, numbers: Numbers, direction: np.ndarray) -> tuple[np.ndarray, Ends, Breaks]:
        """Numbers of the printed functions, the ends of strokes among them, and the breaks of all actions.

        Parameters
        ----------
        numbers : Numbers
        direction : ndarray (variants,)
            +1 or −1, the sign of the crank speed.
        """
        parameters = self.tabulation.parameters(numbers, direction)
        functions, found = self.tabulation.functions, np.full((0, 0, direction.size), np.nan)
        if functions.landmarks:
            outcome = self._cycle.evaluate(parameters, functions.memory)
            self.tabulation.levels.fill_found(parameters, lambda which: outcome.landmarks.at_end(which).value)
            found = outcome.crossings
        some = np.isfinite(found).any(axis=2)
        which, angles = np.nonzero(some)[0], found[some]
        ends = {node: parameters[functions.rows[node]] for node in self._found}
        return parameters, ends, Breaks(angles, self.actions, self._acting(parameters, angles, which))

    def _acting(self, parameters: np.ndarray, angles: np.ndarray, which: np.ndarray) -> np.ndarray:
        """Whether the torques of actions are nonzero next to their breaks, (actions, breaks, variants)."""
        acting = np.zeros((len(self.actions), *angles.shape), bool)
        if not angles.size:
            return acting
        owned = np.array([[name in self.watches[w].actions for w in which] for name in self.actions])[..., None]
        acting |= np.array([name in self._unjudged for name in self.actions])[:, None, None]
        around = np.sort([*angles, np.fmin.reduce(angles, axis=0) + math.tau * self._turns], axis=0)
        # Between two close breaks, torques are tested next to each of them.
        close = np.flatnonzero((np.diff(around, axis=0) < 2.0 * CLEAR).any(axis=0))
        for distance, some in ((CLEAR, slice(None)), (JUMP, close)):
            own = angles[:, some]
            if not own.size:
                continue
            offset = np.concatenate([own - distance, own + distance])
            still = dict.fromkeys(self.tabulation.given, np.zeros_like(offset))
            rows = self.tabulation(parameters[:, some], offset, still).reshape(-1, 2, *own.shape)
            for i, name in enumerate(self.actions):
                if name in self.moments:
                    acting[i][:, some] |= (rows[self.moments[name]] != 0.0).any(axis=0)
        return acting & owned & np.isfinite(angles)
