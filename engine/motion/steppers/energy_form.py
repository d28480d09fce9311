"""The equation of motion in the energy form, dE = M dφ.

With E = ½Iω² the equation I·ε + ½ω²·dI/dφ = M reads dE/dφ = M(φ, √(2E/I)): no derivative of I is needed, and a
machine without moments keeps its energy to the last bit. Time and works are integrals over φ of 1/ω and of the
moments, carried along by the same method.

Angles here are turned in the direction of motion, so ω > 0 and moments are positive where they drive.
"""

from typing import NamedTuple

import numpy as np


class Tables(NamedTuple):
    """What depends on the crank angle, at the nodes and the middles between them: 2·steps + 1 places.

    Attributes
    ----------
    steps : ndarray (steps, variants)
        Lengths of the steps [rad].
    inertia : ndarray (places, variants)
        Reduced inertia with the flywheel [kg·m²].
    loads : ndarray (channels, 3, places, variants)
        Reduced moments over ω⁰, ω¹ and ω², separately for each sort of work; one channel for all if not asked.
    powers : ndarray (laws, places, variants)
        Reduced moments over ω to a power of their own.
    """

    steps: np.ndarray
    inertia: np.ndarray
    loads: np.ndarray
    powers: np.ndarray

    def at(self, places: np.ndarray | slice, columns: np.ndarray | slice = slice(None)) -> "Tables":
        """The tables at some of the places, of each variant at one of its own, or at the nodes with a slice.

        Parameters
        ----------
        places, columns : ndarray (variants,) of int, or slice
        """

        def picked(rows: np.ndarray) -> np.ndarray:
            rows = rows[..., places, columns]
            return rows if isinstance(places, slice) else rows[..., None, :]

        return Tables(self.steps, picked(self.inertia), picked(self.loads), picked(self.powers))


NODES = slice(None, None, 2)
