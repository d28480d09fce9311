"""Motion of a radial engine's pistons with master and link rods: exact positions, and harmonics by Fourier transform.

The big end of the master rod is on the crankpin and carries the knuckle pins of the link rods, at the radius c from the
crankpin. With the master rod inclined by psi to its cylinder's axis beta_m, the knuckle pin of a cylinder beta is at

    K = r exp(i phi) + c exp(i(beta + psi))

and its piston at Re(K exp(−i beta)) + √(l'² − Im(K exp(−i beta))²) along its axis. So the harmonics differ from piston
to piston, and the outer dead centres are unevenly spaced.

Source: C. F. Taylor, The Internal-Combustion Engine in Theory and Practice, vol. 2 (articulated rods); the positions
follow from the triangle of each rod.
"""

import math
from collections.abc import Sequence

import numpy as np

from engine.elements.engines.engine_layout import Engine

# Harmonics decay as the piston's do (see `harmonics`): to rounding for λ + |ε| up to 0.97.
POSITIONS = 512


def positions(engine: Engine, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pistons along their axes, and knuckle pins relative to the crankpin.

    Parameters
    ----------
    engine : Engine
        With a master rod.
    phi : ndarray (positions,)
        Crank angles [rad].

    Returns
    -------
    ndarray (..., cylinders, positions)
        Piston position from the crank axis, along the cylinder [m].
    ndarray of complex (..., cylinders, positions)
        Knuckle pins [m]; 0 for the master rod's cylinder.
    """
    layout, master = engine.layout, engine.master
    radius, rod, offset, knuckle, link = (
        np.asarray(x, float)[..., None, None]
        for x in (engine.radius, engine.rod, engine.offset, master.knuckle_radius, master.link_rod)
    )
    bank, throw = layout.banks[..., None], layout.throws[..., None]
    own = np.arange(layout.banks.shape[-1])[:, None] == master.cylinder
    crankpin = radius * np.exp(1j * (phi + throw))
    at_master = crankpin * np.exp(-1j * bank[..., master.cylinder, :][..., None, :])
    lean = np.arcsin((offset - at_master.imag) / rod)
    pin = np.where(own, 0.0, knuckle * np.exp(1j * (bank + lean)))
    along = (crankpin + pin) * np.exp(-1j * bank)
    length = np.where(own, rod, link)
    return along.real + np.sqrt(length**2 - (along.imag - offset) ** 2), pin


def master_rod_harmonics(engine: Engine, orders: Sequence[int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Harmonics of the accelerations of pistons and knuckle pins.

    Parameters
    ----------
    engine : Engine
        With a master rod.
    orders : sequence of int
        From 1.

    Returns
    -------
    ndarray of complex (..., cylinders, orders)
        Pistons: amplitudes c_n of −ẍ/ω² = Re Σ c_n exp(i n phi) [m].
    ndarray of complex (..., cylinders, orders), twice
        Knuckle pins relative to the crankpin: parts that rotate with the crank and against it [m].
    """
    pistons, pins = positions(engine, math.tau * np.arange(POSITIONS) / POSITIONS)
    orders = np.array(orders)
    pistons = np.fft.rfft(pistons, axis=-1)[..., orders] * (2 / POSITIONS)
    pins = np.fft.fft(pins, axis=-1) / POSITIONS
    return pistons * orders**2, pins[..., orders] * orders**2, pins[..., -orders] * orders**2
