"""All loads on a machine as nodes: gravity, forces, moments, springs and cylinders, with their reduced moments.

By virtual power, a force F at a point with transfer velocity v reduces to the moment F · v on the input, and a moment M
on a link with transfer velocity w to M w. Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on the
reduction of forces and masses.
"""

from collections.abc import Iterator

from engine import mechanism
from engine.graph.nodes import Node
from engine.mechanism.actions.characteristics import characteristics
from engine.mechanism.actions.paths import about_link, along, uniform_time
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Characteristic, Grip, Load, load
from engine.mechanism.vectors import Vector
from engine.parts import actions
from engine.parts.motors import Motor
from engine.parts.skeleton import FRAME
from engine.scene.pairs import holder_of
from engine.scene.scene import Scene


class Loads:
    """The loads of a scene.

    Parameters
    ----------
    scene : Scene
    kinematics : Kinematics
    time, speed : Node, optional
        Time [s] and magnitude of the input speed [rad/s]; required unless the input moves at constant speed.

    Attributes
    ----------
    terms : list of Load
        Loads of all actions except motors, gravity first. A load that does no work has a zero basis.
    motors : tuple of str
        Names of the moments that are motors; their torque depends on speed only.
    """

    def __init__(
        self, scene: Scene, kinematics: Kinematics, time: Node | None = None, speed: Node | None = None
    ) -> None:
        self.scene, self.kinematics = scene, kinematics
        self._time, self._speed = uniform_time(kinematics) if time is None else time, speed
        self.motors = tuple(n for n, m in scene.moments.items() if isinstance(m, Motor))
        self.terms: list[Load] = [
            *self._gravity(),
            *(load for name in scene.forces for load in self._force(name)),
            *(load for name in scene.moments if name not in self.motors for load in self._moment(name)),
            *(load for name in scene.springs for load in mechanism.actions.springs.spring_loads(kinematics, name)),
            *(mechanism.actions.cylinders.cylinder_load(kinematics, name) for name in scene.cylinders),
        ]

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions with a reduced moment; gravity only if it does work."""
        zero = self.kinematics.graph.zero
        return tuple(dict.fromkeys(t.action for t in self.terms if t.action != "gravity" or t.basis is not zero))

    def _gravity(self) -> Iterator[Load]:
        """Weights, and the inertia forces of an accelerated base."""
        graph, zero = self.kinematics.graph, self.kinematics.graph.zero
        back, fields = graph.constant(-1.0), {}
        if self.scene.gravity != 0.0 or "gravity" in self.kinematics.varied:
            fields["gravity"] = Vector(zero, back)
        if self.scene.base is not None:
            fields |= {"base.acceleration_x": Vector(back, zero), "base.acceleration_y": Vector(zero, back)}
        for name, mass in self.kinematics.masses.items():
            centre = self.kinematics.mass_centre(name)
            for path, direction in fields.items():
                size = graph.derived(f"{path} on {name}", lambda n, path=path, mass=mass.mass: n[path] * mass(n))
                grip = Grip(mass.link, centre, direction)
                yield load("gravity", Characteristic(size, graph.one), grip, centre.v.dot(direction), None)

    def _force(self, name: str) -> Iterator[Load]:
        force, kinematics = self.scene.forces[name], self.kinematics
        motion = along(kinematics, name, force)
        grip = Grip(holder_of(self.scene, force.on), kinematics.points[force.on], motion.direction)
        for size in characteristics(kinematics, force, f"forces.{name}", motion, self._time, self._speed):
            yield load(name, size, grip, motion.velocity, force.role)

    def _moment(self, name: str) -> Iterator[Load]:
        moment, kinematics = self.scene.moments[name], self.kinematics
        motion = about_link(kinematics, moment.on)
        on_frame = isinstance(moment, actions.TorsionSpring | actions.Brake)
        grip = Grip(moment.on, None, None, (FRAME, kinematics.links[FRAME].origin) if on_frame else None)
        if isinstance(moment, actions.TorsionSpring):
            yield load(name, mechanism.actions.springs.torsion_spring(kinematics, name), grip, motion.velocity, None)
            return
        for size in characteristics(kinematics, moment, f"moments.{name}", motion, self._time, self._speed):
            yield load(name, size, grip, motion.velocity, moment.role)
