"""What may be asked of the reactions in the pairs and of the forces that load the links."""

from engine.machine.quantities.quantities import InputUnits, Quantity, has_cycle
from engine.scene.actions import Brake, DCMotor, InductionMotor
from engine.scene.pairs import Pair, pairs
from engine.scene.scene import Scene


def reaction_fields(scene: Scene) -> list[Quantity]:
    """Reactions in all pairs, on the frame, and the input moment found from them."""
    found = [quantity for pair in pairs(scene) for quantity in _fields_of(scene, pair)]
    on_frame = "of all that the machine does to its frame, drive included"
    found += [
        Quantity("frame.reaction_x", f"x component of the force {on_frame}", "N"),
        Quantity("frame.reaction_y", f"y component of the force {on_frame}", "N"),
        Quantity("frame.reaction_moment", f"moment about the origin {on_frame}", "N m"),
    ]
    unit = InputUnits.of(scene).moment
    kept = "input moment that keeps the speed uniform"
    rubbing = ", friction in pairs among them" if scene.friction else ""
    found += [
        Quantity("input_moment_by_equilibrium", f"{kept}, by equilibrium of the input link", unit),
        Quantity("input_moment_by_power", f"{kept}, by virtual power of all forces{rubbing} (Zhukovsky's lever)", unit),
    ]
    return [*found, *_friction_fields(scene, unit)]


def friction_in_pairs(scene: Scene) -> dict[str, str]:
    """Field of the friction in each pair that has it: a moment or a force on the pair's link."""
    kinds = {pair.name: "moment" if pair.kind == "revolute" else "force" for pair in pairs(scene)}
    return {friction.pair: f"{friction.pair}.friction_{kinds[friction.pair]}" for friction in scene.friction.values()}


def _friction_fields(scene: Scene, unit: str) -> list[Quantity]:
    """Friction in the pairs that have it, and what it comes to at the input."""
    found, known = [], {pair.name: pair for pair in pairs(scene)}
    for friction in scene.friction.values():
        pair = known[friction.pair]
        where = f"in {pair.place}, pair {pair.name}"
        if pair.kind == "revolute":
            found.append(Quantity(f"{pair.name}.friction_moment", f"moment of friction on {pair.link} {where}", "N m"))
        else:
            along = f"friction on {pair.link} along its own direction {where}"
            found.append(Quantity(f"{pair.name}.friction_force", along, "N"))
        found.append(Quantity(f"{pair.name}.friction_power", f"power lost to friction {where}", "W"))
    if scene.friction:
        kept = "input moment at uniform speed with friction in pairs"
        found += [
            Quantity("friction_moment", "reduced moment of the friction in all pairs", unit),
            Quantity("input_moment_with_friction", kept, unit),
        ]
    return found


def friction_summaries(scene: Scene) -> list[Quantity]:
    """What friction in the pairs costs, and how its passes went."""
    if not scene.friction:
        return []
    span = "over the cycle" if has_cycle(scene) else "over the input's range"
    known = {pair.name: pair for pair in pairs(scene)}
    found = [
        Quantity("friction_passes", "passes until friction in all pairs had settled, of the slowest group", "1"),
        Quantity("friction_residual", "greatest relative change of a pressing force in the last pass", "1"),
        Quantity("jamming_margin", "least determinant of friction's feedback: 1 without friction, 0 on jamming", "1"),
        Quantity("friction_loss", f"work lost to friction in all pairs {span}", "J"),
        *(
            Quantity(f"{f.pair}.friction_work", f"work lost to friction in {known[f.pair].place}, {span}", "J")
            for f in scene.friction.values()
        ),
    ]
    if has_cycle(scene):
        of = "useful work and work given at the input, over driving work and work taken there, over the cycle"
        found.append(Quantity("mechanical_efficiency", f"mechanical efficiency: {of}", "1"))
    return found


def acting_fields(scene: Scene) -> list[Quantity]:
    """Forces and moments of the scene as they act on its links; the drive and released brakes are none of them."""
    found = []
    for name in (*scene.forces, *scene.springs, *scene.cylinders):
        on = f" on point {scene.springs[name].between[1]}" if name in scene.springs else ""
        found += [Quantity(f"{name}.force_{axis}", f"{axis} component of the force {name}{on}", "N") for axis in "xy"]
    apart = (Brake, DCMotor, InductionMotor)
    acting = {name: moment.on for name, moment in scene.moments.items() if not isinstance(moment, apart)}
    return found + [Quantity(f"{n}.acting_moment", f"moment {n} on link {on}", "N m") for n, on in acting.items()]


def _fields_of(scene: Scene, pair: Pair) -> list[Quantity]:
    other = pair.other if pair.other == "frame" else f"link {pair.other}"
    force = f"force on link {pair.link} from {other} in {pair.place}"
    if pair.name in scene.shafts:
        force += " (without forces between teeth)"
    found = [
        Quantity(f"{pair.name}.reaction_x", f"x component of the {force}", "N"),
        Quantity(f"{pair.name}.reaction_y", f"y component of the {force}", "N"),
    ]
    if pair.kind == "prismatic":
        where = "about the slider's joint" if pair.name != "input" else "about the input's point"
        return [
            *found,
            Quantity(f"{pair.name}.reaction", f"{force}, positive to the left of its direction", "N"),
            Quantity(f"{pair.name}.reaction_moment", f"moment of the {force}, {where}", "N m"),
        ]
    return [
        *found,
        Quantity(f"{pair.name}.reaction", force, "N"),
        Quantity(f"{pair.name}.reaction_direction", f"direction of the {force}, continuous over the range", "rad"),
        Quantity(f"{pair.name}.reaction_along", f"component along link {pair.link} of the {force}", "N"),
        Quantity(f"{pair.name}.reaction_across", f"component to the left across link {pair.link} of the {force}", "N"),
    ]


def direction_summaries(scene: Scene) -> list[Quantity]:
    """Where the bearings are loaded, in the axes of both of their links."""
    found = []
    for pair in pairs(scene):
        for link in (pair.link, pair.other) if pair.kind == "revolute" else ():
            load = f"load on {link} in {pair.place}, in its own axes"
            found += [
                Quantity(f"{pair.name}.load_direction_of_{link}", f"direction of the mean {load}", "rad"),
                Quantity(
                    f"{pair.name}.load_spread_of_{link}",
                    f"spread of the {load}: 0 in one direction, 1 all around (1 less mean vector over mean magnitude)",
                    "1",
                ),
                Quantity(f"{pair.name}.unloaded_arc_of_{link}", f"widest arc never pointed to by the {load}", "rad"),
                Quantity(
                    f"{pair.name}.unloaded_middle_of_{link}", f"middle of the arc never pointed to by the {load}", "rad"
                ),
            ]
    return found


def reaction_summaries() -> list[Quantity]:
    """Checks of the reactions."""
    return [
        Quantity(
            "input_moment_disagreement",
            "greatest difference between the input moment by equilibrium, by virtual power and by change of kinetic "
            "energy, relative to its greatest magnitude",
            "1",
        ),
        Quantity(
            "equilibrium_residual",
            "greatest force or moment left without balance on the whole machine, inertia included, relative to the "
            "reactions at their greatest, their magnitudes summed",
            "1",
        ),
    ]
