"""The drive of the scene's own machine through an elastic shaft: shaft torques, speeds, stability.

The results depend on the scene's machine: `engine.machine.drives.elastic_drives` computes them from its curves and sets
them as numbers of the drive, with their error estimates and the verdict on every variant.
"""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.elastic_drives.elastic_shaft import ElasticShaft
from engine.elements.element import Answers, Element, Numbers
from engine.parts.actions import Time
from engine.parts.bodies import OF_FLUCTUATION
from engine.parts.skeleton import ActionRef, Angle, GearedRef, Inertia, Part
from engine.words.quantity import Quantity, check_result, main_result

RESULTS = (
    main_result("stiffness", "torsional stiffness of the shaft, reduced to the crank", "N m rad-1"),
    Quantity("damping", "torsional damping of the shaft, reduced to the crank", "N m s rad-1"),
    main_result("natural_frequency", "natural frequency with the machine's mean inertia", "rad s-1"),
    Quantity("period", "duration of a cycle", "s"),
    main_result("mean_speed", "mean speed of the crank over time", "rad s-1"),
    main_result("motor_fluctuation", f"coefficient of speed fluctuation at the motors' end, {OF_FLUCTUATION}", "1"),
    main_result("machine_fluctuation", f"coefficient of speed fluctuation of the crank, {OF_FLUCTUATION}", "1"),
    main_result("mean_moment", "mean torque of the shaft over time", "N m"),
    main_result("greatest_moment", "maximum shaft torque", "N m"),
    main_result("least_moment", "minimum shaft torque", "N m"),
    main_result("alternating_moment", "alternating torque of the shaft: half its range", "N m"),
    Quantity("rigid_moment", "peak torque of a rigid shaft", "N m"),
    main_result("dynamic_factor", "peak shaft torque over that of a rigid shaft", "1", True),
    main_result("greatest_twist", "peak shaft twist (crank lag)", "rad"),
    main_result("position_error", "position error of the crank due to elasticity: half the range of the twist", "rad"),
    main_result("motor_power", "mean power of the motors", "W"),
    Quantity("damping_power", "mean power dissipated by the shaft's damping", "W"),
    check_result("power_residual", "power balance residual, relative", "1", True),
    check_result("multiplier", "largest magnitude of a multiplier: growth of disturbances per cycle", "1"),
    check_result("second_multiplier", "second largest magnitude of a multiplier", "1"),
    check_result("third_multiplier", "smallest magnitude of a multiplier", "1"),
    Quantity("growth_rate", "rate at which disturbances grow", "s-1"),
)
RUN_RESULTS = (
    main_result("run_greatest_moment", "peak shaft torque during the run", "N m", True),
    main_result("run_greatest_at", "time of the peak shaft torque during the run", "s", True),
    Quantity("run_motor_speed", "speed at the motors' end after the run, at the crank", "rad s-1", True),
    Quantity("run_machine_speed", "speed of the crank after the run, negative backwards", "rad s-1", True),
    Quantity("run_angle", "angle that the crank turned", "rad", True),
    Quantity("run_stops", "number of stops of the crank", "1", True, exact=True),
    Quantity("run_closings", "how often the backlash closed", "1", True, exact=True),
)

VERDICT_KEY = "machine.verdict"


class MachineRun(Part):
    """A run over `time`, from rest with an untwisted shaft at a crank angle, or from steady running at φ = 0.

    During the run all actions are active except those in `off`: with the motors `off` the machine runs down; an action
    that was off in steady running acts as a sudden load. `backlash` is the whole angle through which one end turns
    freely relative to the other: at rest it is open, and the motors have to close it; steady running ignores it.
    """

    goes_with: ClassVar = {"angle": ("begin", ("at rest",))}

    begin: Literal["at rest", "steady"] = "at rest"
    angle: Angle = 0.0
    time: Annotated[Time, Field(gt=0)]
    off: tuple[ActionRef, ...] = ()
    backlash: Annotated[Angle, Field(ge=0)] = 0.0


class MachineDrive(ElasticShaft, Element):
    """The scene's motors drive its crank through an elastic shaft.

    The motor end carries the `driver`, a shaft of the scene, or a `motor_inertia` in addition to the scene; all other
    inertia of the scene turns with the crank. Stiffness, damping and `motor_inertia` are reduced to the crank. Actions
    named in `off` are inactive in steady running. A `run` is simulated over time.
    """

    one_of: ClassVar = (("driver", "motor_inertia"),)
    picture: ClassVar = "cycle"
    results: ClassVar = (*RESULTS, *RUN_RESULTS)

    type: Literal["machine_drive"]
    driver: GearedRef | None = None
    motor_inertia: Annotated[Inertia, Field(gt=0)] | None = None
    off: tuple[ActionRef, ...] = ()
    run: MachineRun | None = None

    def evaluate(self, n: Numbers) -> Answers:
        """The results set as numbers of the drive."""
        parts = ({r.name: n[f"machine.{kind}.{r.name}"] for r in self.results} for kind in ("value", "error"))
        return Answers(*parts, n[VERDICT_KEY])

    def machine_needed(self) -> tuple[str, str]:
        """The scene needs a fully turning crank."""
        return "", "an elastic shaft can only drive a crank that turns fully"
