"""Crank and second link that two bars join, as data of a scene; `inputs` or `shafts` give the second its motion."""

from geared_links import CRANK
from machines import frame, on, rrr

JOINED = {
    "gravity": 9.81,
    "points": {"O": frame(0, 0), "C": frame(0.2, 0.02), "D": on("second", 0.04, 0.01)},
    "input": CRANK,
    "groups": {"arms": rrr("B", ("left", "A", 0.19), ("right", "D", 0.17))},
    "bodies": {
        "left_body": {"link": "left", "mass": 0.7, "x": 0.09, "inertia": 0.002},
        "right_body": {"link": "right", "mass": 0.8, "x": 0.08, "inertia": 0.003},
        "second_body": {"link": "second", "mass": 1.5, "x": 0.04, "y": 0.01, "inertia": 0.002},
    },
}
