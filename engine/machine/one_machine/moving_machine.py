"""One machine at equally spaced positions of its input: where its parts are, how they move, what acts on its links.

Values have the shapes of the graph's own records, with arrays in place of nodes and a vector as x + iy. Rates are by
the input, as in the graph.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.machine.machine import Machine
from engine.machine.results import Outcome
from engine.mechanism.assembly import MovingPoint, Slide, Turning
from engine.mechanism.higher_pairs.cam_motion import CamMotion
from engine.mechanism.higher_pairs.noncircular_motion import NoncircularMotion
from engine.mechanism.link_loads import LinkForce
from engine.mechanism.vectors import Vector
from engine.parts.skeleton import FRAME, CrankInput
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.verdicts import Verdict


class NowhereDefinedError(ValueError):
    """Something of a machine has no value at any position; `verdict` says why."""

    def __init__(self, verdict: Verdict) -> None:
        super().__init__(verdict.sentence)
        self.verdict = verdict


class Places(NamedTuple):
    """Where the parts of a machine are, by their names: places [m] and directions in the scene's coordinates.

    Attributes
    ----------
    points, contacts, pitch_points : dict of str to complex ndarray (positions,)
        Contacts of cams, pitch points of non-circular wheels.
    links, guides : dict of str to (complex ndarray, complex ndarray)
        Origin and direction of a link's axes; a point and the direction of a guide.
    slides : dict of str to ndarray (positions,)
        [m]
    centres : dict of str to complex ndarray (positions,)
        Of the masses of bodies.
    """

    points: dict[str, np.ndarray]
    links: dict[str, tuple[np.ndarray, np.ndarray]]
    guides: dict[str, tuple[np.ndarray, np.ndarray]]
    slides: dict[str, np.ndarray]
    contacts: dict[str, np.ndarray]
    pitch_points: dict[str, np.ndarray]
    centres: dict[str, np.ndarray]


class Motions(NamedTuple):
    """How the parts of a machine move, by their names."""

    points: dict[str, MovingPoint]
    links: dict[str, Turning]
    slides: dict[str, Slide]
    centres: dict[str, MovingPoint]
    cams: dict[str, CamMotion]
    noncircular: dict[str, NoncircularMotion]


class MovingMachine:
    """One machine at equally spaced positions.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) in place of the scene's.
    positions : int
        Intervals over the cycle, or over the input's range.
    made : Machine, optional
        A machine that is used if it is one of this scene and takes the same numbers.

    Attributes
    ----------
    values : dict of str to float
    numbers : Numbers
    q : ndarray (positions,)
        Crank angles [rad], or displacements of a sliding input [m].

    Raises
    ------
    NowhereDefinedError
        By its properties: what is asked has no value at any position.
    """

    def __init__(
        self,
        scene: Scene,
        values: Mapping[str, float] | None = None,
        positions: int = 720,
        made: Machine | None = None,
    ) -> None:
        self.scene, self.values = scene, dict(values or {})
        values = self.values
        fits = made is not None and made.scene is scene and {*made.varied} == {*values}
        self.machine = made.asked_for(positions=positions) if fits else Machine(scene, (), (), values, positions)
        self.numbers = Numbers(scene_numbers(scene), values)
        self._varied = {path: np.array([value]) for path, value in values.items()}
        self._kinematics = self.machine.mechanics.kinematics
        self.q = self.machine.nodes
        if not isinstance(scene.input, CrankInput):
            start, stop = self.numbers["input.start"], self.numbers["input.stop"]
            self.q = start + (stop - start) * self.q

    @cached_property
    def places(self) -> Places:
        """Where everything is."""
        k, at, scene = self._kinematics, self._kinematics.coordinates, self.scene
        fixed = [name for name, point in scene.points.items() if point.link == FRAME]
        places = Places(
            {name: at(point.r) for name, point in k.points.items() if name not in fixed},
            {name: (at(link.origin.r), link.u) for name, link in k.links.items() if name != FRAME},
            {name: (at(guide.r), guide.u) for name, guide in k.guides.items()},
            {name: slide.d for name, slide in k.slides.items()},
            {name: at(cam.contact) for name, cam in k.cams.items()},
            {name: at(wheel.pitch_point) for name, wheel in k.noncircular.items()},
            {name: at(k.body_centre(name).r) for name in scene.bodies},
        )
        found, still = self._values(places), np.zeros_like(self.q)
        for name in fixed:
            found.points[name] = self.numbers[f"points.{name}.x"] + 1j * self.numbers[f"points.{name}.y"] + still
        found.links[FRAME] = still + 0j, still + (1 + 0j)
        return found

    @cached_property
    def motions(self) -> Motions:
        """How everything moves."""
        k = self._kinematics
        links = {name: link._replace(origin=self._seen(link.origin)) for name, link in k.links.items()}
        wheels = {n: wheel._replace(pitch_point=k.coordinates(wheel.pitch_point)) for n, wheel in k.noncircular.items()}
        return self._values(
            Motions(
                {name: self._seen(point) for name, point in k.points.items()},
                links,
                k.slides,
                {name: self._seen(k.body_centre(name)) for name in self.scene.bodies},
                {name: cam._replace(contact=k.coordinates(cam.contact)) for name, cam in k.cams.items()},
                wheels,
            )
        )

    @cached_property
    def forces(self) -> list[LinkForce]:
        """Everything that acts on each link at the input's uniform speed, in which each is in equilibrium."""
        seen = self._kinematics.coordinates
        found = self.machine.mechanics.reactions.link_forces()
        return self._values([force._replace(at=seen(force.at)) if force.at else force for force in found])

    def outcome(self, summaries: Iterable[str], fields: Iterable[str]) -> Outcome:
        """Summaries and fields by their names, with the verdict."""
        return self.machine.asked_for(summaries, fields).evaluate(self._varied)

    def fields(self, names: list[str]) -> dict[str, np.ndarray]:
        """Fields by their names."""
        return self._values({name: self.machine.register.fields[name].curve() for name in names})

    def _seen(self, point: MovingPoint) -> MovingPoint:
        """A point by the scene's coordinates."""
        return point._replace(r=self._kinematics.coordinates(point.r))

    def _values(self, shape: Any) -> Any:
        """The same shape with the values of its nodes."""
        nodes = list(dict.fromkeys(_nodes(shape)))
        outcome = self.machine.asked_for(curves={str(i): node for i, node in enumerate(nodes)}).evaluate(self._varied)
        rows = [outcome.fields[str(i)][0] for i in range(len(nodes))]
        if not all(np.isfinite(row).any() for row in rows):
            raise NowhereDefinedError(Verdict(int(outcome.status[0])))
        return _with_values(shape, dict(zip(nodes, rows, strict=True)))


def _nodes(shape: Any) -> Iterator[Node]:
    """All nodes in a shape of records, lists and mappings."""
    if isinstance(shape, Node):
        yield shape
    elif isinstance(shape, (tuple, list, dict)):
        for part in shape.values() if isinstance(shape, dict) else shape:
            yield from _nodes(part)


def _with_values(shape: Any, values: Mapping[Node, np.ndarray]) -> Any:
    if isinstance(shape, Node):
        return values[shape]
    if isinstance(shape, dict):
        return {name: _with_values(part, values) for name, part in shape.items()}
    if not isinstance(shape, (tuple, list)):
        return shape
    parts = [_with_values(part, values) for part in shape]
    if isinstance(shape, Vector):
        return parts[0] + 1j * parts[1]
    make: Callable = type(shape)._make if hasattr(shape, "_make") else type(shape)
    return make(parts)
