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
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from engine.cycle.measured import Measured
from engine.elements.element import Answers, Element, NamedRows, Numbers
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
from engine.elements.engines.engine_torque import ROUNDED_ORDERS, SIZES, TORQUE_ORDERS, engine_torque, made_engine
from engine.elements.engines.firing import FOUR_STROKE, even_firing_order, firing_angles
from engine.elements.engines.hodograph import Hodograph
from engine.elements.engines.master_rod import POSITIONS
from engine.elements.engines.shafts import crankshaft_counterweights, remaining_shaking
from engine.elements.engines.shaking import EngineShaking, engine_shaking
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, path, plan
from engine.laws.rounding import EPS
from engine.parts.skeleton import Angle, AngularSpeed, Faults, Inertia, Length, Mass, Number, Part, Positive, quantity
from engine.units.display import quantity_text
from engine.words.quantity import Quantity, Rank, main_result

MassOrNone = Annotated[Mass, Field(ge=0)]
Pressure = Annotated[quantity("pressure"), Field(gt=0)]
Exponent = Annotated[Number, Field(gt=0)]
# Array elements in memory at a time.
_BLOCK = 2**19

_WORDS = {1: "primary", 2: "secondary", 3: "third_order", 4: "fourth_order", 5: "fifth_order", 6: "sixth_order"}
# Keys used only for forces and couples.
OF_SHAKING = ("spacing", "rod_distance", "throw_mass", "balanced_rotating", "balanced_reciprocating", "crank_angle")
_SHARES = ("balanced_rotating", "balanced_reciprocating")
SHOWN_ORDERS = (1, 2, 3, 4, 5, 6)
BEFORE, AFTER = "without counterweights", "with counterweights"
_SHOWN = 721
_ORDER = PanelAxis("order of the crank's speed", "1", "k")
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
        offset = abs(self.gudgeon_offset or 0.0)
        if self.rod <= math.hypot(self.stroke / 2, offset):
            least = f"half the stroke, {quantity_text(self.stroke / 2, 'm')}"
            if offset:
                least = (
                    f"{quantity_text(math.hypot(self.stroke / 2, offset), 'm')}, for half the "
                    f"stroke and gudgeon_offset across it"
                )
            yield f"rod = {quantity_text(self.rod, 'm')}: it must be longer than {least}"
        if self.knuckle_radius is not None and self.gas is not None:
            yield "gas: the torque can't be computed with link rods; leave out gas, or the link rods"
        if self.master_cylinder > self.cylinders:
            yield f"master_cylinder = {self.master_cylinder}: there are {self.cylinders} cylinders; give one of them"

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
            raise ValueError(
                "firing_order is missing, and these throws allow no even one: give the cylinders in the order they fire"
            )
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

    def named(self, n: Numbers) -> NamedRows:
        """Results by orders, couples if `spacing` is given, and the torque if `gas` is given."""
        yield from _forces(self, n, made_engine(self, n))
        if self.gas is not None:
            yield from _torques(self, n)

    def evaluate(self, n: Numbers) -> Answers:
        """Results with error estimates from the sizes of their terms."""
        with np.errstate(invalid="ignore", divide="ignore"):
            return Answers.of(self.values(n))

    def panels(self) -> tuple[Panel, ...]:
        """Hodographs and orders of force and couple, throws along the crank, torque."""
        return _panels(self)


def torque_name(order: float) -> str:
    """Name of the result for an order of the torque, such as "torque_order_2_5"."""
    return f"torque_order_{order:g}".replace(".", "_")


def _forces(engine: EngineElement, n: Numbers, made: Engine) -> NamedRows:
    """Forces and couples by orders, with counterweights, and the unbalance of these."""
    weights = crankshaft_counterweights(made, *(n[key] for key in _SHARES))
    # Odd orders above the first only with offset gudgeon pins or a master rod.
    orders = (1, 2, 4, 6) if engine.gudgeon_offset is None and engine.master_index is None else tuple(_WORDS)
    left = remaining_shaking(engine_shaking(made, orders), [weights])
    square, listed = np.square(n["speed"]), ", ".join(map(str, orders))
    forces, couples = _settled(engine, n, made, left)
    kinds = [("force", "N", *forces), *([] if engine.spacing is None else [("couple", "N m", *couples)])]
    for kind, units, vector, carried in kinds:
        for i, word in enumerate(_WORDS[order] for order in orders):
            said, rank = word.replace("_", " "), Rank.ANSWER if word in (_WORDS[1], _WORDS[2]) else Rank.FURTHER
            most = main_result(f"{word}_{kind}", f"maximum {said} {kind}", units, rank=rank)
            least_of_all = Quantity(f"{word}_{kind}_least", f"minimum {said} {kind}", units)
            for result, axis in ((most, vector.major), (least_of_all, vector.minor)):
                value = np.where(axis[..., i] <= EPS * carried[..., i], 0.0, axis[..., i]) * square
                yield result, _rounded(value, carried[..., i] * square)
        whole = np.sqrt(np.square(carried).sum(axis=-1)) * square
        rms = main_result(f"rms_{kind}", f"root mean square of the {kind}, orders {listed}", units)
        yield rms, _rounded(vector.rms * square, whole)
    if engine.crank_angle is not None:
        yield from _at_angle(left.forces, left.force_terms, forces[1], n)
    unbalance = np.abs(weights.unbalances).sum(axis=-1)
    words = "sum of the magnitudes of all counterweights' unbalances"
    yield main_result("crank_unbalance", words, "kg m"), _rounded(unbalance, ROUNDED_ORDERS * unbalance)


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


def _torques(engine: EngineElement, n: Numbers) -> NamedRows:
    """Torque of all cylinders by orders."""
    one, all_together, angles = engine_torque(engine, n)
    count, steps, sums = engine.cylinders, np.array(TORQUE_ORDERS), np.abs(all_together)
    phases = np.abs(one.orders) * (steps * (2 * FOUR_STROKE + np.abs(angles).max(axis=-1)[..., None]) + count)
    carried = count * (ROUNDED_ORDERS * one.sizes[..., 1:] + phases)
    sums = np.where(sums <= ROUNDED_ORDERS * EPS * count * np.abs(one.orders), 0.0, sums)
    mean, size, speed = count * one.mean, count * ROUNDED_ORDERS * one.sizes[..., 0], n["speed"]
    yield main_result("mean_torque", "mean torque of the gas", "N m"), _rounded(mean, size)
    yield main_result("mean_power", "mean power of the gas", "W"), _rounded(mean * speed, size * speed)
    for i, order in enumerate(TORQUE_ORDERS):
        words = f"torque of gas and inertia, order {order:g}"
        result = Quantity(torque_name(order), words, "N m", may_be_undefined=True)
        yield result, _rounded(sums[..., i], carried[..., i])


def _at_angle(forces: Hodograph, terms: np.ndarray, carried: np.ndarray, n: Numbers) -> NamedRows:
    """Components of the primary and the total force at the element's crank angle."""
    steps, square = np.array(forces.orders) * n["crank_angle"][..., None], np.square(n["speed"])
    orders = forces.forward * np.exp(1j * steps) + forces.backward * np.exp(-1j * steps)
    with_phases, listed = carried + (np.abs(steps) + 1) * terms, ", ".join(map(str, forces.orders))
    for name, words, force, size in (
        ("primary_force", "primary force", orders[..., 0], with_phases[..., 0]),
        ("force", f"force, orders {listed},", orders.sum(axis=-1), with_phases.sum(axis=-1)),
    ):
        for (key, said), part in zip(_DIRECTIONS.items(), (force.real, force.imag), strict=True):
            result = main_result(f"{name}_{key}", f"unbalanced {words} {said}, at the crank angle", "N")
            yield result, _rounded(part * square, size * square)


class Shaken(NamedTuple):
    """Forces [N] and couples [N·m] of an engine by orders, without and with counterweights."""

    forces: tuple[Hodograph, Hodograph]
    couples: tuple[Hodograph, Hodograph]


def _settled(
    engine: EngineElement, n: Numbers, made: Engine, found: EngineShaking
) -> Iterator[tuple[Hodograph, np.ndarray]]:
    """Forces and couples, with their rounding in multiples of eps; parts within it are 0."""
    orders = found.forces.orders
    sizes = _carried(engine, n, made, found.force_terms, orders), _couples_carry(engine, n, made, found, orders)
    for vector, carried in zip((found.forces, found.couples), sizes, strict=True):
        parts = (np.where(np.abs(part) <= EPS * carried, 0.0, part) for part in (vector.forward, vector.backward))
        yield Hodograph(orders, *parts), carried


def shaken(engine: EngineElement) -> Shaken:
    """Forces and couples of an engine at its speed; values within rounding are 0."""
    n = engine.own_numbers()
    made = made_engine(engine, n)
    found = engine_shaking(made, SHOWN_ORDERS)
    weights = crankshaft_counterweights(made, n["balanced_rotating"], n["balanced_reciprocating"])
    both = zip(*(_settled(engine, n, made, one) for one in (found, remaining_shaking(found, [weights]))), strict=True)

    def at_speed(vector: Hodograph) -> Hodograph:
        return Hodograph(vector.orders, *(part[0] * engine.speed**2 for part in (vector.forward, vector.backward)))

    return Shaken(*(tuple(at_speed(vector) for vector, _ in kind) for kind in both))


def torque_orders(engine: EngineElement, orders: np.ndarray) -> tuple[float, np.ndarray]:
    """Mean torque and its orders [N·m]; values within rounding are 0.

    Parameters
    ----------
    engine : EngineElement
    orders : ndarray (orders,)
    """
    one, found, _ = engine_torque(engine, engine.own_numbers(), orders)
    least = ROUNDED_ORDERS * EPS * engine.cylinders * np.abs(one.orders[0])
    return engine.cylinders * float(one.mean[0]), np.where(np.abs(found[0]) <= least, 0.0, found[0])


def _panels(engine: EngineElement) -> tuple[Panel, ...]:
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
        bars = [line._replace(values=np.asarray(v.major), places=None) for line, v in zip(lines, both, strict=True)]
        y = PanelAxis(f"maximum {word}", unit, letter)
        panels.append(Panel(_ORDER, y, np.array(SHOWN_ORDERS, float), bars, kind="bars"))
    if engine.spacing is not None:
        layout = engine.nominal_layout
        heights = Curve("", engine.stroke / 2.0 * np.cos(layout.throws))
        axes = PanelAxis("along the crank", "m", "z"), PanelAxis("height of the crankpins", "m", "y")
        order, title = np.argsort(layout.positions, kind="stable"), "Throws from the side, crank at 0"
        heights = heights._replace(values=heights.values[order])
        panels.append(Panel(*axes, layout.positions[order], (heights,), title=title, kind="bars"))
    return (*panels, *([] if engine.gas is None else _torque(engine)))


def _torque(engine: EngineElement) -> tuple[Panel, Panel]:
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
