"""What may be asked of the shaking force and the shaking moment: sums of inertia forces, linear in the masses."""

from collections.abc import Mapping
from typing import Literal

import numpy as np

from engine.equal_positions.text.program import Program
from engine.machine.mechanism import Mechanism
from engine.machine.quantities.quantities import Quantity, has_cycle
from engine.scene.parts import CrankInput
from engine.scene.scene import Numbers, Scene

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


def shaking_terms(
    scene: Scene, mechanism: Mechanism, program: Program, by: Literal["square", "epsilon"] = "square"
) -> Terms:
    """Write the shaking force and moment into a program.

    Parameters
    ----------
    scene : Scene
    mechanism : Mechanism
    program : Program
    by : {"square", "epsilon"}
        Those of accelerations ω² r″, at the input's uniform speed; or of r′, which ε multiplies where the speed isn't
        uniform: the latter are right at unit speed.

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
        rate, turning = ((centre.ax, centre.ay), link.e) if by == "square" else ((centre.vx, centre.vy), link.w)

        def push(n: Numbers, name: str = name) -> float | np.ndarray:
            return -m.masses[name].mass(n) * n["input.speed"] ** 2

        def twist(n: Numbers, name: str = name) -> float | np.ndarray:
            return -m.masses[name].inertia(n) * n["input.speed"] ** 2

        if rate != ("zero", "zero"):
            slot = p.derived(f"bodies.{name}.inertia_force", push, "load")
            p.about(f"shaking moment of {name}", "acceleration")
            arm = p.fresh_pair(f"{centre.x} - {about.x}, {centre.y} - {about.y}")
            force_x.append((slot, rate[0]))
            force_y.append((slot, rate[1]))
            moment.append((slot, p.fresh(f"moment_of({arm[0]}, {arm[1]}, {rate[0]}, {rate[1]})")))
        if part.inertia is not None and turning is not None:
            moment.append((p.derived(f"bodies.{name}.inertia_moment", twist, "load"), turning))
    rates = {name: m.links[name].e if by == "square" else m.links[name].w for name in scene.shafts}
    moment += _of_shafts({name: rate for name, rate in rates.items() if rate is not None}, p)
    return {"shaking_force_x": tuple(force_x), "shaking_force_y": tuple(force_y), "shaking_moment": tuple(moment)}


def _of_shafts(turning: Mapping[str, str], program: Program) -> list[tuple[str, str]]:
    """Inertia moments of shafts by what they turn with, each with its own sense of rotation."""
    found = []
    for name, rate in turning.items():

        def twist(n: Numbers, name: str = name) -> float | np.ndarray:
            return -n[f"shafts.{name}.inertia"] * n["input.speed"] ** 2

        found.append((program.derived(f"shafts.{name}.inertia_moment", twist, "load"), rate))
    return found
