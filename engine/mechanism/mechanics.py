"""The mechanics of a scene, whole: one graph, and what each chapter of the textbook adds to it when it is asked for."""

from functools import cached_property

import numpy as np

from engine.graph.nodes import Graph, Node, Number
from engine.mechanism.inertia import (
    BodyInertiaForces,
    FrameShaking,
    ReducedInertia,
    inertia_forces,
    reduced_inertia,
    shaking,
)
from engine.mechanism.input_motion import InputMotion, input_span
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.loads import Loads
from engine.mechanism.reactions import Reactions
from engine.parts.skeleton import CrankInput
from engine.scene.scene import Scene
from engine.scene.structure.ordering import Structure, order


class Mechanics:
    """The graph of a scene.

    Parameters
    ----------
    scene : Scene
    varied : frozenset of str
        Paths of numbers that will vary; what is zero and doesn't vary is left out.

    Attributes
    ----------
    scene, varied : as given
    structure : Structure
    graph : Graph
    kinematics : Kinematics

    Raises
    ------
    SceneError
        The scene can't be ordered into structural groups.
    """

    def __init__(self, scene: Scene, varied: frozenset[str] = frozenset()) -> None:
        self.scene, self.varied = scene, varied
        self.structure: Structure = order(scene)
        self.graph = Graph()
        self.kinematics = Kinematics(scene, self.structure, self.graph, varied)

    @property
    def has_cycle(self) -> bool:
        """Whether the input turns fully, so that there is a cycle to close."""
        return isinstance(self.scene.input, CrankInput) and self.scene.input.start is None

    @property
    def first(self) -> Number:
        """Where the range of the input begins [rad, or m of a sliding input]."""
        return input_span(self.scene, self.graph)[0]

    @property
    def last(self) -> Number:
        """Where it ends."""
        return input_span(self.scene, self.graph)[1]

    @property
    def speed(self) -> Number:
        """Speed of the input [rad/s or m/s]."""
        return self.graph.number("input.speed", "load")

    @property
    def speed_squared(self) -> Number:
        """Square of the input's speed."""
        return self.graph.derived("square of the input's speed", lambda n: n["input.speed"] ** 2, "load")

    @property
    def forward(self) -> Number:
        """Sign of the input's speed: which way the cycle is run through."""
        return self.graph.derived("sense of the input", lambda n: np.sign(n["input.speed"]) + 0.0)

    @cached_property
    def reduced(self) -> ReducedInertia:
        """The reduced moment of inertia."""
        return reduced_inertia(self.kinematics)

    @cached_property
    def loads(self) -> Loads:
        """The actions of the scene and their reduced moments."""
        return Loads(self.scene, self.kinematics)

    @cached_property
    def reactions(self) -> Reactions:
        """Reactions in the pairs at uniform speed of the input."""
        return Reactions(self.kinematics, self.structure, self.loads.terms, InputMotion.uniform(self.graph))

    @cached_property
    def shaking(self) -> FrameShaking:
        """What shakes the frame at uniform speed."""
        return shaking(self.kinematics, lambda point: point.a, lambda link: link.e)

    def inertia_forces(self, body: str) -> BodyInertiaForces:
        """Inertia forces of a body at uniform speed."""
        return inertia_forces(self.kinematics, body)

    def moment_of(self, roles: frozenset[str | None] | None = None) -> Node:
        """Reduced moment of the actions with some roles; where none are named, of all but brakes: they are released."""
        terms = [t for t in self.loads.terms if (t.role != "braking" if roles is None else t.role in roles)]
        return self.graph.combination((t.coefficient, t.basis) for t in terms)

    @cached_property
    def input_moment(self) -> Node:
        """Input moment that keeps the speed uniform: ½ ω² dI/dφ − M."""
        terms = [(self.speed_squared * mass, basis) for mass, basis in self.reduced.slope_terms]
        terms += [(-t.coefficient, t.basis) for t in self.loads.terms if t.role != "braking"]
        return self.graph.combination(terms)
