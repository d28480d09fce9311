"""The regimes of a machine as a scene describes them: what it does, one after another, and what acts meanwhile.

Conventions
-----------
Regimes follow one another in the order of the text: each begins where the one before it ended, the first one at rest
at φ = 0. Everything in the scene acts, but for what a regime names as `off`: motors, forces, moments, springs,
cylinders, brakes, "gravity", or a coupling, which is then open. Speeds are magnitudes, in the direction of
`input.speed`.
"""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.scene.actions import Time
from engine.scene.parts import Angle, AngularSpeed, Name, Number, Part

ENDS = ("cycles", "time", "speed", "rest", "lock_up")


class SteadyRegime(Part):
    """The motion that repeats itself every cycle, found directly."""

    type: Literal["steady"]
    off: tuple[Name, ...] = ()


class RunRegime(Part):
    """Motion until one of: a number of `cycles`, a `time`, a `speed` reached from below or above, `rest` = true.

    With a clutch, `lock_up` = true: until it holds both sides together. `from_speed` and `from_angle` set the begin,
    instead of where the regime before ended, `from_shaft_speed` that of a shaft behind a coupling, which otherwise
    turns along with from_speed. A run that hasn't ended after `at_most` cycles is given up.
    """

    type: Literal["run"]
    off: tuple[Name, ...] = ()
    from_speed: Annotated[AngularSpeed, Field(ge=0)] | None = None
    from_angle: Angle | None = None
    from_shaft_speed: Annotated[AngularSpeed, Field(ge=0)] | None = None
    cycles: Annotated[Number, Field(gt=0)] | None = None
    time: Annotated[Time, Field(gt=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    rest: Literal[True] | None = None
    lock_up: Literal[True] | None = None
    at_most: Annotated[Number, Field(gt=0)] = 10_000.0

    @model_validator(mode="after")
    def _ends_once(self) -> "RunRegime":
        given = [key for key in ENDS if getattr(self, key) is not None]
        if len(given) != 1:
            what = "none is" if not given else f"{' and '.join(given)} are"
            raise ValueError(
                f"a run ends after cycles, after a time, at a speed or at rest: {what} given; give exactly one of "
                "cycles, time, speed, rest = true, or with a clutch lock_up = true"
            )
        return self


Regime = Annotated[SteadyRegime | RunRegime, Field(discriminator="type")]
