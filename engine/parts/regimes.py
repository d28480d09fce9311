"""The regimes of a scene: how the machine moves in each, one after the other, and which actions are off.

Conventions
-----------
Regimes follow one another in the order of the text. Each starts where the one before it ended; the first starts at rest
at φ = 0, or at the start of the range of an input that doesn't turn fully. All actions of the scene are on except those
that a regime lists as `off`: motors, forces, moments, springs, cylinders, brakes, "gravity", or a coupling, which is
then open. Speeds are magnitudes, in the direction of `input.speed`.

An end of the input's range stops the input: a run that reaches it ends, and the next one starts there at rest.
"""

import math
from collections.abc import Callable
from itertools import pairwise
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import BeforeValidator, Field, field_validator

from engine.parts.actions import Time
from engine.parts.skeleton import (
    ActionRef,
    Angle,
    AngularSpeed,
    CrankInput,
    Faults,
    Length,
    Number,
    Part,
    SliderInput,
    Speed,
)
from engine.units.reading import even_steps, first_last_count, in_text

ENDS = ("cycles", "time", "speed", "velocity", "rest", "reversal", "end_of_range", "lock_up")
MOST_INSTANTS = 100_000


def _spaced(dimension: str, unit: str) -> Callable[[object], object]:
    """Validator that expands a text such as "0 s to 2 s, 201" into equally spaced values; lists pass unchanged."""

    def read(value: object) -> object:
        if not isinstance(value, str):
            return value
        found = first_last_count(value)
        if found is None:
            raise ValueError(
                f"{value!r}: write a list, or 'FIRST to LAST, HOW MANY' such as '0 {unit} to 2 {unit}, 201'"
            )
        first, last = (in_text(end, dimension) for end in found[:2])
        count = found[2]
        if not 2 <= count <= MOST_INSTANTS:
            raise ValueError(f"{value!r}: from 2 to {MOST_INSTANTS} values are kept, not {count}; change their number")
        return [f"{number!r} {unit}" for number in even_steps(first, last, count, np.arange(count)).tolist()]

    return read


class Instants(Part):
    """Instants at which fields of a run are kept: `times` after its start, or `angles` turned since its start.

    Each is a rising list, or a text such as "0 s to 2 s, 201": first, last, number. Rows beyond the end of the run are
    NaN.
    """

    one_of: ClassVar = (("times", "angles"),)

    times: (
        Annotated[list[Time], BeforeValidator(_spaced("time", "s"), json_schema_input_type=list[Time] | str)] | None
    ) = None
    angles: (
        Annotated[list[Angle], BeforeValidator(_spaced("angle", "rad"), json_schema_input_type=list[Angle] | str)]
        | None
    ) = None

    @field_validator("times", "angles")
    @classmethod
    def _rises(cls, values: list[float] | None) -> list[float] | None:
        if values is None:
            return None
        if not 1 <= len(values) <= MOST_INSTANTS:
            raise ValueError(f"from 1 to {MOST_INSTANTS} values are kept, not {len(values)}; change their number")
        rising = all(a < b for a, b in pairwise(values))
        if values[0] < 0.0 or not rising or not math.isfinite(values[-1]):
            raise ValueError("counted from the start of the run, in ascending order")
        return values


class SteadyRegime(Part):
    """Steady running, a motion periodic with the cycle, found directly.

    `off` lists the actions that are off.
    """

    type: Literal["steady"]
    off: tuple[ActionRef, ...] = ()


class RunRegime(Part):
    """Motion until one of: a number of `cycles`, a `time`, a `speed` reached from below or above, `rest` = true.

    `rest` = true ends a run when the machine stays at rest under all loads, as friction or a brake holds it. `reversal`
    = true ends a run when the machine first comes to a standstill, even for an instant, as a swinging load does.

    `end_of_range` = true ends a run when an input that doesn't turn fully reaches an end of its range. A sliding input
    has `velocity` instead of `speed`, and the initial values `from_velocity` and `from_position`.

    `lock_up` = true ends a run when a clutch holds both sides together. `from_speed` and `from_angle` are the initial
    values, by default each that at the end of the regime before (a `from_angle` alone takes the speed of steady running
    at that angle, or the final speed of a run); both together reset the time of loads and laws of time to zero.
    `from_shaft_speed` is the initial speed of a shaft behind a coupling, by default that given by `from_speed`. A run
    is abandoned after `at_most` cycles. `at` gives the instants at which fields of the run are kept.

    `off` lists the actions that are off. Steps are as long as the error control allows. `method` = "rk4" takes
    `steps_per_turn` equal steps per turn of the crank instead, by the classical fourth-order Runge–Kutta method, except
    near rest; between two jumps of a load their number is even. The error estimate is then the change of the result
    with half as many steps.
    """

    together: ClassVar = (("method", "steps_per_turn"),)

    type: Literal["run"]
    off: tuple[ActionRef, ...] = ()
    from_speed: Annotated[AngularSpeed, Field(ge=0)] | None = None
    from_angle: Angle | None = None
    from_velocity: Annotated[Speed, Field(ge=0)] | None = None
    from_position: Length | None = None
    from_shaft_speed: Annotated[AngularSpeed, Field(ge=0)] | None = None
    cycles: Annotated[Number, Field(gt=0)] | None = None
    time: Annotated[Time, Field(gt=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    velocity: Annotated[Speed, Field(gt=0)] | None = None
    rest: Literal[True] | None = None
    reversal: Literal[True] | None = None
    end_of_range: Literal[True] | None = None
    lock_up: Literal[True] | None = None
    at_most: Annotated[Number, Field(gt=0)] = 10_000.0
    at: Instants | None = None
    method: Literal["rk4"] | None = None
    steps_per_turn: Annotated[int, Field(ge=8, le=4096)] | None = None

    def _faults(self) -> Faults:
        given = self.gives(*ENDS)
        if len(given) != 1:
            what = "none is" if not given else f"{' and '.join(given)} are"
            yield (
                f"a run ends after cycles, after a time, at a speed or at rest: {what} given; give exactly one of "
                "cycles, time, speed, rest = true, reversal = true (where it first stands still, even for an instant), "
                "velocity of a sliding input, end_of_range = true of an input that doesn't turn fully, or with a "
                "clutch lock_up = true"
            )


class RunKeys(NamedTuple):
    """Keys of a run for its final speed, and for its initial speed and position, by kind of input."""

    speed: str
    from_speed: str
    from_place: str


OF_CRANK = RunKeys("speed", "from_speed", "from_angle")
OF_SLIDER = RunKeys("velocity", "from_velocity", "from_position")


def run_keys(drive: CrankInput | SliderInput) -> RunKeys:
    """Keys of runs for a crank or a sliding input."""
    return OF_CRANK if isinstance(drive, CrankInput) else OF_SLIDER


Regime = Annotated[SteadyRegime | RunRegime, Field(discriminator="type")]
