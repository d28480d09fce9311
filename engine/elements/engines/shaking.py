"""Shaking forces and couples of an engine by orders of the crank, divided by ω².

A piston of mass m on the axis beta exerts −m ẍ on the engine along that axis. With its harmonics c_n and the crank at
theta = phi + alpha − beta, as a complex number in the plane across the crank, this is m r ω² times the sum over n of

    ½ c_n exp(i(n alpha − (n − 1) beta)) exp(i n phi) + ½ c_n* exp(−i(n alpha − (n + 1) beta)) exp(−i n phi),

one half rotating with the crank and one against it. Rotating masses add m_rot r exp(i alpha) to the first order that
rotates with the crank. Couples are the same with each cylinder's position as its arm, about the crank's middle, drawn
in the direction of the forces; the axis of the couple is a quarter turn ahead. Gas forces are internal and shake the
engine only by the reaction to its torque.

All quantities are divided by ω²: a force in kg·m and a couple in kg·m², as the unbalance of a rotor.

Sources: C. F. Taylor, The Internal-Combustion Engine in Theory and Practice, vol. 2 (engine balance); J. P. Den Hartog,
Mechanical Vibrations, §5.2 (multicylinder engines); H. Maass, H. Klier, Kräfte, Momente und deren Ausgleich in der
Verbrennungskraftmaschine (method of two counter-rotating star vectors).
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.elements.engines.engine_layout import Engine
from engine.elements.engines.harmonics import piston_harmonics
from engine.elements.engines.hodograph import Hodograph
from engine.elements.engines.master_rod import master_rod_harmonics

SHAKING_ORDERS = (1, 2, 4, 6)


class EngineShaking(NamedTuple):
    """Shaking forces and couples on an engine's frame, divided by ω².

    Attributes
    ----------
    forces, couples : Hodograph
        Forces [kg·m]; couples about the crank's middle [kg·m²].
    force_terms, couple_terms : ndarray (..., orders)
        Sums of the magnitudes of the cylinders' contributions: a result within their rounding is balanced.
    """

    forces: Hodograph
    couples: Hodograph
    force_terms: np.ndarray
    couple_terms: np.ndarray


def engine_shaking(engine: Engine, orders: Sequence[int] = SHAKING_ORDERS) -> EngineShaking:
    """Inertia forces and couples on the engine's frame, without counterweights.

    Parameters
    ----------
    engine : Engine
    orders : sequence of int
        From 1.
    """
    moving = (_piston_motions(engine, orders),) if engine.master is None else master_rod_harmonics(engine, orders)
    pistons, *pins = moving
    masses = engine.reciprocating_mass, engine.rotating_mass
    reciprocating, rotating = (np.asarray(mass, float)[..., None] for mass in masses)
    pull = reciprocating * np.exp(1j * engine.layout.banks)[..., None]
    crankpins = np.asarray(engine.radius, float)[..., None] * np.exp(1j * engine.layout.throws)
    turning = rotating * crankpins[..., None] * (np.array(orders) == 1)
    forward, backward = pull * pistons / 2 + turning, pull * np.conj(pistons) / 2
    terms = np.abs(pull * pistons) + np.abs(turning)
    if engine.master is not None:
        with_crank, against = (np.asarray(engine.master.knuckle_mass, float)[..., None, None] * pin for pin in pins)
        forward, backward = forward + with_crank, backward + against
        terms = terms + np.abs(with_crank) + np.abs(against)
    arms = engine.layout.positions[..., None]
    return EngineShaking(
        Hodograph(tuple(orders), forward.sum(axis=-2), backward.sum(axis=-2)),
        Hodograph(tuple(orders), (arms * forward).sum(axis=-2), (arms * backward).sum(axis=-2)),
        terms.sum(axis=-2),
        (np.abs(arms) * terms).sum(axis=-2),
    )


def _piston_motions(engine: Engine, orders: Sequence[int]) -> np.ndarray:
    """Harmonics of each piston's acceleration, as from `master_rod_harmonics`, with all rods on the crankpins."""
    rod = np.asarray(engine.rod, float)
    one = piston_harmonics(engine.radius / rod, orders, engine.offset / rod)
    ahead = (engine.layout.throws - engine.layout.banks)[..., None] * np.array(orders)
    return np.asarray(engine.radius, float)[..., None, None] * one[..., None, :] * np.exp(1j * ahead)
