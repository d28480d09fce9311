"""Racks on connecting rods and couplers, and racks that second inputs drive: no slip in 50 digits, closed forms."""

import numpy as np
import pytest
from driving_cams import BALANCE, asked, changed, rows_of
from geared_links import CRANK
from machines import rrp, rrr
from mpmath import mp

from engine import Machine, Mechanics, Scene, SceneError

EPS = np.finfo(float).eps
# A connecting rod whose rack turns a pinion of the frame; a block about the pinion's axis holds them together.
RACK_ROD = {
    "gravity": 9.81,
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.25, "y": 0.03}, "E": {"link": "rod", "x": 0.3, "y": 0}},
    "guides": {"slot": {"link": "rod", "y": 0.02, "angle": 0.1}},
    "input": CRANK,
    "links": {"rod": {"joints": ["A"]}, "block": {"joints": ["C"], "guide": "slot"}},
    "near": {"E": {"x": 0.35, "y": 0}},
    "pinions": {"pinion": {"guide": "slot", "pivot": "C", "radius": 0.04, "phase": 0.3, "pressure_angle": "20 deg"}},
    "bodies": {
        "rod_body": {"link": "rod", "mass": 1.1, "x": 0.15, "y": 0.01, "inertia": 0.01},
        "pinion_body": {"link": "pinion", "mass": 0.9, "x": 0.01, "inertia": 0.002},
    },
    "moments": {"load": {"type": "linear_drag", "on": "pinion", "coefficient": 0.4}},
}
# On the coupler of a four-bar a block slides, and a pinion in it drives a rack twice as far.
ON_COUPLER = {
    "gravity": 9.81,
    "points": {"O": {"x": 0, "y": 0}, "D": {"x": 0.2, "y": 0}, "X": {"x": 0.05, "y": 0.3}},
    "guides": {"way": {"link": "coupler", "x": 0.02, "y": 0.04, "angle": 0.2}},
    "input": CRANK,
    "groups": {
        "four_bar": rrr("B", ("coupler", "A", 0.18), ("rocker", "D", 0.12)),
        "block_drive": rrp("P", ("stay", "X", 0.25), "block", "way"),
    },
    "pinions": {"wheel": {"guide": "way", "pivot": "P", "radius": 0.02, "pressure_angle": "20 deg"}},
    "racks": {
        "table": {"pinion": "wheel", "pivot": "P", "guide": "way", "radius": -0.02, "start": 0.01,
                  "pressure_angle": "20 deg"}
    },
    "bodies": {
        "coupler_body": {"link": "coupler", "mass": 0.7, "x": 0.09, "inertia": 0.002},
        "wheel_body": {"link": "wheel", "mass": 0.3, "inertia": 0.0001},
        "table_body": {"link": "table", "mass": 1.5, "x": 0.03, "y": 0.03, "inertia": 0.001},
    },
}  # fmt: skip
SERVO_RACK = {
    "gravity": 9.81,
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.2, "y": 0}},
    "guides": {"up": {"x": 0.25, "angle": "90 deg"}},
    "input": CRANK,
    "inputs": {"servo": {"type": "crank", "pivot": "C", "phase": 0.4, "harmonics": {"two": {"order": 2, "sine": 0.7}}}},
    "racks": {"post": {"pinion": "servo", "pivot": "C", "guide": "up", "radius": 0.03, "start": 0.1}},
    "bodies": {
        "post_body": {"link": "post", "mass": 2.0, "y": 0.01},
        "servo_body": {"link": "servo", "mass": 1.0, "inertia": 0.003},
    },
}


def test_rack_on_a_connecting_rod__rolls_without_slip_in_50_digits():
    fields = [f"pinion.angle{rate}" for rate in ("", "_phi", "_phiphi")]
    nodes, rows = asked(RACK_ROD, fields)
    with mp.workdps(50):

        def rod(q: mp.mpf) -> tuple[mp.mpc, mp.mpc, mp.mpf]:
            """Crank pin, direction of the slot, and where the pinion's axis lies along it."""
            pin, axis = mp.mpf(0.05) * mp.expj(q), mp.mpc(0.25, 0.03)
            # The slot passes the pin at a distance: its point lies at 0.02 across, and it leans by 0.1.
            local = mp.mpc(0, 0.02) * mp.expj(-mp.mpf(0.1))
            far = mp.sqrt(abs(axis - pin) ** 2 - local.imag**2)
            along = (axis - pin) / mp.mpc(far, local.imag)
            return pin, along / abs(along), far - local.real

        def turned(q: mp.mpf) -> mp.mpf:
            # The phase is against the rod's own axis, by 0.1 behind the slot.
            _, along, place = rod(q)
            return mp.arg(along) - mp.mpf(0.1) + mp.mpf(0.3) - place / mp.mpf(0.04)

        def rate_without_slip(q: mp.mpf) -> mp.mpf:
            """From velocities at the pitch point alone: rod and pinion have the same one along the rack."""
            pin, along, _ = rod(q)
            touch = mp.mpc(0.25, 0.03) - mp.mpf(0.04) * mp.j * along
            speed = mp.diff(lambda p: rod(p)[0], q) + (touch - pin) * mp.diff(lambda p: rod(p)[1], q) / along
            return (speed / along).real / mp.mpf(0.04)

        for k in (0, 5, 13):
            q = mp.mpf(float(nodes[k]))
            assert complex(mp.expj(turned(q) - rows[fields[0]][k])) == pytest.approx(1, abs=1e-13)
            # A division by a radius of 0.04 m, twice for accelerations.
            assert float(rate_without_slip(q)) == pytest.approx(rows[fields[1]][k], abs=1e-13)
            assert float(mp.diff(rate_without_slip, q)) == pytest.approx(rows[fields[2]][k], abs=1e-12)


def test_rack_on_a_connecting_rod__carries_the_moment_of_its_pinion():
    data = changed(RACK_ROD, gravity=0, inertia_in_reactions=False)
    names = ["input_moment_by_equilibrium", "pinion.angle_phi", "pinion.angular_velocity", "pinion.tangential_force"]
    _, rows = asked(data, names)
    moment, rate, speed, force = rows.values()
    np.testing.assert_allclose(moment, 0.4 * speed * rate, atol=200 * EPS * np.abs(moment).max())
    np.testing.assert_allclose(force * 0.04, 0.4 * speed, atol=200 * EPS * np.abs(0.4 * speed).max())


def test_rack_on_a_coupler__moves_twice_as_far_as_its_pinion():
    fields = [f"{of}.{of_which}" for of in ("table", "block") for of_which in ("slide", "slide_phi", "slide_phiphi")]
    fields += ["wheel.angle_phi", "coupler.angle_phi"]
    _, rows = asked(ON_COUPLER, fields)
    np.testing.assert_allclose(rows["table.slide"], 2 * rows["block.slide"] + 0.01, atol=16 * EPS)
    for rate in ("slide_phi", "slide_phiphi"):
        np.testing.assert_allclose(rows[f"table.{rate}"], 2 * rows[f"block.{rate}"], atol=32 * EPS)
    against = -rows["block.slide_phi"] / 0.02
    np.testing.assert_allclose(rows["wheel.angle_phi"] - rows["coupler.angle_phi"], against, atol=64 * EPS)


def test_rack_of_a_servo__takes_the_moment_that_lifts_it():
    names = ["post.slide", "post.slide_phiphi", "servo.driving_moment", "input_moment_by_equilibrium"]
    machine = Machine(Scene.model_validate(SERVO_RACK), [*BALANCE, "servo.swing", "post.stroke"], names, positions=24)
    outcome = machine.evaluate({})
    for name, value in (("servo.swing", 1.4), ("post.stroke", 0.03 * 1.4)):
        assert abs(outcome.summaries[name][0] - value) <= outcome.errors[name][0] < 1e-13
    phi, rows = machine.nodes, rows_of(machine)
    omega = 4 * np.pi
    psi, bend = 0.4 + 0.7 * np.sin(2 * phi), -2.8 * np.sin(2 * phi)
    np.testing.assert_allclose(rows["post.slide"], 0.1 + 0.03 * psi, atol=8 * EPS)
    np.testing.assert_allclose(rows["post.slide_phiphi"], 0.03 * bend, atol=8 * EPS)
    moment = 0.03 * 2.0 * (0.03 * bend * omega**2 + 9.81) + 0.003 * bend * omega**2
    np.testing.assert_allclose(rows["servo.driving_moment"], moment, atol=32 * EPS * np.abs(moment).max())
    np.testing.assert_allclose(rows["input_moment_by_equilibrium"], 0.0, atol=32 * EPS)


def test_rack_of_a_servo_that_goes_on__runs_away():
    with pytest.raises(SceneError, match="the rack would run away"):
        Mechanics(Scene.model_validate(changed(SERVO_RACK, inputs__servo__ratio=1)))
