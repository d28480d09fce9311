"""Results available from a regime: names, descriptions and units."""

from typing import NamedTuple

import numpy as np

from engine.compiling.running import of_all
from engine.mechanism.mechanics import Mechanics
from engine.parts.bodies import OF_FLUCTUATION
from engine.parts.motors import InductionMotor, Motor
from engine.parts.regimes import Regime
from engine.parts.skeleton import CrankInput, SliderInput
from engine.quantities.chapters import inertia, reactions
from engine.quantities.register import Field
from engine.scene.attachments import sliders
from engine.scene.pairs import has_friction, own_drives
from engine.scene.scene import Scene
from engine.words.quantity import STATISTICS, Quantity, Rank, called

# Kinds of power, by the channel that supplies or absorbs it.
POWERS = ("driving_power", "useful_power", "harmful_power", "braking_power", "other_power")
EFFICIENCY_NOW = "instantaneous_efficiency"
WORKS = ("motor_work", "driving_work", "useful_work", "harmful_work", "brake_heat", "other_work")

# Summaries of every regime; `{name}` is the regime's.
COMMON = {
    "speed_min": ("minimum angular speed of the input link in {name}", "rad s-1"),
    "speed_max": ("maximum angular speed of the input link in {name}", "rad s-1"),
    "motor_moment_peak": ("peak motor torque in {name}, reduced to the input", "N m"),
    "motor_moment_rms": ("rms motor torque over time in {name}, reduced to the input", "N m"),
    "motor_power": ("mean power of the motors in {name}", "W"),
    "motor_work": ("work of the motors in {name}", "J"),
    "driving_work": ("work of the other driving actions in {name}", "J"),
    "useful_work": ("work against useful resistances in {name}", "J"),
    "harmful_work": ("work against harmful resistances in {name}", "J"),
    "brake_heat": ("heat in the brakes in {name}", "J"),
    "other_work": ("work of gravity, springs and all other actions in {name}", "J"),
    "energy_change": ("change of kinetic energy in {name}", "J"),
    "work_residual": (
        "sum of all works minus the change of kinetic energy in {name}, relative to the energy converted",
        "1",
    ),
    "efficiency": ("useful work over driving work in {name}", "1"),
    "implicit_steps": ("1 where a steep motor or coupling needed implicit steps in {name}, else 0", "1"),
}
STEADY = {
    "period": ("duration of a cycle in {name}", "s"),
    "mean_speed": ("mean angular speed over time of a cycle in {name}", "rad s-1"),
    "speed_fluctuation": (f"coefficient of speed fluctuation in {{name}}, {OF_FLUCTUATION}", "1"),
    "multiplier": ("factor by which a small disturbance of the energy grows from cycle to cycle in {name}", "1"),
    "return_residual": ("relative difference of the energy after a cycle in {name}", "1"),
}
# Torques at the shaft of a single driving motor; `{n}` is its name, `{motor}` the same in words.
AT_SHAFT = {
    f"{{n}}_shaft_torque_{key}": (f"{words} of {{motor}} in {{name}}, at its own shaft", "N m")
    for key, words in {"peak": "peak torque", "rms": "rms torque over time"}.items()
}
SLIP = {"{n}_slip": ("mean slip of {motor} in {name}", "1")}
FINAL_POSITION = "final_position"
# Summaries that check the others.
CHECKS = ("work_residual", "multiplier", "return_residual", "implicit_steps")
RUN = {
    "time": ("duration of {name}", "s"),
    "angle": ("angle turned in {name}", "rad"),
    "final_speed": ("angular speed of the input link at the end of {name}", "rad s-1"),
    FINAL_POSITION: ("position of the input at the end of {name}", "rad"),
}
OF_SLIDER = {f"{{slider}}.{FINAL_POSITION}": ("position of slider {slider} at the end of {name}", "m")}
# Summaries of a run with an input of limited range.
WITHIN_RANGE = {
    "end_reached": ("end of its range at which the input arrives in {name}: −1 the lower, 1 the upper, 0 none", "1"),
    "impact_energy": ("kinetic energy that the end of the range takes up in {name}", "J"),
}
# Names, descriptions and units for a sliding input that differ from a crank's.
SLIDING = {"angle": "displacement"}
SLIDING_WORDS = (("angular ", ""), ("angle turned", "displacement"), ("torque", "force"), ("moment", "force"))
SLIDING_UNITS = {"rad": "m", "rad s-1": "m s-1", "rad s-2": "m s-2", "N m": "N"}
# Summaries of a run with a coupling that is not open; `{coupling}` is its name, `{shaft}` that of its shaft.
COUPLED = {
    "{coupling}_heat": ("heat dissipated in {coupling} in {name}", "J"),
    "{coupling}_slip_angle": ("angle by which shaft {shaft} slipped in {name}", "rad"),
    "{coupling}_moment_peak": ("peak torque of {coupling} in {name}, at its shaft", "N m"),
}
CLUTCHED = {
    "{coupling}_slip_time": ("slip time of {coupling} in {name}", "s"),
    "{coupling}_lock_up_time": ("time of the last lock-up of {coupling} after the start of {name}", "s"),
    "{coupling}_lock_up_speed": ("angular speed of the input link at lock-up of {coupling} in {name}", "rad s-1"),
}
FLUID = {"{coupling}_slip": ("slip angle of shaft {shaft} over its angle turned in {name}", "1")}
# Summaries of a steady regime, in which a clutch does not slip.
_MOMENT = "{coupling}_moment_peak"
HELD = {_MOMENT: COUPLED[_MOMENT]}
MEAN_SPEED = {"{shaft}_mean_speed": ("mean angular speed of shaft {shaft} in {name}", "rad s-1")}
# Summaries of a run with a coupling, open or not.
AT_TWO_SPEEDS = {"{shaft}_final_speed": ("angular speed of shaft {shaft} at the end of {name}", "rad s-1")}
# Summaries that may be undefined: a coasting machine has no driving work, a clutch may never lock.
MAY_BE_UNDEFINED = ("efficiency", "{coupling}_lock_up_time", "{coupling}_lock_up_speed")
FIELDS = {
    "speed": ("angular speed of the input link in {name}", "rad s-1"),
    "acceleration": ("angular acceleration of the input link in {name}", "rad s-2"),
    "motor_moment": ("motor torque in {name}, reduced to the input", "N m"),
    "load_moment": ("torque of all loads in {name}, reduced to the input", "N m"),
    "input_moment": ("torque of motors and flywheel on the input link in {name}, at its true motion", "N m"),
    "kinetic_energy": ("kinetic energy of the whole machine in {name}", "J"),
    "motors_power": ("power of the motors in {name}, over time", "W"),
    "driving_power": ("power of the other driving actions in {name}, over time", "W"),
    "useful_power": ("power against useful resistances in {name}, over time", "W"),
    "harmful_power": ("power against harmful resistances in {name}, over time", "W"),
    "braking_power": ("power in the brakes in {name}, over time", "W"),
    "other_power": ("power of gravity, springs and all other actions in {name}, over time", "W"),
    EFFICIENCY_NOW: ("instantaneous efficiency in {name}: 1 minus the lost share of the supplied power", "1"),
}
# Of the position and the instant at which fields are stored, one is given and the other computed.
INSTANT, TURNED = "instant", "turned"
AXES = {
    INSTANT: ("time after the start of {name}", "s"),
    TURNED: ("angle turned after the start of {name}", "rad"),
}
AT_UNIFORM_SPEED = " at constant speed"
LOADS = (
    *(f"reaction{part}" for part in ("", "_x", "_y", "_along", "_across", "_moment")),
    *(f"driving_{part}" for part in ("moment", "force")),
    *(f"shaking_{part}" for part in ("force", "force_x", "force_y", "moment")),
)

# Statistics of fields of steady running, whose means are over time.
OVER_TIME = STATISTICS | {"mean": "time average of", "rms": "rms over time of"}
# Statistics of fields of runs: extremes, with their positions and instants.
EXTREMES = {key: words for key, words in STATISTICS.items() if key not in ("mean", "rms")} | {
    "min_time": "time (after the start) of the minimum",
    "max_time": "time (after the start) of the maximum",
}


class KeptAt(NamedTuple):
    """Where fields of a run are stored: the axis, and its values (instants,), times [s] or angles [rad]."""

    quantity: Quantity
    values: np.ndarray

    @property
    def over_time(self) -> bool:
        """Whether the values are times."""
        return self.quantity.name.endswith(f".{INSTANT}")


class FieldAnswers(NamedTuple):
    """Requested fields of a regime and their statistics, (variants,), by name without the regime's.

    Attributes
    ----------
    values : dict of str to ndarray
    missed : dict of str to ndarray
        Error estimates due to the behaviour between nodes.
    scales : dict of str to ndarray
        Magnitudes to which rounding is relative.
    rows : dict of str to ndarray (variants, instants or equal steps)
        Stored fields.
    """

    values: dict[str, np.ndarray]
    missed: dict[str, np.ndarray]
    scales: dict[str, np.ndarray]
    rows: dict[str, np.ndarray]

    @classmethod
    def none(cls) -> "FieldAnswers":
        """No fields."""
        return cls({}, {}, {}, {})

    def copied(self) -> "FieldAnswers":
        """The same in separate tables."""
        return FieldAnswers(*(dict(rows) for rows in self))

    def over_all(self, who: np.ndarray, count: int) -> "FieldAnswers":
        """Results of some variants expanded to all `count` of them, NaN for the others."""
        return FieldAnswers(*({key: of_all(row.T, who, count).T for key, row in rows.items()} for rows in self))


class Asked(NamedTuple):
    """A requested result of a regime: names of the regime and of the field (or summary), and a statistic or ""."""

    regime: str
    field: str
    statistic: str

    @classmethod
    def of(cls, name: str) -> "Asked":
        """Split a name into its parts."""
        regime, _, rest = name.partition(".")
        field, _, statistic = rest.rpartition(".")
        known = statistic in STATISTICS or statistic in EXTREMES
        return cls(regime, field, statistic) if field and known else cls(regime, rest, "")


def _made(scene: Scene, name: str, table: dict[str, tuple[str, str]], **parts: str) -> list[Quantity]:
    """Quantities of a regime from a table; `parts` are the names in its braces next to the regime's."""
    if isinstance(scene.input, SliderInput):
        table = {SLIDING.get(key, key): of_sliding(*row) for key, row in table.items()}
    return [
        Quantity(
            f"{name}.{key.format(**parts)}",
            words.format(name=name, **parts),
            unit,
            key in MAY_BE_UNDEFINED,
            rank=Rank.CHECK if key in CHECKS else Rank.FURTHER,
        )
        for key, (words, unit) in table.items()
    ]


def of_sliding(words: str, unit: str) -> tuple[str, str]:
    """Description and unit for a sliding input, from those for a crank."""
    for of_crank, of_slider in SLIDING_WORDS:
        words = words.replace(of_crank, of_slider)
    return words, SLIDING_UNITS.get(unit, unit)


def only_motor(scene: Scene, regime: Regime) -> list[str]:
    """The only motor that drives in a regime, whose torque at its own shaft is known; empty for several motors."""
    motors = [n for n, moment in scene.moments.items() if isinstance(moment, Motor) and n not in regime.off]
    return motors if len(motors) == 1 else []


def motion_summaries(scene: Scene) -> list[Quantity]:
    """Summaries of the regimes of a scene."""
    found: list[Quantity] = []
    for name, regime in scene.regimes.items():
        limited = {} if scene.has_cycle else WITHIN_RANGE
        if own_drives(scene):
            # At an impact other drives give energy, too.
            limited = {key: row for key, row in limited.items() if key != "impact_energy"}
        found += _made(scene, name, COMMON | (STEADY if regime.type == "steady" else RUN | limited))
        # Drives of their own move sliders over time, too.
        for slider in () if regime.type == "steady" or own_drives(scene) else sliders(scene):
            found += _made(scene, name, OF_SLIDER, slider=slider)
        found += _of_couplings(scene, name)
        for n in only_motor(scene, regime):
            found += _made(scene, name, AT_SHAFT, n=n, motor=called("motor", n))
        if regime.type == "steady":
            for n, motor in scene.moments.items():
                if isinstance(motor, InductionMotor) and n not in regime.off:
                    found += _made(scene, name, SLIP, n=n, motor=called("motor", n))
            sized = scene.flywheel is not None and scene.flywheel.speed_fluctuation is not None
            if sized and not _at_two_speeds(scene, regime):
                words = (
                    f"flywheel inertia for the required speed fluctuation in the actual motion of {name}, whose other "
                    "results include it"
                )
                found.append(Quantity(f"{name}.flywheel", words, "kg m2"))
    return found


def sized_regimes(scene: Scene) -> list[str]:
    """Steady regimes with the flywheel for the required speed fluctuation, as the scene gives none."""
    flywheel = scene.flywheel
    if flywheel is None or flywheel.inertia is not None or flywheel.speed_fluctuation is None:
        return []
    steady = {name: regime for name, regime in scene.regimes.items() if regime.type == "steady"}
    return [name for name, regime in steady.items() if not _at_two_speeds(scene, regime)]


def _at_two_speeds(scene: Scene, regime: Regime) -> bool:
    """Whether both sides of a coupling have separate speeds: in runs, and through a fluid coupling."""
    fluid = any(coupling.type == "fluid_coupling" for coupling in scene.couplings.values())
    return fluid or (regime.type == "run" and bool(scene.couplings))


def _of_couplings(scene: Scene, name: str) -> list[Quantity]:
    """Summaries of a run with a coupling."""
    found, regime = [], scene.regimes[name]
    for coupling, model in scene.couplings.items():
        table = AT_TWO_SPEEDS if regime.type == "run" else HELD
        if regime.type == "steady" and model.type == "fluid_coupling":
            table = COUPLED | FLUID | MEAN_SPEED
        if regime.type == "run" and coupling not in regime.off:
            table = COUPLED | (CLUTCHED if model.type == "friction_clutch" else FLUID) | table
        found += _made(scene, name, table, coupling=coupling, shaft=model.shaft)
    return found


def motion_fields(mechanics: Mechanics, kind: str = "steady") -> list[Quantity]:
    """Fields of the regimes of one kind, "steady" or "run", of a scene."""
    of_kind = [name for name, regime in mechanics.scene.regimes.items() if regime.type == kind]
    found, loads = [], load_fields(mechanics) if of_kind else {}
    instant = {INSTANT: ("time since the crank angle 0 in {name}", "s")} if kind == "steady" else {}
    for name in of_kind:
        found += _made(mechanics.scene, name, FIELDS | instant)
        found += [Quantity(f"{name}.{key}", words.format(name=name), unit) for key, (words, unit) in loads.items()]
    return found


def kept_at_of(scene: Scene) -> dict[str, KeptAt]:
    """Where the fields of runs are stored, by the names of the runs that specify it."""
    found = {}
    for name, regime in scene.regimes.items():
        at = regime.at if regime.type == "run" else None
        if at is not None:
            axis = INSTANT if at.times is not None else TURNED
            words, unit = AXES[axis]
            values = at.times if at.times is not None else at.angles
            found[name] = KeptAt(Quantity(f"{name}.{axis}", words.format(name=name), unit), np.array(values, float))
    return found


def kept_fields(mechanics: Mechanics) -> list[Quantity]:
    """Fields stored for the runs of a scene, each at its instants or angles."""
    if mechanics.scene.couplings:
        return []
    axes = {f"{name}.": at.quantity.name for name, at in kept_at_of(mechanics.scene).items()}
    found = [q for q in motion_fields(mechanics, "run") if q.name.startswith(tuple(axes))]
    for prefix, axis in axes.items():
        found += [q for q in _made(mechanics.scene, prefix[:-1], AXES) if q.name != axis]
    return found


def load_fields(mechanics: Mechanics) -> dict[str, tuple[str, str]]:
    """Descriptions and units of the loads on pairs and frame, for the actual motion of a regime, by name."""
    declared = [q for part in (reactions, inertia) for q in part.declare(mechanics) if isinstance(q, Field)]
    found = {q.name: q for q in declared if q.name.rpartition(".")[2] in LOADS}
    table = {key: (q.long_name.replace(AT_UNIFORM_SPEED, ""), q.units) for key, q in found.items()}
    moment, unit = ("moment", "N m") if isinstance(mechanics.scene.input, CrankInput) else ("force", "N")
    words = f"input {moment} by equilibrium of the input link, without flywheel"
    table["input_moment_by_equilibrium"] = (words, unit)
    if has_friction(mechanics.scene):
        table["friction_moment"] = (f"{moment} on the input equivalent to friction in pairs", unit)
    return {key: (f"{words} in {{name}}, at its true motion", unit) for key, (words, unit) in table.items()}


def statistics_of(field: Quantity, table: dict[str, str], q: str) -> list[Quantity]:
    """Statistics of a field of a regime, with positions in the unit `q` of the input.

    Parameters
    ----------
    field : Quantity
    table : dict of str to str
        OVER_TIME in steady running, EXTREMES in a run.
    q : str
    """
    units = {"_at": q, "_time": "s"}
    return [
        Quantity(
            f"{field.name}.{suffix}",
            f"{words} {field.long_name}",
            next((unit for end, unit in units.items() if suffix.endswith(end)), field.units),
        )
        for suffix, words in table.items()
    ]
