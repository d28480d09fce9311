"""The regimes of a machine as a scene describes them: what it does, one after another, and what acts meanwhile.

Conventions
-----------
Regimes follow one another in the order of the text: each begins where the one before it ended, the first one at rest
at φ = 0, or where the range of an input that doesn't turn fully begins. Everything in the scene acts, but for what a
regime names as `off`: motors, forces, moments, springs, cylinders, brakes, "gravity", or a coupling, which is then
open. Speeds are magnitudes, in the direction of `input.speed`.

An end of the range of an input stops it: a run that arrives there ends, and the next one begins there at rest.
"""

from typing import Annotated, Literal, NamedTuple

from pydantic import Field, model_validator

from engine.scene.actions import Time
from engine.scene.parts import Angle, AngularSpeed, CrankInput, Length, Name, Number, Part, SliderInput, Speed

ENDS = ("cycles", "time", "speed", "velocity", "rest", "end_of_range", "lock_up")


class SteadyRegime(Part):
    """The motion that repeats itself every cycle, found directly."""

    type: Literal["steady"]
    off: tuple[Name, ...] = ()


class RunRegime(Part):
    """Motion until one of: a number of `cycles`, a `time`, a `speed` reached from below or above, `rest` = true.

    With an input that doesn't turn fully, `end_of_range` = true: until it arrives at an end of its range. A sliding
    input has a `velocity` for its speed, and begins by `from_velocity` and `from_position`, its displacement.

    With a clutch, `lock_up` = true: until it holds both sides together. `from_speed` and `from_angle` set the begin,
    instead of where the regime before ended, `from_shaft_speed` that of a shaft behind a coupling, which otherwise
    turns along with from_speed. A run that hasn't ended after `at_most` cycles is given up.
    """

    type: Literal["run"]
    off: tuple[Name, ...] = ()
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
    end_of_range: Literal[True] | None = None
    lock_up: Literal[True] | None = None
    at_most: Annotated[Number, Field(gt=0)] = 10_000.0

    @model_validator(mode="after")
    def _ends_once(self) -> "RunRegime":
        given = [key for key in ENDS if getattr(self, key) is not None]
        if len(given) != 1:
            what = "none is" if not given else f"{' and '.join(given)} are"
            raise ValueError(
                f"a run ends after cycles, after a time, at a speed or at rest: {what} given; give exactly one of "
                "cycles, time, speed, rest = true, velocity of a sliding input, end_of_range = true of an input that "
                "doesn't turn fully, or with a clutch lock_up = true"
            )
        return self


class RunKeys(NamedTuple):
    """Keys of a run for the speed at its end, and for speed and place at its begin, by the kind of the input."""

    speed: str
    from_speed: str
    from_place: str


OF_CRANK = RunKeys("speed", "from_speed", "from_angle")
OF_SLIDER = RunKeys("velocity", "from_velocity", "from_position")


def run_keys(drive: CrankInput | SliderInput) -> RunKeys:
    """Keys of runs with a crank, or with a sliding input."""
    return OF_CRANK if isinstance(drive, CrankInput) else OF_SLIDER


Regime = Annotated[SteadyRegime | RunRegime, Field(discriminator="type")]
