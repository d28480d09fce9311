"""Cams for tests, as data of a scene."""

from driving_cams import changed
from element_samples import results

from engine import Scene

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
SWINGING = {
    "type": "oscillating",
    "pivot_distance": "80 mm",
    "inertia": "0.002 kg m2",
    "preload": "6 N m",
    "stiffness": "20 N m/rad",
}
ARM = ROLLER | {
    "sections": changed(SECTIONS, out__lift=None, out__swing="14 deg"),
    "follower": SWINGING | {"contact": "roller", "roller_radius": "8 mm", "arm": "70 mm"},
}
ARM_WITH = ARM | {"follower": ARM["follower"] | {"opens": "with"}}
FACE = ARM | {"base_radius": "40 mm", "follower": SWINGING | {"contact": "flat"}}
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
    """Scene with a cam; keys with double underscores for inner tables."""
    return Scene.model_validate({"elements": {"cam": changed(cam, **changes)}})


def cam_of(cam, **changes):
    """The element alone."""
    return cam_scene(cam, **changes).elements["cam"]


def cam_answers(cam, *names, **changes):
    """Values, error estimates and status of results of one cam; of all it has unless named."""
    values, errors, status = results(changed(cam, **changes), *names)
    return *({name: float(column[0]) for name, column in table.items()} for table in (values, errors)), int(status[0])
