"""Torque of an engine by orders of the crank: gas and inertia, of one cylinder and of all of them together.

The torque of a cylinder repeats with its cycle, so a four-stroke engine has half orders too. Cylinders that fire at
the angles f_k add up to T_n Σ exp(−i n f_k): with even intervals all orders vanish but multiples of firings per turn.
At constant speed the inertia torque is −dE/dphi, E being the kinetic energy of pistons and rods; with the rods'
correction J_S − m a b the rods' own turning is in it, without it left out. The engine's frame feels the reaction, as a
rolling moment.

Complex amplitudes: T(phi) = mean + Re Σ T_n exp(i n phi), positive where the crank is driven.

Sources: C. F. Taylor, The Internal-Combustion Engine in Theory and Practice, vol. 2 (torque and its harmonics);
J. P. Den Hartog, Mechanical Vibrations, §5.3 (inertia torque: λ/4, −1/2, −3λ/4 … of m r²ω²).
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from engine.balancing.engines.engine_layout import TURN, Engine
from engine.balancing.engines.harmonics import rod_harmonics
from engine.balancing.engines.master_rod import positions
from engine.balancing.engines.shaking import piston_motions
from engine.laws.indicator_diagrams import four_stroke_engine

# Orders of the motion that the inertia torque is made of, and positions that hold their products.
_ORDERS = range(1, 65)
_POSITIONS = 256


class Indicator(NamedTuple):
    """Ideal diagram of a four-stroke engine: `engine.laws.indicator_diagrams.four_stroke_engine` with its numbers.

    Attributes
    ----------
    clearance : float
        1/(compression ratio − 1).
    intake, exhaust, peak, outside : float
        Pressures, absolute; outside that below the piston [Pa].
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


def gas_torque(
    indicator: Indicator, bore: float, radius: float, rod: float, offset: float = 0.0, count: int = 1440
) -> np.ndarray:
    """Torque of one cylinder's gas over its four strokes.

    Parameters
    ----------
    indicator : Indicator
    bore, radius, rod, offset : float
        [m].
    count : int
        Positions over two turns, from firing on.

    Returns
    -------
    ndarray (count,)
        [N·m] at theta_f + 4π k/count, theta_f being the outer dead centre.
    """
    outer, inner = math.sqrt((rod + radius) ** 2 - offset**2), math.sqrt((rod - radius) ** 2 - offset**2)
    top, bottom = math.asin(offset / (rod + radius)), math.pi + math.asin(offset / (rod - radius))
    theta = top + 2 * TURN * np.arange(count) / count
    lean = np.arcsin((offset - radius * np.sin(theta)) / rod)
    travel = outer - (radius * np.cos(theta) + rod * np.cos(lean))
    rate = radius * np.sin(theta - lean) / np.cos(lean)
    turned = (theta - top) % TURN
    # Power, exhaust, intake, compression.
    number = np.where(turned < bottom - top, 0, 1) + 2 * (np.arange(count) >= count / 2)
    lines = indicator.intake, indicator.exhaust, indicator.peak, indicator.n_compression, indicator.n_expansion
    pressure = np.array(
        [
            four_stroke_engine(float(x), outer - inner, indicator.clearance, int(k), *lines)
            for x, k in zip(travel, number, strict=True)
        ]
    )
    return (pressure - indicator.outside) * math.pi / 4 * bore**2 * rate


def torque_harmonics(torque: ArrayLike, orders: Sequence[float], turns: int = 2) -> np.ndarray:
    """Harmonics of a torque curve.

    Parameters
    ----------
    torque : array_like (..., positions)
        Over one cycle of so many turns, evenly spaced, without its end [N·m].
    orders : sequence of float
        Multiples of 1/turns, above 0.
    turns : int
        2 for four strokes, 1 for two.

    Returns
    -------
    ndarray of complex (..., orders)
        [N·m].
    """
    torque = np.asarray(torque, float)
    places = np.rint(np.multiply(orders, turns)).astype(int)
    return np.fft.rfft(torque, axis=-1)[..., places] * (2 / torque.shape[-1])


def superposed(one: ArrayLike, orders: Sequence[float], angles: ArrayLike) -> np.ndarray:
    """Harmonics of the torque of all cylinders, from those of one.

    Parameters
    ----------
    one : array_like of complex (..., orders)
        Of one cylinder that fires at phi = 0 [N·m].
    orders : sequence of float
    angles : array_like (..., cylinders)
        At which the cylinders fire [rad].

    Returns
    -------
    ndarray of complex (..., orders)
        [N·m].
    """
    return np.asarray(one) * firing_sums(orders, angles)


def firing_sums(orders: Sequence[float], angles: ArrayLike) -> np.ndarray:
    """Sums of the unit vectors exp(−i n f_k) of all cylinders: what each order of the torque is multiplied by.

    Parameters
    ----------
    orders : sequence of float
    angles : array_like (..., cylinders)
        [rad].

    Returns
    -------
    ndarray of complex (..., orders)
        Their size is the number of cylinders in the major orders, 0 in those that balance.
    """
    angles = np.asarray(angles, float)
    return np.exp(-1j * angles[..., None, :] * np.asarray(orders, float)[:, None]).sum(axis=-1)


def inertia_torque(engine: Engine, orders: Sequence[int]) -> np.ndarray:
    """Harmonics of the torque that the inertia of pistons and rods gives the crank at constant speed, over ω².

    Parameters
    ----------
    engine : Engine
    orders : sequence of int
        Up to 64.

    Returns
    -------
    ndarray of complex (..., orders)
        [kg·m²].
    """
    steps = np.arange(1, 65)
    phi = TURN * np.arange(_POSITIONS) / _POSITIONS
    turned = np.exp(1j * np.multiply.outer(steps, phi))
    pistons = (piston_motions(engine, _ORDERS) * (1j / steps)) @ turned
    energy = (np.asarray(engine.reciprocating_mass, float)[..., None] * pistons.real**2).sum(axis=-2)
    rods = (_rods(engine) * (1j * steps)) @ turned
    energy = energy + np.asarray(engine.rod_correction, float)[..., None] * (rods.real**2).sum(axis=-2)
    if engine.master is not None:
        energy = energy + _knuckles(engine, phi)
    amplitudes = np.fft.rfft(energy / 2, axis=-1)[..., list(orders)] * (2 / _POSITIONS)
    return -1j * np.array(orders) * amplitudes


def _rods(engine: Engine) -> np.ndarray:
    """Harmonics of the rods' angles in the crank angle of the engine; of a master rod, that of its own alone."""
    rod = np.asarray(engine.rod, float)
    one = rod_harmonics(engine.radius / rod, _ORDERS, engine.offset / rod)
    ahead = engine.layout.throws - engine.layout.banks
    if engine.master is not None:
        ahead = ahead[..., engine.master.cylinder, None]
    return one[..., None, :] * np.exp(1j * ahead[..., None] * np.array(_ORDERS))


def _knuckles(engine: Engine, phi: np.ndarray) -> np.ndarray:
    """Twice the kinetic energy of the knuckle pins' masses, over ω², and a constant (..., positions)."""
    radius = np.asarray(engine.radius, float)[..., None, None]
    pins = positions(engine, phi)[1] + radius * np.exp(1j * (phi + engine.layout.throws[..., None]))
    waves = np.fft.fftfreq(phi.size, 1 / phi.size)
    rates = np.fft.ifft(np.fft.fft(pins, axis=-1) * 1j * waves, axis=-1)
    return np.asarray(engine.master.knuckle_mass, float)[..., None] * (np.abs(rates) ** 2).sum(axis=-2)
