"""What can be asked of a regime: names, words and units."""

from engine.actions import InductionMotor
from engine.quantities import Quantity
from engine.scene import Scene

WORKS = ("motor_work", "driving_work", "useful_work", "harmful_work", "brake_heat", "other_work")

# Of every regime; `{name}` is the regime's.
COMMON = {
    "speed_min": ("least angular speed of the input link in {name}", "rad s-1"),
    "speed_max": ("greatest angular speed of the input link in {name}", "rad s-1"),
    "motor_moment_peak": ("greatest moment of the motors in {name}, reduced to the input, by magnitude", "N m"),
    "motor_moment_rms": ("root mean square over time of the motors' moment in {name}, reduced to the input", "N m"),
    "motor_power": ("mean power of the motors in {name}", "W"),
    "motor_work": ("work of the motors in {name}", "J"),
    "driving_work": ("work of the other driving actions in {name}", "J"),
    "useful_work": ("work against useful resistances in {name}", "J"),
    "harmful_work": ("work against harmful resistances in {name}", "J"),
    "brake_heat": ("heat in the brakes in {name}", "J"),
    "other_work": ("work of gravity, springs and all else in {name}", "J"),
    "energy_change": ("change of kinetic energy in {name}", "J"),
    "work_residual": ("sum of all works less the change of kinetic energy in {name}, over what was turned over", "1"),
    "efficiency": ("useful work over the work of what drives in {name}", "1"),
}
STEADY = {
    "period": ("time of a cycle in {name}", "s"),
    "mean_speed": ("mean angular speed over a cycle in {name}", "rad s-1"),
    "speed_fluctuation": ("coefficient of speed fluctuation of the true motion in {name}", "1"),
    "multiplier": ("factor by which a small disturbance of the energy grows from cycle to cycle in {name}", "1"),
    "return_residual": ("relative difference of the energy after a cycle in {name}", "1"),
}
RUN = {
    "time": ("duration of {name}", "s"),
    "angle": ("angle turned in {name}", "rad"),
    "final_speed": ("angular speed of the input link at the end of {name}", "rad s-1"),
}
FIELDS = {
    "speed": ("angular speed of the input link in {name}", "rad s-1"),
    "acceleration": ("angular acceleration of the input link in {name}", "rad s-2"),
    "motor_moment": ("moment of the motors in {name}, reduced to the input", "N m"),
    "load_moment": ("moment of everything else in {name}, reduced to the input", "N m"),
}


def _made(name: str, table: dict[str, tuple[str, str]]) -> list[Quantity]:
    return [Quantity(f"{name}.{key}", words.format(name=name), unit) for key, (words, unit) in table.items()]


def motion_summaries(scene: Scene) -> list[Quantity]:
    """Summaries of the regimes of a scene."""
    found: list[Quantity] = []
    for name, regime in scene.regimes.items():
        found += _made(name, COMMON | (STEADY if regime.type == "steady" else RUN))
        if regime.type == "steady":
            motors = [n for n, m in scene.moments.items() if isinstance(m, InductionMotor) and n not in regime.off]
            found += [Quantity(f"{name}.{n}_slip", f"mean slip of motor {n} in {name}", "1") for n in motors]
            if scene.flywheel is not None and scene.flywheel.speed_fluctuation is not None:
                words = (
                    f"flywheel inertia that gives the asked speed fluctuation in the true motion of {name}; where it "
                    f"is asked, the other answers of {name} are those with it"
                )
                found.append(Quantity(f"{name}.flywheel", words, "kg m2"))
    return found


def motion_fields(scene: Scene) -> list[Quantity]:
    """Fields of the steady regimes of a scene."""
    return [q for name, regime in scene.regimes.items() if regime.type == "steady" for q in _made(name, FIELDS)]
