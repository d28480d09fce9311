"""Rows of many variants, each at its own crank angles.

Motion needs a machine's rows at nodes where torques jump, and at another angle for every variant at every instant.
So a printed function of the machine's graph is called with a different position, and maybe variant, in each lane.
"""

from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.graph.at_points import Points, fill_points
from engine.graph.functions import Functions
from engine.graph.nodes import Found, Given
from engine.graph.values import LevelValues
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
        self.levels = LevelValues(functions)

    def parameters(
        self,
        numbers: Numbers,
        direction: np.ndarray,
        known: Mapping[Found | Given, np.ndarray | float] = MappingProxyType({}),
    ) -> np.ndarray:
        """Numbers of all variants at unit speed, so that a load of order n is the coefficient of |ω|ⁿ.

        Parameters
        ----------
        numbers : Numbers
        direction : ndarray (variants,)
            +1 or −1, the sign of the crank speed.
        known : mapping of Found or Given to ndarray, optional
            Ends of strokes, without which dependent numbers are NaN, and numbers supplied for the variants.

        Returns
        -------
        ndarray (numbers, variants)
        """
        unit = numbers.with_values({"input.speed": direction})
        return self.levels.table(unit, direction.size, known)

    def __call__(
        self, parameters: np.ndarray, q: np.ndarray, given: Mapping[Given, np.ndarray] = MappingProxyType({})
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
        rows = len(self.functions.curves)
        out = np.empty((rows, *q.shape))
        if not out.size:
            return out
        given_rows = np.array([self.functions.rows[node] for node in given], np.int64)
        every = np.array([np.broadcast_to(values, q.shape) for values in given.values()]).reshape(-1, q.size)
        numbers, flat = np.require(parameters, requirements="CW"), out.reshape(rows, q.size)
        points = Points(numbers, self.functions.memory, np.array(q).ravel(), flat, every, given_rows)
        fill_points(self._curves_at, points)
        return out

    @cached_property
    def _curves_at(self) -> PrintedFunction:
        return PrintedFunction(self.functions.codes["curves_at"])
