"""Machines with non-circular wheels, as data of a scene."""

from geared_links import CRANK
from machines import rrp

# Elliptical wheels before a slider-crank.
ELLIPSES = {
    "gravity": "9.81 m/s2",
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.2, "y": 0.05}, "D": {"link": "second", "x": 0.06, "y": 0.01}},
    "guides": {"way": {}},
    "input": CRANK,
    "noncircular_wheels": {
        "second": {
            "geared_to": "crank",
            "pivot": "C",
            "law": {"type": "elliptical", "eccentricity": 0.4},
            "begin": 0.3,
            "phase": 1.0,
            "pressure_angle": "20 deg",
        }
    },
    "groups": {"drive": rrp("B", ("rod", "D", 0.26), "ram", "way")},
    "bodies": {
        "ram_body": {"link": "ram", "mass": 10},
        "second_body": {"link": "second", "mass": 6, "x": 0.01, "inertia": 0.03},
    },
}
# Two wheels after each other: three lobes drive two by a law of two harmonics, those drive one lobe.
CHAIN = {
    "gravity": "9.81 m/s2",
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.2, "y": 0.05}, "E": {"x": 0.35, "y": -0.02}},
    "input": {**CRANK, "revolutions": 2},
    "noncircular_wheels": {
        "middle": {
            "geared_to": "crank",
            "pivot": "C",
            "driver_lobes": 3,
            "lobes": 2,
            "law": {
                "type": "harmonic",
                "harmonics": {"one": {"order": 1, "cosine": 0.2, "sine": -0.1}, "two": {"order": 2, "sine": 0.05}},
            },
            "begin": 0.2,
            "phase": 0.7,
        },
        "last": {
            "geared_to": "middle",
            "pivot": "E",
            "law": {"type": "elliptical", "eccentricity": 0.3},
            "pressure_angle": 0.3,
        },
    },
    "bodies": {
        "middle_body": {"link": "middle", "mass": 2, "x": 0.01, "inertia": 0.004},
        "last_body": {"link": "last", "mass": 1, "x": 0.02, "y": 0.01, "inertia": 0.002},
    },
}
