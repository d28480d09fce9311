"""A slider-crank and a yoke with friction in their pairs, as tables of a scene; the former solved by hand."""

import math

import numpy as np
from machines import crank, frame, on, rpp, rrp
from scipy.optimize import brentq

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


def by_friction_circles(phi: float, f_guide: float) -> tuple[float, float]:
    """Force in the rod and moment on the crank, φ rising from 0 to π: the slider moves to the left, Q with it.

    The force in the rod is tangent to the circles in A and B; in the guide it leans by the friction angle.
    """
    beta = math.asin(R * math.sin(phi) / L)
    # Rotations: crank +1 against the frame, rod −cos φ, so that the rod turns clockwise from the crank up to there.
    rod = -R * math.cos(phi) / (L * math.cos(beta))
    turn_a, turn_b = np.sign(rod - 1.0), np.sign(rod)
    # Sum of the friction couples on the rod, per newton of its force, over the length of the rod.
    lean = math.asin((-turn_a * RHO["A"] - turn_b * RHO["B"]) / L)

    def slider(force: float, angle: float) -> float:
        # On the slider: force of the rod, Q to the left, friction to the right.
        return force * math.cos(angle) - Q + f_guide * abs(force * math.sin(angle))

    # The rod pushes the slider to the right against Q: along from A to B, which falls by beta, turned by the lean.
    angle = -beta + lean
    force = brentq(slider, 0.0, 10 * Q, (angle,), xtol=1e-12)
    fx, fy = force * math.cos(angle), force * math.sin(angle)
    # On the crank in A the rod gives −f; the friction couple of the rod on the crank follows the rod's motion.
    on_crank = -(R * math.cos(phi) * fy - R * math.sin(phi) * fx) + turn_a * RHO["A"] * force
    return force, -on_crank + RHO["O"] * force
