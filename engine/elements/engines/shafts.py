"""Counterweights on the crank and balance shafts: those that cancel forces and couples, and what remains with them.

An unbalance U on a shaft at n times the crank speed exerts n² U exp(i n phi), divided by ω² of the crank; on a
shaft in the opposite sense it exerts n² U exp(−i n phi). So each part of each order needs its own shaft:

- the first order's part that rotates with the crank: counterweights on the crank itself;
- a single rotating part (a circle): a single shaft;
- both parts, of equal magnitude (a line): a pair of counter-rotating shafts, as in Lanchester's balancer.

Two unbalances on a shaft balance a force and a couple at once: the equivalent unbalances in two planes.

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

# Forces and couples below this multiple of the cylinders' total contribution need no shaft.
_NOTHING = 1e-9


class BalanceShaft(NamedTuple):
    """A shaft with unbalances, parallel to the crank, or the crank itself with its counterweights.

    A single shaft off the crank axis adds a rolling moment of its order; a counter-rotating pair placed
    symmetrically to the engine's axis adds none.

    Attributes
    ----------
    order : int
        Ratio of the shaft's speed to the crank's.
    sense : int
        1: rotates with the crank, −1: against it.
    unbalances : ndarray of complex (..., planes)
        Unbalances with the crank at phi = 0 [kg·m].
    planes : ndarray (..., planes)
        Position along the crank, from its middle [m].
    """

    order: int
    sense: int
    unbalances: np.ndarray
    planes: np.ndarray

    @property
    def force(self) -> np.ndarray:
        """Force divided by ω² of the crank, at phi = 0 (...) [kg·m]."""
        return self.order**2 * self.unbalances.sum(axis=-1)

    @property
    def couple(self) -> np.ndarray:
        """Couple divided by ω² of the crank, at phi = 0 (...) [kg·m²]."""
        return self.order**2 * (self.unbalances * self.planes).sum(axis=-1)


def crankshaft_counterweights(
    engine: Engine, rotating: ArrayLike = 1.0, reciprocating: ArrayLike = 0.0
) -> BalanceShaft:
    """Counterweights opposite each throw.

    Parameters
    ----------
    engine : Engine
    rotating, reciprocating : array_like (...)
        Fractions of the masses to balance; ½ of a single cylinder's reciprocating mass halves its first order.

    Returns
    -------
    BalanceShaft
        The crank, with the unbalances in the planes of the throws.
    """
    shares = (np.asarray(x, float)[..., None] for x in (rotating, reciprocating))
    masses = (np.asarray(x, float) for x in (engine.rotating_mass, engine.reciprocating_mass))
    mass = sum(share * m for share, m in zip(shares, masses, strict=True))
    throws = np.asarray(engine.radius, float)[..., None] * np.exp(1j * engine.layout.throws)
    return BalanceShaft(1, 1, -mass * throws, engine.layout.positions)


def balance_shafts(found: EngineShaking, planes: tuple[float, float]) -> list[BalanceShaft]:
    """Shafts that cancel forces and couples of all given orders.

    Parameters
    ----------
    found : EngineShaking
        Shaking of an engine, or the remainder with counterweights and other shafts.
    planes : tuple of float
        Positions of the unbalances on each shaft [m]; two equal planes leave the couples as they are.

    Returns
    -------
    list of BalanceShaft
        For each order with something to balance, one shaft that rotates with the crank and one against it. The shaft of
        the first order that rotates with the crank is the crank itself.
    """
    shafts, apart = [], planes[0] != planes[1]
    for i, order in enumerate(found.forces.orders):
        parts = zip((1, -1), found.forces.of(order), found.couples.of(order), strict=True)
        for sense, force, couple in parts:
            pulls = np.abs(force) > _NOTHING * found.force_terms[..., i]
            tilts = np.abs(couple) > _NOTHING * found.couple_terms[..., i]
            if np.any(pulls | (tilts & apart)):
                shafts.append(_shaft(order, sense, force, couple, planes))
    return shafts


def _shaft(order: int, sense: int, force: np.ndarray, couple: np.ndarray, planes: tuple[float, float]) -> BalanceShaft:
    if planes[0] == planes[1]:
        return BalanceShaft(order, sense, -force[..., None] / order**2, np.array(planes[:1]))
    first, second = unbalance_in_two_planes(Resultant(force, couple, np.zeros(())), *planes)
    return BalanceShaft(order, sense, -np.stack([first, second], axis=-1) / order**2, np.array(planes))


def remaining_shaking(found: EngineShaking, shafts: Iterable[BalanceShaft]) -> EngineShaking:
    """Shaking that remains with counterweights and shafts.

    Parameters
    ----------
    found : EngineShaking
        Shaking of an engine, or a previous remainder.
    shafts : iterable of BalanceShaft
        Shafts of orders other than `found`'s have no effect.

    Returns
    -------
    EngineShaking
        Its terms include the magnitudes of the shafts' contributions.
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
    forward, backward = vector.forward + added * with_crank, vector.backward + added * (not with_crank)
    return Hodograph(vector.orders, forward, backward)
