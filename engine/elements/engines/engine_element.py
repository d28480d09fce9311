"""An engine as a machine element of a scene: its layout by name, its cranks, rods, masses, counterweights and gas."""

import math
from functools import cached_property
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elements.engines.engine_layout import (
    EngineLayout,
    Pattern,
    boxer_engine,
    in_line_engine,
    radial_engine,
    v_engine,
    w_engine,
)
from engine.elements.engines.firing import even_firing_order, firing_angles
from engine.parts.skeleton import Angle, AngularSpeed, Inertia, Length, Mass, Number, Part, quantity

Positive = Annotated[Length, Field(gt=0)]
MassOrNone = Annotated[Mass, Field(ge=0)]
Pressure = Annotated[quantity("pressure"), Field(gt=0)]
Exponent = Annotated[Number, Field(gt=0)]
SIZES = ("bank_angle", "pin_offset", "spacing", "rod_distance")


class EngineGas(Part):
    """Ideal four-stroke diagram of every cylinder, as for a cylinder of type "four_stroke"."""

    bore: Positive
    clearance: Annotated[Number, Field(gt=0)]
    intake: Pressure
    exhaust: Pressure
    peak: Pressure
    n_compression: Exponent = 1.32
    n_expansion: Exponent = 1.28
    ambient: Pressure = 101_325.0


class EngineElement(Part):
    """An engine of equal cylinders, whose rods all turn on the crankpins, or on a radial engine's master rod.

    `bank_angle` lies between neighbouring banks of a V or W. `throws` are the angles of the throws, of one cylinder or
    of the pair, or row across, that works on it; usual ones where not given. By `pin_offset` a split crankpin of a V
    leads for the second bank. `spacing` is that of the throws, `rod_distance` that of the rods on one throw: without
    `spacing` there are no couples. `rod_centre` is the distance of the rod's centre of mass from the crankpin,
    `throw_mass` is reduced to the crankpin. Counterweights balance the shares `balanced_rotating` and
    `balanced_reciprocating` of the masses at each throw. At a `crank_angle` forces are told with their directions.

    `gudgeon_offset` is the distance of the gudgeon pins' lines of motion from the crank's axis, to the left of each
    cylinder as it points outwards: of an offset pin or an offset cylinder. With `knuckle_radius` and `link_rod` the rod
    is that of `master_cylinder`; the others have link rods, with their centres of mass at `link_rod_centre` from the
    knuckle pins. `gas` gives the torque; `rod_inertia`, about the centre of mass, matters to it alone.
    """

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

    @model_validator(mode="after")
    def _keys_fit_the_layout(self) -> "EngineElement":
        if (self.layout in ("V", "W")) != (self.bank_angle is not None):
            raise ValueError(f"bank_angle goes with layout = 'V' or 'W'; the layout is {self.layout!r}")
        if self.pin_offset is not None and self.layout != "V":
            raise ValueError(f"pin_offset goes with layout = 'V'; the layout is {self.layout!r}")
        if self.throws is not None and self.layout == "radial":
            raise ValueError("throws: a radial engine has one throw; leave throws out")
        self._check_rods()
        self.pattern()
        if self.gas is not None:
            firing_angles(self.nominal_layout, self.order_of_firing)
        return self

    def _check_rods(self) -> None:
        aside = abs(self.gudgeon_offset or 0.0)
        if self.rod <= math.hypot(self.stroke / 2, aside):
            least = f"half the stroke, {self.stroke / 2:g} m"
            if aside:
                least = f"{math.hypot(self.stroke / 2, aside):g} m, for half the stroke and gudgeon_offset across it"
            raise ValueError(f"rod = {self.rod:g} m: it must be longer than {least}")
        if (self.knuckle_radius is None) != (self.link_rod is None):
            raise ValueError("knuckle_radius and link_rod belong together: give both, or neither")
        if self.knuckle_radius is None:
            if self.link_rod_mass or self.link_rod_centre or self.master_cylinder != 1:
                raise ValueError("link rods need knuckle_radius and link_rod: give both")
        elif self.layout != "radial":
            raise ValueError(f"knuckle_radius goes with layout = 'radial'; the layout is {self.layout!r}")
        elif self.gas is not None:
            raise ValueError("gas: the torque is that of rods on the crankpin; leave out gas, or the link rods")
        elif self.master_cylinder > self.cylinders:
            raise ValueError(f"master_cylinder = {self.master_cylinder}: there are {self.cylinders} cylinders")
        if self.firing_order is not None and self.gas is None:
            raise ValueError("firing_order matters to the torque alone, which needs gas: give gas, or leave it out")

    def pattern(self) -> Pattern:
        """The cylinders, with sizes still open.

        Raises
        ------
        LayoutError
            This layout doesn't have so many cylinders or throws.
        """
        if self.layout == "radial":
            return radial_engine(self.cylinders)
        return {"in-line": in_line_engine, "V": v_engine, "W": _w, "boxer": boxer_engine}[self.layout](
            self.cylinders, self.throws
        )

    @cached_property
    def nominal_layout(self) -> EngineLayout:
        """The layout with the element's own sizes; without `spacing` with one of 1."""
        return self.pattern().layout(**{key: getattr(self, key) for key in SIZES if getattr(self, key) is not None})

    @cached_property
    def order_of_firing(self) -> tuple[int, ...]:
        """Numbers of the cylinders from 1 on as they fire: those given, or an order with even intervals.

        Raises
        ------
        ValueError
            None is given and the throws allow no even one.
        """
        found = self.firing_order or even_firing_order(self.nominal_layout)
        if found is None:
            raise ValueError("firing_order is missing: these throws allow no even one")
        return found

    @property
    def master_index(self) -> int | None:
        """Index of the master rod's cylinder from 0; None where all rods turn on the crankpins."""
        return None if self.knuckle_radius is None else self.master_cylinder - 1


def _w(cylinders: int, throws: tuple[float, ...] | None) -> Pattern:
    return w_engine(cylinders, throws=throws)
