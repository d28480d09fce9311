"""A slider-crank and a yoke with friction in their pairs, as tables of a scene."""

import math

from machines import crank, frame, on, rpp, rrp

R, L, Q = 0.1, 0.4, 1000.0
RHO = {"O": 0.004, "A": 0.003, "B": 0.002}


def press(f_guide: float, journals: bool = True, **more: object) -> dict:
    """Slider-crank without masses that pushes against a force on its slider; friction circles of RHO."""
    circles = {"input": "O", "drive.first": "A", "drive.inner": "B"} if journals else {}
    # Diameters that make the circles, rho = d/2 sin(arctan 1/2).
    friction = {
        name: {"pair": pair, "coefficient": 0.5, "diameter": 2 * RHO[name] * math.sqrt(5)}
        for pair, name in circles.items()
    }
    friction |= {"way": {"pair": "drive.second", "coefficient": f_guide}}
    return {
        "points": {"O": frame(0.0, 0.0)},
        "guides": {"way": {}},
        "input": crank(length=R, speed=2.0, **more),
        "groups": {"drive": rrp("B", ("rod", "A", L), "ram", "way")},
        "forces": {"work": {"type": "constant", "on": "B", "angle": math.pi, "force": Q}},
        "friction": friction,
    }


def yoke(length: float, f: float) -> dict:
    """Yoke on a long guide that tilts, pushed aside by the crank's block against a force."""
    return {
        "guides": {"way": {}},
        "input": crank(length=R, speed=2.0),
        "groups": {"g": rpp(("block", "A"), ("yoke", "way"), math.pi / 2)},
        "points": {"O": frame(0.0, 0.0), "P": on("yoke", 0.0, 0.0)},
        "forces": {"work": {"type": "against_motion", "on": "P", "force": Q, "role": "useful"}},
        "friction": {"way": {"pair": "g.second", "coefficient": f, "length": length}},
    }
