"""What may be asked of the inertia of bodies: their inertia forces, and the point masses that stand for them."""

from typing import NamedTuple

from engine.equal_positions.text.program import Program
from engine.laws.replacement_masses import Value, inertia_error
from engine.machine.mechanism import Mechanism
from engine.machine.quantities.quantities import Quantity
from engine.scene.inertia import body_inertia, body_mass
from engine.scene.masses import CENTRE, count_points, point_name, replacement
from engine.scene.scene import Numbers, Scene


def inertia_fields(scene: Scene) -> list[Quantity]:
    """Inertia forces of every body at the input's uniform speed."""
    found = []
    for name in scene.bodies:
        at = "at uniform speed of the input"
        found += [
            Quantity(f"{name}.inertia_force_{axis}", f"{axis} component of the inertia force of body {name} {at}", "N")
            for axis in ("x", "y")
        ]
        found += [
            Quantity(
                f"{name}.inertia_moment", f"moment of the inertia forces of body {name} about its centre {at}", "N m"
            ),
            Quantity(
                f"{name}.inertia_offset",
                f"distance of the resultant of the inertia forces of body {name} from its centre of mass "
                "(positive: passes to the right of it)",
                "m",
            ),
        ]
    return found


class InertiaForces(NamedTuple):
    """Where the inertia forces of bodies are found in a program.

    Attributes
    ----------
    sums : dict of str to (coefficient, basis)
        Fields that are a load slot times a variable.
    variables : dict of str to str
        Fields that are a variable.
    """

    sums: dict[str, tuple[str, str]]
    variables: dict[str, str]


def inertia_of(scene: Scene, name: str, numbers: Numbers) -> Value:
    """Moment of inertia about a body's centre of mass that is computed with: its own, or that of its point masses."""
    if scene.bodies[name].replace is None:
        return body_inertia(scene, name, numbers)
    return replacement(scene, name, numbers).inertia()


def write_inertia_forces(scene: Scene, mechanism: Mechanism, program: Program) -> InertiaForces:
    """Write the inertia forces of all bodies into a program.

    Parameters
    ----------
    scene : Scene
    mechanism : Mechanism
    program : Program
    """
    p, found = program, InertiaForces({}, {})
    for name, body in scene.bodies.items():
        at, centre, e = f"bodies.{name}", mechanism.body_centre(name), mechanism.links[body.link].e or "zero"

        def force(n: Numbers, name: str = name) -> Value:
            return -body_mass(scene, name, n) * n["input.speed"] ** 2

        def moment(n: Numbers, name: str = name) -> Value:
            return -inertia_of(scene, name, n) * n["input.speed"] ** 2

        def gyration2(n: Numbers, name: str = name) -> Value:
            return inertia_of(scene, name, n) / body_mass(scene, name, n)

        slot = p.derived(f"{at}.inertia_force", force, "load")
        found.sums[f"{name}.inertia_force_x"] = (slot, centre.ax)
        found.sums[f"{name}.inertia_force_y"] = (slot, centre.ay)
        found.sums[f"{name}.inertia_moment"] = (p.derived(f"{at}.inertia_moment", moment, "load"), e)
        p.about(f"inertia forces of {name}", "acceleration")
        offset = f"inertia_offset({p.derived(f'{at}.gyration2', gyration2)}, {centre.ax}, {centre.ay}, {e})"
        found.variables[f"{name}.inertia_offset"] = p.let(f"__{name}_offset", offset)
    return found


def replacement_summaries(scene: Scene) -> list[Quantity]:
    """Masses and places of the points that stand for bodies, and what they miss of the moment of inertia."""
    found = []
    for name, body in scene.bodies.items():
        for i in range(count_points(scene, name)):
            chosen = body.replace.at[i : i + 1]
            place = ("the centre of mass" if chosen == (CENTRE,) else chosen[0]) if chosen else "the point found"
            whose = f"mass {i + 1} (at {place}) that stands for body {name}"
            found.append(Quantity(f"{name}.replacement_mass_{i + 1}", f"point {whose}, may be negative", "kg"))
            found += [
                Quantity(f"{name}.replacement_{axis}_{i + 1}", f"{axis} coordinate on the link of {whose}", "m")
                for axis in ("x", "y")
            ]
        if body.replace is not None:
            words = f"moment of inertia of the point masses that stand for body {name}, less its own"
            found.append(Quantity(f"{name}.replacement_error", words, "kg m2"))
    return found


def replacement_slots(scene: Scene, mechanism: Mechanism, program: Program) -> dict[str, str]:
    """Slots of the program that hold the replacement summaries, by their names."""
    found = {}
    for name in scene.bodies:
        count = count_points(scene, name)
        for i in range(count):
            label = point_name(name, i)
            part = mechanism.masses[label]
            found[f"{name}.replacement_mass_{i + 1}"] = program.derived(f"bodies.{label}.mass_of", part.mass, "load")
            for axis, compute, word in (("x", part.along, "along"), ("y", part.across, "across")):
                found[f"{name}.replacement_{axis}_{i + 1}"] = program.derived(f"bodies.{label}.{word}", compute)
        if count:

            def error(n: Numbers, name: str = name) -> Value:
                return inertia_error(replacement(scene, name, n), body_inertia(scene, name, n))

            found[f"{name}.replacement_error"] = program.derived(f"bodies.{name}.replacement_error", error, "load")
    return found
