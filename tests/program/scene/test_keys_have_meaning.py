"""Every key of every part of a scene changes something where it stands, or is refused there.

A key counts in each position: with the other keys that its part has, and under the input. It is given other values, one
after another; what may be asked of the machine (nodes of all fields and summaries, at some positions of the input) must
change with one of them, or all of them must be refused.
"""

import copy
from collections.abc import Callable, Iterable, Iterator
from functools import cached_property
from typing import Literal, get_args, get_origin

import numpy as np
import pytest
from cam_samples import KNIFE
from each_case import each
from element_samples import EVERY
from governor_samples import ENGINE, EVERY_GOVERNOR, PORTER
from graph_values import GraphValues
from scenes_of_parts import SCENES, program

from engine import Element, Mechanics, Scene, SceneError
from engine.cycle.measured import Measured
from engine.graph.nodes import Node
from engine.parts.skeleton import Part, _marked
from engine.quantities.all_chapters import register_of
from engine.quantities.expressions import VariantNumber, evaluated, nodes_of
from sweeps import read_study
from sweeps.study.bundled import bundled_studies

# Of the input's range; enough for windows of loads and for pieces of motion programs.
SHARES = np.linspace(0.013, 0.987, 13)


# What describes a thing itself and has no effect in some motion, or counts in regimes alone.
NO_EFFECT = {
    ("Point", "x"): "of a mark that nothing hangs on",
    ("Point", "y"): "of a mark that nothing hangs on",
    ("Body", "inertia"): "of what slides",
    ("Body", "x"): "of what slides, under no force across",
    ("TableMoment", "role"): "where there is no cycle, works are those of regimes",
    ("Scene", "inertia_in_reactions"): "where nothing has a mass",
    ("VehicleMoment", "gravity"): "on the level, without rolling resistance",
    ("ConveyorMoment", "gravity"): "on the level, without friction",
    ("VehicleMoment", "role"): "where it resists by its mass alone",
    ("ConveyorMoment", "role"): "where it resists by its mass alone",
    ("EngineElement", "spacing"): "of cylinders on one throw, which gives couples all the same: none",
    ("TableGovernor", "sleeve_mass"): "where the controlling force is measured, without an engine",
    ("CamElement", "cutter_radius"): "of the cutter's path, which is drawn and exported",
    ("RunRegime", "at_most"): "of a run that ends before",
    ("Scene", "gravity"): "where nothing has a mass",
    ("DrivingCam", "closure"): "on a verdict alone",
    ("FourStroke", "firing_angle"): "until the next dead centre",
    ("PairFriction", "length"): "of a slider that doesn't tilt",
    ("Near", "x"): "as long as the same mode is nearest",
    ("Near", "y"): "as long as the same mode is nearest",
}
# What counts in regimes or in warnings, or names something.
IN_MOTION = {"RunRegime", "SteadyRegime", "Instants", "FrictionClutch", "FluidCoupling", "Balance", "WarningLimits"}
OTHERWISE = {"units", "title", "source", "type", "regimes", "limits", "elements"}


class Effects:
    """All that may be asked of a scene, as numbers; summaries only where fields don't differ already."""

    def __init__(self, scene: Scene) -> None:
        mechanics = Mechanics(scene)
        self._values, self._register = GraphValues(scene, mechanics.graph), register_of(mechanics)
        self._known: dict[Node, np.ndarray] = {}

    def _numbers(self, asked: dict[str, list[Node]]) -> dict[str, list[np.ndarray]]:
        every = list(dict.fromkeys(node for some in asked.values() for node in some))
        q = self._values.first + SHARES * (self._values.last - self._values.first)
        self._known |= dict(zip(every, self._values(every, q), strict=True))
        return {name: [self._known[node] for node in some] for name, some in asked.items()}

    @cached_property
    def fields(self) -> dict[str, list[np.ndarray]]:
        return self._numbers({name: list(nodes_of(field.curve())) for name, field in self._register.fields.items()})

    @cached_property
    def summaries(self) -> dict[str, list[np.ndarray]]:
        summaries = {name: summary.expression() for name, summary in self._register.summaries.items()}
        found = self._numbers({name: list(nodes_of(summary)) for name, summary in summaries.items()})
        with np.errstate(all="ignore"):
            known: dict = {}
            for name, summary in summaries.items():
                found[name].append(np.asarray(evaluated(summary, self._measured, known).value) * np.ones(1))
        return found

    def _measured(self, asked: object) -> Measured:
        """Some number that stands for a measurement: what a summary makes of it may depend on the scene, too."""
        if isinstance(asked, VariantNumber):
            return Measured(self._known[asked.number][:1])
        parts = [np.abs(self._known[node]).mean() for node in nodes_of(asked)]
        return Measured(np.full(1, 1.0 + sum(parts)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Effects):
            return False
        return are_equal(self.fields, other.fields) and are_equal(self.summaries, other.summaries)

    __hash__ = None


def are_equal(some: dict[str, list[np.ndarray]], more: dict[str, list[np.ndarray]]) -> bool:
    def in_a_row(found: dict[str, list[np.ndarray]]) -> np.ndarray:
        return np.concatenate([np.ravel(part) for name in some for part in found[name]] or [np.zeros(0)])

    if {name: len(values) for name, values in some.items()} != {name: len(values) for name, values in more.items()}:
        return False
    return np.allclose(in_a_row(some), in_a_row(more), rtol=1e-9, atol=0.0, equal_nan=True)


def parts_of(part: Part, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Part]]:
    """A part and all within it, with their paths."""
    yield path, part
    for key in type(part).model_fields:
        value = getattr(part, key)
        inner = {(key,): value} if isinstance(value, Part) else {}
        if isinstance(value, dict):
            inner = {(key, name): one for name, one in value.items() if isinstance(one, Part)}
        for here, one in inner.items():
            yield from parts_of(one, path + here)


def other_values(part: Part, key: str) -> list:
    """Other values of a key: choices, counts and numbers; none where it names something or is a table."""
    kinds, pending, value = [], [type(part).model_fields[key].annotation], getattr(part, key)
    while pending:
        kind = pending.pop()
        kinds += get_args(kind) if get_origin(kind) is Literal else [kind] if kind in (bool, int, float) else []
        pending += [] if get_origin(kind) is Literal else get_args(kind)
    if bool in kinds:
        return [not value]
    if int in kinds:
        return [(value or 1) + 1, (value or 1) + 2]
    if _marked(type(part), key)[0] is not None:
        return [value * 1.1 + 0.013, value * 0.9 - 0.013] if isinstance(value, float) else [0.3, 0.02, 1.5, 30.0]
    return [kind for kind in kinds if not isinstance(kind, type) and kind != value]


def put(data: dict, path: tuple[str, ...], value: object) -> dict:
    data = copy.deepcopy(data)
    inner = data
    for key in path[:-1]:
        inner = inner.setdefault(key, {})
    inner[path[-1]] = value
    return data


def is_ignored(changed: Iterable[dict], is_same: Callable[[dict], bool]) -> bool:
    """Whether tables with a key changed are accepted, and none of them changes anything."""
    accepted = False
    for data in changed:
        try:
            if not is_same(data):
                return False
        except SceneError:
            continue
        accepted = True
    return accepted


SEEN: set[tuple] = set()


@pytest.mark.parametrize("name", SCENES)
def test_key__changes_something_or_is_refused(name):
    data, ignored = SCENES[name], []
    scene = Scene.model_validate(data)
    before = Effects(scene)
    for path, part in parts_of(scene):
        for key in set(type(part).model_fields) - OTHERWISE:
            kind, values = type(part).__name__, other_values(part, key)
            position = (kind, key, repr(part if path else sorted(part.model_fields_set)), repr(scene.input))
            if not values or position in SEEN or (kind, key) in NO_EFFECT:
                continue
            SEEN.add(position)
            changed = (put(data, (*path, key), value) for value in values)
            if is_ignored(changed, lambda data: Effects(Scene.model_validate(data)) == before):
                ignored.append(".".join((*path, key)))
    assert not ignored


def models() -> set[type[Part]]:
    """Every part that a scene may have, but machine elements."""
    found, pending = set(), [Scene]
    while pending:
        kind = pending.pop()
        if isinstance(kind, type) and issubclass(kind, Part) and kind not in found and kind is not Element:
            found.add(kind)
            pending += [field.annotation for field in kind.model_fields.values()]
        pending += get_args(kind)
    return found


def test_every_part__stands_in_one_of_the_scenes():
    tried = {type(part) for data in SCENES.values() for _, part in parts_of(Scene.model_validate(data))}
    assert {kind.__name__ for kind in models() - tried} == IN_MOTION


def element_scenes() -> list[Scene]:
    """Elements of all kinds: samples, and those of bundled studies that need no machine."""
    governed = {"governed": PORTER | {"damping": 600.0, "engine": ENGINE}}
    # So small a change of load that it depends on the band whether the engine settles.
    slight = ENGINE | {"new_load": 280.0, "duration": 0.6}
    governed |= {"followed": PORTER | {"damping": 600.0, "engine": slight}}
    every = EVERY | EVERY_GOVERNOR | governed | {"knife": KNIFE | {"sections": program("lift")}}
    studies = [read_study(path).scene for path in bundled_studies().values()]
    samples = [Scene.model_validate({"elements": {name: e}}) for name, e in every.items()]
    return samples + [scene for scene in studies if scene.elements and scene.input is None]


def test_key_of_an_element__changes_something_or_is_refused():
    ignored = []
    for name, element in (named for scene in element_scenes() for named in scene.elements.items()):
        data, before = element.model_dump(exclude_unset=True, exclude_none=True), values_of(element)

        def is_same(data: dict, name: str = name, before: dict = before) -> bool:
            return are_equal(values_of(Scene.model_validate({"elements": {name: data}}).elements[name]), before)

        for path, part in parts_of(element):
            for key in set(type(part).model_fields) - OTHERWISE:
                position = (type(part).__name__, key, type(element).__name__, *sorted(part.model_fields_set))
                if position in SEEN or position[:2] in NO_EFFECT:
                    continue
                SEEN.add(position)
                changed = (put(data, (*path, key), value) for value in other_values(part, key))
                if is_ignored(changed, is_same):
                    ignored.append(".".join((name, *path, key)))
    assert not ignored


def values_of(element: Element) -> dict[str, list[float]]:
    return {name: [value] for name, value in element.own_values().items()}


# Keys of a run, and what each has a meaning with.
RUN_KEYS = {
    "from_speed": (2.0, "crank"),
    "from_angle": (0.3, "crank"),
    "from_velocity": (0.1, "slider"),
    "from_position": (0.01, "slider"),
    "from_shaft_speed": (2.0, "coupling"),
}
RUN_ENDS = {"speed": (9.0, "crank"), "velocity": (9.0, "slider")}
RUN_ENDS |= {"end_of_range": (True, "range"), "lock_up": (True, "coupling")}


@each("key", [*RUN_KEYS, *RUN_ENDS])
@each("name", ["constant", "range", "slider"])
def test_key_of_a_run__is_refused_where_it_means_nothing(name, key):
    value, needs = (RUN_KEYS | RUN_ENDS)[key]
    has = {"constant": {"crank"}, "range": {"crank", "range"}, "slider": {"slider", "range"}}[name]
    regime = {"type": "run", key: value} | ({} if key in RUN_ENDS else {"time": 1.0})
    scene = SCENES[name] | {"regimes": {"go": regime}}
    if needs in has:
        assert Mechanics(Scene.model_validate(scene))
        return
    with pytest.raises(SceneError, match=key):
        Mechanics(Scene.model_validate(scene))
