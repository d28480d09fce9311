"""Cams for tests, as data of a scene."""

from copy import deepcopy

from engine import ElementsAlone, Scene

SECTIONS = {
    "out": {"type": "rise", "law": "modified sine", "angle": "100 deg", "lift": "20 mm"},
    "rest": {"type": "dwell", "angle": "40 deg"},
    "back": {"type": "return", "law": "cycloidal", "angle": "110 deg"},
    "low": {"type": "dwell"},
}
ROLLER = {
    "type": "cam",
    "base_radius": "30 mm",
    "speed": "600 rpm",
    "sections": SECTIONS,
    "follower": {
        "type": "translating",
        "contact": "roller",
        "roller_radius": "8 mm",
        "offset": "5 mm",
        "mass": "0.5 kg",
        "preload": "80 N",
        "stiffness": "8 N/mm",
    },
}
FLAT = ROLLER | {
    "follower": {"type": "translating", "contact": "flat", "mass": "0.5 kg", "preload": "80 N", "stiffness": "8 N/mm"}
}
KNIFE = ROLLER | {"follower": {"type": "translating", "contact": "knife edge", "offset": "-3 mm"}}
SWINGS = {name: {k: ("14 deg" if k == "lift" else v) for k, v in section.items()} for name, section in SECTIONS.items()}
for _section in SWINGS.values():
    if _section["type"] == "rise":
        _section["swing"] = _section.pop("lift")
ARM = ROLLER | {
    "sections": SWINGS,
    "follower": {
        "type": "oscillating",
        "contact": "roller",
        "roller_radius": "8 mm",
        "pivot_distance": "80 mm",
        "arm": "70 mm",
        "inertia": "0.002 kg m2",
        "preload": "6 N m",
        "stiffness": "20 N m/rad",
    },
}
ARM_WITH = ARM | {"follower": ARM["follower"] | {"opens": "with"}}
FACE = ARM | {
    "base_radius": "40 mm",
    "follower": {
        "type": "oscillating",
        "contact": "flat",
        "pivot_distance": "80 mm",
        "inertia": "0.002 kg m2",
        "preload": "6 N m",
        "stiffness": "20 N m/rad",
    },
}
FACE_WITH = FACE | {"follower": FACE["follower"] | {"opens": "with"}}
CAMS = {
    "roller": ROLLER,
    "flat": FLAT,
    "knife edge": KNIFE,
    "arm": ARM,
    "arm with": ARM_WITH,
    "face": FACE,
    "face with": FACE_WITH,
}


def cam_scene(cam, **changes):
    """Scene with a cam; keys with dots or double underscores for inner tables."""
    data = deepcopy(cam)
    for key, value in changes.items():
        *tables, last = key.split("__")
        table = data
        for name in tables:
            table = table.setdefault(name, {})
        if value is None:
            table.pop(last, None)
        else:
            table[last] = value
    return Scene.model_validate({"elements": {"cam": data}})


def cam_of(cam, **changes):
    """The element alone."""
    return cam_scene(cam, **changes).elements["cam"]


def cam_answers(cam, *names, **changes):
    """Values, error estimates and status of results of one cam; of all it has unless named."""
    scene = cam_scene(cam, **changes)
    every = ElementsAlone(scene).available_summaries
    asked = [f"cam.{name}" for name in names] or list(every)
    outcome = ElementsAlone(scene, asked).evaluate({})
    short = [name.partition(".")[2] for name in asked]
    values = {s: float(outcome.summaries[name][0]) for s, name in zip(short, asked, strict=True)}
    errors = {s: float(outcome.errors[name][0]) for s, name in zip(short, asked, strict=True)}
    return values, errors, int(outcome.status[0])
