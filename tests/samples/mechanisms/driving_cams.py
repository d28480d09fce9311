"""Machines with cams in them, as data of a scene."""

from copy import deepcopy

import numpy as np
from graph_values import GraphValues

from engine import Machine, MovingMachine, Scene, Verdict

BALANCE = ("input_moment_disagreement", "equilibrium_residual")

SECTIONS = {
    "out": {"type": "rise", "law": "modified sine", "angle": "100 deg", "lift": "20 mm"},
    "rest": {"type": "dwell", "angle": "40 deg"},
    "back": {"type": "return", "law": "modified trapezoid", "angle": "110 deg"},
    "low": {"type": "dwell"},
}
# By half turns the harmonic law is the motion of an eccentric circle.
CIRCLE = {
    "up": {"type": "rise", "law": "harmonic", "angle": "180 deg", "lift": "40 mm"},
    "down": {"type": "return", "law": "harmonic"},
}
CRANK = {"type": "crank", "pivot": "O", "pin": "A", "length": "20 mm", "speed": "300 rpm"}
SLIDING = {
    "gravity": "9.81 m/s2",
    "points": {"O": {"x": 0, "y": 0}, "top": {"x": "5 mm", "y": "200 mm"}, "end": {"link": "tappet", "x": 0, "y": 0}},
    "guides": {"way": {"x": "5 mm", "angle": "90 deg"}},
    "input": CRANK,
    "cams": {
        "cam": {
            "on": "crank",
            "base_radius": "30 mm",
            "sections": SECTIONS,
            "follower": {
                "type": "translating", "link": "tappet", "guide": "way", "contact": "roller", "roller_radius": "8 mm",
            },
        }
    },
    "bodies": {"own": {"link": "tappet", "mass": "0.5 kg"}},
    "springs": {"closing": {"between": ["top", "end"], "stiffness": "8 N/mm", "free_length": "190 mm"}},
}  # fmt: skip
SWINGING = {
    "points": {"O": {"x": 0, "y": 0}, "Q": {"x": "70 mm", "y": "40 mm"}, "C": {"x": "-150 mm", "y": 0}},
    "input": CRANK | {"pivot": "C"},
    "shafts": {"camshaft": {"geared_to": "crank", "ratio": -2, "pivot": "O", "phase": "20 deg"}},
    "cams": {
        "cam": {
            "on": "camshaft",
            "begin": "25 deg",
            "base_radius": "30 mm",
            "sections": {
                "out": {"type": "rise", "law": "cycloidal", "angle": "100 deg", "swing": "14 deg"},
                "rest": {"type": "dwell", "angle": "40 deg"},
                "back": {"type": "return", "law": "4-5-6-7", "angle": "110 deg"},
                "low": {"type": "dwell"},
            },
            "follower": {
                "type": "oscillating", "link": "arm", "pivot": "Q", "contact": "roller", "roller_radius": "8 mm",
                "arm": "70 mm", "mode": -1,
            },
        }
    },
    "bodies": {"own": {"link": "arm", "mass": "0.4 kg", "x": "30 mm", "inertia": "0.002 kg m2"}},
    "moments": {"spring": {"type": "torsion_spring", "on": "arm", "stiffness": "20 N m/rad", "free_angle": "300 deg"}},
}  # fmt: skip


def changed(data: dict, **paths: object) -> dict:
    """A copy of a scene with values put at paths, their parts joined by two underscores; None takes a key away."""
    data = deepcopy(data)
    for path, value in paths.items():
        *way, last = path.split("__")
        part = data
        for key in way:
            part = part.setdefault(key, {})
        if value is None:
            part.pop(last, None)
        else:
            part[last] = deepcopy(value)
    return data


def asked(data: dict, fields: list[str], positions: int = 24) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Positions and fields of a machine by NumPy: by power and by equilibrium its inputs take the same torque."""
    machine = MovingMachine(Scene.model_validate(data), positions=positions)
    moments = ["input_moment_by_power", "input_moment_by_equilibrium"]
    assert machine.verdict([*fields, *moments]) == Verdict.OK
    power, equilibrium = machine.fields(moments).values()
    for name, second in machine.scene.inputs.items():
        kinds = ("driving_moment", "angle_phi") if second.type == "crank" else ("driving_force", "slide_phi")
        if second.drive == "own":
            load, rate = machine.fields([f"{name}.{kind}" for kind in kinds]).values()
            equilibrium = equilibrium + load * rate
    checks = machine.mechanics.reactions.checks.values()
    force, forces, moment, on_frame = GraphValues(machine.scene, machine.mechanics.graph)(list(checks), machine.q)
    # A handful of roundings of forces that a few links pass on.
    assert (np.abs(power - equilibrium) <= 1e-13 * (np.abs(power).max() + on_frame.max())).all()
    assert (force <= 1e-13 * forces.max()).all()
    assert (np.abs(moment) <= 1e-13 * on_frame.max()).all()
    return machine.q, machine.fields(fields)


def rows_of(machine: Machine, **values: float) -> dict[str, np.ndarray]:
    """Fields and summaries of one variant of a machine that is asked for BALANCE, too, and is in balance."""
    outcome = machine.evaluate({path: np.array([value]) for path, value in values.items()})
    assert outcome.status[0] == Verdict.OK
    # A few roundings of what a handful of links pass on, against the greatest.
    assert all(outcome.summaries[name][0] < 1e-13 for name in BALANCE)
    return {name: values[0] for name, values in {**outcome.fields, **outcome.summaries}.items()}
