"""The machines of the benchmark, and the sample of variants each is evaluated for.

Every body has its centre of mass away from the link's axis; one constant force and one constant moment act. The press
also has a load over a part of its stroke, which starts at a different crank angle in each variant.
"""

from typing import NamedTuple

import numpy as np

from engine import Scene, scene_numbers


class Case(NamedTuple):
    """A machine and what varies.

    Attributes
    ----------
    scene : Scene
    geometry : dict of str to float
        Varied lengths, as path and relative spread.
    loads : dict of str to float
        Varied masses, inertias and forces.
    """

    scene: Scene
    geometry: dict[str, float]
    loads: dict[str, float]


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
        {"input.length": 0.1, "groups.g.first.length": 0.1},
        {"bodies.rod.mass": 0.5, "bodies.ram.mass": 0.5, "bodies.rod.inertia": 0.5, "forces.work.scale": 0.5},
    ),
    "four_bar": Case(
        Scene.model_validate(FOUR_BAR),
        {"input.length": 0.1, "groups.g.first.length": 0.05, "groups.g.second.length": 0.05},
        {"bodies.rod.mass": 0.5, "bodies.rocker.mass": 0.5, "bodies.rocker.inertia": 0.5, "forces.push.force": 0.5},
    ),
    "six_bar": Case(
        Scene.model_validate(SIX_BAR),
        {"input.length": 0.1, "groups.g.first.length": 0.03, "groups.h.first.length": 0.03},
        {"bodies.rod.mass": 0.5, "bodies.lever.mass": 0.5, "bodies.lever.inertia": 0.5, "forces.push.force": 0.5},
    ),
}


def _body(name: str, inertia: bool = True) -> list[str]:
    keys = ("mass", "x", "y", "inertia") if inertia else ("mass", "x", "y")
    return [f"bodies.{name}.{key}" for key in keys]


def _dyad(name: str) -> list[str]:
    return [f"groups.{name}.{key}" for key in ("first.length", "second.length", "mode")]


def _places(names: str) -> list[str]:
    return [f"points.{name}.{axis}" for name in names for axis in ("x", "y")]


ACTIONS = ["forces.push.angle", "forces.push.force", "moments.twist.moment"]

# The numbers of a variant in the order in which the C++ baseline reads them.
BASELINE_PATHS = {
    "press": [
        *("gravity", *_places("O"), "guides.way.x", "guides.way.y", "guides.way.angle", "input.length"),
        *("groups.g.first.length", "groups.g.second.offset", "groups.g.mode"),
        *(*_body("crank"), *_body("rod"), *_body("ram", inertia=False), *ACTIONS, "forces.work.scale"),
    ],
    "four_bar": [
        *("gravity", *_places("OD"), "input.length", *_dyad("g")),
        *(*_body("crank"), *_body("rod"), *_body("rocker"), *_places("C"), *ACTIONS),
    ],
    "six_bar": [
        *("gravity", *_places("ODE"), "input.length", *_dyad("g"), *_dyad("h"), *_body("crank"), *_body("rod")),
        *(*_body("rocker"), *_body("bar"), *_body("lever"), *_places("C"), *ACTIONS),
    ],
}


def sample(case: Case, paths: dict[str, float], variants: int) -> dict[str, np.ndarray]:
    """Uniform sample of the varied numbers, each within its spread about the scene's value."""
    rng = np.random.default_rng(1)
    numbers = scene_numbers(case.scene)
    return {path: numbers[path].value * rng.uniform(1 - s, 1 + s, variants) for path, s in paths.items()}


def all_numbers(case: Case, varied: dict[str, np.ndarray], paths: list[str]) -> np.ndarray:
    """Values of the paths for every variant, (variants, paths): the input of the C++ baseline."""
    numbers = scene_numbers(case.scene)
    variants = next(iter(varied.values())).size
    columns = [np.broadcast_to(varied.get(path, numbers[path].value), variants) for path in paths]
    return np.ascontiguousarray(np.stack(columns, axis=1))
