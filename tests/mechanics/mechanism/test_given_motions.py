"""Reactions, loads and friction at a given speed and acceleration of the input, which only regimes give otherwise.

Tolerances: see `machines.compare`, the sensitivity of the reference itself to a rounding of the data.
"""

import math

import numpy as np
import pytest
from loaded_machines import asked, loaded
from machines import chain, compare, slider_crank
from newton_euler import reactions
from oracle import EPS
from press import bodies, press
from reaction_graphs import ReactionValues
from rubbing_machines import press as rubbing_press

from engine import Machine, Scene, Verdict
from engine.graph.nodes import Graph
from engine.laws.friction.coefficients import stribeck
from engine.laws.friction.journals import friction_circle
from engine.mechanism.input_motion import InputMotion


def expected(scene: Scene, q: np.ndarray, **motion: float) -> dict[str, np.ndarray]:
    rows = reactions(scene, q, **motion)
    return rows | {f"input_moment_by_{way}": rows["input_moment"] for way in ("equilibrium", "power")}


# Loads whose coefficients grow with speed, that the oracle knows at any speed.
WITH_SPEED = {
    "rub": {"type": "against_motion", "on": "R", "force": 60.0},
    "oil": {"type": "linear_drag", "on": "E", "angle": 0.2, "turns_with": "link", "coefficient": 30.0},
    "air": {"type": "quadratic_drag", "on": "B", "coefficient": 12.0},
    "paste": {"type": "power_drag", "on": "R", "force": 35.0, "at_speed": 1.2, "exponent": 0.7},
}


def test_accelerated_input__newton_euler():
    scene, omega, epsilon = press(bodies=bodies(), forces=WITH_SPEED), 11.0, -35.0
    # With the motion given, coefficients are those at unit speed.
    scene["input"]["speed"] = 1.0

    def motion(graph: Graph) -> InputMotion:
        return InputMotion(graph.constant(omega**2), graph.constant(epsilon), graph.constant(omega))

    of = ReactionValues(scene, motion)
    q, names = (
        np.random.default_rng(11).uniform(of.values.first, of.values.last, 11),
        [*asked(of.scene), "input_moment_by_power"],
    )
    compare(of(names, q), scene, lambda scene: expected(scene, q, omega=omega, epsilon=epsilon))


def test_brakes__act_on_a_given_motion_alone():
    brake = {
        "type": "disc_brake",
        "on": "rod",
        "force": 100.0,
        "friction": 0.3,
        "inner_radius": 0.05,
        "outer_radius": 0.1,
    }
    scene, q = slider_crank(moments={"brake": brake}), np.array([0.3, 2.0])
    uniform = ReactionValues(scene)
    assert "brake.acting_moment" not in uniform.reactions.variables
    assert not uniform(["input_moment_by_equilibrium"], q)["input_moment_by_equilibrium"].any()
    given = ReactionValues(scene, lambda g: InputMotion(g.one, g.zero, g.one))
    found = given(["brake.acting_moment", "input_moment_by_equilibrium", "input_moment_by_power"], q)
    # Crank forwards, rod backwards on the right, forwards on the left: the brake is against it.
    np.testing.assert_array_equal(np.sign(found["brake.acting_moment"]), [1.0, -1.0])
    by_equilibrium, by_power = (found[f"input_moment_by_{way}"] for way in ("equilibrium", "power"))
    assert (by_equilibrium > 0).all()
    np.testing.assert_allclose(by_equilibrium, by_power, rtol=100 * EPS)


def test_friction_that_falls_with_speed__follows_a_given_motion():
    own = {"pair": "input", "coefficient": 0.2, "diameter": 0.04, "static_coefficient": 0.5, "stribeck_speed": 0.03}
    scene = rubbing_press(0.0, journals=False) | {"friction": {"main": own}}

    def motion(graph: Graph) -> InputMotion:
        return InputMotion(graph.constant(0.25), graph.zero, graph.constant(0.5))

    names = ["input.friction_moment", "input.reaction", "input.friction_power"]
    moment, reaction, power = ReactionValues(scene, motion)(names, np.arange(6.0)).values()
    expected = friction_circle(0.02, stribeck(0.5, 0.2, 0.02 * 0.5, 0.03, 2.0), 1.0)
    np.testing.assert_allclose(-moment / reaction, expected, rtol=20 * EPS)
    np.testing.assert_allclose(power, -moment * 0.5, rtol=20 * EPS)


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
