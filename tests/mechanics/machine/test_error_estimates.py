"""What errors are made of: dips, change points, distance from the origin, places of cuts, zeros by nature."""

import math
from functools import cache

import mpmath
import numpy as np
import pytest
from closed_forms import rocker_swing, slider_motion
from machines import crank, four_bar, frame, rpp, rpr, rrp, slider_crank
from noncircular_wheels import ELLIPSES
from scenes_of_parts import SCENES

from engine import Machine, Scene
from engine.compiling.running import mean_of_rows, sum_of_rows

TURN = 2.0 * math.pi


FOUR_BAR = four_bar(O=frame(0.0, 0.0), D=frame(1.0, 0.0))
LENGTHS = ("input.length", "groups.bars.first.length", "groups.bars.second.length", "points.D.x")
BESIDE = ("rocker.angular_velocity.max", "rocker.angular_acceleration.max", "B.x.mean")


def near_change_points(count):
    """Crank-rockers whose longest link is 1e-11 to 0.01 too short for all links to fall in line; by how much."""
    rng = np.random.default_rng(6)
    r, one, other = rng.uniform(0.5, 1.0, count), rng.uniform(1.2, 3.0, count), rng.uniform(1.2, 3.0, count)
    short = 10.0 ** rng.uniform(-11.0, -2.0, count)
    links = rng.permuted(np.array([one, other, one + other - r - short]), axis=0)
    return np.array([r, *links]), short


def test_swing_near_a_change_point__is_right_whatever_else_is_asked():
    lengths, short = near_change_points(128)
    varied = dict(zip(LENGTHS, lengths, strict=True))
    with mpmath.workdps(40):
        true = [rocker_swing(*variant) for variant in lengths.T]
        for beside in ((), BESIDE[:1], BESIDE):
            found = Machine(Scene.model_validate(FOUR_BAR), ["rocker.swing", *beside], (), LENGTHS).evaluate(varied)
            swing, error = found.summaries["rocker.swing"], found.errors["rocker.swing"]
            off = np.array([float(abs(value - exact)) for value, exact in zip(swing, true, strict=True)])
            assert (found.status == 0).all()
            assert (off <= error).all()
            assert off[short > 1e-9].max() < 1e-9
            assert error[short > 1e-9].max() < 1e-6


PRESS = {
    "gravity": 9.81,
    "points": {"O": {"x": 0, "y": 0}},
    "guides": {"way": {"x": 0.0, "y": 0.015625, "angle": 0.3}},
    "input": crank(length=0.05, speed=10.0),
    "groups": {"g": rrp("B", ("rod", "A", 0.2), "ram", "way")},
    "bodies": {"rod_body": {"link": "rod", "mass": 1.0, "x": 0.1, "y": 0.0, "inertia": 0.01}},
    "flywheel": {"inertia": 1.0},
}


def test_machine_far_from_the_origin__has_the_same_numbers():
    asked = ["ram.stroke", "ram.stroke_low_at", "ram.acceleration.max", "input.reaction.max", "input.reaction.mean"]
    asked += ["g.transmission_angle", "input_moment.rms", "speed_fluctuation", "B.x.max", "B.y.min"]
    moved = ["points.O.x", "points.O.y", "guides.way.x", "guides.way.y"]
    distance = np.array([0.0, 2.0**10, 2.0**20])
    varied = dict(zip(moved, (distance, -distance, distance, 0.015625 - distance), strict=True))
    found = Machine(Scene.model_validate(PRESS), asked, (), moved).evaluate(varied)
    assert (found.status == 0).all()
    for name in asked[:-2]:
        assert (found.summaries[name] == found.summaries[name][0]).all()
        assert (found.errors[name] == found.errors[name][0]).all()
    for name, sign in (("B.x.max", 1.0), ("B.y.min", -1.0)):
        there, error = found.summaries[name], found.errors[name]
        assert (np.abs(there - (there[0] + sign * distance)) <= error + error[0]).all()


@pytest.mark.parametrize("width", [1e-6, 1e-4])
def test_load_at_the_end_of_a_stroke__its_work_is_covered(width):
    table = {"type": "table", "on": "B", "angle": 0.3, "slider": "ram", "measured_from": "high end", "acts": "against"}
    table |= {"over_stroke": [0.0, width], "force": [1e3, 1e3], "interpolation": "linear", "outside": "zero"}
    scene = Scene.model_validate(PRESS | {"gravity": 0.0, "forces": {"work": table}})
    rng = np.random.default_rng(3)
    varied = {"input.length": rng.uniform(0.03, 0.07, 256), "groups.g.first.length": rng.uniform(0.15, 0.4, 256)}
    found = Machine(scene, ["required_drive_moment", "excess_work"], (), list(varied)).evaluate(varied)
    moment = found.summaries["required_drive_moment"]
    assert (np.abs(moment - 1e3 * width / TURN) <= found.errors["required_drive_moment"]).all()
    assert (found.errors["required_drive_moment"] < 1e-8 * 1e3).all()


def test_what_vanishes_by_nature__reaches_the_accuracy():
    yoke = rpp(("block", "A"), ("yoke", "way"), 0.5 * math.pi)
    scene = PRESS | {"groups": {"g": yoke}, "bodies": {"b": {"link": "yoke", "mass": 2.0, "inertia": 0.0}}}
    scene |= {"guides": {"way": {"angle": 0.0}}}
    asked = ["shaking_force.order_2", "required_power", "input_moment.order_3", "yoke.velocity.mean", "yoke.stroke_low"]
    for names in (asked, *([name] for name in asked)):
        found = Machine(Scene.model_validate(scene), [*names, "accuracy_reached"], accuracy=1e-3).evaluate({})
        assert found.summaries["accuracy_reached"][0] == 1.0
        zeros = [name for name in names if not name.endswith("stroke_low")]
        assert all(abs(found.summaries[name][0]) < 1e-9 for name in zeros)


def test_direction_of_zero_and_load_all_around__reach_the_accuracy():
    """A bar without mass is loaded along its axis; the weight of a slow crank turns all around in the crank's axes."""
    bodies = {"wheel": {"link": "crank", "mass": 2.0}, "ram_body": {"link": "ram", "mass": 0.01}}
    scene = Scene.model_validate(PRESS | {"input": crank(length=0.05, speed=0.1), "bodies": bodies})
    for name in ("g.first.load_direction_of_rod", "input.unloaded_arc_of_crank"):
        found = Machine(scene, [name, "accuracy_reached"], accuracy=1e-9).evaluate({}).summaries
        assert abs(found[name][0]) < 1e-12
        assert found["accuracy_reached"][0] == 1.0


def test_force_that_is_only_rounding__leaves_others_their_accuracy():
    """A rod without mass has no force across it, beside φ = 0 to the same bits from whichever panel."""
    names, scene = ["input.unloaded_arc_of_crank", "input.reaction.mean"], Scene.model_validate(ELLIPSES)
    alone, beside = (
        Machine(scene, [*names, *more]).evaluate({}) for more in ((), ("drive.first.reaction_across.max",))
    )
    for name in names:
        error = beside.errors[name][0]
        assert abs(beside.summaries[name][0] - alone.summaries[name][0]) <= error + alone.errors[name][0]
        assert error <= 1e-7 * beside.summaries[name][0]


RODS = np.random.default_rng(5).uniform(1.2, 6.0, 128)


@cache
def true_slider_motion():
    """Position of a slider-crank's slider with two derivatives, by Fourier series of the closed formula; by summary."""
    q = np.arange(4096) * (TURN / 4096)
    x, _, _ = slider_motion(q, 1.0, RODS[:, None], by=np)
    order = np.arange(2049)
    found = {}
    for power, name in enumerate(("B.x", "B.x_phi", "B.x_phiphi")):
        # Finer, so that the greatest of the values is the greatest of all to 1e-9.
        values = np.fft.irfft((1j * order) ** power * np.fft.rfft(x), 2**17) * 32.0
        found |= {f"{name}.max": values.max(axis=1), f"{name}.min": values.min(axis=1)}
        found[f"{name}.rms"] = np.sqrt((values**2).mean(axis=1))
    return found


# A load over part of the stroke cuts the cycle: panels are then of lower degree.
CUT = {
    "type": "table",
    "on": "B",
    "angle": 0.0,
    "slider": "ram",
    "acts": "against",
    "over_stroke": [0.2, 0.7],
    "force": [1e3, 3e3],
}
CUT |= {"interpolation": "linear", "outside": "zero", "measured_from": "high end"}


@pytest.mark.parametrize("forces", [{}, {"cut": CUT}])
def test_coarse_accuracy__takes_fewer_positions_and_covers_the_true_errors(forces):
    path = "groups.g.first.length"
    true = true_slider_motion() | ({"required_drive_moment": np.full(128, 2e3 * 0.5 / TURN)} if forces else {})
    scene = Scene.model_validate(slider_crank(length=1.0, rod=2.0) | {"forces": forces})
    asked = [*true, "positions_used"]
    by_default = Machine(scene, asked, (), [path]).evaluate({path: RODS})
    for accuracy in (1e-2, 1e-4):
        found = Machine(scene, asked, (), [path], accuracy=accuracy).evaluate({path: RODS})
        assert found.summaries["positions_used"].mean() < by_default.summaries["positions_used"].mean()
        for name, exact in true.items():
            off = np.abs(found.summaries[name] - exact)
            assert (off <= found.errors[name] + 1e-8 * np.abs(exact)).all()
            assert (off <= accuracy * np.abs(exact)).all()


def test_extremes_of_a_short_range__are_those_of_its_parts():
    # Rounding is measured where panels meet, but one panel would do for so smooth curves.
    begin, middle, end = 4.054482124826052, 4.059245621334699, 4.065289545643511
    names = [f"{part}.{end}" for part in ("input_moment", "input_moment_by_power") for end in ("min", "max")]
    found = []
    for start, stop in ((begin, end), (begin, middle), (middle, end)):
        scene = SCENES["wavy_input"] | {"input": SCENES["wavy_input"]["input"] | {"start": start, "stop": stop}}
        outcome = Machine(Scene.model_validate(scene), names).evaluate({})
        found.append([(outcome.summaries[name][0], outcome.errors[name][0]) for name in names])
    for name, whole, *parts in zip(names, *found, strict=True):
        of_parts = max(parts) if name.endswith("max") else min(parts)
        assert abs(whole[0] - of_parts[0]) <= whole[1] + of_parts[1], name


def test_sums_over_rows__are_the_same_for_one_variant_as_for_many():
    rows = np.random.default_rng(4).normal(size=(64, 37))
    alone = np.array([[total(rows[:, [k]])[0] for k in range(37)] for total in (sum_of_rows, mean_of_rows)])
    assert (alone == [sum_of_rows(rows), mean_of_rows(rows)]).all()


def test_switches_that_a_narrow_peak_hides__are_in_the_estimates():
    """A slotted link turns over within a hundredth degree, as its pivot is next to the crank's circle.

    The force against the ram acts over its stroke one way. Where the ram turns back is seen if the stroke is asked for.
    """
    scene = {
        "points": {"O": frame(0.0, 0.0), "D": frame(0.0, -0.06), "E": {"link": "slotted", "x": -0.09, "y": 0.0}},
        "guides": {"way": {"y": -0.07}},
        "input": crank(length=0.06, speed=5.0),
        "groups": {
            "slot": rpr(("block", "A"), ("slotted", "D")),
            "drive": rrp("F", ("rod", "E", 0.32), "ram", "way"),
        },
        "forces": {"cut": {"type": "constant", "on": "F", "angle": math.pi, "force": 1e3, "acts": "against"}},
    }
    varied = {"input.length": 0.06 + 10.0 ** np.random.default_rng(5).uniform(-6.5, -3.0, 128)}
    asked, beside = ["mean_useful_moment"], ["ram.stroke"]
    machine = Scene.model_validate(scene)
    alone, full = (Machine(machine, names, (), list(varied)).evaluate(varied) for names in (asked, beside))
    assert (alone.status == 0).all()
    exact = 1e3 * full.summaries["ram.stroke"] / TURN
    allowed = alone.errors["mean_useful_moment"] + 1e3 * full.errors["ram.stroke"] / TURN
    assert (np.abs(np.abs(alone.summaries["mean_useful_moment"]) - exact) <= allowed).all()
