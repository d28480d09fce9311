"""Machines with racks and pinions, as data of a scene."""

from geared_links import CRANK
from machines import rrp

DRIVE = rrp("B", ("rod", "A", 0.2), "ram", "way")
# A pinion on the slider's joint, between a rack of the frame and one that moves: it doubles the stroke.
DOUBLER = {
    "gravity": "9.81 m/s2",
    "points": {"O": {"x": 0, "y": 0}},
    "guides": {"way": {"angle": 0.2}},
    "input": CRANK,
    "groups": {"drive": DRIVE},
    "pinions": {"wheel": {"guide": "way", "pivot": "B", "radius": 0.03, "pressure_angle": "20 deg"}},
    "racks": {"table": {"pinion": "wheel", "pivot": "B", "guide": "way", "radius": -0.03, "pressure_angle": "20 deg"}},
    "bodies": {
        "table_body": {"link": "table", "mass": 8, "x": 0.01, "y": 0.035},
        "wheel_body": {"link": "wheel", "mass": 0.8, "inertia": 0.0004},
    },
}
# The slider's own rack turns a gear, which lifts a post across; the post turns another wheel.
LIFT = {
    "gravity": "9.81 m/s2",
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.25, "y": 0.03}, "T": {"x": 0.3, "y": 0.1}},
    "guides": {"way": {"angle": 0.2}, "up": {"x": 0.25, "angle": 1.5}},
    "input": CRANK,
    "groups": {"drive": DRIVE},
    "pinions": {
        "gear": {"rack": "ram", "pivot": "C", "radius": 0.04, "phase": 0.4, "pressure_angle": 0.35},
        "idler": {"rack": "post", "pivot": "T", "radius": 0.02, "pressure_angle": 0.3},
    },
    "racks": {
        "post": {
            "pinion": "gear", "pivot": "C", "guide": "up", "radius": -0.05, "start": 0.01, "pressure_angle": 0.3,
        },
    },
    "bodies": {
        "ram_body": {"link": "ram", "mass": 2, "x": 0.03, "y": 0.02},
        "gear_body": {"link": "gear", "mass": 1, "x": 0.01, "y": -0.02, "inertia": 0.003},
        "post_body": {"link": "post", "mass": 1.5, "x": 0.1, "y": 0.04},
        "idler_body": {"link": "idler", "mass": 0.5, "x": 0.01, "inertia": 0.001},
    },
}  # fmt: skip
# A guide on the crank, and on it a rack that a faster shaft about the same axis drives.
ON_CRANK = {
    "gravity": "9.81 m/s2",
    "points": {"O": {"x": 0, "y": 0}},
    "guides": {"arm": {"link": "crank", "x": 0.01, "y": 0.02, "angle": 0.3}},
    "input": {**CRANK, "start": 0, "stop": 2},
    "shafts": {"sun": {"geared_to": "crank", "ratio": 3, "pivot": "O", "phase": 0.5}},
    "racks": {"bar": {"pinion": "sun", "pivot": "O", "guide": "arm", "radius": 0.02, "pressure_angle": 0.3}},
    "bodies": {"bar_body": {"link": "bar", "mass": 1.5, "x": 0.02, "y": 0.01, "inertia": 0.002}},
}
