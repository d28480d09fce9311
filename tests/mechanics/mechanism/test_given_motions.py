"""Reactions, loads and friction at a given speed and acceleration of the input, which only regimes give otherwise.

Tolerances: see `machines.compare`, the sensitivity of the reference itself to a rounding of the data.
"""

import math

import numpy as np
import pytest
from loaded_machines import asked, loaded
from machines import chain, moving, slider_crank
from reaction_graphs import ReactionValues

from engine import Machine, Scene, Verdict


def fields(scene, count=7):
    of = ReactionValues(scene)
    q = np.random.default_rng(count).uniform(of.values.first, of.values.last, count)
    return of([*asked(of.scene), "input_moment_by_power"], q)


def same(one, other):
    for name, row in one.items():
        # Some hundred operations on forces that partly cancel.
        np.testing.assert_allclose(row, other[name], rtol=1e-10, atol=1e-10 * np.abs(row).max() + 1e-9, err_msg=name)


@pytest.mark.parametrize(("seed", "dyads"), [(0, 3), (4, 5)])
def test_accelerated_base__is_a_force_on_every_mass(seed, dyads):
    scene = loaded(chain(seed, dyads, True), seed)
    ax, ay = 3.0, -1.5
    forced = {**scene, "points": {**scene["points"]}, "forces": {**scene["forces"]}}
    for name, body in scene["bodies"].items():
        forced["points"][f"centre_{name}"] = {key: body[key] for key in ("link", "x", "y")}
        forced["forces"][f"base_{name}"] = {
            "type": "constant",
            "on": f"centre_{name}",
            "angle": math.atan2(-ay, -ax),
            "force": body["mass"] * math.hypot(ax, ay),
        }
    same(fields(scene | {"base": {"acceleration_x": ax, "acceleration_y": ay}}), fields(forced))


def test_lift_that_falls_freely__has_no_weight():
    scene = loaded(chain(1, 3, True), 1)
    same(fields(scene | {"base": {"acceleration_y": -9.81}}), fields(scene | {"gravity": 0.0}))


def test_slider_crank_on_a_braking_vehicle__works_against_the_inertia_of_its_ram_alone():
    bodies = {"ram_body": {"link": "ram", "mass": 4.0}}
    scene = slider_crank(bodies=bodies, base={"acceleration_x": -6.0})
    machine = Machine(Scene.model_validate(scene), ["ram.stroke"], ["reduced_moment", "B.x"], ["base.acceleration_x"])
    outcome = machine.evaluate({"base.acceleration_x": np.array([-6.0, 0.0])})
    assert (outcome.status == Verdict.OK).all()
    moment, place = outcome.fields["reduced_moment"], outcome.fields["B.x"]
    # The work of 24 N along the way of the ram.
    angle = machine.nodes
    work = np.cumsum(0.5 * (moment[0][1:] + moment[0][:-1]) * np.diff(angle))
    np.testing.assert_allclose(work, 24.0 * (place[0][1:] - place[0][0]), atol=1e-3)
    np.testing.assert_array_equal(moment[1], 0.0)


def test_spring_with_a_damper__pulls_as_both_do():
    def pull(**own):
        scene = slider_crank(springs={"coil": {"between": ["O", "B"], **own}})
        return moving(scene, ["coil.force_x"], 16)[1]["coil.force_x"]

    stiff, damped = {"stiffness": 300.0, "free_length": 0.1}, {"damping": 7.0}
    np.testing.assert_allclose(pull(**stiff, **damped), pull(**stiff) + pull(**damped), atol=1e-13 * 300.0)
