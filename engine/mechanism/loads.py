"""All that acts on a machine as nodes: gravity, forces, moments, springs and cylinders, with their reduced moments.

By virtual power a force F at a point with the transfer velocity v reduces to the moment F · v on the input, a moment
M on a link with the transfer velocity w to M w. Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter
on the reduction of forces and masses.
"""

from collections.abc import Iterator

from engine.graph.nodes import Node
from engine.mechanism.acting import Characteristic, Grip, Load, load
from engine.mechanism.actions.characteristics import characteristics
from engine.mechanism.actions.cylinders import cylinder_load
from engine.mechanism.actions.paths import about_link, along
from engine.mechanism.actions.springs import spring_loads, torsion_spring
from engine.mechanism.actions.tables import uniform_time
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.vectors import Vector
from engine.scene import actions
from engine.scene.pairs import holder_of
from engine.scene.parts import FRAME
from engine.scene.scene import Scene


class Loads:
    """The loads of a scene.

    Parameters
    ----------
    scene : Scene
    kinematics : Kinematics
    time : Node, optional
        Time on which loads over time depend, where the input doesn't move uniformly [s].

    Attributes
    ----------
    terms : list of Load
        Of all actions but motors, gravity first. A load that does no work has a basis of zero.
    motors : tuple of str
        Moments of the scene that are motors: they follow from the speed alone.
    """

    def __init__(self, scene: Scene, kinematics: Kinematics, time: Node | None = None) -> None:
        self.scene, self.kinematics = scene, kinematics
        self._time = uniform_time(kinematics) if time is None else time
        motors = (actions.DCMotor, actions.InductionMotor)
        self.motors = tuple(n for n, m in scene.moments.items() if isinstance(m, motors))
        self.terms: list[Load] = [
            *self._gravity(),
            *(load for name in scene.forces for load in self._force(name)),
            *(load for name in scene.moments if name not in self.motors for load in self._moment(name)),
            *(load for name in scene.springs for load in spring_loads(kinematics, name)),
            *(cylinder_load(kinematics, name) for name in scene.cylinders),
        ]

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions with a reduced moment; gravity only where it does work."""
        zero = self.kinematics.graph.zero
        return tuple(dict.fromkeys(t.action for t in self.terms if t.action != "gravity" or t.basis is not zero))

    def weight(self, name: str) -> Node | None:
        """Weight of one of the mechanism's masses [N]; None where there is no gravity."""
        if self.scene.gravity == 0.0 and "gravity" not in self.kinematics.varied:
            return None
        mass = self.kinematics.masses[name].mass
        return self.kinematics.graph.derived(f"weight of {name}", lambda n: n["gravity"] * mass(n), "load")

    def _gravity(self) -> Iterator[Load]:
        graph = self.kinematics.graph
        down = Vector(graph.zero, graph.constant(-1.0))
        for name, mass in self.kinematics.masses.items():
            weight, centre = self.weight(name), self.kinematics.mass_centre(name)
            if weight is not None:
                size = Characteristic(weight, graph.one)
                yield load("gravity", size, Grip(mass.link, centre, down), centre.v.dot(down), None)

    def _force(self, name: str) -> Iterator[Load]:
        force, kinematics = self.scene.forces[name], self.kinematics
        motion = along(kinematics, name, force)
        grip = Grip(holder_of(self.scene, force.on), kinematics.points[force.on], motion.direction)
        for size in characteristics(kinematics, force, f"forces.{name}", motion, self._time):
            yield load(name, size, grip, motion.velocity, force.role)

    def _moment(self, name: str) -> Iterator[Load]:
        moment, kinematics = self.scene.moments[name], self.kinematics
        motion = about_link(kinematics, moment.on)
        on_frame = isinstance(moment, actions.TorsionSpring | actions.Brake)
        grip = Grip(moment.on, None, None, (FRAME, kinematics.links[FRAME].origin) if on_frame else None)
        if isinstance(moment, actions.TorsionSpring):
            yield load(name, torsion_spring(kinematics, name), grip, motion.velocity, None)
            return
        for size in characteristics(kinematics, moment, f"moments.{name}", motion, self._time):
            yield load(name, size, grip, motion.velocity, moment.role)
