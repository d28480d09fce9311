"""Losses between the teeth of gears in mechanisms: efficiencies by hand, equilibrium, and the power that is lost."""

import math

import numpy as np
import pytest
from driving_cams import BALANCE, asked, changed, rows_of
from geared_links import CRANK
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import rrp
from noncircular_wheels import ELLIPSES
from test_wheels_on_groups import WATT

from engine import Machine, Scene, SceneError, Verdict

EPS = np.finfo(float).eps
LOAD = {"load": {"type": "constant", "on": "second", "moment": -12.0}}
PAIR_OF_WHEELS = {
    "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0.3, "y": 0.1}},
    "input": CRANK,
    "shafts": {"second": {"geared_to": "crank", "ratio": 0.5, "pivot": "C", "efficiency": 0.9}},
    "moments": LOAD,
}
FIELDS = ["input_moment_with_friction", "input_moment", "second.mesh_loss", "input.reaction", "second.reaction"]


@settings(max_examples=5)
@given(st.floats(0.5, 1.0), st.sampled_from([-1, 1]), st.sampled_from([-0.5, 2.5]), st.booleans())
def test_two_wheels__lose_what_their_efficiency_says(efficiency, load, ratio, teeth):
    data = changed(PAIR_OF_WHEELS, shafts__second__ratio=ratio, moments__load__moment=12.0 * load)
    data = changed(data, **({"shafts__second__pressure_angle": "20 deg"} if teeth else {}))
    summaries = ["friction_loss", "second.mesh_work", "mechanical_efficiency"]
    varied = {"shafts.second.efficiency": efficiency}
    rows = rows_of(Machine(Scene.model_validate(data), [*BALANCE, *summaries], FIELDS, list(varied), 48), **varied)
    taken = -12.0 * load * ratio
    driven = taken / efficiency if taken > 0 else taken * efficiency
    if 1.0 - ratio * (1 / efficiency if taken > 0 else efficiency) == 0.0:
        return
    tolerance = 100 * EPS * 12.0 * 2.5 / efficiency
    np.testing.assert_allclose(rows["input_moment"], taken, atol=tolerance)
    np.testing.assert_allclose(rows["input_moment_with_friction"], driven, atol=tolerance)
    np.testing.assert_allclose(rows["second.mesh_loss"], 4 * math.pi * (driven - taken), atol=20 * tolerance)
    np.testing.assert_allclose(rows["friction_loss"], 2 * math.pi * (driven - taken), atol=20 * tolerance)
    np.testing.assert_allclose(rows["second.mesh_work"], rows["friction_loss"], atol=20 * tolerance)
    if teeth:
        # The force acts so far from both axes that its moments on them are those of the load and the drive.
        across = rows["second.reaction"][0] * math.cos(math.radians(20))
        arms = 12.0 / across, abs(driven) / across
        np.testing.assert_allclose(arms[1] + math.copysign(arms[0], -ratio), math.hypot(0.3, 0.1), rtol=1e-10)


def test_planet__loses_power_of_its_motion_against_the_carrier():
    """By Willis's method: i = 1 + z₃/z₁ from the sun, the ring held; η = (1 + η₀ z₃/z₁)/(1 + z₃/z₁)."""
    first, second, teeth = 0.97, 0.98, 84 / 24
    data = {
        "points": {"O": {"x": 0, "y": 0}, "C": {"x": 0, "y": 0}},
        "input": CRANK,
        "shafts": {
            "arm": {"geared_to": "crank", "ratio": 1, "pivot": "C"},
            "planet": {"geared_to": "frame", "carrier": "crank", "pivot": "A", "ratio": "84/30", "efficiency": second},
            "sun": {"geared_to": "planet", "carrier": "crank", "pivot": "O", "ratio": "-30/24", "efficiency": first},
        },
        "moments": {"drive": {"type": "constant", "on": "sun", "moment": 2.0, "role": "driving"}},
    }
    # The sun drives: the crank, its carrier, takes what the train gives.
    _, rows = asked(data, ["input_moment_with_friction", "input_moment"], 48)
    np.testing.assert_allclose(rows["input_moment"], -2.0 * (1 + teeth), rtol=64 * EPS)
    np.testing.assert_allclose(rows["input_moment_with_friction"], -2.0 * (1 + first * second * teeth), rtol=64 * EPS)


@pytest.mark.parametrize(("teeth", "speed"), [(None, 12.0), ("20 deg", -12.0)])
def test_wheel_on_a_rocker__loses_in_both_senses_of_its_swing(teeth, speed):
    """Powers of drive, inertia and losses balance at every position; the loss is that share of what rolls through."""
    gone = dict.fromkeys(("shafts__sun", "shafts__idler", "points__G", "bodies__idler_body"))
    counter = {"shafts__counter__efficiency": 0.92, "shafts__counter__pressure_angle": teeth}
    data = changed(WATT, **gone, **counter, input__speed=speed)
    wheel = ["counter.angle_phi", "counter.angle_phiphi", "counter.angle"]
    moments = ["input_moment_with_friction", "input_moment", "counter.mesh_loss"]
    _, rows = asked(data, [*wheel, *moments], 48)
    angle = rows["counter.angle"]
    # About its own axis: 0.02 kg m² and 0.8 kg at 0.01 m, with 0.001 kg m² of that body.
    own = (0.02 + 0.001 + 0.8e-4) * speed**2 * rows["counter.angle_phiphi"] + 0.8 * 9.81 * 0.01 * np.cos(angle)
    rolling = own * rows["counter.angle_phi"] * speed
    loss = np.where(rolling > 0, (1 / 0.92 - 1) * rolling, (0.92 - 1) * rolling)
    np.testing.assert_allclose(rows["counter.mesh_loss"], loss, atol=1e4 * EPS * np.abs(rolling).max())
    extra = (rows["input_moment_with_friction"] - rows["input_moment"]) * speed
    np.testing.assert_allclose(extra, loss, atol=1e4 * EPS * np.abs(rows["input_moment"] * speed).max())


RACK = {
    "points": {"O": {"x": 0, "y": 0}, "end": {"link": "bar", "x": 0.05, "y": 0}},
    "guides": {"way": {"y": -0.1}},
    "input": CRANK | {"start": 0, "stop": 2},
    "racks": {
        "bar": {"pinion": "crank", "pivot": "O", "guide": "way", "radius": 0.04, "pressure_angle": 0.35,
                "efficiency": 0.9},
    },
    "forces": {"load": {"type": "constant", "on": "end", "force": 50.0, "angle": 0}},
}  # fmt: skip


@pytest.mark.parametrize(("angle", "radius"), [(0.0, 0.04), (math.pi, 0.04), (0.0, -0.04), (math.pi, -0.04)])
def test_rack__takes_more_of_its_pinion_or_gives_it_less_as_power_goes(angle, radius):
    """F r/η where the pinion drives against a force F, η F r where the force drives the pinion."""
    data = changed(RACK, forces__load__angle=angle, racks__bar__radius=radius)
    names = ["input_moment_with_friction", "input_moment", "bar.mesh_loss", "bar.tangential_force"]
    _, rows = asked(data, [*names, "bar.reaction_moment"], 48)
    ideal = -50.0 * math.cos(angle) * radius
    driven = ideal / 0.9 if ideal > 0 else ideal * 0.9
    np.testing.assert_allclose(rows["input_moment"], ideal, rtol=64 * EPS)
    np.testing.assert_allclose(rows["input_moment_with_friction"], driven, rtol=64 * EPS)
    np.testing.assert_allclose(rows["bar.mesh_loss"], 4 * math.pi * (driven - ideal), rtol=256 * EPS)
    # Losses don't change what holds the load, but the arm at which it does: the crank's moment over that force.
    np.testing.assert_allclose(rows["bar.tangential_force"], -50.0 * math.cos(angle), rtol=64 * EPS)
    # About the origin on the way the teeth act at the height 0.1 − r k, and push down or up by tan 0.35 of that force
    # beside the crank's axis, where the origin is s = r φ off.
    k = driven / ideal
    slide = radius * np.linspace(0, 2, 49)
    pushed = -math.copysign(math.tan(0.35), radius) * 50.0
    moment = -(-slide * pushed - (0.1 - radius * k) * -50.0 * math.cos(angle))
    np.testing.assert_allclose(rows["bar.reaction_moment"], moment, atol=1e3 * EPS * 5.0)


def test_pinion_that_rolls_on_a_rack__is_driven_by_what_losses_leave():
    """A slider pushes a pinion along; a drag M on it asks for M/(η r) at the axis."""
    data = changed(
        RACK, racks=None, points={"O": {"x": 0, "y": 0}}, guides={"way": {}}, forces=None,
        groups={"g": rrp("B", ("rod", "A", 0.2), "block", "way")},
        pinions={"wheel": {"guide": "way", "pivot": "B", "radius": 0.03, "efficiency": 0.8}},
        moments={"drag": {"type": "linear_drag", "on": "wheel", "coefficient": 0.5}},
    )  # fmt: skip
    names = ["wheel.angle_phi", "wheel.tangential_force", "wheel.mesh_loss", "input_moment_with_friction"]
    _, rows = asked(data, [*names, "input_moment"], 48)
    turning = rows["wheel.angle_phi"] * 4 * math.pi
    np.testing.assert_allclose(rows["wheel.tangential_force"], 0.5 * turning / (0.8 * 0.03), atol=1e-12 * 500)
    loss = 0.5 * turning**2 * (1 / 0.8 - 1)
    np.testing.assert_allclose(rows["wheel.mesh_loss"], loss, atol=1e-12 * loss.max())
    extra = (rows["input_moment_with_friction"] - rows["input_moment"]) * 4 * math.pi
    np.testing.assert_allclose(extra, loss, atol=1e-12 * loss.max())


@pytest.mark.parametrize("teeth", [None, 0.3])
def test_noncircular_wheels__lose_a_share_of_what_rolls_through_them(teeth):
    data = changed(
        ELLIPSES, gravity=0, groups=None, guides=None, bodies=None, points__D=None,
        noncircular_wheels__second__efficiency=0.85, noncircular_wheels__second__pressure_angle=teeth,
        moments={"drag": {"type": "linear_drag", "on": "second", "coefficient": 0.5}},
    )  # fmt: skip
    fields = ["second.angle_phi", "second.mesh_loss", "input_moment_with_friction", "input_moment"]
    _, rows = asked(data, fields, 48)
    power = 0.5 * (4 * math.pi * rows["second.angle_phi"]) ** 2
    np.testing.assert_allclose(rows["input_moment"] * 4 * math.pi, power, rtol=256 * EPS)
    np.testing.assert_allclose(rows["input_moment_with_friction"] * 4 * math.pi, power / 0.85, rtol=256 * EPS)
    np.testing.assert_allclose(rows["second.mesh_loss"], power / 0.85 - power, rtol=1e4 * EPS)


def test_motion_with_losses__takes_their_work_from_the_motor():
    """The motor sits two meshes away from the crank, the drag one; of the motor's two the second one is lossy."""
    mesh = {"pressure_angle": "20 deg", "inertia": 0.02}
    data = changed(
        PAIR_OF_WHEELS,
        shafts__second__inertia=0.5,
        shafts__middle=mesh | {"geared_to": "crank", "ratio": -2, "pivot": "M"},
        shafts__fast=mesh | {"geared_to": "middle", "ratio": -2, "pivot": "F", "efficiency": 0.9},
        points__M={"x": -0.2, "y": 0.0},
        points__F={"x": -0.3, "y": 0.1},
        moments__motor={"type": "dc_motor", "on": "fast", "stall_moment": 10.0, "no_load_speed": "720 rpm"},
        moments__load={"type": "linear_drag", "on": "second", "coefficient": 1.5},
        regimes={"steady": {"type": "steady"}},
    )
    names = ["steady.speed_max", "steady.fast.reaction.max"]
    paths = ["shafts.second.efficiency", "shafts.fast.efficiency"]
    drag, drive = np.array([0.8, 1.0, 0.7]), np.array([1.0, 0.6, 0.9])
    outcome = Machine(Scene.model_validate(data), names, varied=paths).evaluate(
        dict(zip(paths, (drag, drive), strict=True))
    )
    assert (outcome.status == Verdict.OK).all()
    # 40 η (1 − ω/ω₀) = 1.5 (ω/2)²/ω/η′, the motor's torque and the drag of a shaft at half the speed, at the crank.
    stall, slope = 40.0 * drive, 1.5 * 0.25 / drag
    known = stall / (stall / (6 * math.pi) + slope)
    # The force between the teeth turns both wheels about their axes, so its arms add up to the centre distance.
    taken = slope * known / 4 / drive
    pressed = (taken + 2 * drive * taken) / math.hypot(0.1, 0.1) / math.cos(math.radians(20))
    for name, exact in zip(names, (known, pressed), strict=True):
        assert (np.abs(outcome.summaries[name] - exact) <= outcome.errors[name] + 1e-9 * exact).all(), name


def test_losses_and_what_does_not_know_them__are_refused_in_words():
    data = changed(PAIR_OF_WHEELS, shafts__second__efficiency=1.2)
    with pytest.raises(ValueError, match="efficiency"):
        Scene.model_validate(data)
    clutch = {"type": "friction_clutch", "shaft": "motor_shaft", "capacity": 20.0}
    coupled = changed(
        PAIR_OF_WHEELS,
        shafts__motor_shaft={"geared_to": "crank", "ratio": 2, "efficiency": 0.9, "inertia": 0.1},
        couplings={"clutch": clutch},
        regimes={"run": {"type": "run", "time": 1.0}},
    )
    scene = Scene.model_validate(coupled)
    with pytest.raises(SceneError, match=r"shafts.motor_shaft.efficiency: mesh losses between a coupling"):
        Machine(scene, ["run.time"])
