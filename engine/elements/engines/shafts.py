"""Counterweights on the crank and balance shafts: which leave no force and couple, and what remains with them.

An unbalance U on a shaft that turns at n times the crank's speed pulls with n² U exp(i n phi), over ω² of the crank;
on one that turns the other way with n² U exp(−i n phi). So each part of each order has its own shaft:

- the first order's part that turns with the crank: counterweights on the crank itself;
- a part that turns alone (a circle): a single shaft;
- both parts, equal in size (a line): a pair of shafts that turn against each other, as Lanchester's.

Two unbalances on a shaft balance a force and a couple at once: those of two planes that amount to the same.

Sources: F. W. Lanchester's harmonic balancer (1910); C. F. Taylor, The Internal-Combustion Engine in Theory and
Practice, vol. 2 (balance shafts).
"""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.engines.engine_layout import Engine
from engine.elements.engines.hodograph import Hodograph
from engine.elements.engines.shaking import EngineShaking
from engine.elements.rotors.unbalance import Resultant, unbalance_in_two_planes


class BalanceShaft(NamedTuple):
    """A shaft with unbalances, parallel to the crank, or the crank itself with its counterweights.

    Across the crank, a single shaft anywhere but on the crank's axis adds a rolling moment of its order; a pair that
    stands evenly on both sides of the engine's axis, as far from the crank's, adds none.

    Attributes
    ----------
    order : int
        Speed of the shaft over that of the crank.
    sense : int
        1: turns with the crank, −1: against it.
    unbalances : ndarray of complex (..., planes)
        When the crank is at phi = 0 [kg·m].
    planes : ndarray (..., planes)
        Along the crank, from its middle [m].
    """

    order: int
    sense: int
    unbalances: np.ndarray
    planes: np.ndarray

    @property
    def force(self) -> np.ndarray:
        """Force over ω² of the crank at phi = 0 (...) [kg·m]."""
        return self.order**2 * self.unbalances.sum(axis=-1)

    @property
    def couple(self) -> np.ndarray:
        """Couple over ω² of the crank at phi = 0 (...) [kg·m²]."""
        return self.order**2 * (self.unbalances * self.planes).sum(axis=-1)


def crankshaft_counterweights(
    engine: Engine, rotating: ArrayLike = 1.0, reciprocating: ArrayLike = 0.0
) -> BalanceShaft:
    """Counterweights opposite each throw.

    Parameters
    ----------
    engine : Engine
    rotating, reciprocating : array_like (...)
        Shares of the masses that they balance; ½ of a single cylinder's reciprocating mass halves its first order.

    Returns
    -------
    BalanceShaft
        The crank with them, the unbalances in the planes of the throws.
    """
    shares = (np.asarray(x, float)[..., None] for x in (rotating, reciprocating))
    masses = (np.asarray(x, float) for x in (engine.rotating_mass, engine.reciprocating_mass))
    mass = sum(share * m for share, m in zip(shares, masses, strict=True))
    throws = np.asarray(engine.radius, float)[..., None] * np.exp(1j * engine.layout.throws)
    return BalanceShaft(1, 1, -mass * throws, engine.layout.positions)


def balance_shafts(found: EngineShaking, planes: tuple[float, float], tolerance: float = 1e-9) -> list[BalanceShaft]:
    """Shafts that leave no force and no couple of any order given.

    Parameters
    ----------
    found : EngineShaking
        Of an engine, or what already remains with counterweights and other shafts.
    planes : tuple of float
        Where the shafts carry their unbalances [m]; of twice the same plane, couples are left as they are.
    tolerance : float
        What is no greater than this share of the sizes of all that the cylinders contribute needs no shaft.

    Returns
    -------
    list of BalanceShaft
        For each order the one that turns with the crank and the one against it, where there is something to balance.
        For the first order and with the crank it is the crank itself.
    """
    shafts, apart = [], planes[0] != planes[1]
    for i, order in enumerate(found.forces.orders):
        parts = zip((1, -1), found.forces.of(order), found.couples.of(order), strict=True)
        for sense, force, couple in parts:
            pulls = np.abs(force) > tolerance * found.force_terms[..., i]
            tilts = np.abs(couple) > tolerance * found.couple_terms[..., i]
            if np.any(pulls | (tilts & apart)):
                shafts.append(_shaft(order, sense, force, couple, planes))
    return shafts


def _shaft(order: int, sense: int, force: np.ndarray, couple: np.ndarray, planes: tuple[float, float]) -> BalanceShaft:
    if planes[0] == planes[1]:
        return BalanceShaft(order, sense, -force[..., None] / order**2, np.array(planes[:1]))
    first, second = unbalance_in_two_planes(Resultant(force, couple, np.zeros(())), *planes)
    return BalanceShaft(order, sense, -np.stack([first, second], axis=-1) / order**2, np.array(planes))


def remaining_shaking(found: EngineShaking, shafts: Iterable[BalanceShaft]) -> EngineShaking:
    """What remains with counterweights and shafts.

    Parameters
    ----------
    found : EngineShaking
        Of an engine, or what already remains.
    shafts : iterable of BalanceShaft
        Those of other orders change nothing.

    Returns
    -------
    EngineShaking
        With the sizes of the shafts' contributions in its terms.
    """
    for shaft in shafts:
        here = (np.array(found.forces.orders) == shaft.order) * shaft.order**2
        pulls = np.abs(shaft.unbalances)
        tilts = pulls * np.abs(shaft.planes)
        found = EngineShaking(
            _with(found.forces, shaft, shaft.force),
            _with(found.couples, shaft, shaft.couple),
            found.force_terms + pulls.sum(axis=-1)[..., None] * here,
            found.couple_terms + tilts.sum(axis=-1)[..., None] * here,
        )
    return found


def _with(vector: Hodograph, shaft: BalanceShaft, part: np.ndarray) -> Hodograph:
    added = part[..., None] * (np.array(vector.orders) == shaft.order)
    with_crank = shaft.sense > 0
    return vector.plus(Hodograph(vector.orders, added * with_crank, added * (not with_crank)))
