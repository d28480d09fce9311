"""The complete mechanics of a scene: one graph, to which each chapter adds its nodes on demand."""

from collections.abc import Iterable, Mapping
from functools import cached_property

import numpy as np

from engine.graph.nodes import Constant, Graph, Node, Number, Return, value_of
from engine.mechanism.inertia import (
    FrameShaking,
    ReducedInertia,
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

# Messages for a fractional number of turns per cycle, and for tables whose parts must not turn at all.
_WHOLE = (
    "{name!r} makes {turns:.12g} turns in a cycle of {revolutions} of the crank, and doesn't return to its position "
    "with the parts on it"
)
_NONE_ALLOWED = {
    "racks": "the pinion of {name!r} keeps turning, by {turns:.12g} turns in a cycle, and the rack would run away: "
    "give input.start and input.stop, or drive it by a pinion that swings",
    "moments": "the link keeps turning, by {turns:.12g} turns in a cycle, and would wind up spring {name!r}: name "
    "a link that swings, or give input.start and input.stop",
}


def _holds(condition: Return, turns: float | np.ndarray) -> bool | np.ndarray:
    """Whether a part is back in its initial position after this number of turns in a cycle."""
    return is_whole(turns) & (np.logical_not(condition.none) | (np.round(turns) == 0.0))


class Mechanics:
    """The graph of a scene.

    Parameters
    ----------
    scene : Scene
    varied : frozenset of str
        Paths of the varied numbers; numbers that are zero and not varied are dropped.

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
        """Whether the input turns fully, so that the machine has a closed cycle."""
        return self.scene.has_cycle

    @cached_property
    def conservative_moment(self) -> Node:
        """Reduced moment of gravity and springs, which do no net work over a closed cycle."""
        terms = [(t.coefficient, t.basis) for t in self.loads.terms if t.role is None and t.order == 0]
        return self.graph.combination(terms)

    @property
    def sprung(self) -> list[tuple[Node, Node]]:
        """For each torsion spring: its characteristic, and the transfer velocity of its link."""
        if not self.has_cycle:
            return []
        sprung = {name for name, moment in self.scene.moments.items() if isinstance(moment, TorsionSpring)}
        return [(load.characteristic, load.velocity) for load in self.loads.terms if load.action in sprung]

    def replaced_in(self, scene: Scene, values: Mapping[str, float]) -> dict[str, float] | None:
        """Numbers (SI) in which a variant of this scene differs from it; None if some of them don't vary here.

        Parameters
        ----------
        scene : Scene
            This scene, or one of its variants; its assembly modes are those of this scene.
        values : mapping of path to float
            Further numbers to replace.
        """
        own = scene_numbers(self.scene)
        given = {path: number.value for path, number in scene_numbers(scene).items() if number != own.get(path)}
        replaced = {path: value for path, value in {**given, **values}.items() if not path.startswith("near.")}
        return replaced if self.varied.issuperset(replaced) else None

    # Whether the cycle closes

    def returns_of(self, nodes: Iterable[Node]) -> list[Return]:
        """Conditions on which all parts, and the given nodes, return to their initial positions and values."""
        return list(dict.fromkeys([*self._returns, *self.graph.returns_behind(nodes)]))

    def closes(self, numbers: Mapping[str, float | np.ndarray], conditions: Iterable[Return]) -> bool | np.ndarray:
        """Whether conditions of return hold after a cycle.

        Parameters
        ----------
        numbers : mapping of path to float or ndarray (variants,)
        conditions : iterable of Return
            From `returns_of`.

        Returns
        -------
        bool or ndarray (variants,) of bool
        """
        closed: bool | np.ndarray = True
        for condition in conditions:
            closed = closed & _holds(condition, value_of(condition.turns, numbers))
        return closed

    def depends_on_time(self, nodes: Iterable[Node]) -> bool:
        """Whether a time-dependent load keeps some of the nodes from repeating with the cycle.

        Only numbers that do not vary are judged: the period of a load may fit the cycle of some variants, which
        `closes` decides.

        Parameters
        ----------
        nodes : iterable of Node
        """
        timed = [condition for condition in self.graph.returns_behind(nodes) if condition.of == TIME]
        fixed = [c for c in timed if isinstance(c.turns, Constant) or not self.varied]
        return any(not _holds(condition, value_of(condition.turns, self._as_is)) for condition in fixed)

    @property
    def _as_is(self) -> dict[str, float]:
        """Numbers of the scene, unvaried."""
        return {path: number.value for path, number in scene_numbers(self.scene).items()}

    @cached_property
    def _returns(self) -> list[Return]:
        """Conditions for all parts of the scene to return to their initial positions; bare shafts have none."""
        k = self.kinematics
        points = [*k.points.values(), *(k.mass_centre(name) for name in k.masses)]
        nodes = [node for point in points for node in point.r]
        nodes += [node for guide in k.guides.values() for node in (*guide.r, *guide.u)]
        nodes += [slide.d for slide in k.slides.values()]
        nodes += [node for name, link in k.links.items() if name not in self.scene.shafts for node in (*link.u, link.w)]
        nodes += [node for load in self.loads.terms for node in (load.basis, load.characteristic)]
        # Time-dependent loads may be intended for runs only.
        return [condition for condition in self.graph.returns_behind(nodes) if condition.of != TIME]

    def _open_parts(self) -> list[tuple[str, str]]:
        """Parts that are not back in their initial position after a cycle, with unvaried numbers."""
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
        """Start of the input's range [rad, or m for a sliding input]."""
        return input_span(self.scene, self.graph)[0]

    @property
    def last(self) -> Number:
        """End of the input's range."""
        return input_span(self.scene, self.graph)[1]

    @property
    def speed(self) -> Number:
        """Speed of the input [rad/s or m/s]."""
        return self.graph.number("input.speed")

    @property
    def speed_squared(self) -> Number:
        """Square of the input speed."""
        return InputMotion.uniform(self.graph).square

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
        """Reactions in the pairs at constant input speed."""
        return Reactions(self.kinematics, self.structure, self.loads.terms, InputMotion.uniform(self.graph))

    @cached_property
    def shaking(self) -> FrameShaking:
        """Shaking force and moment on the frame at constant speed."""
        return shaking(self.kinematics, lambda point: point.a, lambda link: link.e)

    def moment_of(self, roles: frozenset[str | None] | None = None) -> Node:
        """Reduced moment of the actions with the given roles; by default, of all but the released brakes."""
        terms = [t for t in self.loads.terms if (t.role != "braking" if roles is None else t.role in roles)]
        return self.graph.combination((t.coefficient, t.basis) for t in terms)

    @cached_property
    def input_moment(self) -> Node:
        """Drive torque for constant speed: ½ ω² dI/dφ − M."""
        terms = [(self.speed_squared * mass, basis) for mass, basis in self.reduced.slope_terms]
        terms += [(-t.coefficient, t.basis) for t in self.loads.terms if t.role != "braking"]
        return self.graph.combination(terms)
