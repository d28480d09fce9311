"""Engines: shaking forces and couples, and torque, by orders.

The equations are those of `engine.elements.engines.shaking` and `engine.elements.engines.engine_torque`. The throws of
a balanced layout cancel except for rounding; a remainder within rounding counts as balanced. The maximum and minimum of
a force or couple of one order are the semi-axes of its ellipse: the minimum is 0 for a vector along a line, and equals
the maximum for a rotating one.

Error estimates: the numbers of an engine are factors or phases, so the effect of their rounding follows from the sizes
of the terms. The effect of the crank-to-rod ratio grows as the rod length approaches the crank radius, but stays within
the estimate: 0.9 of it at a ratio of 0.99999.
"""

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.cycle.measured import Measured
from engine.elements.element import Answers, Element, ElementResult, Numbers, Rank, further
from engine.elements.engines.engine_layout import (
    Engine,
    EngineLayout,
    Pattern,
    boxer_engine,
    in_line_engine,
    radial_engine,
    v_engine,
    w_engine,
)
from engine.elements.engines.engine_panels import engine_panels
from engine.elements.engines.firing import FOUR_STROKE, even_firing_order, firing_angles
from engine.elements.engines.hodograph import Hodograph
from engine.elements.engines.made_engine import ROUNDED_ORDERS, SIZES, TORQUE_ORDERS, engine_torque, made_engine
from engine.elements.engines.master_rod import POSITIONS
from engine.elements.engines.shafts import crankshaft_counterweights, remaining_shaking
from engine.elements.engines.shaking import EngineShaking, engine_shaking
from engine.elements.panels import Panel
from engine.laws.rounding import EPS
from engine.parts.skeleton import Angle, AngularSpeed, Faults, Inertia, Length, Mass, Number, Part, Positive, quantity
from engine.units.display import quantity_text

MassOrNone = Annotated[Mass, Field(ge=0)]
Pressure = Annotated[quantity("pressure"), Field(gt=0)]
Exponent = Annotated[Number, Field(gt=0)]
# Array elements in memory at a time.
_BLOCK = 2**19

_WORDS = {1: "primary", 2: "secondary", 3: "third_order", 4: "fourth_order", 5: "fifth_order", 6: "sixth_order"}
# Keys used only for forces and couples.
OF_SHAKING = ("spacing", "rod_distance", "throw_mass", "balanced_rotating", "balanced_reciprocating", "crank_angle")
_SHARES = ("balanced_rotating", "balanced_reciprocating")
_DIRECTIONS = {"along": "along the engine's axis", "across": "across the engine's axis, to its left"}


class EngineGas(Part):
    """Ideal four-stroke indicator diagram of every cylinder, as for a cylinder of type "four_stroke"."""

    bore: Positive
    clearance: Annotated[Number, Field(gt=0)]
    intake: Pressure
    exhaust: Pressure
    peak: Pressure
    n_compression: Exponent = 1.32
    n_expansion: Exponent = 1.28
    ambient: Pressure = 101_325.0


class EngineElement(Element):
    """An engine of equal cylinders, with all rods on the crankpins, or on the master rod of a radial engine.

    `bank_angle` is the angle between neighbouring banks of a V or W. `throws` are the angles of the throws, one for
    each cylinder, or for each pair or row of cylinders on one throw; the usual ones by default. The split crankpin of a
    V leads by `pin_offset` for the second bank. `spacing` is the distance between throws, `rod_distance` between rods
    on one throw; couples require `spacing`. `rod_centre` is the distance of the rod's centre of mass from the crankpin,
    `throw_mass` is reduced to the crankpin. Counterweights balance the fractions `balanced_rotating` and
    `balanced_reciprocating` of the masses at each throw. Force components are given at `crank_angle`.

    `gudgeon_offset` is the distance of the gudgeon pins' line of motion from the crank axis, to the left of each
    cylinder seen outwards, due to an offset pin or an offset cylinder. With `knuckle_radius` and `link_rod`, the rod
    is that of `master_cylinder`; the other cylinders have link rods with the centre of mass at `link_rod_centre` from
    the knuckle pin. The torque requires `gas`; `rod_inertia`, about the centre of mass, affects the torque only.
    """

    picture: ClassVar = "orders"
    together: ClassVar = (("knuckle_radius", "link_rod"),)
    required_with: ClassVar = {"bank_angle": ("layout", ("V", "W"))}
    goes_with: ClassVar = {
        "pin_offset": ("layout", ("V",)),
        "throws": ("layout", ("in-line", "V", "W", "boxer")),
        "knuckle_radius": ("layout", ("radial",)),
    }
    needs: ClassVar = {
        **dict.fromkeys(("link_rod_mass", "link_rod_centre", "master_cylinder"), ("knuckle_radius",)),
        **dict.fromkeys(("firing_order", "rod_inertia"), ("gas",)),
    }

    type: Literal["engine"]
    layout: Literal["in-line", "V", "W", "boxer", "radial"]
    cylinders: Annotated[int, Field(ge=1, le=100)]
    throws: tuple[Angle, ...] | None = None
    bank_angle: Annotated[Angle, Field(ge=0, le=math.pi)] | None = None
    pin_offset: Angle | None = None
    spacing: Annotated[Length, Field(ge=0)] | None = None
    rod_distance: Length = 0.0
    stroke: Positive
    rod: Positive
    gudgeon_offset: Length | None = None
    piston_mass: Annotated[Mass, Field(gt=0)]
    rod_mass: MassOrNone = 0.0
    rod_centre: Length = 0.0
    rod_inertia: Annotated[Inertia, Field(ge=0)] | None = None
    throw_mass: MassOrNone = 0.0
    master_cylinder: Annotated[int, Field(ge=1)] = 1
    knuckle_radius: Positive | None = None
    link_rod: Positive | None = None
    link_rod_mass: MassOrNone = 0.0
    link_rod_centre: Length = 0.0
    balanced_rotating: Number = 1.0
    balanced_reciprocating: Number = 0.0
    speed: Annotated[AngularSpeed, Field(gt=0)]
    crank_angle: Angle | None = None
    gas: EngineGas | None = None
    firing_order: tuple[int, ...] | None = None

    def _faults(self) -> Faults:
        yield from self._faults_of_rods()
        self.pattern()
        if self.gas is not None:
            firing_angles(self.nominal_layout, self.order_of_firing)

    def _faults_of_rods(self) -> Faults:
        aside = abs(self.gudgeon_offset or 0.0)
        if self.rod <= math.hypot(self.stroke / 2, aside):
            least = f"half the stroke, {quantity_text(self.stroke / 2, 'm')}"
            if aside:
                least = (
                    f"{quantity_text(math.hypot(self.stroke / 2, aside), 'm')}, for half the "
                    f"stroke and gudgeon_offset across it"
                )
            yield f"rod = {quantity_text(self.rod, 'm')}: it must be longer than {least}"
        if self.knuckle_radius is not None and self.gas is not None:
            yield "gas: the torque is that of rods on the crankpin; leave out gas, or the link rods"
        if self.master_cylinder > self.cylinders:
            yield f"master_cylinder = {self.master_cylinder}: there are {self.cylinders} cylinders"

    def pattern(self) -> Pattern:
        """Arrangement of the cylinders, without dimensions.

        Raises
        ------
        LayoutError
            The layout is impossible with this number of cylinders or throws.
        """
        if self.layout == "radial":
            return radial_engine(self.cylinders)
        if self.layout == "W":
            return w_engine(self.cylinders, throws=self.throws)
        make = {"in-line": in_line_engine, "V": v_engine, "boxer": boxer_engine}[self.layout]
        return make(self.cylinders, self.throws)

    @cached_property
    def nominal_layout(self) -> EngineLayout:
        """The layout with the element's dimensions; `spacing` defaults to 1."""
        return self.pattern().layout(**{key: getattr(self, key) for key in SIZES if getattr(self, key) is not None})

    @cached_property
    def order_of_firing(self) -> tuple[int, ...]:
        """Cylinder numbers, from 1, in firing order: the given order, or one with even intervals.

        Raises
        ------
        ValueError
            No order is given and the throws allow no even one.
        """
        found = self.firing_order or even_firing_order(self.nominal_layout)
        if found is None:
            raise ValueError("firing_order is missing: these throws allow no even one")
        return found

    @property
    def master_index(self) -> int | None:
        """Index of the master rod's cylinder, from 0; None if all rods are on the crankpins."""
        return None if self.knuckle_radius is None else self.master_cylinder - 1

    @property
    def variants_at_once(self) -> int:
        """Few if the motion of link rods is computed."""
        positions = POSITIONS * self.cylinders if self.master_index is not None else 256
        return max(1, _BLOCK // positions)

    def results(self) -> tuple[ElementResult, ...]:
        """Results for the orders, for couples if `spacing` is given, and for the torque if `gas` is given."""
        return tuple(r for r in _results(self) if r.needs is None or getattr(self, r.needs) is not None)

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates from the sizes of their terms."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return Answers.of(engine_results(self, n))

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """Hodographs and orders of force and couple, throws along the crank, torque."""
        return engine_panels(self)


def shaking_orders(engine: EngineElement) -> tuple[int, ...]:
    """Orders of the forces, odd ones above the first only with offset gudgeon pins or a master rod."""
    return (1, 2, 4, 6) if engine.gudgeon_offset is None and engine.master_index is None else tuple(_WORDS)


def _results(engine: EngineElement) -> Iterator[ElementResult]:
    orders = shaking_orders(engine)
    for kind, units, needs in (("force", "N", None), ("couple", "N m", "spacing")):
        for word in (_WORDS[n] for n in orders):
            said = word.replace("_", " ")
            rank = Rank.ANSWER if word in (_WORDS[1], _WORDS[2]) else Rank.FURTHER
            yield ElementResult(f"{word}_{kind}", f"maximum {said} {kind}", units, needs, rank=rank)
            yield further(f"{word}_{kind}_least", f"minimum {said} {kind}", units, needs=needs)
        listed = ", ".join(map(str, orders))
        yield ElementResult(f"rms_{kind}", f"root mean square of the {kind}, orders {listed}", units, needs)
    if engine.crank_angle is not None:
        for name, words in (("primary_force", "primary force"), ("force", f"force, orders {listed},")):
            for key, said in _DIRECTIONS.items():
                yield ElementResult(f"{name}_{key}", f"unbalanced {words} {said}, at the crank angle", "N")
    yield ElementResult("crank_unbalance", "sum of the magnitudes of all counterweights' unbalances", "kg m")
    if engine.gas is not None:
        yield ElementResult("mean_torque", "mean torque of the gas", "N m")
        yield ElementResult("mean_power", "mean power of the gas", "W")
        for n in TORQUE_ORDERS:
            words = f"torque of gas and inertia, order {n:g}"
            yield further(torque_name(n), words, "N m", may_be_undefined=True)


def torque_name(order: float) -> str:
    """Name of the result for an order of the torque, such as "torque_order_2_5"."""
    return f"torque_order_{order:g}".replace(".", "_")


def engine_results(engine: EngineElement, numbers: Numbers) -> dict[str, Measured]:
    """All results of an engine for a set of variants."""
    made = made_engine(engine, numbers)
    weights = crankshaft_counterweights(made, *(numbers[key] for key in _SHARES))
    orders = shaking_orders(engine)
    left = remaining_shaking(engine_shaking(made, orders), [weights])
    square = np.square(numbers["speed"])
    unbalance = np.abs(weights.unbalances).sum(axis=-1)
    found = {"crank_unbalance": _rounded(unbalance, ROUNDED_ORDERS * unbalance)}
    for kind, vector, terms, carried in (
        ("force", left.forces, left.force_terms, _carried(engine, numbers, made, left.force_terms, orders)),
        ("couple", left.couples, left.couple_terms, _couples_carry(engine, numbers, made, left, orders)),
    ):
        least = ROUNDED_ORDERS * EPS * terms
        whole = np.sqrt(np.square(carried).sum(axis=-1)) * square
        found[f"rms_{kind}"] = _rounded(_settled(vector, least).rms * square, whole)
        for i, word in enumerate(_WORDS[n] for n in orders):
            for name, axis in ((f"{word}_{kind}", vector.major), (f"{word}_{kind}_least", vector.minor)):
                value = np.where(axis[..., i] <= least[..., i], 0.0, axis[..., i]) * square
                found[name] = _rounded(value, carried[..., i] * square)
        if kind == "force" and engine.crank_angle is not None:
            found |= _at_angle(vector, terms, carried, numbers)
    return found if engine.gas is None else found | _torque_results(engine, numbers)


def _rounded(value: np.ndarray, size: np.ndarray) -> Measured:
    """A sum with the rounding error of its terms, given the sum of their magnitudes."""
    return Measured(value, EPS * size)


def _carried(engine: EngineElement, n: Numbers, made: Engine, terms: np.ndarray, orders: tuple[int, ...]) -> np.ndarray:
    """Rounding of sums (..., orders) in multiples of eps, including the rounding of the input numbers."""
    steps = np.array(orders)
    _, lean, _, lead, _, _ = np.abs(np.array(engine.pattern(), float)).max(axis=0)
    bank, offset = (np.abs(n.get(key, np.zeros(1)))[..., None] for key in ("bank_angle", "pin_offset"))
    phases = (steps + 1) * lean * bank + steps * lead * offset
    # The Fourier transform gives every harmonic the rounding of the whole motion.
    whole = steps**2 * (1.0 if made.master is None else 1.0 + (made.rod / made.radius)[..., None])
    return (ROUNDED_ORDERS + phases) * terms + 4 * whole * terms[..., :1]


def _couples_carry(
    engine: EngineElement, n: Numbers, made: Engine, left: EngineShaking, orders: tuple[int, ...]
) -> np.ndarray:
    """As `_carried`, for couples: their arms are sums of two lengths."""
    places, shifts = np.abs(np.array(engine.pattern(), float)).T[4:]
    pitch, apart = (np.abs(n.get(key, np.ones(1)))[..., None] for key in ("spacing", "rod_distance"))
    longest = (places * pitch + shifts * apart).max(axis=-1)
    return _carried(engine, n, made, left.couple_terms, orders) + left.force_terms * longest[..., None]


def _torque_results(engine: EngineElement, n: Numbers) -> dict[str, Measured]:
    """Torque of all cylinders by orders."""
    one, all_together, angles = engine_torque(engine, n)
    count, steps, sums = engine.cylinders, np.array(TORQUE_ORDERS), np.abs(all_together)
    phases = np.abs(one.orders) * (steps * (2 * FOUR_STROKE + np.abs(angles).max(axis=-1)[..., None]) + count)
    carried = count * (ROUNDED_ORDERS * one.sizes[..., 1:] + phases)
    sums = np.where(sums <= ROUNDED_ORDERS * EPS * count * np.abs(one.orders), 0.0, sums)
    mean_size = count * ROUNDED_ORDERS * one.sizes[..., 0]
    mean = {"mean_torque": _rounded(count * one.mean, mean_size)}
    mean["mean_power"] = _rounded(count * one.mean * n["speed"], mean_size * n["speed"])
    return mean | {torque_name(h): _rounded(sums[..., i], carried[..., i]) for i, h in enumerate(TORQUE_ORDERS)}


def _at_angle(forces: Hodograph, terms: np.ndarray, carried: np.ndarray, numbers: Numbers) -> dict[str, Measured]:
    """Components of the primary and the total force at the element's crank angle."""
    steps = np.array(forces.orders) * numbers["crank_angle"][..., None]
    square = np.square(numbers["speed"])
    orders = forces.forward * np.exp(1j * steps) + forces.backward * np.exp(-1j * steps)
    with_phases = carried + (np.abs(steps) + 1) * terms
    found = {}
    for name, force, size in (
        ("primary_force", orders[..., 0], with_phases[..., 0]),
        ("force", orders.sum(axis=-1), with_phases.sum(axis=-1)),
    ):
        for key, part in zip(_DIRECTIONS, (force.real, force.imag), strict=True):
            found[f"{name}_{key}"] = _rounded(part * square, size * square)
    return found


def _settled(found: Hodograph, least: np.ndarray) -> Hodograph:
    """The vector with parts within rounding set to 0."""
    parts = (np.where(np.abs(part) <= least, 0.0, part) for part in (found.forward, found.backward))
    return Hodograph(found.orders, *parts)
