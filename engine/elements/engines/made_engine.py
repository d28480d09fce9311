"""An engine with the numbers of all variants, and its torque."""

from collections.abc import Sequence

import numpy as np

from engine.elements.element import Element, Numbers
from engine.elements.engines.engine_layout import Engine, MasterRod
from engine.elements.engines.engine_torque import Torque, cylinder_torque
from engine.elements.engines.firing import FOUR_STROKE, firing_sequence, firing_sums
from engine.elements.engines.harmonics import CrankMasses, crank_masses, crank_radius

SIZES = ("bank_angle", "pin_offset", "spacing", "rod_distance")
# Rounding of a sum over cylinders, in eps times the sum of the magnitudes of its terms: phases up to 6 · 2π, products,
# sums, and the given masses, fractions and speed.
ROUNDED_ORDERS = 64
TORQUE_ORDERS = tuple(k / 2 for k in range(1, 13))


def made_engine(engine: Element, numbers: Numbers) -> Engine:
    """The engine of an element, with the numbers of all variants."""
    n = numbers
    layout = engine.pattern().layout(**{key: n[key] for key in SIZES if key in n})
    offset = n.get("gudgeon_offset", np.zeros_like(n["stroke"]))
    own = _masses(n, "", n.get("rod_inertia"))
    reciprocating, rotating, master = own.reciprocating[..., None], own.rotating[..., None], None
    if engine.master_index is not None:
        link = _masses(n, "link_")
        here = np.arange(engine.cylinders) == engine.master_index
        reciprocating = np.where(here, reciprocating, link.reciprocating[..., None])
        rotating = np.where(here, rotating, link.rotating[..., None])
        knuckle = link.rotating - n["throw_mass"]
        master = MasterRod(engine.master_index, n["knuckle_radius"], n["link_rod"], knuckle)
    radius = crank_radius(n["stroke"], n["rod"], offset)
    return Engine(layout, radius, n["rod"], reciprocating, rotating, offset, own.rod_correction, master)


def _masses(n: Numbers, which: str, inertia: np.ndarray | None = None) -> CrankMasses:
    rod, mass, centre = n[f"{which}rod"], n[f"{which}rod_mass"], n[f"{which}rod_centre"]
    return crank_masses(n["piston_mass"], mass, rod, centre, inertia, n["throw_mass"])


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
    one = cylinder_torque(made, gas, n["speed"], orders)
    angles, taken = firing_sequence(made.layout, engine.order_of_firing)
    with np.errstate(invalid="ignore"):
        top = np.arcsin(made.offset / (made.rod + made.radius))
    angles = np.where((taken < FOUR_STROKE)[..., None], angles + top[..., None], np.nan)
    return one, one.orders * firing_sums(orders, angles), angles
