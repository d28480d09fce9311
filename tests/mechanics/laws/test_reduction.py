"""Reduced inertia of a press with every kind of body and shaft against the kinetic energy of the oracle's motion.

Tolerances: see `machines.compare`.
"""

import numpy as np
from machines import compare, variants_of
from oracle import Motion
from oracle_dynamics import reduced_inertia, reduced_inertia_phi
from press import bodies, press

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
