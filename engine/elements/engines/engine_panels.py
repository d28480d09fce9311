"""Diagrams of an engine by orders of the crank speed: hodographs of forces and couples, torque over the cycle."""

import math
from typing import NamedTuple

import numpy as np

from engine.elements.element import Element
from engine.elements.engines.firing import FOUR_STROKE, firing_angles
from engine.elements.engines.hodograph import Hodograph
from engine.elements.engines.made_engine import ROUNDED_ORDERS, engine_torque, made_engine
from engine.elements.engines.shafts import crankshaft_counterweights, remaining_shaking
from engine.elements.engines.shaking import engine_shaking
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, path, plan
from engine.laws.rounding import EPS
from engine.units.display import quantity_text

SHOWN_ORDERS = (1, 2, 3, 4, 5, 6)
BEFORE, AFTER = "without counterweights", "with counterweights"
# Rounding of a harmonic by the whole motion, in eps times the square of its order.
_WHOLE = 32
_SHOWN = 721
_ORDER = PanelAxis("order of the crank's speed", "1", "k")


class Shaken(NamedTuple):
    """Forces [N] and couples [N·m] of an engine by orders, without and with counterweights."""

    forces: tuple[Hodograph, Hodograph]
    couples: tuple[Hodograph, Hodograph]


def shaken(engine: Element) -> Shaken:
    """Forces and couples of an engine at its speed; values within rounding are 0."""
    n = engine.own_numbers()
    made = made_engine(engine, n)
    found = engine_shaking(made, SHOWN_ORDERS)
    weights = crankshaft_counterweights(made, n["balanced_rotating"], n["balanced_reciprocating"])
    both = found, remaining_shaking(found, [weights])
    return Shaken(
        tuple(_scaled(one.forces, one.force_terms, engine.speed**2) for one in both),
        tuple(_scaled(one.couples, one.couple_terms, engine.speed**2) for one in both),
    )


def _scaled(vector: Hodograph, terms: np.ndarray, factor: float) -> Hodograph:
    # In addition to the rounding of sums, the Fourier transform gives every harmonic the rounding of the whole motion.
    least = EPS * (ROUNDED_ORDERS * terms + _WHOLE * np.square(vector.orders) * terms[..., :1])
    parts = (np.where(np.abs(p) <= least, 0.0, p)[0] * factor for p in (vector.forward, vector.backward))
    return Hodograph(vector.orders, *parts)


def torque_orders(engine: Element, orders: np.ndarray) -> tuple[float, np.ndarray]:
    """Mean torque and its orders [N·m]; values within rounding are 0.

    Parameters
    ----------
    engine : EngineElement
    orders : ndarray (orders,)
    """
    one, found, _ = engine_torque(engine, engine.own_numbers(), orders)
    least = ROUNDED_ORDERS * EPS * engine.cylinders * np.abs(one.orders[0])
    return engine.cylinders * float(one.mean[0]), np.where(np.abs(found[0]) <= least, 0.0, found[0])


def engine_panels(engine: Element) -> tuple[Panel, ...]:
    """Hodographs and orders of an engine's forces and couples, throws along the crank, and torque."""
    found, panels = shaken(engine), []
    kinds = [("force", "N", "F", found.forces)]
    kinds += [] if engine.spacing is None else [("couple", "N m", "M", found.couples)]
    for word, unit, letter, both in kinds:
        if not any(np.any(vector.major) for vector in both):
            continue
        phi = np.linspace(0.0, math.tau, _SHOWN)
        # The engine's own axis points upwards.
        ways = [1j * vector.at(phi) for vector in both]
        lines = path(BEFORE, ways[0], True), path(AFTER, ways[1])
        marks = [Mark("crank at 0" if k else "", way[0].real, way[0].imag) for k, way in enumerate(ways)]
        words = "across", "along the engine's axis"
        panels.append(plan(lines, f"{word.capitalize()} over a turn", unit, words)._replace(marks=marks))
        bars = [Curve(words, np.asarray(v.major)) for words, v in zip((BEFORE, AFTER), both, strict=True)]
        panels.append(
            Panel(_ORDER, PanelAxis(f"maximum {word}", unit, letter), np.array(SHOWN_ORDERS, float), bars, kind="bars")
        )
    if engine.spacing is not None:
        layout = engine.nominal_layout
        heights = Curve("", engine.stroke / 2.0 * np.cos(layout.throws))
        axes = PanelAxis("along the crank", "m", "z"), PanelAxis("height of the crankpins", "m", "y")
        order, title = np.argsort(layout.positions, kind="stable"), "Throws from the side, crank at 0"
        heights = heights._replace(values=heights.values[order])
        panels.append(Panel(*axes, layout.positions[order], (heights,), title=title, kind="bars"))
    return (*panels, *([] if engine.gas is None else _torque(engine)))


def _torque(engine: Element) -> tuple[Panel, Panel]:
    """Torque over the cycle with the firing angles, and its orders."""
    phi, steps = np.linspace(0.0, FOUR_STROKE, _SHOWN), np.arange(1, 33) / 2
    mean, parts = torque_orders(engine, steps)
    torque = mean + (parts @ np.exp(1j * np.multiply.outer(steps, phi))).real
    fires = firing_angles(engine.nominal_layout, engine.order_of_firing) % FOUR_STROKE
    marks = Mark("", None, mean), *(Mark("", angle, None) for angle in fires)
    title = f"Mean {quantity_text(mean, 'N m')}\nfiring order {'-'.join(map(str, engine.order_of_firing))}"
    y = PanelAxis("torque", "N m", "M")
    axes = PanelAxis("crank angle", "rad", "φ"), y._replace(words="torque of gas and inertia")
    curve = Panel(*axes, phi, (Curve("", torque),), marks, title)
    return curve, Panel(_ORDER, y, steps[:12], (Curve("", np.abs(parts[:12])),), kind="bars")
