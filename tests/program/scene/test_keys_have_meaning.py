"""Every key of every part of a scene changes something where it stands, or is refused there.

A key counts in each position: with the other keys that its part has, and under the input. It is given other values, one
after another; what may be asked of the machine (nodes of all fields and summaries, at some positions of the input) must
change with one of them, or all of them must be refused.
"""

import copy
import math
from collections.abc import Iterator
from typing import Literal, get_args, get_origin

import numpy as np
import pytest
from cam_samples import KNIFE
from driving_cams import SLIDING, SWINGING, changed
from element_samples import EVERY
from free_link_scenes import triad_data
from governor_samples import ENGINE, EVERY_GOVERNOR, PORTER
from graph_values import GraphValues
from machines import crank, four_bar, frame, on, prp, rpr, rrp
from noncircular_wheels import CHAIN, ELLIPSES
from pydantic import ValidationError
from racks import DOUBLER, LIFT, ON_CRANK
from rubbing_machines import yoke

from engine import Element, Mechanics, Scene, SceneError
from engine.cycle.measured import Measured
from engine.graph.nodes import Node
from engine.parts.skeleton import Part, _marked
from engine.quantities.expressions import Evaluation, VariantNumber, nodes_of
from engine.quantities.machine import register_of
from sweeps import read_study
from sweeps.study.bundled import bundled_studies

# Of the input's range; enough for windows of loads and for pieces of motion programs.
SHARES = np.linspace(0.013, 0.987, 13)


def slider_crank(**tables: dict) -> dict:
    scene = {
        "gravity": 9.81,
        "points": {"O": frame(0, 0), "P": frame(0.3, 0.3), "K": on("rod", 0.1, 0.03), "Q": frame(0.4, 0.0)},
        "guides": {"way": {"y": 0.01}},
        "input": crank(length=0.05, speed=5.0),
        "groups": {"g": rrp("B", ("rod", "A", 0.2), "ram", "way")},
        "bodies": {
            "rod_body": {"link": "rod", "mass": 2.0, "x": 0.1, "inertia": 0.01},
            "ram_body": {"link": "ram", "mass": 1.0, "y": 0.05},
        },
    }
    return scene | {key: {**scene.get(key, {}), **more} for key, more in tables.items()}


def limited(scene: dict) -> dict:
    scene["input"] |= {"start": 0.2, "stop": 3.0}
    return scene


def table(**own: object) -> dict:
    return {"type": "table", "interpolation": "linear"} | own


ANGLES = {"over_angle": [0.5, 1.5, 4.0], "moment": [5.0, 9.0, -3.0]}
TIMES = {"over_time": [0.1, 0.2, 0.4], "moment": [5.0, 9.0, -3.0]}
STROKE = {"slider": "ram", "on": "B", "angle": 0.3, "force": [7.0, 9.0, 3.0, 5.0]}
OF_SHAFT = {"shafts": {"s": {"geared_to": "crank", "ratio": 2.0}}}


def on_shaft(**own: object) -> dict:
    return slider_crank(**OF_SHAFT, moments={"load": {"on": "s"} | own})


def shaft(**own: object) -> dict:
    return slider_crank(
        shafts={"s": {"geared_to": "crank", "ratio": 2.0} | own},
        moments={"load": {"type": "constant", "on": "s", "moment": 3.0}},
    )


def body(**own: object) -> dict:
    return slider_crank(bodies={"one": {"link": "rod"} | own})


def wheel(**own: object) -> dict:
    return slider_crank() | {"flywheel": {"speed_fluctuation": 0.02, "wheel": own}}


def force(**own: object) -> dict:
    return slider_crank(forces={"load": own})


def law(**own: object) -> dict:
    masses = {"second_body": {"link": "second", "mass": 1.0, "x": 0.1}}
    second = {"type": "crank", "pivot": "C"} | own
    return slider_crank(points={"C": frame(0.5, 0.0)}, inputs={"second": second}, bodies=masses)


def rubbing(**own: object) -> dict:
    return slider_crank(friction={"f": {"coefficient": 0.1} | own})


def cylinder(**own: object) -> dict:
    gas = {"piston": "ram", "bore": 0.05, "clearance": 0.1, "intake": 1e5, "exhaust": 1.1e5, "peak": 4e6}
    scene = slider_crank(cylinders={"c": gas | own})
    scene["input"]["revolutions"] = 2 if own["type"] == "four_stroke" else 1
    return scene


def slide(**own: object) -> dict:
    second = {"second": {"type": "slider", "guide": "up"} | own}
    masses = {"second_body": {"link": "second", "mass": 1.0}}
    return slider_crank(guides={"up": {"x": 0.4, "angle": 1.0}}, inputs=second, bodies=masses)


def brake(**own: object) -> dict:
    return on_shaft(force=10.0, friction=0.3, **own)


def program(key: str) -> dict:
    return {
        "up": {"type": "rise", "law": "cycloidal", "angle": 2.0, key: 0.025},
        "back": {"type": "return", "law": "3-4-5", "angle": 2.0},
        "low": {"type": "dwell"},
    }


ROWS = {"over_angle": [0.0, 2.0, 4.0], "lift": [0.0, 0.02, 0.01]}
BAND = {"type": "band_brake", "radius": 0.1, "lever_arm": 0.5, "slack_arm": 0.1}
TWO_GUIDES = {
    "points": {"O": frame(0, 0)},
    "input": crank(length=0.05),
    "guides": {"a": {"angle": 0.1}, "b": {"link": "crank", "x": 0.05, "angle": 1.5}},
    "groups": {"g": prp("B", ("one", "a", 0.0), ("other", "b", 0.0))},
    "bodies": {"m": {"link": "one", "mass": 2.0}},
}
RING = {"type": "ring", "diameter": 0.2, "inner_diameter": 0.1, "thickness": 0.01}
FLAT = {"type": "translating", "link": "tappet", "guide": "way", "contact": "flat"}
WANTED = {"over_angle": [0.2, 1.5, 4.0]}
ARMS = {"type": "arms", "arm_area": 1e-3, "hub_diameter": 0.05, "hub_width": 0.04}
LINES = {"piston": "ram", "bore": 0.05, "suction": 1e5, "discharge": 5e5}
SCENES = {
    "four_bar": four_bar(1, K=on("coupler", 0.4, 0.1)) | {"bodies": {"a": {"link": "coupler", "mass": 1.0, "x": 0.4}}},
    "range": limited(slider_crank(moments={"load": table(on="rod", **ANGLES), "clock": table(on="rod", **TIMES)})),
    "over_angle": slider_crank(moments={"load": table(on="rod", **ANGLES)}),
    "over_stroke": force(**table(**STROKE, over_stroke=[0.16, 0.18, 0.2, 0.22])),
    "from_low": force(**table(**STROKE, measured_from="low end", over_stroke=[0.01, 0.02, 0.05, 0.07])),
    "against": force(type="against_motion", on="K", force=10.0),
    "against_along": force(type="against_motion", on="K", angle=0.2, force=10.0),
    "drag": force(type="linear_drag", on="K", coefficient=10.0),
    "power_drag": force(type="power_drag", on="K", force=5.0, at_speed=0.3, exponent=1.5),
    "formula": force(type="formula", on="K", force="k * K.x", numbers={"k": "3 N/m"}),
    "constant": force(type="constant", on="K", angle=0.3, force=10.0),
    "bare_shaft": shaft(inertia=0.1),
    "shaft": shaft(pivot="Q"),
    "toothed_shaft": shaft(pivot="Q", pressure_angle=0.3),
    "lossy_shaft": shaft(efficiency=0.9),
    "shaft_on_rod": shaft(geared_to="rod"),
    "moment": on_shaft(type="constant", moment=3.0),
    "resistance": on_shaft(type="against_motion", moment=3.0),
    "fan": on_shaft(type="quadratic_drag", coefficient=0.3),
    "hoist": on_shaft(type="hoist", mass=3.0, drum_radius=0.1),
    "vehicle": on_shaft(type="vehicle", mass=3.0, wheel_radius=0.1),
    "rolling": on_shaft(type="vehicle", mass=3.0, wheel_radius=0.1, rolling=0.1),
    "climbing": on_shaft(type="vehicle", mass=3.0, wheel_radius=0.1, slope=0.1, drag_area=0.3),
    "conveyor": on_shaft(type="conveyor", load_mass=3.0, drum_radius=0.1),
    "long_conveyor": on_shaft(type="conveyor", load_mass=3.0, drum_radius=0.1, friction=0.1),
    "lift": on_shaft(type="conveyor", load_mass=3.0, drum_radius=0.1, incline=0.1),
    "dc": on_shaft(type="dc_motor", no_load_speed=20.0, stall_moment=10.0),
    "induction": on_shaft(type="induction_motor", synchronous_speed=20.0, breakdown_moment=10.0, breakdown_slip=0.2),
    "torsion": slider_crank(moments={"load": {"type": "torsion_spring", "on": "rod", "stiffness": 3.0}}),
    "spring": slider_crank(springs={"load": {"between": ["P", "B"], "stiffness": 100.0}}),
    "damper": slider_crank(springs={"load": {"between": ["P", "B"], "damping": 10.0}}),
    "point_mass": body(mass=1.0, x=0.1),
    "rod": body(mass=1.0, shape={"type": "rod", "length": 0.2}),
    "dense_rod": body(density=7000.0, shape={"type": "rod", "length": 0.2, "area": 1e-3}),
    "disc": body(mass=1.0, shape={"type": "disc", "diameter": 0.2}),
    "dense_ring": body(density=7000.0, shape=RING),
    "plate": body(mass=1.0, shape={"type": "plate", "length": 0.2, "width": 0.1}),
    "swing": body(mass=1.0, x=0.1, swing={"type": "compound", "period": 1.0, "distance": 0.1}),
    "rim": wheel(type="rim", diameter=1.0, strength=1e8),
    "free_rim": wheel(type="rim"),
    "heavy_rim": wheel(type="rim", density=7000.0, rim_speed_limit=20.0),
    "disc_wheel": wheel(type="disc", diameter=1.0),
    "arms": wheel(**ARMS, diameter=1.0),
    "mean_rim": wheel(type="mean rim", mean_diameter=1.0),
    "even_input": law(ratio=1),
    "wavy_input": law(harmonics={"one": {"order": 1, "cosine": 0.3}}),
    "pump": slider_crank(cylinders={"c": LINES | {"type": "pump"}}),
    "compressor": slider_crank(cylinders={"c": LINES | {"type": "compressor", "clearance": 0.1}}),
    "base": slider_crank(base={"acceleration_x": 1.0}),
    "wanted_path": slider_crank(wanted={"w": {"type": "path", "point": "K", "x": [0.1, 0.12], "y": [0.02, 0.03]}}),
    "wanted_slide": slider_crank(wanted={"w": {"type": "slider", "of": "ram", "slide": [0.1, 0.2, 0.1], **WANTED}}),
    "wanted_angle": slider_crank(wanted={"w": {"type": "link", "of": "rod", "angle": [0.1, 0.4, 0.2], **WANTED}}),
    "doubler": DOUBLER,
    "lossy_doubler": changed(DOUBLER, pinions__wheel__efficiency=0.9, racks__table__efficiency=0.9),
    "lifted": LIFT,
    "rack_on_crank": ON_CRANK,
    "ellipses": ELLIPSES,
    "chain": CHAIN,
    "cam": changed(SLIDING, cams__cam__sections=program("lift")),
    "flat_cam": changed(SLIDING, cams__cam__sections=program("lift"), cams__cam__follower=FLAT),
    "tabled_cam": changed(SLIDING, cams__cam__sections=None, cams__cam__table=ROWS),
    "swinging_cam": SWINGING,
    "journal": rubbing(pair="g.inner", diameter=0.02),
    "worn_journal": rubbing(pair="g.inner", diameter=0.02, contact="worn in"),
    "rule_journal": rubbing(pair="g.inner", diameter=0.02, above_prismatic=0.3),
    "way": rubbing(pair="g.second"),
    "vee": rubbing(pair="g.second", form="vee", vee_angle=1.0),
    "stribeck": rubbing(pair="g.second", static_coefficient=0.2, stribeck_speed=0.1),
    "yoke": yoke(0.3, 0.1),
    "two_guides": TWO_GUIDES,
    "four_stroke": cylinder(type="four_stroke"),
    "two_stroke": cylinder(type="two_stroke", port=0.8),
    "block_brake": brake(type="block_brake", radius=0.1),
    "disc_brake": brake(type="disc_brake", inner_radius=0.05, outer_radius=0.1),
    "band_brake": brake(**BAND, wrap=3.0),
    "lined_band": brake(**BAND, blocks=8, block_angle=0.3),
    "bifilar": body(mass=1.0, x=0.1, swing={"type": "bifilar", "period": 1.0, "spacing": 0.1, "length": 1.0}),
    "trifilar": body(mass=1.0, x=0.1, swing={"type": "trifilar", "period": 1.0, "radius": 0.1, "length": 1.0}),
    "replaced": body(mass=1.0, x=0.1, inertia=0.004, replace={"type": "dynamic", "at": ["A", "K"], "mass": 0.2}),
    "statically": body(mass=1.0, x=0.1, inertia=0.004, replace={"type": "static", "at": ["A", "B"]}),
    "slide": slide(harmonics={"one": {"order": 1, "cosine": 0.03}}),
    "slide_sections": slide(sections=program("lift")),
    "slide_table": slide(table=ROWS),
    "swing_sections": law(sections=program("swing")),
    "over_time_input": law(period=2 * math.pi / 5, harmonics={"one": {"order": 1, "cosine": 0.3}}),
    "even_in_time": law(speed=5.0),
    "triad": triad_data(),
    "formula_moment": on_shaft(type="formula", moment="k * omega", numbers={"k": "3 N m s"}),
    "drag_moment": on_shaft(type="linear_drag", coefficient=1.0),
    "power_moment": on_shaft(type="power_drag", moment=1.0, at_speed=2.0, exponent=1.5),
    "square_drag": force(type="quadratic_drag", on="K", coefficient=10.0),
    "planet": slider_crank(
        shafts={"s": {"geared_to": "frame", "carrier": "crank", "pivot": "A", "ratio": 2.0}},
        bodies={"p": {"link": "s", "mass": 1.0, "x": 0.03}},
    ),
    "slider": {
        "points": {"D": frame(0.05, 0.25)},
        "guides": {"way": {"angle": 0.2}},
        "input": {"type": "slider", "link": "piston", "guide": "way", "point": "P"}
        | {"start": 0.0, "stop": 0.1, "speed": 0.3},
        "groups": {"g": rpr(("block", "P"), ("lever", "D"))},
        "bodies": {"l": {"link": "lever", "mass": 1.0, "x": 0.1}},
    },
}
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
# What counts in regimes, or names something.
IN_MOTION = {"RunRegime", "SteadyRegime", "Instants", "FrictionClutch", "FluidCoupling", "Balance"}
OTHERWISE = {"title", "source", "type", "regimes", "elements"}


class Effects:
    """All that may be asked of a scene, as numbers."""

    def __init__(self, scene: Scene) -> None:
        mechanics = Mechanics(scene)
        self._values = GraphValues(scene, mechanics.graph)
        register, values = register_of(mechanics), self._values
        fields = {name: list(nodes_of(field.curve())) for name, field in register.fields.items()}
        summaries = {name: summary.expression() for name, summary in register.summaries.items()}
        nodes = {name: list(nodes_of(summary)) for name, summary in summaries.items()}
        every = list(dict.fromkeys(node for some in (*fields.values(), *nodes.values()) for node in some))
        q = values.first + SHARES * (values.last - values.first)
        self._known: dict[Node, np.ndarray] = dict(zip(every, values(every, q), strict=True))
        self.found = {name: [self._known[node] for node in some] for name, some in (fields | nodes).items()}
        with np.errstate(all="ignore"):
            evaluated = Evaluation(self._measured)
            for name, summary in summaries.items():
                self.found[f"{name} as a number"] = [np.asarray(evaluated(summary).value) * np.ones(1)]

    def _measured(self, asked: object) -> Measured:
        """Some number that stands for a measurement: what a summary makes of it may depend on the scene, too."""
        if isinstance(asked, VariantNumber):
            return Measured(self._known[asked.number][:1])
        parts = [np.abs(self._known[node]).mean() for node in nodes_of(asked)]
        return Measured(np.full(1, 1.0 + sum(parts)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Effects) or self.found.keys() != other.found.keys():
            return False
        return all(
            len(some) == len(more)
            and all(np.allclose(a, b, rtol=1e-9, atol=0.0, equal_nan=True) for a, b in zip(some, more, strict=True))
            for some, more in zip(self.found.values(), other.found.values(), strict=True)
        )

    __hash__ = None


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


def is_ignored(data: dict, path: tuple[str, ...], values: list, before: Effects) -> bool:
    """Whether values of a key are accepted, and none of them changes anything."""
    accepted = False
    for value in values:
        try:
            after = Effects(Scene.model_validate(put(data, path, value)))
        except (ValidationError, SceneError):
            continue
        if after != before:
            return False
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
            if is_ignored(data, (*path, key), values, before):
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


def element_scenes() -> dict[str, Scene]:
    """Elements of all kinds: samples, and those of bundled studies that need no machine."""
    governed = {"governed": PORTER | {"damping": 600.0, "engine": ENGINE}}
    governed |= {"followed": PORTER | {"damping": 600.0, "engine": ENGINE | {"duration": 2.0}}}
    every = EVERY | EVERY_GOVERNOR | governed | {"knife": KNIFE | {"sections": program("lift")}}
    samples = {name: Scene.model_validate({"elements": {"e": e}}) for name, e in every.items()}
    studies = {name: read_study(path).scene for name, path in bundled_studies().items()}
    return samples | {f"study {name}": s for name, s in studies.items() if s.elements and s.input is None}


@pytest.mark.parametrize("scene", [pytest.param(scene, id=name) for name, scene in element_scenes().items()])
def test_key_of_an_element__changes_something_or_is_refused(scene):
    ignored = []
    for name, element in scene.elements.items():
        data, before = element.model_dump(exclude_unset=True, exclude_none=True), element.own_values()
        for path, part in parts_of(element):
            for key in set(type(part).model_fields) - OTHERWISE:
                position = (type(part).__name__, key, type(element).__name__, *sorted(part.model_fields_set))
                if position in SEEN or position[:2] in NO_EFFECT:
                    continue
                SEEN.add(position)
                found = [values_with(name, put(data, (*path, key), value)) for value in other_values(part, key)]
                accepted = [values for values in found if values is not None]
                if accepted and all(is_same(values, before) for values in accepted):
                    ignored.append(".".join((name, *path, key)))
    assert not ignored


def values_with(name: str, data: dict) -> dict[str, float] | None:
    """Results of an element; None where it is refused."""
    try:
        return Scene.model_validate({"elements": {name: data}}).elements[name].own_values()
    except (ValidationError, SceneError):
        return None


def is_same(some: dict[str, float], more: dict[str, float]) -> bool:
    return some.keys() == more.keys() and all(
        np.allclose(some[key], more[key], rtol=1e-9, atol=0.0, equal_nan=True) for key in some
    )


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


@pytest.mark.parametrize("key", [*RUN_KEYS, *RUN_ENDS])
@pytest.mark.parametrize("name", ["constant", "range", "slider"])
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
