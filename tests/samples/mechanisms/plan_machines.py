"""Machines that plans are drawn of: the templates, one of each kind of symbol, guides that turn, gears."""

from functools import cache

import numpy as np
from drawn_machines import GALLERY, crank, four_bar
from driving_cams import SLIDING, SWINGING, changed
from five_bars import JOINED
from free_link_scenes import free_link_scene
from geared_links import CARDAN, TRAIN
from machines import prp, rpp, rrr
from noncircular_wheels import CHAIN, ELLIPSES
from racks import LIFT, ON_CRANK

from engine import Scene
from engine.scene.pairs import pairs
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.plans.forces.loads import loads_on_links
from sweeps.pictures.plans.pose import pose_at
from sweeps.text.scene_text import read_scene
from sweeps.text.templates import bundled_templates, templates

# A plan adds a few vectors of the engine's, each good to some tens of roundings of the largest in it.
EXACT = 1e-12

PRP = Scene.model_validate(
    {
        "points": {"O": {"x": 0, "y": 0}, "D": {"x": 0.22, "y": 0.01}},
        "guides": {"bar": {"link": "rocker", "x": 0.05, "angle": 0.3}, "way": {"y": -0.05, "angle": 0.1}},
        "gravity": 9.81,
        "input": crank(),
        "groups": {
            "g": rrr("B", ("rod", "A", 0.2), ("rocker", "D", 0.15)),
            "h": prp("F", ("sleeve", "bar", 0.02), ("ram", "way", -0.01)),
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
    groups={**four_bar().model_dump(exclude_none=True)["groups"], "h": rpp(("block", "G"), ("yoke", "bar"), 1.4)},
    bodies={"yoke": {"link": "yoke", "mass": 2.0, "x": 0.05, "y": 0.02, "inertia": 0.004}},
    gravity=9.81,
)
SCENES = {name: read_scene(bundled_templates()[name]) for name in templates()}


def is_of_dyads(scene):
    """Whether a mechanism has neither free links nor cams, second inputs, planets, racks and teeth with forces."""
    toothed = any(shaft.carrier or shaft.pressure_angle is not None for shaft in scene.shafts.values())
    toothed = toothed or scene.noncircular_wheels or scene.racks or scene.pinions
    return not (scene.links or scene.cams or scene.inputs or toothed)


MECHANISMS = [name for name, scene in SCENES.items() if scene.input is not None and is_of_dyads(scene)]
MACHINES = {name: SCENES[name] for name in MECHANISMS} | GALLERY
MACHINES |= {"PRP": PRP, "geared to a rocker": GEARED_TO_A_ROCKER, "turning yoke": TURNING_YOKE}
MACHINES |= {"without inertia": GEARED_TO_A_ROCKER.model_copy(update={"inertia_in_reactions": False})}
_LOSING = {"pressure_angle": "20 deg", "efficiency": 0.95}
_TRAIN = changed(TRAIN, input__revolutions=5, gravity=9.81)
_TRAIN = changed(_TRAIN, shafts__moon__pressure_angle="25 deg", shafts__sun__inertia=0.01)
_TRAIN["shafts"]["planet"] |= _LOSING
_TRAIN["moments"] = {"load": {"type": "linear_drag", "on": "planet", "coefficient": 0.4}}
_RUBBING_CAM = changed(SWINGING, gravity=9.81, shafts__camshaft__efficiency=0.9, shafts__camshaft__inertia=0.001)
_RUBBING_CAM["friction"] = {
    "contact": {"pair": "cam.contact", "coefficient": 0.1, "diameter": "8 mm"},
    "pivot": {"pair": "cam.pivot", "coefficient": 0.1, "diameter": "12 mm"},
}
_FLAT_ARM = changed(SWINGING, cams__cam__follower={
    "type": "oscillating", "link": "arm", "pivot": "Q", "contact": "flat", "mode": -1,
})  # fmt: skip
_KNIFE_EDGE = changed(SLIDING, cams__cam__follower={
    "type": "translating", "link": "tappet", "guide": "way", "contact": "knife edge",
})  # fmt: skip
# Beside the crank one link is turned by a law, driven by the crank, and one slides on it with a drive of its own.
_SERVOS = JOINED | {
    "guides": {"bar": {"link": "second", "x": 0.01, "y": 0.03, "angle": 0.3}},
    "inputs": {
        "second": {
            "type": "crank",
            "pivot": "C",
            "ratio": -1,
            "drive": "crank",
            "harmonics": {"one": {"order": 1, "cosine": 0.2}},
        },
        "ram": {"type": "slider", "guide": "bar", "harmonics": {"one": {"order": 2, "sine": 0.02}}},
    },
    "bodies": JOINED["bodies"] | {"ram_body": {"link": "ram", "mass": 0.5, "x": 0.01, "inertia": 0.001}},
}
_LOSING_RACKS = changed(LIFT, pinions__gear__efficiency=0.9, racks__post__efficiency=0.8)
_LOSING_WHEELS = changed(CHAIN, noncircular_wheels__middle__efficiency=0.9, noncircular_wheels__last__efficiency=0.8)
HIGHER = {
    "planets": _TRAIN,
    "cardan circles": CARDAN,
    "racks": _LOSING_RACKS,
    "rack on the crank": ON_CRANK,
    "ellipses": ELLIPSES,
    "wheels that pass moments": _LOSING_WHEELS,
    "roller": SLIDING,
    "edge": _KNIFE_EDGE,
    "rubbing cam": _RUBBING_CAM,
    "flat arm": _FLAT_ARM,
    "servos": _SERVOS,
}
HIGHER = {name: Scene.model_validate(data) for name, data in HIGHER.items()}
# A group that begins with a special point, and one that has none and slides; both rub.
_FREE_FRICTION = {
    "three bars": {"pair": "lower.C", "coefficient": 0.2, "diameter": 0.05},
    "sliding plate": {"pair": "plate.slot", "coefficient": 0.2, "length": 0.1},
}
FREE = {
    name: Scene.model_validate(free_link_scene(name).model_dump(exclude_unset=True) | {"friction": {"one": friction}})
    for name, friction in _FREE_FRICTION.items()
}
EVERY = MACHINES | HIGHER | FREE
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
def motion_of(name):
    return DrawnMotion(EVERY[name])


def poses(name):
    motion = motion_of(name)
    return [pose_at(motion, motion.q[k]) for k in (77, 301, 655)]


def moment_about(place, loads):
    """Moment of loads on a link about a place [N·m]."""
    return sum(load.moment + ((load.at - place).conjugate() * load.force).imag for load in loads)


def largest(plan):
    return max(map(abs, plan.images.values()), default=0.0)


def assert_legs_meet(plan, bound=EXACT):
    """In the images of the points that they lead to."""
    for leg in plan.legs:
        end = plan.images.get(leg.start, 0j) + sum(step.vector for step in leg.steps)
        assert abs(end - plan.images.get(leg.end, 0j)) < bound * largest(plan), leg


def assert_in_equilibrium(pose, bound=EXACT):
    """Every link, under its loads."""
    on_links = loads_on_links(pose)
    scale = max([abs(load.force) for loads in on_links.values() for load in loads], default=0.0)
    size = abs(np.ptp(np.concatenate(list(pose.motion.points.values()))))
    for link, loads in on_links.items():
        # A few roundings of the largest force, and of its moment over the size of the mechanism, times what the
        # transmission of forces enlarges them by: ten and more near the ends of a swing.
        least = max([scale * size, *(abs(load.moment) for load in loads)])
        assert abs(sum(load.force for load in loads)) <= bound * scale
        assert abs(moment_about(pose.origin(link).place, loads)) <= bound * least, link
