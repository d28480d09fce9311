"""Torque of equal cylinders by orders of the crank, for many engines at once: gas and inertia, by quadrature.

Torque and kinetic energy are smooth within each stroke, so Gauss quadrature over each of the four strokes gives their
harmonics to rounding, whereas evenly spaced positions would suffer from the kinks at the dead centres. With theta from
the outer dead centre at which a cylinder fires, the gas torque is (p − p_0) A dx/dtheta, where x is the piston's travel
from there, and the inertia torque is −d/dtheta ½ (m x'² + K psi'²), where m is the reciprocating mass and K the rod's
J_S − m a b. For cylinders that fire at f_k, multiply the harmonics of one cylinder by Σ exp(−i n f_k).

The error estimate comes from the rule with half the nodes: singularities of the motion are close for rods hardly longer
than the crank, those of the gas for small clearances.
"""

from collections.abc import Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from engine.elements.engines.engine_layout import TURN
from engine.laws.rounding import EPS

NODES = 48


class Indicator(NamedTuple):
    """Ideal indicator diagram of a four-stroke engine, as in `engine.laws.indicator_diagrams`.

    Attributes
    ----------
    clearance : float
        1/(compression ratio − 1).
    intake, exhaust, peak, outside : float
        Absolute pressures; `outside` acts below the piston [Pa].
    n_compression, n_expansion : float
        Polytropic exponents.
    """

    clearance: float
    intake: float
    exhaust: float
    peak: float
    n_compression: float
    n_expansion: float
    outside: float = 101325.0


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


class CylinderParts(NamedTuple):
    """Moving parts of a cylinder.

    Attributes
    ----------
    radius, rod, offset : ndarray (...)
        Crank radius, rod length, offset of the cylinder axis [m].
    mass, rod_correction, speed : ndarray (...)
        Reciprocating mass [kg], J_S − m a b [kg·m²], crank speed [rad/s].
    """

    radius: np.ndarray
    rod: np.ndarray
    offset: np.ndarray
    mass: np.ndarray
    rod_correction: np.ndarray
    speed: np.ndarray


def cylinder_torque(indicator: Indicator, bore: np.ndarray, moving: CylinderParts, orders: Sequence[float]) -> Torque:
    """Torque of one cylinder by orders, over its four strokes.

    Parameters
    ----------
    indicator : Indicator
        With numbers (...).
    bore : ndarray (...)
        Cylinder bore [m].
    moving : CylinderParts
    orders : sequence of float
        Positive multiples of ½.
    """
    (mean, found, sizes), (half_mean, half, _) = (
        _by_quadrature(indicator, bore, moving, orders, nodes) for nodes in (NODES, NODES // 2)
    )
    off = np.concatenate([np.abs(mean - half_mean)[..., None], np.abs(found - half)], axis=-1)
    # Convergence is geometric: the full rule's relative error is the square of the half rule's; 1.5 adds margin.
    return Torque(mean, found, sizes * (1 + (off / sizes) ** 1.5 / EPS))


@np.errstate(invalid="ignore", divide="ignore")
def _by_quadrature(
    indicator: Indicator, bore: np.ndarray, moving: CylinderParts, orders: Sequence[float], nodes: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mean, harmonics and their sizes by Gauss quadrature with this number of nodes per stroke."""
    m = CylinderParts(*(np.asarray(x, float)[..., None, None] for x in moving))
    lines = Indicator(*(np.asarray(x, float)[..., None, None] for x in indicator))
    outer = np.sqrt((m.rod + m.radius) ** 2 - m.offset**2)
    stroke = outer - np.sqrt((m.rod - m.radius) ** 2 - m.offset**2)
    top = np.arcsin(m.offset / (m.rod + m.radius))
    out = np.pi + np.arcsin(m.offset / (m.rod - m.radius)) - top
    begin, width = _strokes(out)
    x, w = np.polynomial.legendre.leggauss(nodes)
    turned, weights = begin + width * (x + 1) / 2, width * w / 2
    theta = top + turned
    lean = np.arcsin((m.offset - m.radius * np.sin(theta)) / m.rod)
    travel = outer - m.radius * np.cos(theta) - m.rod * np.cos(lean)
    rate = m.radius * np.sin(theta - lean) / np.cos(lean)
    swing = -m.radius * np.cos(theta) / (m.rod * np.cos(lean))
    pressure = _pressure(lines, travel, stroke)
    pull = np.pi / 4 * np.asarray(bore, float)[..., None, None] ** 2 * rate * weights
    energy = (m.mass * rate**2 + m.rod_correction * swing**2) * m.speed**2 / 2 * weights
    gas = (pressure - lines.outside) * pull
    shape = *np.broadcast_shapes(gas.shape, energy.shape)[:-2], -1
    gas, energy, turned = (np.broadcast_to(a, (*shape[:-1], 4, nodes)).reshape(shape) for a in (gas, energy, turned))
    steps = np.asarray(orders, float)
    # Kinetic energy has whole orders only: both turns are alike.
    derived = -1j * steps * (steps % 1 == 0)
    half_turn = np.exp(-0.5j * turned)
    waves = dict(enumerate(accumulate([half_turn] * round(2 * steps.max()), np.multiply), 1))
    found = [
        ((gas + d * energy) * waves[round(2 * n)]).sum(axis=-1) / TURN for d, n in zip(derived, steps, strict=True)
    ]
    felt = ((pressure + lines.outside) * np.abs(pull)).reshape(shape).sum(axis=-1) / TURN
    stored = np.abs(energy).sum(axis=-1) / TURN
    sizes = [felt / 2, *(felt + np.abs(d) * stored for d in derived)]
    return gas.sum(axis=-1) / (2 * TURN), np.stack(found, axis=-1), np.stack(sizes, axis=-1)


def _strokes(out: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Start and length of the strokes power, exhaust, intake, compression (..., 4, 1)."""
    back = TURN - out
    return np.concatenate([0 * out, out, TURN + 0 * out, TURN + out], axis=-2), np.concatenate(
        [out, back, out, back], axis=-2
    )


def _pressure(lines: Indicator, travel: np.ndarray, stroke: np.ndarray) -> np.ndarray:
    """Pressures over the strokes (..., 4, nodes) [Pa]."""
    length, least = np.maximum(travel, 0.0) / stroke + lines.clearance, lines.clearance
    power, _, _, compression = np.moveaxis(length, -2, 0)
    least, peak, intake, exhaust = (np.squeeze(a, -1) for a in (least, lines.peak, lines.intake, lines.exhaust))
    up, down = np.squeeze(lines.n_compression, -1), np.squeeze(lines.n_expansion, -1)
    constant = np.ones_like(power)
    return np.stack(
        [
            peak * (least / power) ** down,
            exhaust * constant,
            intake * constant,
            intake * ((1 + least) / compression) ** up,
        ],
        axis=-2,
    )
