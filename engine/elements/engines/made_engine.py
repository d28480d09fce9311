"""An engine with the numbers of all variants, and the torque of its cylinders."""

from collections.abc import Sequence

import numpy as np

from engine.elements.element import Element, Numbers
from engine.elements.engines.engine_layout import Engine, MasterRod
from engine.elements.engines.engine_torque import CylinderParts, Indicator, Torque, cylinder_torque
from engine.elements.engines.firing import FOUR_STROKE, firing_sequence, firing_sums
from engine.elements.engines.harmonics import CrankMasses, crank_masses, crank_radius

SIZES = ("bank_angle", "pin_offset", "spacing", "rod_distance")
_GAS = ("bore", "clearance", "intake", "exhaust", "peak", "n_compression", "n_expansion", "ambient")
# Roundings of a sum over cylinders, relative to the sum of the sizes of its terms: phases up to 6 · 2π, products, sums,
# and masses, shares and the speed as they are given.
ROUNDED_ORDERS = 64
TORQUE_ORDERS = tuple(k / 2 for k in range(1, 13))


def made_engine(engine: Element, numbers: Numbers) -> Engine:
    """The engine of an element, with the numbers of all variants.

    Parameters
    ----------
    engine, numbers
        As for `engine_results`.
    """
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
    """Torque of the gas and the inertia of all cylinders.

    Parameters
    ----------
    engine, n
        As for `engine_results`; with gas.
    orders : sequence of float
        Multiples of ½, above 0.

    Returns
    -------
    one : Torque
        Of one cylinder.
    found : ndarray of complex (variants, orders)
        Of all; T = mean + Re Σ T_n exp(i n phi). NaN where the throws don't let the cylinders fire in their order.
    angles : ndarray (variants, cylinders)
        At which the cylinders fire [rad].
    """
    made = made_engine(engine, n)
    gas = {key: n[f"gas.{key}"] for key in _GAS}
    bore, outside = gas.pop("bore"), gas.pop("ambient")
    mass = made.reciprocating_mass[..., 0]
    moving = CylinderParts(made.radius, made.rod, made.offset, mass, made.rod_correction, n["speed"])
    one = cylinder_torque(Indicator(**gas, outside=outside), bore, moving, orders)
    angles, taken = firing_sequence(made.layout, engine.order_of_firing)
    with np.errstate(invalid="ignore"):
        top = np.arcsin(made.offset / (made.rod + made.radius))
    angles = np.where((taken < FOUR_STROKE)[..., None], angles + top[..., None], np.nan)
    return one, one.orders * firing_sums(orders, angles), angles
