"""The mechanics of a scene, whole: one graph, and what each chapter of the textbook adds to it when it is asked for."""

from collections.abc import Iterable, Mapping
from functools import cached_property

import numpy as np

from engine.graph.nodes import Constant, Graph, Node, Number, Return, value_of
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
from engine.parts.actions import TorsionSpring
from engine.scene.load_formulas import TIME
from engine.scene.scene import Scene, SceneError, scene_numbers
from engine.scene.structure.closing import how_to_close, is_whole
from engine.scene.structure.ordering import Structure, order

# What is wrong with turns in a cycle that aren't whole; of tables whose parts allow none at all.
_WHOLE = (
    "{name!r} makes {turns:.12g} turns in a cycle of {revolutions} of the crank, and doesn't come back to its place "
    "with what lies on it"
)
_NONE_ALLOWED = {
    "racks": "the pinion of {name!r} keeps turning, by {turns:.12g} turns in a cycle, and the rack would run away: "
    "give input.start and input.stop, or drive it by a pinion that comes back",
    "moments": "the link keeps turning, by {turns:.12g} turns in a cycle, and would wind up spring {name!r}: name "
    "a link that swings, or give input.start and input.stop",
}


def _holds(condition: Return, turns: float | np.ndarray) -> bool | np.ndarray:
    """Whether something is in its place again, by turns in a cycle."""
    return is_whole(turns) & (np.logical_not(condition.none) | (np.round(turns) == 0.0))


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
        The scene can't be ordered into structural groups, or its cycle doesn't close.
    """

    def __init__(self, scene: Scene, varied: frozenset[str] = frozenset()) -> None:
        self.scene, self.varied = scene, varied
        self.structure: Structure = order(scene)
        self.graph = Graph()
        self.kinematics = Kinematics(scene, self.structure, self.graph, varied)
        problems = self._open_parts()
        if problems:
            raise SceneError(problems)

    @property
    def has_cycle(self) -> bool:
        """Whether the input turns fully, so that there is a cycle to close."""
        return self.kinematics.has_cycle

    @cached_property
    def conservative_moment(self) -> Node:
        """Reduced moment of gravity and springs, which do no work over a closed cycle."""
        terms = [(t.coefficient, t.basis) for t in self.loads.terms if t.role is None and t.order == 0]
        return self.graph.combination(terms)

    @property
    def sprung(self) -> list[tuple[Node, Node]]:
        """Of links with torsion springs, what the springs follow and the rate of the angle that they wind up by."""
        if not self.has_cycle:
            return []
        sprung = {name for name, moment in self.scene.moments.items() if isinstance(moment, TorsionSpring)}
        return [(load.characteristic, load.velocity) for load in self.loads.terms if load.action in sprung]

    # Whether the cycle closes

    def closes(self, numbers: Mapping[str, float | np.ndarray], nodes: Iterable[Node] = ()) -> bool | np.ndarray:
        """Whether all parts of variants, and some nodes, have their first places and values again after a cycle.

        Parameters
        ----------
        numbers : mapping of path to float or ndarray (variants,)
        nodes : iterable of Node

        Returns
        -------
        bool or ndarray (variants,) of bool
        """
        closed: bool | np.ndarray = True
        for condition in dict.fromkeys([*self._returns, *self.graph.returns_behind(nodes)]):
            closed = closed & _holds(condition, value_of(condition.turns, numbers))
        return closed

    def depends_on_time(self, nodes: Iterable[Node]) -> bool:
        """Whether some nodes don't repeat themselves with the cycle, as a load in them depends on time.

        Of numbers that vary, a load's period may fit the cycle of some variants: `closes` says of which.

        Parameters
        ----------
        nodes : iterable of Node
        """
        timed = [condition for condition in self.graph.returns_behind(nodes) if condition.of == TIME]
        fixed = [c for c in timed if isinstance(c.turns, Constant) or not self.varied]
        return any(not _holds(condition, value_of(condition.turns, self._as_is)) for condition in fixed)

    @property
    def _as_is(self) -> dict[str, float]:
        """Numbers of the scene."""
        return {path: number.value for path, number in scene_numbers(self.scene).items()}

    @cached_property
    def _returns(self) -> list[Return]:
        """Conditions on which all parts of the scene are in their places again; a bare shaft has none."""
        k = self.kinematics
        points = [*k.points.values(), *(k.mass_centre(name) for name in k.masses)]
        nodes = [node for point in points for node in point.r]
        nodes += [node for guide in k.guides.values() for node in (*guide.r, *guide.u)]
        nodes += [slide.d for slide in k.slides.values()]
        nodes += [node for name, link in k.links.items() if name not in self.scene.shafts for node in (*link.u, link.w)]
        nodes += [node for load in self.loads.terms for node in (load.basis, load.characteristic)]
        # Loads over time may be meant for runs alone.
        return [condition for condition in self.graph.returns_behind(nodes) if condition.of != TIME]

    def _open_parts(self) -> list[tuple[str, str]]:
        """Nodes that don't return to their value after a cycle of the unmodified scene."""
        if not self._returns:
            return []
        values, revolutions = self._as_is, self.scene.input.revolutions
        found = [(c, float(value_of(c.turns, values))) for c in self._returns]
        mend = how_to_close([turns / revolutions for c, turns in found if not c.none], revolutions)
        problems = []
        for condition, turns in found:
            if not _holds(condition, turns):
                table, name, _ = condition.of.split(".")
                words = _NONE_ALLOWED.get(table, _WHOLE).format(name=name, turns=turns, revolutions=revolutions)
                problems.append((condition.of, words if condition.none else f"{words}: {mend}"))
        return problems

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
        return self.graph.number("input.speed")

    @property
    def speed_squared(self) -> Number:
        """Square of the input's speed."""
        return self.graph.derived("square of the input's speed", lambda n: n["input.speed"] ** 2)

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
        """Drive torque for constant speed: ½ ω² dI/dφ − M."""
        terms = [(self.speed_squared * mass, basis) for mass, basis in self.reduced.slope_terms]
        terms += [(-t.coefficient, t.basis) for t in self.loads.terms if t.role != "braking"]
        return self.graph.combination(terms)
