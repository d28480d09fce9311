"""Kept fields: against closed forms and NumPy, in place, the same to the last bit however the work is cut."""

import numpy as np
import pytest
from machines import crank, frame, rrp, rrr

from engine import Machine, MovingMachine, Scene
from engine.words.verdicts import Verdict

EPS = np.finfo(float).eps

FOUR_BAR = {
    "gravity": 9.81,
    "points": {"O": frame(0.0, 0.0), "D": frame(0.22, 0.01)},
    "input": crank(length=0.05, speed=12.0),
    "groups": {"g": rrr("B", ("rod", "A", 0.2), ("rocker", "D", 0.15))},
    "bodies": {"rod": {"link": "rod", "mass": 1.0, "x": 0.1, "y": 0.01, "inertia": 0.01}},
    "moments": {"twist": {"on": "rocker", "type": "constant", "moment": 5.0}},
    "flywheel": {"speed_fluctuation": 0.02},
}
FIELDS = ["reduced_inertia", "reduced_moment", "rod.angle", "crank.angle", "B.x", "B.y"]


def four_bar(**changes: object) -> Scene:
    return Scene.model_validate({**FOUR_BAR, **changes})


# A table of stacked lanes is cut at 64 variants.
VARIED = {"input.length": np.linspace(0.03, 0.05, 150), "bodies.rod.mass": np.linspace(1.0, 5.0, 150)}


def everything(outcome: object) -> list[bytes]:
    parts = outcome.summaries, outcome.errors, outcome.fields
    return [rows.tobytes() for part in parts for rows in part.values()]


def test_part_of_a_buffer__gets_the_same_bits_and_nothing_is_left_of_what_it_held():
    machine = Machine(four_bar(), [], FIELDS, VARIED, 90)
    buffer = machine.new_buffer(200)
    buffer[:] = 7.0
    drop = np.arange(150) % 7 == 2
    found, own = machine.evaluate(VARIED, drop, buffer), machine.evaluate(VARIED, drop)
    assert everything(found) == everything(own)
    assert np.shares_memory(found.fields["B.x"], buffer)
    assert np.isnan(found.fields["B.x"][drop]).all()
    assert np.isfinite(found.fields["B.x"][~drop]).all()


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
@pytest.mark.parametrize("revolutions", [1, 2])
def test_angles__go_on_through_all_turns(dtype, revolutions):
    turning = FOUR_BAR["input"] | {"revolutions": revolutions}
    machine = Machine(
        four_bar(input=turning), [], ["crank.angle", "rod.angle", "A.x", "A.y", "B.x", "B.y"], [], 360, dtype
    )
    f = {name: rows[0] for name, rows in machine.evaluate({}).fields.items()}
    # A rounding of the greatest angle, and of the direction before it.
    close = {"rtol": 0, "atol": 4 * np.finfo(dtype).eps * 2 * np.pi * revolutions}
    np.testing.assert_allclose(f["crank.angle"], machine.nodes, **close)
    along = np.arctan2(f["B.y"] - f["A.y"], f["B.x"] - f["A.x"])
    # Joints at a distance of 0.2 known to some roundings of 0.4.
    np.testing.assert_allclose(f["rod.angle"], np.unwrap(along.astype(float)), rtol=0, atol=64 * np.finfo(dtype).eps)


@pytest.mark.parametrize("short", [1e-2, 1e-4, 1e-8])
def test_lever_near_a_change_point__turns_on_in_its_sense(short):
    """The crank pin passes next to the lever's bearing, halfway between two positions: it turns by more than π."""
    bearing = (1 - short) * 0.1 * np.exp(2j * np.pi / 128)
    lever = {"type": "RPR", "first": {"link": "block", "joint": "A"}, "second": {"link": "lever", "joint": "D"}}
    scene = {"points": {"O": frame(0.0, 0.0), "D": frame(bearing.real, bearing.imag)}, "groups": {"g": lever}}
    scene = Scene.model_validate(scene | {"input": crank(length=0.1, speed=12.0)})
    pin = 0.1 * np.exp(2j * np.pi * np.arange(64) / 64) - bearing
    # From the bearing's direction both turn by half together, between positions 32 and 33.
    true = np.angle(pin / bearing) + np.where(np.arange(64) > 32, 2 * np.pi, 0.0)
    for found in (
        Machine(scene, [], ["lever.angle"], [], 64).evaluate({}).fields["lever.angle"][0],
        MovingMachine(scene, positions=64).fields(["lever.angle"])["lever.angle"],
    ):
        np.testing.assert_allclose(found - found[0], true - true[0], rtol=0, atol=64 * EPS / short)


def test_ranges_of_variants_own__are_those_of_the_slide():
    """An elliptic trammel: A slides along x from 0.05 on, B along y, at a distance of 0.2."""
    scene = Scene.model_validate(
        {
            "points": {"O": {"x": 0.0, "y": 0.0}},
            "guides": {"along": {}, "across": {"angle": np.pi / 2}},
            "input": {
                "type": "slider", "link": "drive", "guide": "along", "point": "A",
                "start": 0.05, "stop": 0.1, "speed": 0.1,
            },
            "groups": {"g": rrp("B", ("rod", "A", 0.2), "ram", "across")},
        }
    )  # fmt: skip
    stops = np.array([0.1, 0.15, 0.19, 0.26, -0.1])
    outcome = Machine(scene, [], ["A.x", "B.y"], ["input.stop"], 40).evaluate({"input.stop": stops})
    x = 0.05 + (stops[:, None] - 0.05) * np.arange(41) / 40
    np.testing.assert_allclose(outcome.fields["A.x"], x, rtol=0, atol=2 * EPS * 0.25)
    reached = np.abs(x) < 0.2
    with np.errstate(invalid="ignore"):
        y = np.sqrt((0.2 - x) * (0.2 + x))
    # The root's own error near its zero: half the rounding of x over y, by x/y.
    np.testing.assert_allclose(outcome.fields["B.y"][reached], y[reached], rtol=0, atol=64 * EPS)
    assert np.isnan(outcome.fields["B.y"][~reached]).all()
    assert list(outcome.status) == [Verdict.OK, Verdict.OK, Verdict.OK, Verdict.CANNOT_ASSEMBLE, Verdict.OK]


def test_variant_that_cannot_be_assembled__keeps_what_there_is_and_spoils_no_other():
    lengths = np.array([0.05, 0.13, 0.05])
    machine = Machine(four_bar(), [], FIELDS, ["input.length"], 90)
    outcome, well = machine.evaluate({"input.length": lengths}), machine.evaluate({"input.length": lengths[:1]})
    assert list(outcome.status) == [Verdict.OK, Verdict.CANNOT_ASSEMBLE, Verdict.OK]
    for name in FIELDS:
        assert outcome.fields[name][0].tobytes() == outcome.fields[name][2].tobytes() == well.fields[name][0].tobytes()
    # The links reach from |0.2 − 0.15| to 0.2 + 0.15.
    q = machine.nodes
    apart = np.hypot(0.22 - 0.13 * np.cos(q), 0.01 - 0.13 * np.sin(q))
    assert (np.isnan(outcome.fields["B.x"][1]) == ((apart > 0.35) | (apart < 0.05))).all()
    assert (np.isnan(outcome.fields["rod.angle"][1]) == np.isnan(outcome.fields["B.x"][1])).all()
    assert machine.groups[outcome.status_group[1]] == "g"
    base = complex(0.22, 0.01)
    lost = np.angle(base) + np.arccos((abs(base) ** 2 + 0.13**2 - 0.35**2) / (2 * 0.13 * abs(base)))
    assert outcome.status_at[1] == pytest.approx(lost, rel=1e-9)


def test_force_that_is_not_there__has_the_direction_zero():
    light = four_bar(gravity=0.0, bodies={}, moments={})
    outcome = Machine(light, [], ["g.inner.reaction_direction"]).evaluate({})
    assert outcome.status[0] == Verdict.OK
    assert (outcome.fields["g.inner.reaction_direction"] == 0.0).all()


def test_direction_that_jumps_far_from_zero__is_followed_to_the_end():
    """Steps down to a fraction of the distance of two positions didn't move a position of 1000π, and never ended."""
    centre, half = 1000 * np.pi, 1e-4
    limited = FOUR_BAR["input"] | {"start": centre - half, "stop": centre + half}
    scene = Scene.model_validate(
        {
            "gravity": 9.81,
            "points": {"O": frame(0.0, 0.0)},
            "guides": {"way": {}},
            "input": limited,
            "groups": {"g": rrp("B", ("rod", "A", 0.2), "ram", "way")},
            "bodies": {"ram": {"link": "ram", "mass": 1.0}},
            # It changes its sense at the dead centre.
            "forces": {"rub": {"type": "against_motion", "on": "B", "angle": 0.0, "force": 9.81}},
        }
    )
    names = [f"input.reaction_{part}" for part in ("x", "y", "direction")]
    outcome = Machine(scene, [], names, [], 16).evaluate({})
    assert outcome.status[0] == Verdict.OK
    x, y, direction = (outcome.fields[name][0] for name in names)
    off = direction - np.arctan2(y, x)
    np.testing.assert_allclose(off, 2 * np.pi * np.rint(off / (2 * np.pi)), rtol=0, atol=8 * EPS * np.pi)
    assert (np.abs(np.diff(direction)) > 0.5).sum() == 1
