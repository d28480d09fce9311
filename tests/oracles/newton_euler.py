"""Reactions by Newton and Euler: the equations of motion of all links at once, solved densely.

For every link Σ F = m a_S and Σ M = Σ r × m a_S + J α about the frame's origin, with the motion of the oracle and
every pair's reactions as unknowns; nothing is ordered by groups, and no inertia force appears. Each gear is one more
unknown, its moment on the shaft; the drive is one more, the moment or force on the input link.
"""

from typing import NamedTuple

import numpy as np
from oracle import REAL, Motion, Pose, solved
from oracle_dynamics import _pump_force, body_of, force_at, moment_on, pull_of

from engine import FRAME, CrankInput, Scene, Sliding, Yoke


class Unknown(NamedTuple):
    """A unit force at a place (x, y), or a unit couple, on links with a sign or factor each."""

    name: str
    on: dict[str, float | np.ndarray]
    place: tuple | None = None
    direction: tuple = (0, 0)


class Balance:
    """Forces, moments about the frame's origin, and what they come from, by link."""

    def __init__(self, links: list[str], positions: int) -> None:
        self.of = {name: np.zeros((3, positions), REAL) for name in links}

    def push(self, link: str, place: tuple, fx: np.ndarray, fy: np.ndarray, sign: float = 1.0) -> None:
        x, y = place
        self.of[link] += sign * np.stack([fx + 0 * x, fy + 0 * x, x * fy - y * fx])

    def twist(self, link: str, moment: np.ndarray) -> None:
        self.of[link][2] += moment


def holder(scene: Scene, point: str) -> str:
    """Link on which a force in a point acts; in an inner joint of RRP the slider, of others the first link."""
    if point in scene.points:
        return scene.points[point].link
    for g in scene.groups.values():
        if getattr(g, "inner", None) == point:
            return g.second.link if isinstance(g.second, Sliding) and g.type == "RRP" else g.first.link
    return scene.input.link


def _bearer(scene: Scene, slider: str) -> str:
    for g in scene.groups.values():
        if slider == g.first.link and g.type in ("RPR", "RPP"):
            return g.second.link
        for side in (g.first, g.second):
            if side.link == slider:
                return scene.guides[side.guide].link
    return FRAME


def _at(motion: Motion, point: str) -> tuple:
    return tuple(part.v + 0 * motion.q for part in motion.points[point])


def external(motion: Motion, speed: float | np.ndarray | None = None) -> tuple[Balance, Balance]:
    """Given forces on every link, and of those the ones whose counterpart the frame or another link doesn't bear.

    `speed` is the input's, its uniform one when not given.
    """
    scene, speed = motion.scene, motion.scene.input.speed if speed is None else speed
    inside, outside = (Balance(list(motion.links), motion.q.size) for _ in range(2))
    for body in scene.bodies.values():
        mass, x, y, _ = body_of(body)
        place = tuple(part.v for part in motion.links[body.link].point(x, y))
        outside.push(body.link, place, 0 * motion.q, 0 * motion.q - mass * scene.gravity)
    for force in scene.forces.values():
        outside.push(holder(scene, force.on), _at(motion, force.on), *force_at(force, motion, speed))
    for moment in scene.moments.values():
        value = moment_on(moment, motion, speed)
        (inside if moment.type == "torsion_spring" else outside).twist(moment.on, value)
        if moment.type == "torsion_spring":
            inside.twist(FRAME, -value)
    for spring in scene.springs.values():
        for end, sign in zip(spring.between, (1, -1), strict=True):
            inside.push(holder(scene, end), _at(motion, end), *pull_of(spring, motion, speed), sign)
    for cylinder in scene.cylinders.values():
        slider = motion.links[cylinder.piston]
        value = _pump_force(cylinder, speed * motion.slides[cylinder.piston].d)
        place = (slider.x.v, slider.y.v)
        for link, sign in ((cylinder.piston, 1), (_bearer(scene, cylinder.piston), -1)):
            inside.push(link, place, value * slider.c.v, value * slider.s.v, sign)
    return inside, outside


def momentum(motion: Motion, square: float | np.ndarray, epsilon: float | np.ndarray) -> Balance:
    """Rates of momentum and of moment of momentum about the origin, d²r/dt² = ω² r″ + ε r′."""
    rates = Balance(list(motion.links), motion.q.size)

    def second(part: object) -> np.ndarray:
        return square * part.dd + epsilon * part.d + 0 * motion.q

    for body in motion.scene.bodies.values():
        mass, along, across, inertia = body_of(body)
        link = motion.links[body.link]
        x, y = link.point(along, across)
        rates.push(body.link, (x.v, y.v), mass * second(x), mass * second(y))
        rates.twist(body.link, inertia * second(link.theta))
    for name, shaft in motion.scene.shafts.items():
        rates.twist(name, shaft.inertia * second(motion.links[name].theta))
    return rates


def _joint(name: str, link: str, other: str, place: tuple) -> list[Unknown]:
    on = {link: 1.0, other: -1.0}
    return [Unknown(f"{name}.reaction_{axis}", on, place, u) for axis, u in (("x", (1, 0)), ("y", (0, 1)))]


def _guide(name: str, link: str, other: str, slider: Pose, way: Pose) -> list[Unknown]:
    on, normal = {link: 1.0, other: -1.0}, (-way.s.v, way.c.v)
    return [Unknown(f"{name}.reaction", on, (slider.x.v, slider.y.v), normal), Unknown(f"{name}.reaction_moment", on)]


def unknowns(motion: Motion) -> list[Unknown]:
    """Everything unknown: three for each link (one for a shaft without a pivot)."""
    scene, links = motion.scene, motion.links
    drive = scene.input
    if isinstance(drive, CrankInput):
        found = [*_joint("input", drive.link, FRAME, _at(motion, drive.pivot))]
        found.append(Unknown("input_moment", {drive.link: 1.0, FRAME: -1.0}))
    else:
        slider, way = links[drive.link], motion.guides[drive.guide]
        found = _guide("input", drive.link, FRAME, slider, way)
        place = (slider.x.v, slider.y.v)
        found.append(Unknown("input_moment", {drive.link: 1.0, FRAME: -1.0}, place, (way.c.v, way.s.v)))
    for name, shaft in scene.shafts.items():
        if shaft.pivot is not None:
            found += _joint(name, name, FRAME, _at(motion, shaft.pivot))
        # Gears do no work: the moments on shaft and driver are as −1 to the ratio; their bearings take the rest.
        found.append(Unknown(f"gear of {name}", {name: 1.0, shaft.geared_to: -shaft.ratio, FRAME: shaft.ratio - 1}))
    for name, g in scene.groups.items():
        for side in ("first", "second"):
            part = getattr(g, side)
            if isinstance(part, (Sliding, Yoke)):
                carrier, way = scene.guides[part.guide].link, motion.guides[part.guide]
                found += _guide(f"{name}.{side}", part.link, carrier, links[part.link], way)
            else:
                found += _joint(f"{name}.{side}", part.link, holder(scene, part.joint), _at(motion, part.joint))
        if hasattr(g, "inner"):
            found += _joint(f"{name}.inner", g.first.link, g.second.link, _at(motion, g.inner))
        else:
            block = links[g.first.link]
            found += _guide(f"{name}.inner", g.first.link, g.second.link, block, block)
    return found


def balances(motion: Motion) -> list[tuple[str, int]]:
    """Equations: link, and 0, 1 for its forces or 2 for its moments; a shaft without a pivot has moments alone."""
    loose = {name for name, shaft in motion.scene.shafts.items() if shaft.pivot is None}
    moving = [name for name in motion.links if name != FRAME]
    return [(name, part) for name in moving for part in ((2,) if name in loose else (0, 1, 2))]


def coefficients(motion: Motion, columns: list[Unknown]) -> np.ndarray:
    """What a unit of each unknown adds to each equation, (positions, equations, unknowns)."""
    rows = balances(motion)
    matrix = np.zeros((motion.q.size, len(rows), len(columns)), REAL)
    for j, unknown in enumerate(columns):
        for name, factor in unknown.on.items():
            unit = Balance([name], motion.q.size)
            if unknown.place is None:
                unit.twist(name, np.ones(motion.q.size))
            else:
                unit.push(name, unknown.place, *unknown.direction)
            for i, (link, part) in enumerate(rows):
                if link == name:
                    matrix[:, i, j] += factor * unit.of[name][part]
    return matrix


def reactions(
    scene: Scene, q: np.ndarray, omega: float | np.ndarray | None = None, epsilon: float | np.ndarray = 0.0
) -> dict[str, np.ndarray]:
    """All reactions by the engine's names, in frame axes, with the drive and what the machine does to its frame.

    Parameters
    ----------
    scene : Scene
    q : ndarray (positions,)
    omega, epsilon : float or ndarray (positions,)
        Motion of the input; its uniform speed when not given.
    """
    motion = Motion(scene, q)
    square = REAL(scene.input.speed if omega is None else omega) ** 2
    (inside, outside), rates = external(motion, omega), momentum(motion, square, epsilon)
    columns = unknowns(motion)
    moving = [name for name in motion.links if name != FRAME]
    rows = balances(motion)
    assert len(rows) == len(columns)
    matrix = coefficients(motion, columns)
    right = np.stack([(rates.of[n] - inside.of[n] - outside.of[n])[part] for n, part in rows], axis=-1)
    solution = solved(matrix, right)
    found = {unknown.name: solution[:, j] for j, unknown in enumerate(columns)}
    for name, unknown in ((u.name, u) for u in columns if u.name.endswith(".reaction")):
        found |= {f"{name}_{axis}": found[name] * part for axis, part in zip("xy", unknown.direction, strict=True)}
    # By the law of momentum of the whole: the frame gives what forces from outside don't.
    whole = sum(outside.of[n] - rates.of[n] for n in moving) + outside.of[FRAME]
    found |= {f"frame.reaction_{part}": row for part, row in zip(("x", "y", "moment"), whole, strict=True)}
    return {name: row for name, row in found.items() if not name.startswith("gear of")}
