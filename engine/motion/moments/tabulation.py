"""Rows of many variants, each at its own crank angles.

Motion needs a machine's rows at nodes where torques jump, and at another angle for every variant at every instant.
So a printed function of the machine's graph is called position by position, with a different position in each lane, and
its rows are summed as requested.
"""

from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import gather, hand_out, in_lanes
from engine.compiling.decorators import driver
from engine.compiling.printed import load_printed
from engine.compiling.running import spread
from engine.compiling.tiles import TileFunction
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import rows as lane_rows
from engine.graph.functions import Functions
from engine.graph.nodes import Constant, Found, Given
from engine.laws.elementary import direction_of
from engine.scene.scene import Numbers

# Ends of strokes, and the crank angles there, each (variants,).
Ends = Mapping[Found, np.ndarray]


class Sums(NamedTuple):
    """How rows are summed.

    Attributes
    ----------
    target : ndarray (rows,) of int
        Sum of each row; −1 for none.
    count : int
        Number of sums.
    turned : ndarray (rows,) of bool
        Rows converted to the direction of motion.
    direction : ndarray (variants,)
        +1 or −1.
    """

    target: np.ndarray
    count: int
    turned: np.ndarray
    direction: np.ndarray


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
    """

    def __init__(self, functions: Functions) -> None:
        self.functions = functions
        self.given = tuple(node for node in functions.rows if isinstance(node, Given))
        self._compiled: dict[str, TileFunction] = {}
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
        levels = list(functions.level_rows)
        if levels:
            made[levels] = self._filled("levels", len(levels), made, np.zeros((1, direction.size)))[:, 0]
        return made

    def __call__(
        self,
        parameters: np.ndarray,
        q: np.ndarray,
        given: Mapping[Given, np.ndarray] | None = None,
        sums: Sums | None = None,
    ) -> np.ndarray:
        """The curves at given crank angles, or sums of them.

        Parameters
        ----------
        parameters : ndarray (numbers, variants)
        q : ndarray (nodes, variants)
            Crank angles [rad].
        given : mapping of Given to ndarray (nodes, variants), optional
            Numbers supplied at each position; the others are those of `parameters`.
        sums : Sums, optional
            How to sum the curves; default: separate curves.

        Returns
        -------
        ndarray (curves or sums, nodes, variants)
        """
        return self._filled("curves_at", len(self.functions.curves), parameters, q, given, sums)

    def function(self, name: str) -> TileFunction:
        """One of the printed functions, compiled."""
        if name not in self._compiled:
            self._compiled[name] = TileFunction(getattr(load_printed(self.functions.text), name))
        return self._compiled[name]

    def _filled(
        self,
        function: str,
        rows: int,
        parameters: np.ndarray,
        q: np.ndarray,
        given: Mapping[Given, np.ndarray] | None = None,
        sums: Sums | None = None,
    ) -> np.ndarray:
        variants = q.shape[1]
        if sums is None:
            sums = Sums(np.arange(rows), rows, np.zeros(rows, bool), np.ones(variants))
        out = np.empty((sums.count, *q.shape))
        if not variants or not rows:
            return out
        given = given or {}
        given_rows = np.array([self.functions.rows[node] for node in given], np.int64)
        every = np.array([np.broadcast_to(values, q.shape) for values in given.values()]).reshape(-1, *q.shape)
        at = np.require(q, requirements="CW")
        batch = FilledPlaces(
            parameters,
            self.functions.memory,
            at,
            every,
            given_rows,
            rows,
            sums.target,
            sums.turned,
            sums.direction,
            out,
        )
        count = len(parameters) + rows + sums.count + _ALSO

        def arguments() -> tuple:
            return self.function(function), batch, lane_rows(count)

        spread(fill_places, -(-variants // LANES), arguments)
        return out


class FilledPlaces(NamedTuple):
    """Output of a call at a number of positions, and its input.

    Attributes
    ----------
    parameters : ndarray (numbers, variants)
    memory : ndarray
        All tables.
    q : ndarray (places, variants)
        Crank angles [rad].
    given : ndarray (given, places, variants)
        Numbers that replace parameters.
    given_rows : ndarray (given,) of int
        Rows of these.
    rows : int
        Number of curves of the printed function.
    target, turned, direction
        As in `Sums`.
    out : ndarray (sums, places, variants)
    """

    parameters: np.ndarray
    memory: np.ndarray
    q: np.ndarray
    given: np.ndarray
    given_rows: np.ndarray
    rows: int
    target: np.ndarray
    turned: np.ndarray
    direction: np.ndarray
    out: np.ndarray


# Rows of a block in addition to numbers, curves and sums: position with cosine and sine, and both signs.
_ALSO = 5


@driver
def fill_places(begin: int, end: int, fill: Callable, batch: FilledPlaces, room: np.ndarray) -> None:
    """Fill the blocks begin … end − 1 of variants, position by position; `room` is scratch memory for a block."""
    (places, variants), rows = batch.q.shape, batch.rows
    given, given_rows, direction, out = batch.given, batch.given_rows, batch.direction, batch.out
    count = batch.parameters.shape[0]
    block, place, rest = room[:count], room[count : count + 3], room[count + 3 :]
    tile = rest[2 : rows + 2].reshape(rows, 1, LANES)
    numbers, position, ways = in_lanes(block), in_lanes(place), in_lanes(rest)
    filled, sums = in_lanes(rest[2:]), in_lanes(rest[rows + 2 :])
    for b in range(begin, end):
        first = b * LANES
        gather(batch.parameters, first, numbers)
        for lane in range(LANES):
            ways[0, lane], ways[1, lane] = 1.0, direction[min(first + lane, variants - 1)]
        for j in range(places):
            gather(batch.q[j : j + 1], first, position)
            for lane in range(LANES):
                position[1, lane], position[2, lane] = direction_of(position[0, lane])
            for i in range(given_rows.shape[0]):
                for lane in range(LANES):
                    numbers[given_rows[i], lane] = given[i, j, min(first + lane, variants - 1)]
            fill(block, batch.memory, place[0:1], place[1:2], place[2:3], tile)
            for i in range(out.shape[0]):
                for lane in range(LANES):
                    sums[i, lane] = 0.0
            for row in range(rows):
                into, way = batch.target[row], 1 if batch.turned[row] else 0
                for lane in range(LANES if into >= 0 else 0):
                    sums[into, lane] += filled[row, lane] * ways[way, lane]
            hand_out(sums, first, out[:, j])
