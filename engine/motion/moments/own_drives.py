"""Motion with second inputs that have their own drives, servos, which supply whatever torque their laws need.

The first input keeps one degree of freedom φ. Its equation is the projection of Newton's and Euler's equations on
displacements with the second inputs held, r_φ = ∂r/∂φ and θ_φ = ∂θ/∂φ (Lagrange's equation with laws of time):

    Σ m a · r_φ + J θ̈ θ_φ = M

True accelerations are a = a₀ + ε ∂v/∂ω. Therefore I ε + Σ m a₀ · r_φ + … = M, with I = Σ m ∂v/∂ω · r_φ + …. Loads give
M by r_φ, but their power by the true velocity. The drives give the rest of the power that changes the kinetic energy.

Source: L. A. Pars, A Treatise on Analytical Dynamics, chapters on Lagrange's equations.
"""

from copy import copy

from engine.graph.nodes import Held, Node, reached
from engine.laws.senses import kept_positive
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.assembly import Course
from engine.mechanism.inertia import MovedMass, moved_masses
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Load
from engine.mechanism.loads import Loads
from engine.mechanism.mechanics import Mechanics
from engine.parts.formulas.by_formula import ByFormula
from engine.scene.pairs import own_drives
from engine.scene.scene import SceneError

_NOT_SMOOTH = (
    "in a run with a second input that has its own drive, a load on a point or link moved by that input can't jump, "
    "act along its point's path, be given by a formula or grow with a higher power of the speed: give an angle and a "
    "load linear in the speed, or let gears or cams move the input, drive = 'crank'"
)


def loads_of(
    mechanics: Mechanics, time: Node, speed: Node, magnitude: Node | None = None, epsilon: Node | None = None
) -> Loads:
    """Loads of a machine in motion; parameters as for `WithServos`."""
    if own_drives(mechanics.scene):
        return WithServos(mechanics, time, speed, magnitude, epsilon)
    return Loads(mechanics.scene, mechanics.kinematics, time, speed if magnitude is None else magnitude)


class WithServos(Loads):
    """Loads and masses of a machine whose second inputs have their own drives.

    Parameters
    ----------
    mechanics : Mechanics
    time : Node
        [s].
    speed : Node
        Speed of the first input, in its direction of motion [rad/s].
    magnitude : Node, optional
        Its magnitude, for formulas; by default, `speed`.
    epsilon : Node, optional
        Acceleration of the first input, for which true accelerations are; by default 0 [rad/s²].

    Attributes
    ----------
    true : Kinematics
        With derivatives by time.
    inertia : Node
        Inertia of the first input [kg·m²].
    bias : Node
        Torque that accelerates the masses at a constant speed of the first input [N·m].
    energy : Node
        Kinetic energy [J].

    Raises
    ------
    SceneError
        A load jumps where the motion of a second input decides.
    """

    def __init__(
        self,
        mechanics: Mechanics,
        time: Node,
        speed: Node,
        magnitude: Node | None = None,
        epsilon: Node | None = None,
    ) -> None:
        graph = mechanics.graph
        self._speed_in_motion, self._way = speed, input_sense(mechanics.kinematics)
        held, geared, self.true = (
            Kinematics(mechanics.scene, mechanics.structure, graph, mechanics.varied, course)
            for course in (
                Course(graph.one, graph.zero, time, graph.zero, follows=False),
                Course(graph.one, graph.zero, time, graph.zero, follows=True),
                Course(self._way * speed, graph.zero if epsilon is None else epsilon, time, graph.one, follows=True),
            )
        )
        magnitude = speed if magnitude is None else magnitude
        super().__init__(mechanics.scene, held, time, magnitude)
        by_input, true = (Loads(mechanics.scene, k, time, magnitude).terms for k in (mechanics.kinematics, self.true))
        self.terms = [self._projected(*three) for three in zip(by_input, self.terms, true, strict=True)]
        self._velocities = [load.velocity for load in true]
        self._held, self._geared, self._true = (moved_masses(k) for k in (held, geared, self.true))
        self._first_kind = mechanics.reduced.first_kind
        # A law of φ can make it negative, so that the first input would accelerate against its torque: NaN.
        inertia = self._first_kind + self._sum(self._geared, self._held)
        self.inertia = graph.apply(kept_positive, inertia, inertia)
        self.bias = graph.combination(
            (one.mass, one.second.dot(other.first)) for one, other in zip(self._true, self._held, strict=True)
        )
        self.energy = 0.5 * (self._first_kind * (speed * speed) + self._sum(self._true, self._true))

    def _sum(self, ones: list[MovedMass], others: list[MovedMass]) -> Node:
        """Σ m v₁ · v₂."""
        products = ((one.mass, one.first.dot(other.first)) for one, other in zip(ones, others, strict=True))
        return self.kinematics.graph.combination(products)

    def _projected(self, by_input: Load, held: Load, true: Load) -> Load:
        """A load with the power of the speed in its characteristic, and its torque on the first input.

        If derivatives by the input are the same with the second inputs held, it depends on the first input only.
        """
        speed, graph = self._speed_in_motion, self.kinematics.graph
        characteristic, direction = true.characteristic, true.grip.direction
        if by_input.characteristic is held.characteristic and by_input.grip.direction == held.grip.direction:
            order, direction = held.order, held.grip.direction
            base = speed if order in (1, 2) else abs(speed)
            power = InputMotion(speed * speed, graph.zero, base).power(order)
            characteristic = held.characteristic * power
        elif not self._is_smooth(held, true):
            raise SceneError([(self._path(true.action), _NOT_SMOOTH)])
        elif true.order == 1:
            # Coefficients are those of unit speed in the direction of motion.
            characteristic = self._way * characteristic
        grip = true.grip._replace(direction=direction)
        basis = held.velocity * characteristic
        return held._replace(characteristic=characteristic, grip=grip, basis=basis, order=0)

    def _is_smooth(self, held: Load, true: Load) -> bool:
        """Whether a load is a smooth function of position and velocity, linear in the velocity."""
        behind = reached([true.characteristic, *(true.grip.direction or ())])
        formula = isinstance((self.scene.forces | self.scene.moments).get(true.action), ByFormula)
        smooth = not formula and not any(isinstance(node, Held) for node in behind)
        return smooth and true.order in (0, 1) and held.grip.direction == true.grip.direction

    def _path(self, action: str) -> str:
        tables = ("forces", "moments", "springs", "cylinders")
        return next(f"{table}.{action}" for table in tables if action in getattr(self.scene, table))

    def at_true_velocities(self) -> Loads:
        """The loads with their power, in the direction of motion, as their torque."""
        found = copy(self)
        found.terms = [
            load._replace(basis=(self._way * velocity) * load.characteristic)
            for load, velocity in zip(self.terms, self._velocities, strict=True)
        ]
        return found

    def energy_rate(self, epsilon: Node) -> Node:
        """Derivative of the kinetic energy with respect to time, at an acceleration in the direction of motion [W]."""
        at_constant_speed = self.kinematics.graph.combination(
            (one.mass, one.second.dot(one.first)) for one in self._true
        )
        change = self._way * self._sum(self._geared, self._true) + self._first_kind * self._speed_in_motion
        return at_constant_speed + epsilon * change
