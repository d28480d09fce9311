"""Scenes of free links: groups of every class and with every kind of leg."""

import copy
from functools import partial

from machines import rrp, rrr

from engine import Scene

_TRIAD = {
    "gravity": 9.81,
    "points": {
        "O": {"x": 0.0, "y": 0.0},
        "P": {"x": 0.3, "y": -0.1},
        "Q": {"x": 0.25, "y": 0.3},
        "B": {"link": "plate", "x": 0.0, "y": 0.0},
        "C": {"link": "plate", "x": 0.12, "y": 0.0},
        "D": {"link": "plate", "x": 0.06, "y": 0.08},
    },
    "near": {"C": {"x": 0.3, "y": 0.1}},
    "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.03, "speed": "60 rpm"},
    "bodies": {
        "rod_body": {"link": "rod", "mass": 1.0, "x": 0.1, "y": 0.02, "inertia": 0.01},
        "plate_body": {"link": "plate", "mass": 2.0, "x": 0.05, "y": 0.03, "inertia": 0.02},
        "upper_body": {"link": "upper", "mass": 1.5, "x": 0.02, "inertia": 0.01},
        "lower_body": {"link": "lower", "mass": 0.7, "x": 0.08, "y": -0.02, "inertia": 0.01},
    },
    "links": {
        "rod": {"joints": ["A", "B"], "length": 0.2},
        "lower": {"joints": ["P", "C"], "length": 0.2},
        "upper": {"joints": ["Q", "D"], "length": 0.2},
        "plate": {},
    },
}


def triad_data() -> dict:
    """A ternary link on three bars."""
    return copy.deepcopy(_TRIAD)


def _slider_leg() -> dict:
    """One leg a slider on a guide of the frame."""
    data = triad_data()
    data["guides"] = {"way": {"x": 0.25, "y": 0.1, "angle": 0.3}}
    data["links"]["upper"] = {"joints": ["D"], "guide": "way", "offset": 0.01}
    data["near"]["D"] = {"x": 0.22, "y": 0.1}
    return data


def _slotted_plate() -> dict:
    """One leg a block, pivoted on the frame, in a slot of the ternary link."""
    data = triad_data()
    data["guides"] = {"slot": {"link": "plate", "x": 0.06, "y": 0.08, "angle": 2.2}}
    data["points"]["Q"] = {"x": 0.2, "y": 0.2}
    data["links"]["upper"] = {"joints": ["Q"], "guide": "slot"}
    return data


def _sliding_plate() -> dict:
    """The ternary link slides on a guide of one leg."""
    data = triad_data()
    data["guides"] = {"slot": {"link": "upper", "x": 0.02, "y": 0.03, "angle": 0.5}}
    data["points"]["Q"] = {"x": 0.25, "y": 0.18}
    data["links"]["upper"] = {"joints": ["Q"]}
    data["links"]["plate"] = {"guide": "slot", "offset": 0.01}
    return data


def _contour(sides: int) -> dict:
    """Ternary links in a closed contour with bars between them: the first on the crank, all others on the frame."""
    data = triad_data()
    data["input"]["length"] = 0.03
    data["near"], data["bodies"], data["links"] = {}, {}, {}
    data["points"] = {"O": {"x": 0.0, "y": 0.0}}
    places = {4: [(0.0, 0.0), (0.3, 0.05)], 6: [(0.0, 0.0), (0.36, -0.04), (0.2, 0.33)]}[sides]
    for i, (x, y) in enumerate(places):
        pivot = "A" if i == 0 else f"P{i}"
        if i:
            data["points"][pivot] = {"x": x, "y": y}
        data["links"][f"ternary{i}"] = {"joints": [pivot]}
        data["points"][f"L{i}"] = {"link": f"ternary{i}", "x": 0.1, "y": 0.03 + 0.02 * i}
        data["points"][f"R{i}"] = {"link": f"ternary{i}", "x": 0.02 * i, "y": 0.11}
        data["bodies"][f"body{i}"] = {"link": f"ternary{i}", "mass": 1.0 + i, "x": 0.05, "y": 0.04, "inertia": 0.01}
    for i, _ in enumerate(places):
        ends = [f"L{i}", f"R{(i + 1) % len(places)}"]
        data["links"][f"bar{i}"] = {"joints": ends, "length": 0.22 + 0.02 * i}
        data["bodies"][f"bar_body{i}"] = {"link": f"bar{i}", "mass": 0.5, "x": 0.1, "y": 0.01, "inertia": 0.002}
    return data


KINDS = {
    "three bars": triad_data,
    "slider leg": _slider_leg,
    "slotted plate": _slotted_plate,
    "sliding plate": _sliding_plate,
    "four-sided contour": partial(_contour, 4),  # Class IV.
    "six-sided contour": partial(_contour, 6),  # Class VI.
}


# About where a point lies in a mode that goes all through a turn.
_WHOLE = {
    "slotted plate": {"B": {"x": 0.091, "y": -0.19}},
    "four-sided contour": {"L0": {"x": 0.1226, "y": -0.0482}},
    "six-sided contour": {"L0": {"x": 0.1092, "y": 0.068}, "R2": {"x": 0.283, "y": 0.247}},
}


def free_link_scene(kind: str) -> Scene:
    """One of the scenes, in a mode that goes all through a turn."""
    data = KINDS[kind]()
    return Scene.model_validate(data | {"near": _WHOLE.get(kind, data["near"])})


# Pairs of `dyads_twice` as those of its free links, with the sign of what acts on the link that names them.
AS_FREE_LINKS = {
    "input": ("input", 1.0),
    "swing.first": ("coupler.A", 1.0),
    "swing.inner": ("rocker.B", -1.0),
    "swing.second": ("rocker.D", 1.0),
    "press.first": ("rod.E", 1.0),
    "press.inner": ("ram.F", -1.0),
    "press.second": ("ram.way", 1.0),
}


def dyads_twice() -> tuple[dict, dict]:
    """A press of two dyads, given as groups and as free links."""
    data = {
        "gravity": 9.81,
        "points": {"O": {"x": 0, "y": 0}, "D": {"x": 0.22, "y": 0}, "E": {"link": "coupler", "x": 0.1, "y": 0.05}},
        "guides": {"way": {"x": 0.0, "y": 0.25, "angle": 0.2}},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.06, "speed": "120 rpm"},
        "bodies": {
            "coupler_body": {"link": "coupler", "mass": 0.6, "x": 0.1, "inertia": 0.002},
            "rocker_body": {"link": "rocker", "mass": 0.6, "x": 0.1, "inertia": 0.002},
            "ram_body": {"link": "ram", "mass": 1.2},
        },
    }
    dyads, free = copy.deepcopy(data), copy.deepcopy(data)
    dyads["groups"] = {
        "swing": rrr("B", ("coupler", "A", 0.2), ("rocker", "D", 0.14)),
        "press": rrp("F", ("rod", "E", 0.25), "ram", "way"),
    }
    free["links"] = {
        "coupler": {"joints": ["A", "B"], "length": 0.2},
        "rocker": {"joints": ["D", "B"], "length": 0.14},
        "rod": {"joints": ["E", "F"], "length": 0.25},
        "ram": {"joints": ["F"], "guide": "way"},
    }
    # Where the dyads have their inner joints at the first position.
    free["near"] = {"B": {"x": 0.204, "y": 0.139}, "F": {"x": 0.253, "y": 0.301}}
    return dyads, free
