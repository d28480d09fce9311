"""Parts of one mass on a spring: spring, initial state, excitation."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from engine import parts
from engine.elements.compliances.elastic_parts import HollowRound, PartModulus
from engine.laws.tables import make_table
from engine.parts.actions import Force, Time
from engine.parts.formulas.by_formula import ByFormula, FormulaText
from engine.parts.formulas.expressions import ExpressionError, TextExpression, parse
from engine.parts.skeleton import AngularSpeed, Faults, Length, Mass, NonZero, Part, Positive, Speed, quantity
from engine.units.dimensions import described
from engine.units.reading import any_quantity, dimension_of_unit
from engine.words.glossary import unknown_name_message

AngularAcceleration = quantity("angular_acceleration")
ExcitingSpeed = Annotated[AngularSpeed, Field(ge=0)]


class CantileverSpring(HollowRound):
    """A round cantilever that carries the mass at its end; the cantilever's own mass is neglected."""

    length: Positive
    elastic_modulus: PartModulus


class FreeStart(Part):
    """Free motion: displacement and velocity at the start, and the `time` at which the motion is reported."""

    displacement: Length = 0.0
    velocity: Speed = 0.0
    time: Annotated[Time, Field(ge=0)] = 0.0


class HarmonicForce(Part):
    """A harmonic force on the mass, with zero mean and the angular frequency `speed`."""

    type: Literal["force"]
    amplitude: Annotated[Force, Field(gt=0)]
    speed: ExcitingSpeed


class RotatingUnbalance(Part):
    """An eccentric mass of a rotor on the oscillating mass, which includes it."""

    type: Literal["unbalance"]
    mass: Annotated[Mass, Field(gt=0)]
    radius: Positive
    speed: ExcitingSpeed


class SupportMotion(Part):
    """Harmonic motion of the support of spring and damper."""

    type: Literal["support_motion"]
    amplitude: Positive
    speed: ExcitingSpeed


class OverTime(ByFormula):
    """Excitation over time: by rows with linear interpolation, or by a `formula` of the time t.

    Rows start at 0 s, and the last value stays. `time` is the duration of the motion; by default it ends at the last
    row. A formula may use the `numbers` next to it.
    """

    over_time: list[Time] | None = None
    formula: FormulaText | None = None
    time: Annotated[Time, Field(gt=0)] | None = None

    @property
    def expression(self) -> TextExpression:
        """The parsed formula."""
        return parse(self.formula, any_quantity)

    def _faults_of(self, key: str, unit: str) -> Faults:
        """Anything but rows, or a formula of the time with the right unit."""
        rows = getattr(self, key)
        if (rows is None) != (self.over_time is None) or (rows is None) == (self.formula is None):
            yield f"give over_time and {key}, or a formula: one of the two"
        if self.formula is not None:
            yield from self._faults_of_formula(unit)
            return
        if self.numbers:
            yield "numbers belong to a formula: give one, or leave them out"
        make_table(self.over_time, rows, "linear", names=("over_time", key))
        if self.over_time[0] != 0.0:
            yield f"over_time begins at {self.over_time[0]:g} s: begin at 0 s, when the mass starts"
        if not np.any(rows):
            yield f"{key} is 0 in all rows: nothing drives the mass; leave the excitation out"

    def _faults_of_formula(self, unit: str) -> Faults:
        check = parts.formulas.dimension_check
        if self.time is None:
            yield "time is missing: a formula has no last row; give the duration of the motion"
        if "t" in self.numbers:
            yield "numbers.t: 't' is the time in formulas; choose another name"
        expression = self.expression
        units = {name: described(number.dimension).unit for name, number in self.numbers.items()} | {"t": "s"}
        for name in expression.names:
            if name not in units:
                yield f"formula: {unknown_name_message(name, units)}; it can use t and numbers"
        try:
            check.check_yields(expression, dimension_of_unit(unit), check.dimensions_by_unit(units))
        except ExpressionError as error:
            raise ValueError(f"formula: {error}") from None


class ForceOverTime(OverTime):
    """A force on the mass over time."""

    type: Literal["force_over_time"]
    force: list[Force] | None = None

    def _faults(self) -> Faults:
        yield from self._faults_of("force", "N")


class SupportOverTime(OverTime):
    """Displacement of the support of spring and damper over time, without jumps."""

    type: Literal["support_over_time"]
    displacement: list[Length] | None = None

    def _faults(self) -> Faults:
        yield from self._faults_of("displacement", "m")
        if self.over_time is not None and np.any(np.diff(self.over_time) == 0.0):
            yield "over_time has a time twice: a support can't jump; give the rise a time, however short"


class RunThrough(Part):
    """A rotor whose speed changes with constant acceleration, from the steady vibration at the speed `start` on."""

    start: Annotated[AngularSpeed, Field(ge=0)]
    acceleration: Annotated[AngularAcceleration, NonZero("the speed must change: give a negative one for a run-down")]


Excitation = Annotated[
    HarmonicForce | RotatingUnbalance | SupportMotion | ForceOverTime | SupportOverTime, Field(discriminator="type")
]
