"""Rows of many variants, each at its own crank angles.

Motion needs a machine's rows at nodes where torques jump, and at another angle for every variant at every instant.
So a printed function of the machine's graph is called with a different position, and maybe variant, in each lane.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, gather, hand_out, in_lanes
from engine.compiling.decorators import driver
from engine.compiling.kept_code import load_printed
from engine.compiling.running import spread
from engine.compiling.tiles import TileFunction
from engine.cycle.panels.lanes import rows as lane_rows
from engine.graph.functions import Functions
from engine.graph.nodes import Constant, Found, Given
from engine.graph.values import LevelValues
from engine.laws.elementary import direction_of
from engine.scene.scene import Numbers

# Ends of strokes, and the crank angles there, each (variants,).
Ends = Mapping[Found, np.ndarray]


class Tabulation:
    """A machine's functions at separate angles of each variant.

    Parameters
    ----------
    functions : Functions
        From `engine.graph.functions.functions_at`.

    Attributes
    ----------
    functions : as given
    given : tuple of Given
        Numbers supplied at each position.
    levels : LevelValues
    """

    def __init__(self, functions: Functions) -> None:
        self.functions = functions
        self.given = tuple(node for node in functions.rows if isinstance(node, Given))
        self._compiled: dict[str, TileFunction] = {}
        self.levels = LevelValues(functions)
        self._found = [(node, row) for node, row in functions.rows.items() if isinstance(node, Found)]

    def parameters(
        self,
        numbers: Numbers,
        direction: np.ndarray,
        ends: Ends | None = None,
        given: Mapping[Given, np.ndarray | float] | None = None,
    ) -> np.ndarray:
        """Numbers of all variants at unit speed, so that a load of order n is the coefficient of |ω|ⁿ.

        Parameters
        ----------
        numbers : Numbers
        direction : ndarray (variants,)
            +1 or −1, the sign of the crank speed.
        ends : mapping of Found to ndarray, optional
            Ends of strokes; without them, dependent numbers are NaN.
        given : mapping of Given to ndarray, optional
            Numbers supplied for the variants.

        Returns
        -------
        ndarray (numbers, variants)
        """
        unit, functions = numbers.with_values({"input.speed": direction}), self.functions
        made = np.full((len(functions.rows), direction.size), np.nan)
        # An overflow in a parameter causes a verdict, not a warning.
        with np.errstate(all="ignore"):
            for row, node in enumerate(functions.numbers):
                made[row] = node.value if isinstance(node, Constant) else node.compute(unit)
        for node, row in self._found:
            if ends is not None:
                made[row] = ends[node]
        for node, values in (given or {}).items():
            if node in functions.rows:
                made[functions.rows[node]] = values
        self.levels.fill(made)
        return made

    def __call__(
        self, parameters: np.ndarray, q: np.ndarray, given: Mapping[Given, np.ndarray] | None = None
    ) -> np.ndarray:
        """The curves at given crank angles.

        Parameters
        ----------
        parameters : ndarray (numbers, variants)
        q : ndarray (nodes, variants)
            Crank angles [rad].
        given : mapping of Given to ndarray (nodes, variants), optional
            Numbers supplied at each position; the others are those of `parameters`.

        Returns
        -------
        ndarray (curves, nodes, variants)
        """
        rows, given = len(self.functions.curves), given or {}
        out = np.empty((rows, *q.shape))
        if not out.size:
            return out
        given_rows = np.array([self.functions.rows[node] for node in given], np.int64)
        every = np.array([np.broadcast_to(values, q.shape) for values in given.values()]).reshape(-1, q.size)
        numbers, flat = np.require(parameters, requirements="CW"), out.reshape(rows, q.size)
        batch = FilledPlaces(numbers, self.functions.memory, np.array(q).ravel(), every, given_rows, flat)

        def arguments() -> tuple:
            return self.function("curves_at"), batch, lane_rows(len(parameters) + rows + _ALSO)

        spread(fill_places, -(-q.size // LANES), arguments)
        return out

    def function(self, name: str) -> TileFunction:
        """One of the printed functions, compiled."""
        if name not in self._compiled:
            self._compiled[name] = TileFunction(getattr(load_printed(self.functions.text), name))
        return self._compiled[name]


class FilledPlaces(NamedTuple):
    """Output of a call at a number of points, and its input; point i belongs to variant i modulo their number.

    Attributes
    ----------
    parameters : ndarray (numbers, variants)
    memory : ndarray
        All tables.
    q : ndarray (points,)
        Crank angles [rad].
    given : ndarray (given, points)
        Numbers that replace parameters.
    given_rows : ndarray (given,) of int
        Rows of these.
    out : ndarray (curves, points)
    """

    parameters: np.ndarray
    memory: np.ndarray
    q: np.ndarray
    given: np.ndarray
    given_rows: np.ndarray
    out: np.ndarray


# Rows of a block in addition to numbers and curves: position with cosine and sine.
_ALSO = 3


@driver
def fill_places(begin: int, end: int, fill: Callable, batch: FilledPlaces, room: np.ndarray) -> None:
    """Fill the blocks begin … end − 1 of points; `room` is scratch memory for a block."""
    (count, variants), (rows, points) = batch.parameters.shape, batch.out.shape
    block, place, tile = room[:count], room[count : count + 3], room[count + 3 :].reshape(rows, 1, LANES)
    numbers, position, filled = in_lanes(block), in_lanes(place), in_lanes(room[count + 3 :])
    for b in range(begin, end):
        first = b * LANES
        # Lanes of successive variants load faster.
        successive = first % variants + LANES <= variants
        if successive:
            gather(batch.parameters, first % variants, numbers)
        for lane in range(LANES):
            point = min(first + lane, points - 1)
            variant = point % variants
            for i in range(0 if successive else count):
                numbers[i, lane] = batch.parameters[i, variant]
            for i in range(batch.given_rows.shape[0]):
                numbers[batch.given_rows[i], lane] = batch.given[i, point]
            position[0, lane] = batch.q[point]
            position[1, lane], position[2, lane] = direction_of(position[0, lane])
        fill(block, batch.memory, place[0:1], place[1:2], place[2:3], tile)
        hand_out(filled, first, batch.out)
