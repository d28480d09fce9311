"""Accuracy asked instead of positions: it is reached, against closed forms, and for no more than it takes."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from motion_scenes import ask, slider_crank, steady

import sweeps
from engine import AccurateMachine, AskError, Machine, Scene, Verdict
from engine.panels.accuracy import FEW, POSITIONS, Ladder, in_panels
from sweeps.study.bundled import find_study
from sweeps.study.study import read_study

TEMPLATES = Path(sweeps.__file__).parent / "templates"
OF_ACCURACY = ["positions_used", "accuracy_reached"]
CRANK, FORCE, SPEED = 0.05, 2000.0, 10.0


def yoke(begins: float, ends: float, **changes: object) -> dict:
    """A Scotch yoke, x = r cos φ, pressed on its way to the right between two places; its masses are left out."""
    return {
        "points": {"O": {"x": 0, "y": 0}, "P": {"link": "yoke", "x": 0.1, "y": 0}},
        "guides": {"way": {}},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": CRANK, "speed": SPEED},
        "groups": {
            "drive": {
                "type": "RPP",
                "first": {"link": "block", "joint": "A"},
                "second": {"link": "yoke", "guide": "way", "slot_angle": "90 deg"},
            }
        },
        "forces": {
            "press": {
                "type": "table",
                "on": "P",
                "angle": "180 deg",
                "slider": "yoke",
                "over_stroke": [begins, ends],
                "force": [FORCE, FORCE],
                "interpolation": "linear",
                "outside": "zero",
                "acts": "against",
            }
        },
        "flywheel": {"speed_fluctuation": 0.02},
    } | changes


def excess_work(begins: float, ends: float) -> float:
    """Of that yoke: outside the stroke of the force the driver stores work, and within it M falls below the mean.

    M = −F r sin φ·(−1) on the way to the right, φ in (π, 2π): F·dx is taken between the two places, and the driver's
    mean moment F·(ends − begins)/2π is given all the time. The least and greatest work lie where M + mean passes zero:
    where the force sets in and ends, or within, where F r |sin φ| = mean.
    """
    mean = FORCE * (ends - begins) / (2 * math.pi)
    first, last = (2 * math.pi - math.acos(x / CRANK) for x in (begins, ends))
    places = [first, last]
    if mean < FORCE * CRANK:
        places += [q for q in (math.pi + math.asin(mean / (FORCE * CRANK)), 2 * math.pi) if first < q < last]
        places += [q for q in (2 * math.pi - math.asin(mean / (FORCE * CRANK)),) if first < q < last]

    def work(q):
        pressed = min(max(CRANK * math.cos(q), begins), ends) - begins if q > math.pi else 0.0
        return mean * q - FORCE * pressed

    found = [work(q) for q in places]
    return max(found) - min(found)


@settings(deadline=None, max_examples=25)
@given(st.floats(-0.9, 0.8), st.floats(0.02, 0.9), st.sampled_from([1e-2, 1e-4, 1e-8]))
def test_accuracy__is_reached_and_its_figure_true_where_a_load_jumps(begins, length, accuracy):
    ends = CRANK * min(begins + length, 0.99)
    begins *= CRANK
    names = ["excess_work", "flywheel_wittenbauer", "reduced_moment.max", "required_power", *OF_ACCURACY]
    machine = AccurateMachine(Scene.model_validate(yoke(begins, ends)), names, accuracy=accuracy)
    found = machine.evaluate({})
    assert found.status[0] == Verdict.OK
    assert found.summaries["accuracy_reached"][0] == 1.0
    exact = excess_work(begins, ends)
    expected = {
        "excess_work": exact,
        "flywheel_wittenbauer": exact / (0.02 * SPEED**2),
        "required_power": FORCE * (ends - begins) / (2 * math.pi) * SPEED,
    }
    for name, value in expected.items():
        assert found.errors[name][0] <= accuracy * value
        # Where a load sets in is known to CLEAR = 1e-10 rad, whose work counts for some 1e-9 of a short load's.
        assert abs(found.summaries[name][0] - value) <= found.errors[name][0] + 1e-8 * exact


def test_positions__as_many_as_it_takes():
    scene = Scene.model_validate(slider_crank({}))
    used = []
    for accuracy in (1e-1, 1e-3, 1e-6, 1e-9):
        machine = AccurateMachine(scene, ["ram.stroke", "reduced_inertia.max", *OF_ACCURACY], accuracy=accuracy)
        found = machine.evaluate({})
        assert found.summaries["accuracy_reached"][0] == 1.0
        used.append(found.summaries["positions_used"][0])
        # I of a slider-crank at its greatest, by a dense sample refined with a parabola.
        for name in ("ram.stroke", "reduced_inertia.max"):
            assert found.errors[name][0] <= accuracy * found.summaries[name][0]
    assert used[0] == POSITIONS[0]
    assert used[0] < max(used) < 720


@pytest.mark.parametrize(
    ("rung", "share", "before", "following"),
    [
        # Finished; 48 √2 and 48 √30 positions do if errors fall by the square; 48 · 1000^(1/6) may; 48 · 10 won't.
        *((0, 0.5, math.inf, -1), (0, 2.0, math.inf, 1), (0, 30.0, math.inf, 3), (0, 1e3, math.inf, 1)),
        (0, 1e6, math.inf, 4),
        # What fell by 64 does with 96 · 1.5^(1/6), what fell by 2 not with 96 · 8; no third try.
        *((1, 1.5, 96.0, 2), (1, 8.0, 16.0, 4), (2, 1.5, 96.0, 4)),
    ],
)
def test_rung__that_is_enough_or_the_panels(rung, share, before, following):
    ladder = Ladder(Scene.model_validate(slider_crank({})), [], (), True)
    assert ladder.after(rung, np.array([[share]]), np.array([[before]])) == following


def test_variants__each_as_many_as_it_takes_whoever_comes_with_it():
    scene = Scene.model_validate(slider_crank({}))
    lengths = np.array([0.0501, 0.12, 1.0, 50.0, 0.04])
    names = ["ram.stroke", "drive.transmission_angle", "reduced_moment.rms", *OF_ACCURACY]
    machine = AccurateMachine(scene, names, (), ["groups.drive.first.length"], 1e-7)
    together = machine.evaluate({"groups.drive.first.length": lengths})
    used = together.summaries["positions_used"]
    assert used[0] > used[2]
    assert together.status[4] == Verdict.CANNOT_ASSEMBLE
    assert np.isnan(used[4])
    for i, length in enumerate(lengths):
        alone = machine.evaluate({"groups.drive.first.length": np.array([length])})
        for name in names:
            assert alone.summaries[name][0] == together.summaries[name][i] or np.isnan(together.summaries[name][i])
            assert alone.errors[name][0] == together.errors[name][i] or np.isnan(together.errors[name][i])


@pytest.mark.parametrize("name", ["stephenson_six_bar"])
def test_agrees_with__many_equally_spaced_positions(name):
    scene = read_study(TEMPLATES / f"{name}.toml").scene
    kinds = ("swing", "time_ratio", "transmission_angle", "flywheel_wittenbauer", "excess_work")
    asked = [n for n in Machine(scene).available_summaries if n.endswith(kinds)]
    asked += ["input_moment.peak", "shaking_force.order_1"]
    names = in_panels(scene, asked)
    assert len(names) > 6
    found = AccurateMachine(scene, [*names, *OF_ACCURACY], accuracy=1e-7).evaluate({})
    even = Machine(scene, names, positions=5760).evaluate({})
    assert found.summaries["positions_used"][0] < 2500
    for name in names:
        if np.isnan(even.summaries[name][0]):
            assert np.isnan(found.summaries[name][0])
            continue
        # Between equally spaced positions a transmission angle is missed by up to h²/8 of its curvature.
        error = found.errors[name][0] + even.errors[name][0]
        error += 1e-7 if name.endswith("transmission_angle") else 1e-9 * abs(even.summaries[name][0])
        assert abs(found.summaries[name][0] - even.summaries[name][0]) <= error, name


def test_fields__are_those_of_the_machine_with_their_positions():
    scene = Scene.model_validate(slider_crank({}))
    machine = AccurateMachine(scene, ["ram.stroke", *OF_ACCURACY], ["ram.slide"], accuracy=1e-3, positions=90)
    found = machine.evaluate({})
    assert (
        found.fields["ram.slide"] == Machine(scene, (), ["ram.slide"], positions=90).evaluate({}).fields["ram.slide"]
    ).all()
    assert found.summaries["ram.stroke"][0] == pytest.approx(0.1, abs=found.errors["ram.stroke"][0] + 1e-15)


def test_regimes__climb_on_equally_spaced_positions():
    scene = slider_crank({"even": steady("dc fan gravity cut rub")})
    name = "even.speed_fluctuation"
    machine = AccurateMachine(Scene.model_validate(scene), [name, "ram.stroke", *OF_ACCURACY], accuracy=1e-4)
    found = machine.evaluate({})
    fine = ask(scene, name, 2000)
    assert found.summaries["accuracy_reached"][0] == 1.0
    assert found.summaries[name][0] == pytest.approx(fine[name], abs=found.errors[name][0] + fine.figure(name))
    assert found.errors[name][0] <= 1e-4 * found.summaries[name][0]


def test_mean_of_zero__is_measured_by_the_peak():
    scene = Scene.model_validate(slider_crank({}))
    found = AccurateMachine(scene, ["ram.velocity.mean", *OF_ACCURACY], accuracy=1e-3).evaluate({})
    assert found.summaries["accuracy_reached"][0] == 1.0
    assert abs(found.summaries["ram.velocity.mean"][0]) <= found.errors["ram.velocity.mean"][0] + 1e-15
    assert list(found.summaries) == ["ram.velocity.mean", *OF_ACCURACY]


def test_out_of_reach__goes_as_far_as_it_helps_and_says_so():
    # Below the rounding of a number there is nothing to reach.
    scene = Scene.model_validate(slider_crank({}))
    found = AccurateMachine(scene, ["reduced_inertia.mean", *OF_ACCURACY], accuracy=1e-16).evaluate({})
    assert found.summaries["accuracy_reached"][0] == 0.0
    assert found.summaries["positions_used"][0] < 3000


def test_failing_variants__as_of_the_machine_of_many_positions():
    scene = Scene.model_validate(slider_crank({}))
    lengths = np.array([0.02, 0.0499999, 0.05, 0.0500001, 0.2])
    path = "groups.drive.first.length"
    found = AccurateMachine(scene, ["ram.stroke"], (), [path], 1e-6).evaluate({path: lengths})
    many = Machine(scene, ["ram.stroke"], (), [path]).evaluate({path: lengths})
    assert (found.status == many.status).all()
    assert (found.status_group == many.status_group).all()


def test_few_positions__are_kept_where_they_do():
    scene = Scene.model_validate(slider_crank({}))
    found = AccurateMachine(scene, ["reduced_inertia.max", *OF_ACCURACY], accuracy=3e-3).evaluate({})
    assert found.summaries["positions_used"][0] in [n for n in POSITIONS if n <= FEW]


@pytest.mark.parametrize("accuracy", [0.0, 1.0, -1e-3, math.nan])
def test_nonsense__is_refused(accuracy):
    with pytest.raises(AskError, match="accuracy"):
        AccurateMachine(Scene.model_validate(slider_crank({})), ["ram.stroke"], accuracy=accuracy)


def test_sliding_input__lies_in_panels_too():
    study = read_study(find_study("toggle_press"))
    names = [n for n in study.summaries if n not in ("friction_passes", "jamming_margin")]
    found = AccurateMachine(study.scene, [*names, *OF_ACCURACY], accuracy=1e-7).evaluate({})
    even = Machine(study.scene, names, positions=5760).evaluate({})
    assert found.summaries["accuracy_reached"][0] == 1.0
    assert set(names) <= set(in_panels(study.scene, names))
    for name in names:
        error = found.errors[name][0] + even.errors[name][0]
        assert abs(found.summaries[name][0] - even.summaries[name][0]) <= error, name
