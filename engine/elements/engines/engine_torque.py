"""Torque of equal cylinders by orders of the crank, for many engines at once: gas and inertia, by quadrature.

Torque and kinetic energy are smooth within each stroke, so Gauss quadrature over each of the four strokes gives their
harmonics to rounding, whereas evenly spaced positions would suffer from the kinks at the dead centres. With theta from
the outer dead centre at which a cylinder fires, the gas torque is (p − p_0) A dx/dtheta, where x is the piston's travel
from there, and the inertia torque is −d/dtheta ½ (m x'² + K psi'²), where m is the reciprocating mass and K the rod's
J_S − m a b. For cylinders that fire at f_k, multiply the harmonics of one cylinder by Σ exp(−i n f_k).

The error estimate comes from the rule with half the nodes: singularities of the motion are close for rods hardly longer
than the crank, those of the gas for small clearances.
"""

import math
from collections.abc import Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from engine.elements.element import Element, Numbers
from engine.elements.engines.engine_layout import Engine, MasterRod
from engine.elements.engines.firing import FOUR_STROKE, firing_sequence, firing_sums
from engine.elements.engines.harmonics import crank_radius
from engine.laws.masses.replacement_masses import inertia_error, static_two
from engine.laws.rounding import EPS

NODES = 48
SIZES = ("bank_angle", "pin_offset", "spacing", "rod_distance")
# Rounding of a sum over cylinders, in eps times the sum of the magnitudes of its terms: phases up to 6 · 2π, products,
# sums, and the given masses, fractions and speed.
ROUNDED_ORDERS = 64
TORQUE_ORDERS = tuple(k / 2 for k in range(1, 13))


class Torque(NamedTuple):
    """Torque of one cylinder, with angles from the outer dead centre at which it fires.

    Attributes
    ----------
    mean : ndarray (...)
        Mean torque [N·m].
    orders : ndarray of complex (..., orders)
        Harmonics [N·m].
    sizes : ndarray (..., 1 + orders)
        Magnitudes of the terms of the mean and of each harmonic, which carry rounding [N·m].
    """

    mean: np.ndarray
    orders: np.ndarray
    sizes: np.ndarray


def _cylinder_torque(engine: Engine, gas: Numbers, speed: np.ndarray, orders: Sequence[float]) -> Torque:
    """Torque of one cylinder by orders, multiples of ½, over its four strokes; all cylinders are alike.

    `gas` has the numbers of an `EngineGas` by their keys; its diagram is that of `engine.laws.indicator_diagrams`.
    """
    mean, found, sizes = _by_quadrature(engine, gas, speed, orders, NODES)
    half_mean, half, _ = _by_quadrature(engine, gas, speed, orders, NODES // 2)
    off = np.concatenate([np.abs(mean - half_mean)[..., None], np.abs(found - half)], axis=-1)
    # Convergence is geometric: the full rule's relative error is the square of the half rule's; 1.5 adds margin. Single
    # orders may agree by chance: the maximum of all counts.
    return Torque(mean, found, sizes * (1 + (off / sizes).max(axis=-1, keepdims=True) ** 1.5 / EPS))


@np.errstate(invalid="ignore", divide="ignore")
def _by_quadrature(
    engine: Engine, gas: Numbers, speed: np.ndarray, orders: Sequence[float], nodes: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean, harmonics and their sizes by Gauss quadrature with this number of nodes per stroke."""
    inertias = engine.reciprocating_mass[..., 0], engine.rod_correction
    given = engine.radius, engine.rod, engine.offset, *inertias, speed
    r, rod, offset, mass, correction, speed = (np.asarray(x, float)[..., None, None] for x in given)
    gas = {key: x[..., None, None] for key, x in gas.items()}
    outer = np.sqrt((rod + r) ** 2 - offset**2)
    stroke = outer - np.sqrt((rod - r) ** 2 - offset**2)
    top = np.arcsin(offset / (rod + r))
    out = np.pi + np.arcsin(offset / (rod - r)) - top
    begin, width = _strokes(out)
    x, w = np.polynomial.legendre.leggauss(nodes)
    turned, weights = begin + width * (x + 1) / 2, width * w / 2
    theta = top + turned
    lean = np.arcsin((offset - r * np.sin(theta)) / rod)
    travel = outer - r * np.cos(theta) - rod * np.cos(lean)
    rate = r * np.sin(theta - lean) / np.cos(lean)
    swing = -r * np.cos(theta) / (rod * np.cos(lean))
    pressure = _pressure(gas, travel, stroke)
    pull = np.pi / 4 * gas["bore"] ** 2 * rate * weights
    energy = (mass * rate**2 + correction * swing**2) * speed**2 / 2 * weights
    work = (pressure - gas["ambient"]) * pull
    shape = *np.broadcast_shapes(work.shape, energy.shape)[:-2], -1
    work, energy, turned = (np.broadcast_to(a, (*shape[:-1], 4, nodes)).reshape(shape) for a in (work, energy, turned))
    steps = np.asarray(orders, float)
    # Kinetic energy has whole orders only: both turns are alike.
    derived = -1j * steps * (steps % 1 == 0)
    half_turn = np.exp(-0.5j * turned)
    waves = dict(enumerate(accumulate([half_turn] * round(2 * steps.max()), np.multiply), 1))
    both = zip(derived, steps, strict=True)
    found = [((work + d * energy) * waves[round(2 * n)]).sum(axis=-1) / math.tau for d, n in both]
    felt = ((pressure + gas["ambient"]) * np.abs(pull)).reshape(shape).sum(axis=-1) / math.tau
    stored = np.abs(energy).sum(axis=-1) / math.tau
    sizes = [felt / 2, *(felt + np.abs(d) * stored for d in derived)]
    return work.sum(axis=-1) / (2 * math.tau), np.stack(found, axis=-1), np.stack(sizes, axis=-1)


def _strokes(out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Start and length of the strokes power, exhaust, intake, compression (..., 4, 1)."""
    back, starts = math.tau - out, [0 * out, out, math.tau + 0 * out, math.tau + out]
    return np.concatenate(starts, axis=-2), np.concatenate([out, back, out, back], axis=-2)


def _pressure(gas: Numbers, travel: np.ndarray, stroke: np.ndarray) -> np.ndarray:
    """Pressures over the strokes (..., 4, nodes) [Pa]."""
    least = gas["clearance"]
    length = np.maximum(travel, 0.0) / stroke + least
    power, compression = length[..., :1, :], length[..., 3:, :]
    constant = np.ones_like(power)
    return np.concatenate(
        [
            gas["peak"] * (least / power) ** gas["n_expansion"],
            gas["exhaust"] * constant,
            gas["intake"] * constant,
            gas["intake"] * ((1 + least) / compression) ** gas["n_compression"],
        ],
        axis=-2,
    )


def made_engine(engine: Element, numbers: Numbers) -> Engine:
    """The engine of an element, with the numbers of all variants."""
    n = numbers
    layout = engine.pattern().layout(**{key: n[key] for key in SIZES if key in n})
    offset = n.get("gudgeon_offset", np.zeros_like(n["stroke"]))
    at_piston, at_crankpin, correction = _masses(n, "", n.get("rod_inertia"))
    reciprocating, rotating, master = at_piston[..., None], at_crankpin[..., None], None
    if engine.master_index is not None:
        at_piston, at_knuckle, _ = _masses(n, "link_")
        here = np.arange(engine.cylinders) == engine.master_index
        reciprocating = np.where(here, reciprocating, at_piston[..., None])
        rotating = np.where(here, rotating, at_knuckle[..., None])
        knuckle = at_knuckle - n["throw_mass"]
        master = MasterRod(engine.master_index, n["knuckle_radius"], n["link_rod"], knuckle)
    radius = crank_radius(n["stroke"], n["rod"], offset)
    return Engine(layout, radius, n["rod"], reciprocating, rotating, offset, correction, master)


def _masses(n: Numbers, which: str, inertia: np.ndarray | None = None) -> tuple[np.ndarray, ...]:
    """Masses of one cylinder at its piston pin and at its crankpin, and J_S − m a b of its rod, 0 without `inertia`."""
    rod, mass, centre = n[f"{which}rod"], n[f"{which}rod_mass"], n[f"{which}rod_centre"]
    shares = static_two(mass, (-centre, 0.0), (rod - centre, 0.0))
    correction = np.zeros(()) if inertia is None else -inertia_error(shares, inertia)
    return n["piston_mass"] + shares.masses[1], n["throw_mass"] + shares.masses[0], correction


def engine_torque(
    engine: Element, n: Numbers, orders: Sequence[float] = TORQUE_ORDERS
) -> tuple[Torque, np.ndarray, np.ndarray]:
    """Gas and inertia torque of all cylinders.

    Parameters
    ----------
    engine, n
        As for `engine_results`; with gas.
    orders : sequence of float
        Positive multiples of ½.

    Returns
    -------
    one : Torque
        Torque of one cylinder.
    found : ndarray of complex (variants, orders)
        Harmonics of the sum, T = mean + Re Σ T_n exp(i n phi). NaN if the throws do not allow the firing order.
    angles : ndarray (variants, cylinders)
        Firing angles [rad].
    """
    made = made_engine(engine, n)
    gas = {key.removeprefix("gas."): row for key, row in n.items() if key.startswith("gas.")}
    one = _cylinder_torque(made, gas, n["speed"], orders)
    angles, taken = firing_sequence(made.layout, engine.order_of_firing)
    with np.errstate(invalid="ignore"):
        top = np.arcsin(made.offset / (made.rod + made.radius))
    angles = np.where((taken < FOUR_STROKE)[..., None], angles + top[..., None], np.nan)
    return one, one.orders * firing_sums(orders, angles), angles
