"""Motion of a radial engine's pistons with master and link rods: exact positions, and their harmonics by transform.

The master rod's big end turns on the crankpin and carries the knuckle pins, at the radius c from the crankpin, of the
link rods. With the master rod leaning by psi from its cylinder's axis beta_m, the knuckle pin of a cylinder beta is at

    K = r exp(i phi) + c exp(i(beta + psi))

and its piston at Re(K exp(−i beta)) + √(l'² − Im(K exp(−i beta))²) along its axis. So each piston has harmonics of its
own, and the outer dead centres aren't evenly spaced.

Source: C. F. Taylor, The Internal-Combustion Engine in Theory and Practice, vol. 2 (articulated rods); the positions
follow from the triangle of each rod.
"""

from collections.abc import Sequence

import numpy as np

from engine.elements.engines.engine_layout import Engine

# Harmonics fall off as those of the piston do (see `harmonics`): to rounding for λ + |ε| up to 0.97.
POSITIONS = 512


def positions(engine: Engine, phi: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pistons along their axes, and knuckle pins as seen from the crankpin.

    Parameters
    ----------
    engine : Engine
        With a master rod.
    phi : ndarray (positions,)
        [rad].

    Returns
    -------
    ndarray (..., cylinders, positions)
        From the crank's axis, along the cylinder's [m].
    ndarray of complex (..., cylinders, positions)
        The master rod's own place holds 0 [m].
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
    """Harmonics of the pistons' and the knuckle pins' accelerations.

    Parameters
    ----------
    engine : Engine
        With a master rod.
    orders : sequence of int
        From 1 on.

    Returns
    -------
    ndarray of complex (..., cylinders, orders)
        Pistons: −ẍ/ω² = Re Σ exp(i n phi) [m].
    ndarray of complex (..., cylinders, orders), twice
        Knuckle pins as seen from the crankpin: parts that turn with the crank and against it [m].
    """
    pistons, pins = positions(engine, 2 * np.pi * np.arange(POSITIONS) / POSITIONS)
    orders = np.array(orders)
    pistons = np.fft.rfft(pistons, axis=-1)[..., orders] * (2 / POSITIONS)
    pins = np.fft.fft(pins, axis=-1) / POSITIONS
    return pistons * orders**2, pins[..., orders] * orders**2, pins[..., -orders] * orders**2
