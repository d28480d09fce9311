"""Machines that plans are drawn of: the templates, one of each kind of symbol, guides that turn, gears."""

from functools import cache

from drawn_machines import GALLERY, crank, four_bar

from engine import Scene
from engine.scene.pairs import pairs
from sweeps.pictures.plans import MachineCycle
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates, templates

PRP = Scene.model_validate(
    {
        "points": {"O": {"x": 0, "y": 0}, "D": {"x": 0.22, "y": 0.01}},
        "guides": {"bar": {"link": "rocker", "x": 0.05, "angle": 0.3}, "way": {"y": -0.05, "angle": 0.1}},
        "gravity": 9.81,
        "input": crank(),
        "groups": {
            "g": {
                "type": "RRR",
                "inner": "B",
                "first": {"link": "rod", "joint": "A", "length": 0.2},
                "second": {"link": "rocker", "joint": "D", "length": 0.15},
            },
            "h": {
                "type": "PRP",
                "inner": "F",
                "first": {"link": "sleeve", "guide": "bar", "offset": 0.02},
                "second": {"link": "ram", "guide": "way", "offset": -0.01},
            },
        },
        "bodies": {"ram": {"link": "ram", "mass": 3.0}, "sleeve": {"link": "sleeve", "mass": 1.0, "inertia": 0.002}},
    }
)
GEARED_TO_A_ROCKER = four_bar(
    shafts={"rotor": {"geared_to": "rocker", "ratio": -3.0, "inertia": 0.02}},
    bodies={"rocker": {"link": "rocker", "mass": 2.0, "x": 0.07, "inertia": 0.01}},
    gravity=9.81,
)
# A yoke on a guide that turns with the rocker, its block pivoted on the frame.
TURNING_YOKE = four_bar(
    points={
        "O": {"x": 0, "y": 0},
        "D": {"x": 0.22, "y": 0.01},
        "G": {"x": 0.3, "y": 0.1},
        "T": {"link": "yoke", "x": 0.04, "y": -0.03},
    },
    guides={"bar": {"link": "rocker", "x": 0.05, "y": 0.02, "angle": 0.3}},
    groups={
        **four_bar().model_dump(exclude_none=True)["groups"],
        "h": {
            "type": "RPP",
            "first": {"link": "block", "joint": "G"},
            "second": {"link": "yoke", "guide": "bar", "slot_angle": 1.4},
        },
    },
    bodies={"yoke": {"link": "yoke", "mass": 2.0, "x": 0.05, "y": 0.02, "inertia": 0.004}},
    gravity=9.81,
)
SCENES = {name: read_scene(bundled_templates()[name]) for name in templates()}


def has_plans(scene):
    """Plans are drawn of dyads, without cams, second inputs, planets, racks and forces of teeth."""
    toothed = any(shaft.carrier or shaft.pressure_angle is not None for shaft in scene.shafts.values())
    toothed = toothed or scene.noncircular_wheels or scene.racks or scene.pinions
    return scene.input is not None and not (scene.links or scene.cams or scene.inputs or toothed)


MECHANISMS = [name for name, scene in SCENES.items() if has_plans(scene)]
MACHINES = {name: SCENES[name] for name in MECHANISMS} | GALLERY
MACHINES |= {"PRP": PRP, "geared to a rocker": GEARED_TO_A_ROCKER, "turning yoke": TURNING_YOKE}
MACHINES |= {"without inertia": GEARED_TO_A_ROCKER.model_copy(update={"inertia_in_reactions": False})}
CLOSED = [name for name, scene in MACHINES.items() if scene.input.type == "crank" and scene.input.start is None]


def rubbing(name, length=None):
    """A machine with friction in all of its pairs, its sliders of a length."""
    scene, friction = MACHINES[name], {}
    for i, pair in enumerate(pairs(scene)):
        own = {"diameter": 0.01 + 0.002 * i} if pair.kind == "revolute" else {}
        own |= {"length": length} if pair.kind == "prismatic" and length else {}
        friction[f"f{i}"] = {"pair": pair.name, "coefficient": 0.05 + 0.02 * i, **own}
    return Scene.model_validate(scene.model_dump(exclude_none=True, exclude_unset=True) | {"friction": friction})


@cache
def cycle_of(name):
    return MachineCycle(MACHINES[name])


def poses(name):
    cycle = cycle_of(name)
    return [cycle.at(cycle.motion.q[k]) for k in (77, 301, 655)]
