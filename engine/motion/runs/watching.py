"""Observation of runs, piece by piece: for extremes or histories.

A piece is smooth except where two nodes coincide, on either side of a jump. Observers do not affect the steps.
"""

from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from engine.motion.loads import PairLoads
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.quantities import INSTANT, TURNED
from engine.motion.settled.cycle import motion_rows, power_rows


class Piece(NamedTuple):
    """A piece of the motion of some variants; arrays (nodes, variants) unless stated.

    A variant with fewer nodes repeats its last node.

    Attributes
    ----------
    time, turned : ndarray
        From the start of the run [s], [rad].
    omega : ndarray
        In the direction of motion, negative backwards [rad/s].
    facing : ndarray (variants,)
        +1 or −1: direction of the piece.
    steps : ndarray (nodes − 1, variants)
        Distances between nodes in the independent variable, 0 at a jump [rad].
    moment : ndarray
        Total torque if known more accurately than from the speed, else NaN [N·m].
    within : BetweenNodes or None
        Interpolates between nodes; None if there is nothing between them.
    """

    time: np.ndarray
    turned: np.ndarray
    omega: np.ndarray
    facing: np.ndarray
    steps: np.ndarray
    moment: np.ndarray
    within: "BetweenNodes | None" = None

    @property
    def held(self) -> tuple[np.ndarray, ...]:
        """What is the same for the whole piece, (variants,) each."""
        return (self.facing,)


class BetweenNodes(NamedTuple):
    """Interpolation between two nodes of a piece from its recorded steps.

    Attributes
    ----------
    in_time : bool
        Whether lengths are times [s], else angles [rad], measured from a node.
    step : callable
        For columns, nodes and lengths, (pairs,) each: time [s], angle turned [rad], speed [rad/s] and torque [N·m], as
        in `Piece`, (pairs,) each.
    """

    in_time: bool
    step: Callable[[np.ndarray, np.ndarray, np.ndarray], tuple[np.ndarray, ...]]


class Observer(Protocol):
    """An observer of runs."""

    def see(self, who: np.ndarray, piece: Piece) -> None:
        """Evaluate a piece of the motion of the variants `who`."""


def side_by_side(values: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """Concatenated values of variants as (nodes, variants); a variant with fewer nodes repeats its last one.

    Parameters
    ----------
    values : ndarray (all nodes,)
    counts : ndarray (variants,) of int
        Number of values of each variant, at least one.
    """
    begins = np.cumsum(counts) - counts
    node = np.minimum(np.arange(counts.max())[:, None], counts - 1)
    return values[begins + node]


class RunFields:
    """Fields in runs: those of the motion, and the requested loads on the pairs.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
        All variants of the runs.
    start, clock : ndarray (variants,)
        Initial crank angle [rad] and time [s].
    loads : PairLoads or None
    off : frozenset of str
        Actions that are off.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        variants: Variants,
        start: np.ndarray,
        clock: np.ndarray,
        loads: PairLoads | None,
        off: frozenset[str],
    ) -> None:
        self.dynamics, self.variants, self.start, self.clock = dynamics, variants, start, clock
        self.loads, self.off = loads, off
        self._parameters: dict[float, np.ndarray] = {}

    def __call__(self, who: np.ndarray, piece: Piece) -> dict[str, np.ndarray]:
        """All fields on a piece of the motion of some variants, counter-clockwise positive except the speed.

        Includes the instant, the angle turned and the torque of each channel of loads.
        """
        own = self.variants.some(who)
        form, clock = EquationOfMotion(self.dynamics, self.variants, self.start, who), piece.time + self.clock[who]
        # A torque may be infinite or NaN.
        with np.errstate(all="ignore"):
            found = form.along(piece.turned, piece.omega, clock, piece.facing)
            inertia, epsilon, motors, loads = found.known_better(piece.moment)
            rows = motion_rows(own, piece.omega, epsilon, motors, loads)
            rows["kinetic_energy"] = 0.5 * inertia * piece.omega**2
            if self.dynamics.with_servos:
                energy, powers = form.with_servos(piece.turned, piece.omega, clock, piece.facing)
                rows["kinetic_energy"] = energy
                rows |= {f"{name} power": row for name, row in zip(self.dynamics.channels, powers, strict=True)}
                rows |= power_rows(motors * piece.omega, powers) if self.dynamics.works else {}
        rows[INSTANT], rows[TURNED] = piece.time, piece.turned
        rows |= {key: own.direction * row for key, row in zip(self.dynamics.channels, loads, strict=True)}
        places = self.start[who] + own.direction * piece.turned
        return rows | self.on_pairs(who, piece.facing, places, piece.omega, epsilon, clock)

    def on_pairs(
        self,
        who: np.ndarray,
        facing: np.ndarray,
        places: np.ndarray,
        omega: np.ndarray,
        epsilon: np.ndarray,
        clock: np.ndarray,
    ) -> dict[str, np.ndarray]:
        """Requested loads on the pairs of some variants, (nodes, variants).

        Parameters
        ----------
        who : ndarray (variants,)
        facing : ndarray (variants,)
            +1 or −1: direction of each variant.
        places, omega, epsilon, clock : ndarray (nodes, variants)
            Crank angle [rad]; speed [rad/s] and acceleration [rad/s²] in the direction of motion; time [s].
        """
        if self.loads is None:
            return {}
        own, found = self.variants.some(who), {name: np.empty(places.shape) for name in self.loads.names}
        for way in (1.0, -1.0):
            those = np.flatnonzero(facing == way)
            if those.size:
                whole = np.ascontiguousarray(self._numbers(way)[:, who[those]])
                at = (x[:, those] for x in (places, np.abs(omega), own.direction * epsilon, clock))
                for name, row in self.loads(own.some(those), whole, *at).items():
                    found[name][:, those] = row
        return found

    def _numbers(self, facing: float) -> np.ndarray:
        """Numbers of the loads of all variants, for forward or backward motion."""
        if facing not in self._parameters:
            variants = self.variants._replace(direction=facing * self.variants.direction)
            self._parameters[facing] = self.loads.parameters(variants, self.off)
        return self._parameters[facing]
