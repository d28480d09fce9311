"""What may be asked of the shaking force and the shaking moment: sums of inertia forces, linear in the masses."""

import numpy as np

from engine.mechanism import Mechanism
from engine.parts import CrankInput
from engine.program import Program
from engine.quantities import Quantity, has_cycle
from engine.scene import Numbers, Scene

ORDERS = (1, 2, 4)

Terms = dict[str, tuple[tuple[str, str], ...]]


def moment_centre(scene: Scene) -> str:
    """The point or guide of the frame about which the shaking moment is taken."""
    if scene.balance is not None:
        return scene.balance.about
    return scene.input.pivot if isinstance(scene.input, CrankInput) else scene.input.guide


def shaking_fields(scene: Scene) -> list[Quantity]:
    """Shaking force and moment at the input's uniform speed: inertia forces alone, without loads and drive."""
    force, about = "shaking force at uniform speed of the input", moment_centre(scene)
    return [
        Quantity("shaking_force_x", f"x component of the {force}", "N"),
        Quantity("shaking_force_y", f"y component of the {force}", "N"),
        Quantity("shaking_force", f"magnitude of the {force}", "N"),
        Quantity(
            "shaking_moment",
            f"shaking moment about {about} at uniform speed of the input, inertia of shafts and gears in it, loads not",
            "N m",
        ),
    ]


def shaking_summaries(scene: Scene) -> list[Quantity]:
    """Orders of the shaking force, where there is a cycle to take them of."""
    orders = ORDERS if has_cycle(scene) else ()
    what = "of the shaking force by the crank's speed, longer half axis of its ellipse"
    return [Quantity(f"shaking_force.order_{n}", f"order {n} {what}", "N") for n in orders]


def shaking_terms(scene: Scene, mechanism: Mechanism, program: Program) -> Terms:
    """Write the shaking force and moment into a program.

    Parameters
    ----------
    scene : Scene
    mechanism : Mechanism
    program : Program

    Returns
    -------
    dict of str to tuple of (coefficient, basis)
        Load slots and variables whose products add up to each field.
    """
    p, m = program, mechanism
    force_x, force_y, moment = [], [], []
    about = m.points.get(moment_centre(scene)) or m.guides[moment_centre(scene)]
    for name, part in m.masses.items():
        centre, link = m.centre(name), m.links[part.link]

        def push(n: Numbers, name: str = name) -> float | np.ndarray:
            return -m.masses[name].mass(n) * n["input.speed"] ** 2

        def twist(n: Numbers, name: str = name) -> float | np.ndarray:
            return -m.masses[name].inertia(n) * n["input.speed"] ** 2

        if (centre.ax, centre.ay) != ("zero", "zero"):
            slot = p.derived(f"bodies.{name}.inertia_force", push, "load")
            p.about(f"shaking moment of {name}", "acceleration")
            arm = p.fresh_pair(f"{centre.x} - {about.x}, {centre.y} - {about.y}")
            force_x.append((slot, centre.ax))
            force_y.append((slot, centre.ay))
            moment.append((slot, p.fresh(f"moment_of({arm[0]}, {arm[1]}, {centre.ax}, {centre.ay})")))
        if part.inertia is not None and link.e is not None:
            moment.append((p.derived(f"bodies.{name}.inertia_moment", twist, "load"), link.e))
    moment += _of_shafts(scene, m, p)
    return {"shaking_force_x": tuple(force_x), "shaking_force_y": tuple(force_y), "shaking_moment": tuple(moment)}


def _of_shafts(scene: Scene, mechanism: Mechanism, program: Program) -> list[tuple[str, str]]:
    """Inertia moments of shafts that don't turn uniformly, each with its own sense of rotation."""
    found = []
    for name in scene.shafts:
        epsilon = mechanism.links[name].e
        if epsilon is not None:

            def twist(n: Numbers, name: str = name) -> float | np.ndarray:
                return -n[f"shafts.{name}.inertia"] * n["input.speed"] ** 2

            found.append((program.derived(f"shafts.{name}.inertia_moment", twist, "load"), epsilon))
    return found
