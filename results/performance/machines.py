"""The machines of the benchmark, and the sample of variants each is evaluated for.

Every body has its centre of mass away from the link's axis; one constant force and one constant moment act. The press
also has a load over a part of its stroke, which starts at a different crank angle in each variant.
"""

from typing import NamedTuple

import numpy as np

from engine import Scene, scene_numbers


class Case(NamedTuple):
    """A machine, and its varied numbers as path and relative spread."""

    scene: Scene
    varied: dict[str, float]


CRANK = {"type": "crank", "pivot": "O", "pin": "A", "length": 0.05, "speed": 12.0}
CRANK_BODY = {"link": "crank", "mass": 2.0, "x": 0.02, "y": 0.005, "inertia": 0.01}
FLYWHEEL = {"speed_fluctuation": 0.02}


def dyad(inner: str, link: str, joint: str, length: float, /, **second: object) -> dict:
    """A group RRR or RRP, depending on the keys of its second link."""
    first = {"link": link, "joint": joint, "length": length}
    return {"type": "RRR" if "joint" in second else "RRP", "inner": inner, "first": first, "second": second}


SLIDER_CRANK = {
    "gravity": 9.81,
    "points": {"O": {"x": 0.0, "y": 0.0}},
    "guides": {"way": {"x": 0.0, "y": 0.01, "angle": 0.1}},
    "input": CRANK,
    "groups": {"g": dyad("B", "rod", "A", 0.2, link="ram", guide="way", offset=0.004)},
    "bodies": {
        "crank": CRANK_BODY,
        "rod": {"link": "rod", "mass": 1.0, "x": 0.08, "y": 0.01, "inertia": 0.004},
        "ram": {"link": "ram", "mass": 3.0, "x": 0.02, "y": 0.015},
    },
    "forces": {"push": {"on": "B", "type": "constant", "angle": 0.3, "force": -400.0}},
    "moments": {"twist": {"on": "crank", "type": "constant", "moment": -3.0}},
    "flywheel": FLYWHEEL,
}

PRESS = {
    **SLIDER_CRANK,
    "forces": {
        **SLIDER_CRANK["forces"],
        "work": {
            "type": "table",
            "on": "B",
            "angle": 0.1,
            "slider": "ram",
            "measured_from": "high end",
            "over_stroke": [0.0, 0.02],
            "force": [-4000.0, -4000.0],
            "interpolation": "linear",
            "outside": "zero",
            "acts": "along",
        },
    },
}

FOUR_BAR = {
    "gravity": 9.81,
    "points": {"O": {"x": 0.0, "y": 0.0}, "D": {"x": 0.22, "y": 0.01}, "C": {"link": "rod", "x": 0.1, "y": 0.06}},
    "input": CRANK,
    "groups": {"g": dyad("B", "rod", "A", 0.2, link="rocker", joint="D", length=0.15)},
    "bodies": {
        "crank": CRANK_BODY,
        "rod": {"link": "rod", "mass": 1.0, "x": 0.1, "y": 0.01, "inertia": 0.01},
        "rocker": {"link": "rocker", "mass": 1.2, "x": 0.07, "y": -0.02, "inertia": 0.02},
    },
    "forces": {"push": {"on": "C", "type": "constant", "angle": 0.3, "force": -100.0}},
    "moments": {"twist": {"on": "rocker", "type": "constant", "moment": 5.0}},
    "flywheel": FLYWHEEL,
}

SIX_BAR = {
    **FOUR_BAR,
    "points": FOUR_BAR["points"] | {"E": {"x": 0.45, "y": -0.03}, "C": {"link": "rocker", "x": 0.12, "y": -0.06}},
    "groups": {**FOUR_BAR["groups"], "h": dyad("F", "bar", "C", 0.18, link="lever", joint="E", length=0.16)},
    "bodies": {
        **FOUR_BAR["bodies"],
        "bar": {"link": "bar", "mass": 0.8, "x": 0.09, "y": 0.012, "inertia": 0.005},
        "lever": {"link": "lever", "mass": 1.5, "x": 0.08, "y": 0.01, "inertia": 0.015},
    },
    "forces": {"push": {"on": "F", "type": "constant", "angle": 0.3, "force": -100.0}},
    "moments": {"twist": {"on": "lever", "type": "constant", "moment": 5.0}},
}

CASES = {
    "press": Case(
        Scene.model_validate(PRESS),
        {"input.length": 0.1, "groups.g.first.length": 0.1}
        | dict.fromkeys(("bodies.rod.mass", "bodies.ram.mass", "bodies.rod.inertia", "forces.work.scale"), 0.5),
    ),
    "four_bar": Case(
        Scene.model_validate(FOUR_BAR),
        {"input.length": 0.1, "groups.g.first.length": 0.05, "groups.g.second.length": 0.05}
        | dict.fromkeys(("bodies.rod.mass", "bodies.rocker.mass", "bodies.rocker.inertia", "forces.push.force"), 0.5),
    ),
    "six_bar": Case(
        Scene.model_validate(SIX_BAR),
        {"input.length": 0.1, "groups.g.first.length": 0.03, "groups.h.first.length": 0.03}
        | dict.fromkeys(("bodies.rod.mass", "bodies.lever.mass", "bodies.lever.inertia", "forces.push.force"), 0.5),
    ),
}


def _of(part: str, keys: str) -> list[str]:
    return [f"{part}.{key}" for key in keys.split()]


def _bodies(*names: str) -> list[str]:
    return [path for name in names for path in _of(f"bodies.{name}", "mass x y inertia")]


def _points(names: str) -> list[str]:
    return [path for name in names for path in _of(f"points.{name}", "x y")]


ACTIONS = ["forces.push.angle", "forces.push.force", "moments.twist.moment"]

# The numbers of a variant in the order in which the C++ baseline reads them.
DYAD = "first.length second.length mode"
BASELINE_PATHS = {
    "press": [
        *("gravity", *_points("O"), *_of("guides.way", "x y angle"), "input.length"),
        *(*_of("groups.g", "first.length second.offset mode"), *_bodies("crank", "rod")),
        *(*_of("bodies.ram", "mass x y"), *ACTIONS, "forces.work.scale"),
    ],
    "four_bar": [
        *("gravity", *_points("OD"), "input.length", *_of("groups.g", DYAD)),
        *(*_bodies("crank", "rod", "rocker"), *_points("C"), *ACTIONS),
    ],
    "six_bar": [
        *("gravity", *_points("ODE"), "input.length", *_of("groups.g", DYAD), *_of("groups.h", DYAD)),
        *(*_bodies("crank", "rod", "rocker", "bar", "lever"), *_points("C"), *ACTIONS),
    ],
}


def all_numbers(case: Case, varied: dict[str, np.ndarray], paths: list[str]) -> np.ndarray:
    """Values of the paths for every variant, (variants, paths): the input of the C++ baseline."""
    numbers = scene_numbers(case.scene)
    variants = next(iter(varied.values())).size
    columns = [np.broadcast_to(varied.get(path, numbers[path].value), variants) for path in paths]
    return np.ascontiguousarray(np.stack(columns, axis=1))
