"""Strength of pins and rods from the reactions in the pairs: bearing pressure, buckling of struts."""

from functools import partial

import numpy as np

from engine.cycle.measured import Measured
from engine.graph.nodes import Node
from engine.laws.buckling import MATERIALS, critical_stress, flat, solid
from engine.mechanism.mechanics import Mechanics
from engine.mechanism.vectors import Vector
from engine.parts.requirements import Strut
from engine.quantities.expressions import Expression, Formula, VariantNumber, greatest, maximum
from engine.quantities.register import Declared, Field, Summary, answer_summary
from engine.scene.pairs import Pair, rods_of
from engine.scene.scene import Numbers


def declare(mechanics: Mechanics) -> Declared:
    """Bearing pressure of every pin, and the buckling safety of every strut."""
    m = mechanics
    for name, pin in m.scene.pins.items():
        at = f"pins.{name}"
        area = m.graph.derived(f"{at}.area", lambda n, at=at: n[f"{at}.diameter"] * n[f"{at}.width"])
        words = f"bearing pressure of pin {name}: force in {pin.pair} over its projected area"
        yield Field(f"{name}.pressure", words, "Pa", partial(_pressure, m, pin.pair, area), "p", ("peak",))
    for name, strut in m.scene.struts.items():
        yield from _of_strut(m, name, strut)


def _pressure(m: Mechanics, pair: str, area: Node) -> Node:
    return m.reactions.variables[f"{pair}.reaction"] / area


def _of_strut(m: Mechanics, name: str, strut: Strut) -> Declared:
    at, graph = f"struts.{name}", m.graph
    slenderness = graph.derived(f"{at}.slenderness", lambda n: _slenderness(m, name, n))
    critical = graph.derived(f"{at}.critical force", lambda n: _critical_force(m, name, n))

    def compression() -> Expression:
        """Maximum compressive force at either end; 0 for a rod always in tension."""
        found = maximum(*(greatest(thrust) for thrust in _thrusts(m, strut.link)))
        return maximum(found, found * 0.0)

    def safety() -> Expression:
        return Formula(_safety, (VariantNumber(critical), compression()))

    words = f"slenderness of strut {name}"
    yield Summary(f"{name}.slenderness", words, "1", lambda: VariantNumber(slenderness), "λ")
    words = f"peak compressive force in strut {name}"
    yield Summary(f"{name}.compression", words, "N", compression, "F")
    words = f"critical force of strut {name}, by Euler or Tetmajer"
    yield Summary(f"{name}.critical_force", words, "N", lambda: VariantNumber(critical), "F_K")
    words = f"buckling safety of strut {name}: critical force over peak compressive force"
    yield answer_summary(f"{name}.buckling_safety", words, "1", safety, "S_K", True)


def _thrusts(m: Mechanics, link: str) -> tuple[Node, Node]:
    """Compressive force in a rod at its origin and at its other end."""
    rod, axis = rods_of(m.scene)[link], m.kinematics.links[link].u
    outer, inner = (
        sum((_force_on(m, pair, link).dot(axis) for pair in found), m.graph.zero) for found in (rod.outer, rod.inner)
    )
    return outer, -inner


def _force_on(m: Mechanics, pair: Pair, link: str) -> Vector:
    force = m.reactions.force_in(pair.name)
    return force if pair.link == link else -force


def _section(m: Mechanics, name: str, n: Numbers) -> tuple[float, float]:
    at = f"struts.{name}"
    if m.scene.struts[name].diameter is None:
        return flat(n[f"{at}.width"], n[f"{at}.thickness"])
    return solid(n[f"{at}.diameter"], n.get(f"{at}.inner_diameter", 0.0))


def _slenderness(m: Mechanics, name: str, n: Numbers) -> float | np.ndarray:
    length = n[rods_of(m.scene)[m.scene.struts[name].link].length]
    return n[f"struts.{name}.end_fixity"] * length / _section(m, name, n)[1]


def _critical_force(m: Mechanics, name: str, n: Numbers) -> np.ndarray:
    material = MATERIALS[m.scene.struts[name].material]
    return _section(m, name, n)[0] * critical_stress(_slenderness(m, name, n), material)


def _safety(critical: Measured, compression: Measured) -> Measured:
    """Buckling safety; undefined for a rod always in tension."""
    with np.errstate(all="ignore"):
        found = critical / compression
    pulled = compression.value <= 0.0
    return Measured(np.where(pulled, np.nan, found.value), np.where(pulled, np.nan, found.error))
