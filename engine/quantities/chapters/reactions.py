"""Reactions in the pairs, forces on the frame, loads on the links, and checks of them."""

import math
from itertools import combinations

import numpy as np

from engine.cycle.measured import Measured, atan2
from engine.mechanism.mechanics import Mechanics
from engine.parts.actions import Brake
from engine.parts.motors import Motor
from engine.parts.skeleton import FRAME, CrankInput
from engine.quantities.chapters.dynamics import is_loaded
from engine.quantities.expressions import (
    Angle,
    Expression,
    Formula,
    UnloadedArc,
    hypot,
    maximum,
    peak,
    share,
    unresolved_peak,
)
from engine.quantities.register import Declared, Field, InputUnits, Summary, check_summary, drive_words, mean
from engine.scene.pairs import Pair, driving_field, has_friction, own_drives, pairs
from engine.scene.scene import Scene
from engine.words.quantity import Quantity, Rank


def declare(mechanics: Mechanics) -> Declared:
    """Fields of all pairs and of the frame, forces of the scene, and the checks of equilibrium."""
    m, unit = mechanics, InputUnits.of(mechanics.scene).moment
    for pair in pairs(m.scene):
        yield from _fields_of(m, pair)
        if pair.kind == "revolute":
            for link in (pair.link, pair.other):
                yield from _load_direction(m, pair, link)
    for field in tooth_force_fields(m.scene):
        yield Field.of(field, lambda name=field.name: m.reactions.variables[name])
    on_frame = "exerted by the machine on its frame, including the drive"
    yield _variable(m, "frame.reaction_x", f"x component of the force {on_frame}", "N")
    yield _variable(m, "frame.reaction_y", f"y component of the force {on_frame}", "N")
    yield _variable(m, "frame.reaction_moment", f"moment about the origin, {on_frame}", "N m")
    kept = drive_words(m.scene)
    with_friction = ", including friction in pairs" if has_friction(m.scene) else ""
    own = ", without the drives of second inputs" if own_drives(m.scene) else ""
    yield _detail(m, "input_moment_by_equilibrium", f"{kept}, by equilibrium of the input link{own}", unit)
    for name in m.scene.inputs:
        slides = name in m.kinematics.slides
        words = f"drive {'force' if slides else 'moment'} on {name}, by equilibrium"
        yield _variable(m, driving_field(m.scene, name), words, "N" if slides else "N m", "F" if slides else "M")
    words = f"{kept}, by virtual power of all forces{with_friction} (Zhukovsky's lever)"
    yield _detail(m, "input_moment_by_power", words, unit)
    for field in acting_fields(m.scene):
        yield Field.of(field, lambda name=field.name: m.reactions.variables[name])
    yield from _checks(m)


def _variable(m: Mechanics, name: str, words: str, unit: str, symbol: str = "", answers: tuple[str, ...] = ()) -> Field:
    return Field(name, words, unit, lambda: m.reactions.variables[name], symbol, answers)


def _detail(m: Mechanics, name: str, words: str, unit: str, symbol: str = "") -> Field:
    return _variable(m, name, words, unit, symbol)._replace(rank=Rank.FURTHER)


def _fields_of(m: Mechanics, pair: Pair) -> Declared:
    force = force_words(m.scene, pair)
    if pair.name in m.scene.shafts and m.scene.shafts[pair.name].pressure_angle is None:
        force += " (without tooth forces)"
    asked = ("peak",) if is_loaded(m) else ()
    yield _detail(m, f"{pair.name}.reaction_x", f"x component of the {force}", "N", "R_x")
    yield _detail(m, f"{pair.name}.reaction_y", f"y component of the {force}", "N", "R_y")
    if pair.kind == "prismatic":
        where = "about the slider's joint" if pair.name != "input" else "about the input's point"
        words = f"{force}, positive to the left of its direction"
        yield _variable(m, f"{pair.name}.reaction", words, "N", "R", asked)
        yield _detail(m, f"{pair.name}.reaction_moment", f"moment of the {force}, {where}", "N m")
        return
    yield _variable(m, f"{pair.name}.reaction", force, "N", "R", asked)
    words = f"direction of the {force}, continuous over the range"
    yield Field(
        f"{pair.name}.reaction_direction", words, "rad", lambda: Angle(m.reactions.force_in(pair.name), vanishes=True)
    )
    yield _detail(m, f"{pair.name}.reaction_along", f"component of the {force} along link {pair.link}", "N")
    words = f"component of the {force} across link {pair.link}, positive to its left"
    yield _detail(m, f"{pair.name}.reaction_across", words, "N")


def force_words(scene: Scene, pair: Pair) -> str:
    """The force in a pair in an engineer's terms: "crankpin force (joint A): crank on rod"."""
    acts = f"{pair.other} on {pair.link}"
    if pair.kind == "prismatic":
        held = pair.other == FRAME and bool(pair.guide)
        return f"side thrust of {pair.link} ({pair.place})" if held else f"force in {pair.place}: {acts}"
    return f"{_bearing(scene, pair)} force ({pair.place}): {acts}"


def _bearing(scene: Scene, pair: Pair) -> str:
    """Name of the bearing at a joint."""
    if isinstance(scene.input, CrankInput) and pair.name == "input":
        return "main-bearing"
    if isinstance(scene.input, CrankInput) and scene.input.link in (pair.link, pair.other):
        return "crankpin"
    group, _, side = pair.name.rpartition(".")
    if side == "inner" and group in scene.groups and scene.groups[group].type == "RRP":
        return "wrist-pin"
    return "bearing" if pair.other == FRAME else "pin"


def acting_fields(scene: Scene) -> list[Quantity]:
    """Forces and moments of a scene on its links, without the drive and the released brakes."""
    found = []
    for name in (*scene.forces, *scene.springs, *scene.cylinders):
        on = f" on point {scene.springs[name].between[1]}" if name in scene.springs else ""
        found += [Quantity(f"{name}.force_{axis}", f"{axis} component of the force {name}{on}", "N") for axis in "xy"]
    driving = (Brake, Motor)
    acting = {name: moment.on for name, moment in scene.moments.items() if not isinstance(moment, driving)}
    return found + [Quantity(f"{n}.acting_moment", f"moment {n} on link {on}", "N m") for n, on in acting.items()]


def tooth_force_fields(scene: Scene) -> list[Quantity]:
    """Tooth forces of shafts and non-circular wheels with a pressure angle, and of racks and pinions."""
    found = []

    def add(name: str, where: str, along: str, radial: str) -> None:
        normal = f"force {where} along the normal to their flanks, the reaction of this higher pair"
        found.append(Quantity(f"{name}.tangential_force", along, "N", symbol="F_t"))
        found.append(Quantity(f"{name}.radial_force", radial, "N", symbol="F_r"))
        found.append(Quantity(f"{name}.normal_force", normal, "N", symbol="F_n"))

    for name, shaft in scene.shafts.items():
        if shaft.pressure_angle is not None:
            where = f"between the teeth of {name} and its driver"
            along = f"tangential force {where}: the moment of the loads on {name} over its pitch radius"
            add(name, where, along, f"separating force {where}")
    for name, wheel in scene.noncircular_wheels.items():
        if wheel.pressure_angle is not None:
            where = f"between the teeth of {name} and of {wheel.geared_to}"
            along = f"force {where}, along the common tangent of their pitch curves"
            add(name, where, along, f"separating force {where}, along the normal of their pitch curves")
    for table, words in (("racks", "pinion"), ("pinions", "rack")):
        for name in getattr(scene, table):
            where = f"between the teeth of {name} and of its {words}"
            along = f"force {where} on {name}, along the rack in the direction of its guide"
            add(name, where, along, f"separating force {where}")
    return found


def _checks(m: Mechanics) -> Declared:
    torques = "the drive torques by equilibrium, virtual power and kinetic energy"
    words = f"maximum difference between {torques}, relative to their peak"
    yield check_summary("input_moment_disagreement", words, "1", lambda: _disagreement(m))
    whole, reactions = "the whole machine, inertia included", "the peak sum of the reactions' magnitudes"
    words = f"maximum force or moment out of balance on {whole}, relative to {reactions}"
    yield check_summary("equilibrium_residual", words, "1", lambda: _residual(m))


def _disagreement(m: Mechanics) -> Expression:
    found = m.reactions.variables
    energy = m.input_moment if m.scene.inertia_in_reactions else -m.moment_of()
    if has_friction(m.scene):
        energy = energy - found["friction_moment"]
    torques = (energy, m.reactions.moment_of_drives, found["input_moment_by_power"])
    difference = maximum(*(unresolved_peak(one - other) for one, other in combinations(torques, 2)))
    return share(difference, maximum(*(peak(torque) for torque in torques)))


def _residual(m: Mechanics) -> Expression:
    checks = m.reactions.checks
    force = share(unresolved_peak(checks["force"]), unresolved_peak(checks["forces"]))
    moment = share(unresolved_peak(checks["moment"]), unresolved_peak(checks["moments"]))
    return maximum(force, moment)


def _load_direction(m: Mechanics, pair: Pair, link: str) -> Declared:
    """Directions in which a bearing is loaded, in the axes of a link."""
    load = f"load on {link} in {pair.place} ({link} axes)"

    def means() -> tuple[Expression, Expression, Expression]:
        along, across = m.reactions.in_axes[pair.name, link]
        return mean(m, along), mean(m, across), mean(m, m.reactions.variables[f"{pair.name}.reaction"])

    def direction() -> Expression:
        x, y, _ = means()
        return Formula(_defined_direction, (x, y))

    def spread() -> Expression:
        x, y, whole = means()
        return 1.0 - hypot(x, y) / whole

    name, words = f"{pair.name}.load_direction_of_{link}", f"direction of the mean {load}"
    yield Summary(name, words, "rad", direction, may_be_undefined=True)
    words = f"spread of the {load}: 0 in one direction, 1 all around (1 less mean vector over mean magnitude)"
    yield Summary(f"{pair.name}.load_spread_of_{link}", words, "1", spread, may_be_undefined=True)

    def unloaded(which: str) -> Expression:
        force = m.reactions.in_axes[pair.name, link]
        return UnloadedArc(force, force.dot(force), which)

    words = f"widest unloaded arc of {link} in {pair.place} ({link} axes)"
    yield Summary(f"{pair.name}.unloaded_arc_of_{link}", words, "rad", lambda: unloaded("arc"))
    words = f"middle of the widest unloaded arc of {link} in {pair.place} ({link} axes)"
    name = f"{pair.name}.unloaded_middle_of_{link}"
    yield Summary(name, words, "rad", lambda: unloaded("middle"), may_be_undefined=True)


def _defined_direction(x: Measured, y: Measured) -> Measured:
    """Direction of a mean vector; undefined if the vector is smaller than its error."""
    angle, size = atan2(y, x), np.hypot(x.value, y.value)
    unknown = ~(size > np.hypot(x.error, y.error))
    return Measured(np.where(unknown, np.nan, angle.value), np.where(unknown, np.nan, np.minimum(angle.error, math.pi)))
