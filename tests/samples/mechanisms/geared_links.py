"""Machines with planets and geared cranks, as data of a scene."""

from machines import rrp, rrr

CRANK = {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": "120 rpm"}
# A wheel rolls inside one of twice its radius: its pitch circle's points go straight through the centre.
CARDAN = {
    "points": {"O": {"x": 0, "y": 0}, "P": {"link": "planet", "x": 0.05, "y": 0}},
    "guides": {"way": {}},
    "input": CRANK,
    "shafts": {
        "planet": {
            "geared_to": "frame", "carrier": "crank", "pivot": "A", "ratio": 2, "inertia": 0.001,
            "pressure_angle": "20 deg",
        }
    },
    "groups": {"g": rrp("B", ("rod", "P", 0.15), "ram", "way")},
    "bodies": {
        "planet_body": {"link": "planet", "mass": 1, "x": 0.01, "inertia": 0.001},
        "ram_body": {"link": "ram", "mass": 2},
    },
}  # fmt: skip
# Watt's wheel on the connecting rod: here the planet that a carrier takes round a sun, which is the second shaft.
TRAIN = {
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0, "y": 0}, "tip": {"link": "moon", "x": 0.02, "y": 0}},
    "input": CRANK,
    "shafts": {
        "sun": {"geared_to": "crank", "ratio": 3, "pivot": "C", "inertia": 0.002},
        "planet": {"geared_to": "sun", "carrier": "crank", "pivot": "A", "ratio": "-24/30", "inertia": 0.003},
        "moon": {"geared_to": "frame", "carrier": "crank", "pivot": "A", "ratio": "84/30", "phase": 1.0},
    },
    "bodies": {"moon_body": {"link": "moon", "mass": 0.5, "x": 0.02, "inertia": 0.0004}},
}
FIVE_BAR = {
    "gravity": "9.81 m/s2",
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.18, "y": 0}, "D": {"link": "second", "x": 0.04, "y": 0}},
    "input": CRANK,
    "shafts": {"second": {"geared_to": "crank", "ratio": 1, "pivot": "C", "phase": 1.0}},
    "groups": {"rods": rrr("B", ("left", "A", 0.15), ("right", "D", 0.16))},
    "bodies": {
        "left_body": {"link": "left", "mass": 0.6, "x": 0.075, "inertia": 0.0012},
        "right_body": {"link": "right", "mass": 0.6, "x": 0.08, "inertia": 0.0013},
        "second_body": {"link": "second", "mass": 1.5, "x": 0.01, "inertia": 0.003},
    },
}
