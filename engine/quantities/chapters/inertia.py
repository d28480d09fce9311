"""Inertia forces of bodies, the masses that replace bodies, and shaking forces on the frame."""

from functools import partial

import numpy as np

from engine import laws
from engine.cycle.measured import Measured, where
from engine.mechanism.inertia import inertia_forces, moment_centre
from engine.mechanism.input_motion import multiple_angle
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import Expression, Formula, Integral, VariantNumber, hypot
from engine.quantities.register import Declared, Field, Summary, detail
from engine.scene.masses import CENTRE, body_inertia, count_points, inertia_from_swing, replacement, replacement_mass
from engine.scene.scene import scene_numbers
from engine.words.quantity import called, ordinal

ORDERS = (1, 2, 4)


def declare(mechanics: Mechanics) -> Declared:
    """Inertia forces body by body, replacement masses, and the shaking force with its orders."""
    for name in mechanics.scene.bodies:
        yield from _forces(mechanics, name)
        if mechanics.scene.bodies[name].swing is not None:
            words = f"moment of inertia of {called('body', name)} about its mass centre, from the period of its swing"
            yield Summary(f"{name}.moment_of_inertia", words, "kg m2", lambda name=name: _swung(mechanics, name))
        yield from _replacement(mechanics, name)
    yield from _shaking(mechanics)


def _forces(m: Mechanics, name: str) -> Declared:
    at, forces = "at constant speed", f"inertia forces of {called('body', name)}"
    found = partial(inertia_forces, m.kinematics, name)
    for i, axis in enumerate("xy"):
        words = f"{axis} component of the inertia force of {called('body', name)} {at}"
        yield detail(f"{name}.inertia_force_{axis}", words, "N", lambda i=i: found().force[i])
    words = f"moment of the {forces} about its centre {at}"
    yield detail(f"{name}.inertia_moment", words, "N m", lambda: found().moment)
    words = f"distance of the resultant of the {forces} from its mass centre (positive: passes to its right)"
    yield detail(f"{name}.inertia_offset", words, "m", lambda: found().offset)


def _swung(m: Mechanics, name: str) -> Expression:
    """Moment of inertia from a swing; the error estimate includes the cancellation in mgh T²/4π² − mh²."""
    own = (f"bodies.{name}.mass", f"bodies.{name}.swing.")
    paths = [path for path in scene_numbers(m.scene) if path.startswith(own)]

    def inertia(*numbers: Measured) -> Measured:
        found = inertia_from_swing(m.scene, name, dict(zip(paths, numbers, strict=True)))
        return where(found.value < 0.0, Measured(np.nan), found)

    return Formula(inertia, tuple(VariantNumber(m.graph.number(path)) for path in paths))


def _replacement(m: Mechanics, name: str) -> Declared:
    """Masses and positions of the points that replace a body, and their error in its moment of inertia."""
    body, graph, count = m.scene.bodies[name], m.graph, count_points(m.scene, name)
    for i in range(count):
        chosen = body.replace.at[i : i + 1]
        place = ("the mass centre" if chosen == (CENTRE,) else chosen[0]) if chosen else "the computed point"
        whose = f"mass {i + 1} (at {place}) that replaces {called('body', name)}"
        part = replacement_mass(m.scene, name, i)
        for key, words, unit, compute in (
            ("mass", f"point {whose}, may be negative", "kg", part.mass),
            ("x", f"x coordinate on the link of {whose}", "m", part.along),
            ("y", f"y coordinate on the link of {whose}", "m", part.across),
        ):
            number = graph.derived(f"replacement {key} {i + 1} of {name}", compute)
            yield Summary(f"{name}.replacement_{key}_{i + 1}", words, unit, lambda number=number: VariantNumber(number))
    if count:
        error_of = laws.masses.replacement_masses.inertia_error
        error = graph.derived(
            f"replacement error of {name}",
            lambda n: error_of(replacement(m.scene, name, n), body_inertia(m.scene, name, n)),
        )
        words = f"moment of inertia of the point masses that replace {called('body', name)}, minus its own"
        yield Summary(f"{name}.replacement_error", words, "kg m2", lambda: VariantNumber(error))


def _shaking(m: Mechanics) -> Declared:
    force, about = "shaking force at constant speed", moment_centre(m.scene)
    for i, axis in enumerate("xy"):
        words = f"{axis} component of the {force}"
        yield detail(f"shaking_force_{axis}", words, "N", lambda i=i: m.shaking.force[i], f"F_{axis}")
    yield Field("shaking_force", force, "N", lambda: m.shaking.force.length, "F")
    words = f"shaking moment about {about} at constant speed, including shafts and gears, excluding loads"
    yield Field("shaking_moment", words, "N m", lambda: m.shaking.moment)
    for n in ORDERS if m.has_cycle else ():
        words = f"{ordinal(n)}-order shaking force, major semi-axis of its ellipse"
        yield Summary(f"shaking_force.order_{n}", words, "N", lambda n=n: order_of_force(m, n))


def order_of_force(m: Mechanics, n: int) -> Expression:
    """Major semi-axis of the ellipse described by order n of the shaking force.

    With the complex force z = F_x + i F_y, order n is c₊ e^{inφ} + c₋ e^{−inφ}, c± = 1/T ∫ z e^{∓inφ} dφ; the semi-axes
    are ||c₊| ± |c₋||.
    """
    cosine, sine = multiple_angle(m.graph, n)
    x, y = m.shaking.force
    xc, xs, yc, ys = (Integral(part * turn) for part in (x, y) for turn in (cosine, sine))
    length = VariantNumber(m.last - m.first)
    forward = hypot(xc + ys, yc - xs)
    backward = hypot(xc - ys, yc + xs)
    return (forward + backward) / length
