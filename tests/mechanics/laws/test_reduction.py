"""Reduction to the input link against energy and power of the oracle's motion.

The rows I(φ), dI/dφ, M(φ) of a press with every kind of body, shaft and action are compared with the kinetic energy
and the power of real forces on real velocities. Tolerances: see `machines.compare`.
"""

import math

import numpy as np
from machines import compare, rrp, variants_of
from oracle import Motion
from oracle_dynamics import moments, reduced_inertia, reduced_inertia_phi
from press import actions, bodies, press

from engine import MovingMachine, Scene

I_FIELDS = ("reduced_inertia", "reduced_inertia_phi")


def test_reduced_inertia_and_its_slope__kinetic_energy():
    varied = {
        "groups.drive.mode": [1, -1, 1],
        "guides.way.angle": [0.25, 0.1, -0.2],
        "shafts.gear.ratio": [-2.0, 1.0, 3.0],
        "bodies.ram_body.mass": [12.0, 1e-3, 1e6],
        "bodies.coupler_body.shape.length": [1.0, 0.5, 2.0],
    }
    scene = press(bodies=bodies())
    for variant in variants_of(scene, varied):
        machine = MovingMachine(Scene.model_validate(variant), positions=8)
        found, q = machine.fields(I_FIELDS), machine.q

        def rows(of: Scene, q: np.ndarray = q) -> dict:
            return dict(zip(I_FIELDS, (reduced_inertia(Motion(of, q)), reduced_inertia_phi(of, q)), strict=True))

        # Differences over 1/256 rad lose digits of I, which shows where long double is no longer than double.
        lost = 4 * 256 * float(np.finfo(np.longdouble).eps) * np.abs(found["reduced_inertia"]).max()
        compare(found, variant, rows, truncation={"reduced_inertia_phi": lost})


def test_reduced_moments__power_of_real_forces_on_real_velocities():
    scene = press(bodies=bodies(), **actions())
    names = [n for table in actions().values() for n in table] + ["gravity"]
    fields = [*(f"{n}.moment" for n in names), "reduced_moment", "input_moment"]
    varied = {"input.speed": [7.0, -3.0], "groups.drive.mode": [1, -1]}
    some = slice(5, None, 120)
    # The ends of the stroke come from cubics between positions: (h⁴/384) max|d⁗|, times the table's slope.
    ends = (2 * math.pi / 360) ** 4 / 384 * 20 * 2000
    truncation = {
        "from_low.moment": ends,
        "from_high.moment": ends,
        "reduced_moment": 2 * ends,
        "input_moment": 2 * ends,
    }
    for variant in variants_of(scene, varied):
        machine = MovingMachine(Scene.model_validate(variant), positions=360)
        q = machine.q[some]

        def rows(of: Scene, q: np.ndarray = q) -> dict:
            each = moments(Motion(of, q))
            total = sum(each.values())
            inertia = 0.5 * of.input.speed**2 * reduced_inertia_phi(of, q)
            return {f"{n}.moment": m for n, m in each.items()} | {
                "reduced_moment": total,
                "input_moment": inertia - total,
            }

        found = {field: row[some] for field, row in machine.fields(fields).items()}
        compare(found, variant, rows, truncation=truncation)


def test_sliding_input__reduced_mass_and_force():
    scene = {
        "gravity": 9.81,
        "guides": {"way": {"angle": 0.3}, "cross": {"x": 0.05, "y": 0.1, "angle": 1.8}},
        "input": {
            "type": "slider",
            "link": "ram",
            "guide": "way",
            "point": "A",
            "start": 0.1,
            "stop": 0.5,
            "speed": 0.3,
        },
        "groups": {"trammel": rrp("B", ("beam", "A", 1.0), "second", "cross")},
        "bodies": {
            "ram_body": {"link": "ram", "mass": 5.0},
            "beam_body": {"link": "beam", "mass": 2.0, "x": 0.4, "y": 0.1, "inertia": 0.3},
            "second_body": {"link": "second", "mass": 3.0, "x": 0.2},
        },
        "forces": {"rub": {"type": "against_motion", "on": "B", "force": 30.0}},
    }
    fields = [*I_FIELDS, "gravity.moment", "rub.moment"]
    machine = MovingMachine(Scene.model_validate(scene), positions=16)
    q = machine.q

    def rows(of: Scene) -> dict:
        motion = Motion(of, q)
        forces = {f"{name}.moment": row for name, row in moments(motion).items()}
        return forces | dict(zip(I_FIELDS, (reduced_inertia(motion), reduced_inertia_phi(of, q)), strict=True))

    compare(machine.fields(fields), scene, rows)
