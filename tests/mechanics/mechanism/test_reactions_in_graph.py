"""Reactions as nodes against the equations of Newton and Euler, solved densely, and against closed forms.

Tolerances: see `machines.compare`, the sensitivity of the reference itself to a rounding of the data.
"""

import math

import numpy as np
import pytest
from drawn_machines import geared_five_bar, quick_return, scotch_yoke, sliding_input
from loaded_machines import asked, loaded
from machines import chain, compare, crank, frame, rrp, slider_crank
from newton_euler import reactions
from oracle import EPS
from press import actions, bodies, press
from reaction_graphs import ReactionValues

from engine import Scene
from engine.graph.nodes import Graph
from engine.mechanism.input_motion import InputMotion
from engine.scene.pairs import pairs


def places(of: ReactionValues, count: int = 11) -> np.ndarray:
    return np.random.default_rng(count).uniform(of.values.first, of.values.last, count)


def expected(scene: Scene, q: np.ndarray, **motion: float) -> dict[str, np.ndarray]:
    rows = reactions(scene, q, **motion)
    return rows | {f"input_moment_by_{way}": rows["input_moment"] for way in ("equilibrium", "power")}


def check(scene: dict) -> None:
    of = ReactionValues(scene)
    q, names = places(of), [*asked(of.scene), "input_moment_by_power"]
    compare(of(names, q), scene, lambda scene: expected(scene, q))


@pytest.mark.parametrize(("seed", "dyads", "in_series"), [(0, 5, False), (4, 10, True)])
def test_random_chains_of_dyads__newton_euler(seed, dyads, in_series):
    check(loaded(chain(seed, dyads, in_series), seed))


@pytest.mark.parametrize("machine", [geared_five_bar(), sliding_input(), quick_return(0.01), scotch_yoke()])
def test_machines_of_all_kinds__newton_euler(machine):
    check(loaded(machine.model_dump(exclude_none=True), 7))


@pytest.mark.parametrize("speed", [7.0, -3.0])
def test_press_with_every_action__newton_euler(speed):
    scene = press(bodies=bodies(), **actions())
    scene["input"]["speed"] = speed
    check(scene)


def test_piston_in_a_slot__cylinder_is_borne_by_the_rocker():
    scene = loaded(quick_return().model_dump(exclude_none=True), 2)
    cylinder = {"type": "pump", "piston": "stone", "bore": 0.05, "suction": 9e4, "discharge": 4e5}
    check(scene | {"cylinders": {"pump": cylinder}})


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
    q, names = places(of), [*asked(of.scene), "input_moment_by_power"]
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


# The whole


def test_whole_machine__is_in_equilibrium():
    of = ReactionValues(loaded(chain(1, 3, True), 1))
    force, forces, moment, moments = of.values(list(of.reactions.checks.values()), places(of))
    assert list(of.reactions.checks) == ["force", "forces", "moment", "moments"]
    # Some hundred operations on the reactions.
    assert (force < 100 * EPS * forces).all()
    assert (np.abs(moment) < 100 * EPS * moments).all()


def test_machine_without_loads__bears_nothing():
    of = ReactionValues({**chain(0, 1, True), "gravity": 0.0})
    assert not np.any(of.values(list(of.reactions.checks.values()), places(of)))
    assert of.reactions.settlings == {}


def test_gravity_alone__frame_bears_the_weight():
    of = ReactionValues(press(bodies=bodies(), input=crank(speed=1e-9)))
    weight = 9.81 * sum(part.mass(of.values.numbers) for part in of.kinematics.masses.values())
    found = of(["frame.reaction_x", "frame.reaction_y"], places(of))
    np.testing.assert_allclose(found["frame.reaction_y"], -weight, rtol=100 * EPS)
    assert np.abs(found["frame.reaction_x"]).max() <= 100 * EPS * weight * 10
    # A weight is no action of the scene that is told by itself.
    assert not [name for name in of.reactions.variables if name.startswith("gravity")]


# Pairs


def test_loads_in_the_axes_of_links__are_the_force_and_its_opposite():
    of = ReactionValues(loaded(chain(0, 2, True), 3))
    q = places(of)
    for pair in (p for p in pairs(of.scene) if p.kind == "revolute"):
        x, y = of.values(list(of.reactions.force_in(pair.name)), q)
        for link, sign in ((pair.link, 1.0), (pair.other, -1.0)):
            u = np.exp(1j * np.arctan2(*of.values([*of.kinematics.links[link].u][::-1], q)))
            along, across = of.values(list(of.reactions.in_axes[pair.name, link]), q)
            np.testing.assert_allclose((along + 1j * across) * u, sign * (x + 1j * y), rtol=20 * EPS, atol=1e-12)


def test_rotor_off_its_axis__published_force():
    # A worked example of courses on balancing: a rotor of 10 kg, 0.1 mm off its axis, at 1000 rad/s loads it by 1000 N.
    scene = {
        "points": {"O": frame(0.0, 0.0)},
        "input": crank(speed=1000.0),
        "bodies": {"rotor": {"link": "crank", "mass": 10.0, "x": 1e-4, "inertia": 0.2}},
    }
    found = ReactionValues(scene)(["input.reaction", "input.reaction_along"], np.linspace(0, 6, 5))
    np.testing.assert_allclose(found["input.reaction"], 1000.0, rtol=8 * EPS)
    np.testing.assert_allclose(found["input.reaction_along"], -1000.0, rtol=8 * EPS)


def test_slider_crank_with_gas_force__closed_form():
    """The piston's gas and inertia force goes into the rod and sideways into the cylinder wall: F tan β and F/cos β."""
    r, rod, mass, omega, gas = 0.05, 0.2, 1.5, 120.0, -9000.0
    scene = {
        "points": {"O": frame(0.0, 0.0)},
        "guides": {"way": {}},
        "input": crank(length=r, speed=omega),
        "groups": {"g": rrp("B", ("rod", "A", rod), "piston", "way")},
        "bodies": {"piston": {"link": "piston", "mass": mass}},
        "forces": {"gas": {"type": "constant", "on": "B", "angle": 0.0, "force": gas}},
    }
    names = ["g.first.reaction", "g.inner.reaction_along", "g.inner.reaction_across", "g.second.reaction"]
    names += ["input_moment_by_equilibrium"]
    phi = np.linspace(0.0, 2 * math.pi, 24, endpoint=False)
    found = ReactionValues(scene)(names, phi)
    beta = np.arcsin(-r * np.sin(phi) / rod)
    beta_phi = -r * np.cos(phi) / (rod * np.cos(beta))
    beta_phiphi = (r * np.sin(phi) / rod + np.sin(beta) * beta_phi**2) / np.cos(beta)
    acceleration = -r * np.cos(phi) - rod * np.cos(beta) * beta_phi**2 - rod * np.sin(beta) * beta_phiphi
    total = gas - mass * omega**2 * acceleration
    x_phi = -r * np.sin(phi) - rod * np.sin(beta) * beta_phi
    rows = (np.abs(total) / np.cos(beta), total / np.cos(beta), 0 * phi, total * np.tan(beta), -total * x_phi)
    for name, row in zip(names, rows, strict=True):
        # Some tens of operations on the greatest force or moment; forces of two kinds partly cancel.
        scale = abs(gas) * (r if "moment" in name else 1.0)
        np.testing.assert_allclose(found[name], row, rtol=0, atol=200 * EPS * scale)
