"""Mechanisms that the tests of pictures draw, one of each kind of symbol."""

import math
from fractions import Fraction

import machines
from machines import frame, on, rpp, rpr, rrp, rrr

from engine import Scene


def crank(length=0.05, speed=6.0, **others):
    return machines.crank(length=length, speed=speed, **others)


def slider_crank(angle=0.0, offset=0.0, **others):
    way = {"way": {"angle": angle, "y": offset}}
    rod = {"link": "rod", "mass": 2.0, "x": 0.07, "inertia": 0.01}
    bodies = {"rod": rod, "piston": {"link": "piston", "mass": 1.5}}
    parts = {"guides": way, "bodies": bodies} | others
    return Scene.model_validate(machines.slider_crank(speed=6.0, slider="piston", **parts))


def four_bar(**others):
    return Scene.model_validate(
        {
            "points": {"O": frame(0, 0), "D": frame(0.22, 0.01), "P": on("rod", 0.1, 0.08)},
            "input": crank(),
            "groups": {"g": rrr("B", ("rod", "A", 0.2), ("rocker", "D", 0.15))},
        }
        | others
    )


def on_moving_guide():
    scene = four_bar().model_dump(exclude_none=True)
    scene["points"]["G"] = {"x": 0.33, "y": 0.0}
    scene["guides"] = {"bar": {"link": "rocker", "x": 0.07, "y": 0.035, "angle": 0.2}}
    scene["groups"]["h"] = rrp("F", ("arm", "G", 0.18), "sleeve", "bar")
    return Scene.model_validate(scene)


def quick_return(offset=0.0):
    return Scene.model_validate(
        {
            "points": {"O": frame(0, 0.3), "D": frame(0, 0), "E": on("rocker", 0.56, 0)},
            "guides": {"way": {"y": 0.6}},
            "input": crank(0.11),
            "groups": {
                "q": rpr(("stone", "A"), ("rocker", "D"), offset),
                "r": rrp("F", ("rod", "E", 0.2), "ram", "way", mode=-1),
            },
        }
    )


def scotch_yoke():
    return Scene.model_validate(
        {
            "points": {"O": {"x": 0, "y": 0}},
            "guides": {"way": {"angle": 0.3}},
            "input": crank(),
            "groups": {"g": rpp(("stone", "A"), ("yoke", "way"), math.pi / 2)},
        }
    )


def geared_five_bar(ratio=-2.0):
    return Scene.model_validate(
        {
            "points": {"O": frame(0, 0), "D": frame(0.16, 0), "E": on("wheel", 0.04, 0), "H": frame(0.05, -0.2)},
            "input": crank(0.04) | {"revolutions": Fraction(ratio).denominator},
            "shafts": {"wheel": {"geared_to": "crank", "ratio": ratio, "pivot": "D", "phase": 1.5}},
            "groups": {"g": rrr("B", ("left", "A", 0.16), ("right", "E", 0.16))},
            "springs": {"s": {"between": ("B", "H"), "stiffness": 100.0}},
        }
    )


def sliding_input():
    return Scene.model_validate(
        {
            "points": {"D": {"x": 0.26, "y": 0.12}, "T": {"link": "lever", "x": 0.22, "y": 0.03}},
            "guides": {"way": {}},
            "input": {
                "type": "slider",
                "link": "rack",
                "guide": "way",
                "point": "A",
                "start": 0.0,
                "stop": 0.12,
                "speed": 0.1,
            },
            "groups": {"g": rrr("B", ("rod", "A", 0.15), ("lever", "D", 0.14))},
            "bodies": {"lever": {"link": "lever", "mass": 2.0, "x": 0.1, "inertia": 0.01}},
        }
    )


def crowded():
    near = {name: {"link": "rod", "x": 0.1 + 0.001 * i, "y": 0.08} for i, name in enumerate("PQR")}
    return four_bar(points={"O": {"x": 0, "y": 0}, "D": {"x": 0.22, "y": 0.01}, **near})


def drum():
    """A wheel on its bearing, to which nothing is hinged."""
    return Scene.model_validate(
        {
            "points": {"O": frame(0, 0)},
            "input": {"type": "crank", "pivot": "O", "speed": 6.0},
            "bodies": {"disc": {"link": "crank", "mass": 3.0, "x": 0.001, "inertia": 0.2}},
            "gravity": 9.81,
        }
    )


GALLERY = {
    "slider crank": slider_crank(),
    "four-bar": four_bar(),
    "crowded": crowded(),
    "moving guide": on_moving_guide(),
    "quick return": quick_return(),
    "Scotch yoke": scotch_yoke(),
    "geared five-bar": geared_five_bar(),
    "sliding input": sliding_input(),
    "drum": drum(),
}
