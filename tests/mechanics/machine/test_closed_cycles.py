"""Whatever is measured over a cycle repeats itself with it, or the machine is refused: gravity and springs do no work.

Scenes are random: trains of shafts of any ratio, planets, and all that can hang on them. Values at a position and one
cycle later are found by walking over the graph in NumPy, without anything that judges cycles.
"""

import math
import re
from fractions import Fraction

import numpy as np
import pytest
from governor_samples import ENGINE, PORTER
from graph_values import GraphValues
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from machines import crank, four_bar, frame, on, rrr, slider_crank

from engine import Machine, Mechanics, Scene, SceneError, Verdict
from engine.machine.results import AskError
from engine.parts.skeleton import MOST_REVOLUTIONS

some = settings(max_examples=30)
RATIOS = st.builds(Fraction, st.sampled_from([-5, -3, -2, -1, 1, 2, 3, 4, 7]), st.integers(1, 6))
PLACES = np.array([0.3, 1.1, 2.9, 4.4, 5.7])


def hung_on(draw: st.DrawFn, scene: dict, shaft: str, planet: bool) -> bool:
    """Something that hangs on a shaft, off its axis; whether its place then matters."""
    kinds = ["nothing", "weight", "spring", "force", "formula", *["rocker", "noncircular"] * (not planet)]
    kind = draw(st.sampled_from(kinds))
    scene["points"][f"on_{shaft}"] = on(shaft, 0.0, 0.0) if kind in ("nothing", "formula") else on(shaft, 0.05, 0.02)
    if kind == "weight":
        scene["bodies"][f"load_{shaft}"] = {"link": shaft, "mass": 2.0, "x": 0.1, "y": -0.03}
    elif kind == "spring":
        scene["springs"][f"load_{shaft}"] = {"between": ["D", f"on_{shaft}"], "stiffness": 300.0, "free_length": 0.1}
    elif kind == "force":
        scene["forces"][f"load_{shaft}"] = {"type": "constant", "on": f"on_{shaft}", "angle": 0.4, "force": 30.0}
    elif kind == "formula":
        formula = f"5 N m * {shaft}.angle"
        scene["moments"][f"load_{shaft}"] = {"type": "formula", "on": "crank", "moment": formula}
    elif kind == "rocker":
        scene["groups"][f"group_{shaft}"] = rrr(
            f"inner_{shaft}", (f"bar_{shaft}", f"on_{shaft}", 4.0), (f"beam_{shaft}", "O", 4.0)
        )
        scene["moments"][f"load_{shaft}"] = {
            "type": "torsion_spring", "on": f"beam_{shaft}", "stiffness": 3.0, "free_angle": 0.7,
        }  # fmt: skip
    elif kind == "noncircular":
        law = {"type": "harmonic", "harmonics": {"one": {"order": 1, "sine": 0.2}}}
        wheel = {"geared_to": shaft, "pivot": "far", "driver_lobes": 1, "lobes": draw(st.integers(1, 2)), "law": law}
        scene["noncircular_wheels"][f"wheel_{shaft}"] = wheel
        scene["bodies"][f"load_{shaft}"] = {"link": f"wheel_{shaft}", "mass": 1.0, "inertia": 0.02}
    return kind != "nothing"


@st.composite
def trains(draw: st.DrawFn) -> tuple[dict, int]:
    """A four-bar with shafts one behind another, planets among them; and in how many turns of the crank all close."""
    scene = four_bar(1, P=frame(0.2, 0.1), Q=frame(0.4, 0.1), far=frame(3.0, 0.0)) | {"gravity": 9.81, "shafts": {}}
    for table in ("bodies", "springs", "forces", "moments", "noncircular_wheels"):
        scene[table] = {}
    turns = {"crank": Fraction(1), "frame": Fraction(0)}
    needed, driver = 1, "crank"
    for name, pivot in zip("abc"[: draw(st.integers(1, 3))], "PQP", strict=False):
        ratio = draw(RATIOS)
        planet = name == "a" and draw(st.booleans())
        if planet:
            assume(ratio != 1)
            shaft = {"geared_to": "frame", "carrier": "crank", "pivot": "A", "ratio": float(ratio)}
            scene["shafts"][name], turns[name] = shaft, 1 - ratio
        else:
            scene["shafts"][name] = {"geared_to": driver, "pivot": pivot, "ratio": float(ratio), "phase": 0.5}
            turns[name], driver = ratio * turns[driver], name
        if hung_on(draw, scene, name, planet):
            needed = math.lcm(needed, turns[name].denominator)
        if f"wheel_{name}" in scene["noncircular_wheels"]:
            wheel = scene["noncircular_wheels"][f"wheel_{name}"]
            needed = math.lcm(needed, (turns[name] / wheel["lobes"]).denominator)
    return scene, needed


def with_revolutions(scene: dict, revolutions: int) -> Scene:
    return Scene.model_validate(scene | {"input": scene["input"] | {"revolutions": revolutions}})


def curves(mechanics: Mechanics) -> list:
    """All that loads, masses and groups are at a position."""
    terms = mechanics.loads.terms
    found = [mechanics.reduced.inertia, mechanics.reduced.slope, mechanics.moment_of(), mechanics.conservative_moment]
    found += [node for load in terms for node in (load.characteristic, load.basis)]
    return found + [node for point in mechanics.kinematics.points.values() for node in (*point.r, *point.v, *point.a)]


@some
@given(trains())
def test_trains__are_refused_until_their_cycle_closes_and_do_no_work_in_it(case):
    data, needed = case
    for revolutions in range(1, min(needed, 13)):
        if revolutions % needed:
            with pytest.raises(SceneError) as caught:
                Mechanics(with_revolutions(data, revolutions))
            told = re.search(r"set input\.revolutions = (\d+)", str(caught.value))
            assert (told is None) == (needed > MOST_REVOLUTIONS)
            assert told is None or int(told[1]) in (needed, math.lcm(needed, revolutions))
    assume(needed <= MOST_REVOLUTIONS)
    scene = with_revolutions(data, needed)
    mechanics = Mechanics(scene)
    values, nodes, cycle = GraphValues(scene, mechanics.graph), curves(mechanics), math.tau * needed
    here, there = values(nodes, PLACES), values(nodes, PLACES + cycle)
    for node, one, other in zip(nodes, here, there, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=1e-10 * (1 + np.abs(one).max()), err_msg=repr(node))
    if "formula" in str(data["moments"]):
        return
    # The trapezoidal rule is exact to rounding for what is smooth and periodic.
    moment = values([mechanics.conservative_moment], np.arange(400 * needed) * cycle / (400 * needed))[0]
    assert abs(moment.mean()) <= 1e-11 * np.abs(moment).max()


WEIGHT = {
    "gravity": 9.81,
    "points": {"O": frame(0, 0), "Q": frame(0.3, 0)},
    "input": crank(length=0.1, speed="100 rpm", revolutions=2),
    "shafts": {"s": {"geared_to": "crank", "ratio": 0.5, "pivot": "Q", "phase": "90 deg"}},
    "bodies": {"w": {"link": "s", "mass": 5.0, "x": 0.1}},
    "flywheel": {"speed_fluctuation": 0.02},
}


def test_weight_on_a_shaft__needs_no_power_and_each_ratio_is_judged_for_itself():
    asked = ["required_power", "conservative_work_residual", "flywheel_wittenbauer"]
    machine = Machine(Scene.model_validate(WEIGHT), asked, varied=["shafts.s.ratio"])
    outcome = machine.evaluate({"shafts.s.ratio": np.array([0.5, 1 / 3, 1.5, 0.5 + 1e-9, -2.0])})
    open_, closed = Verdict.DOES_NOT_CLOSE, Verdict.OK
    assert [Verdict(code) for code in outcome.status] == [closed, open_, closed, open_, closed]
    power, residual, wheel = (outcome.summaries[name] for name in asked)
    fine = outcome.status == Verdict.OK
    assert (np.abs(power[fine]) <= outcome.errors["required_power"][fine]).all()
    assert (residual[fine] < 1e-15).all()
    # E = m g r sin θ against δ ω²: the mean of the weight's energy is kinetic, and constant.
    expected = 2 * 5 * 9.81 * 0.1 / (0.02 * (100 * math.tau / 60) ** 2)
    np.testing.assert_allclose(wheel[0] + 5 * 0.1**2 / 4, expected, rtol=1e-3)


# Loads over time

PULSE = {"type": "formula", "on": "crank", "numbers": {"w": "100 rpm"}}
TABLED = {"type": "table", "on": "crank", "over_time": [0, 0.3], "moment": [1, 2], "interpolation": "linear"}


@pytest.mark.parametrize(
    "load",
    [
        TABLED,
        PULSE | {"moment": "3 N m * sin(0.4 * w * t)"},
        PULSE | {"moment": "3 N m if t < 0.1 s else 0 N m"},
        PULSE | {"moment": "3 N m * sin(w * t + (1 if w * t > 2 else 0))"},
        PULSE | {"moment": "3 N m * exp(-w * t)"},
    ],
)
def test_load_over_time__is_refused_in_a_cycle_and_taken_in_a_run(load):
    run = {"go": {"type": "run", "time": 0.2, "from_speed": "100 rpm"}}
    scene = Scene.model_validate(WEIGHT | {"moments": {"push": load}, "regimes": run})
    for name in ("required_power", "reduced_moment.max"):
        with pytest.raises(AskError, match=r"a load depends on time .*no motion is periodic"):
            Machine(scene, [name])
    with pytest.raises(AskError, match="depends on time"):
        Machine(scene, fields=["reduced_moment"])
    Machine(scene, ["go.final_speed", "reduced_inertia.max"])


def test_load_over_time__is_taken_where_its_period_fits_the_cycle():
    """3 N m sin² (wt/2): half of 3 N m on the mean; the speed decides whether the cycle is whole periods long."""
    moment = {"m": PULSE | {"moment": "3 N m * sin(w * t / 2)^2", "role": "useful"}}
    scene = Scene.model_validate(WEIGHT | {"moments": moment})
    machine = Machine(scene, ["mean_useful_moment"], varied=["input.speed"])
    speed = 100 * math.tau / 60
    outcome = machine.evaluate({"input.speed": speed * np.array([1.0, 0.5, 0.8, -1.0, 1.0 + 1e-9])})
    open_, closed = Verdict.DOES_NOT_CLOSE, Verdict.OK
    assert [Verdict(code) for code in outcome.status] == [closed, closed, open_, closed, open_]
    np.testing.assert_allclose(outcome.summaries["mean_useful_moment"][[0, 1, 3]], -1.5, rtol=1e-13)


GOVERNED = PORTER | {"damping": 600.0, "engine": ENGINE | {"machine": True, "inertia": 3.0}}
TRAIN = {
    "type": "torsional_train",
    "masses": {"motor": {"inertia": 0.2, "damping": 0.02}, "end": {"inertia": 0.05}},
    "shafts": {"shaft": {"between": ["motor", "end"], "stiffness": 800.0, "damping": 0.3}},
    "machine_at": "end",
}


def test_element_that_follows_the_cycle__is_not_given_a_load_over_time():
    """A change of load goes through cycles of any speed; a train is excited at that of the input."""
    element = GOVERNED | {"engine": GOVERNED["engine"] | {"duration": 2.0}}
    with pytest.raises(
        SceneError, match=r"elements\.e\.engine\.duration: 'push' depends on time: no motion is periodic"
    ):
        Mechanics(Scene.model_validate(WEIGHT | {"moments": {"push": TABLED}, "elements": {"e": element}}))
    fine = Scene.model_validate(WEIGHT | {"moments": {"push": TABLED}, "elements": {"e": GOVERNED}})
    assert Machine(fine, ["e.decay_rate"]).evaluate({}).status[0] == Verdict.OK
    for share, verdict in ((0.5, Verdict.OK), (0.4, Verdict.DOES_NOT_CLOSE)):
        moments = {"push": PULSE | {"moment": f"3 N m * sin({share} * w * t)"}}
        train = Scene.model_validate(WEIGHT | {"moments": moments, "elements": {"e": TRAIN}})
        assert Machine(train, ["e.shaft.alternating_moment"]).evaluate({}).status[0] == verdict


# Torsion springs


def test_torsion_spring__is_not_wound_up():
    spring = {"twist": {"type": "torsion_spring", "on": "s", "stiffness": 2.0, "free_angle": 0.4}}
    with pytest.raises(SceneError, match=r"moments\.twist\.on: .* would wind up spring 'twist'"):
        Mechanics(Scene.model_validate(WEIGHT | {"moments": spring}))


def test_torsion_spring_on_a_link_of_a_group__may_swing_and_not_turn():
    """The four-bar of 0.3, 0.9 and 0.8 m is a double crank on a frame of 0.14 m, and has a rocker on one of 1.05 m."""
    spring = {"twist": {"type": "torsion_spring", "on": "rocker", "stiffness": 2.0, "free_angle": 0.4}}
    data, asked = four_bar(1), ["conservative_work_residual"]
    data["groups"]["bars"]["first"]["length"] = 0.9
    scene = Scene.model_validate(data | {"moments": spring})
    outcome = Machine(scene, asked, varied=["points.D.x"]).evaluate({"points.D.x": np.array([1.15, 0.2])})
    assert [Verdict(code) for code in outcome.status] == [Verdict.OK, Verdict.DOES_NOT_CLOSE]
    assert outcome.summaries[asked[0]][0] < 1e-14


def four_stroke(revolutions, quarter=False):
    gas = {"bore": 0.08, "clearance": 0.1, "intake": 1e5, "exhaust": 1.1e5, "peak": 5e6}
    scene = slider_crank(slider="piston", cylinders={"fire": {"type": "four_stroke", "piston": "piston", **gas}})
    scene["input"] |= {"speed": 90.0, "revolutions": revolutions}
    if quarter:
        scene["shafts"] = {"s": {"geared_to": "crank", "ratio": 0.25, "pivot": "O"}}
        scene["bodies"] = {"w": {"link": "s", "mass": 5.0, "x": 0.1}}
    return scene


def test_four_stroke_engine_with_a_slower_shaft__has_one_cycle_that_closes():
    """Two turns close the engine's cycle, four both: a message tells four, and twice the engine's cycle is no other."""
    with pytest.raises(SceneError, match=r"revolutions = 2, or more cycles"):
        Machine(Scene.model_validate(four_stroke(3)))
    with pytest.raises(SceneError, match=r"set input.revolutions = 4") as error:
        Machine(Scene.model_validate(four_stroke(2, quarter=True)))
    assert "revolutions = 2" not in str(error.value)
    found = [
        Machine(Scene.model_validate(four_stroke(turns, quarter)), ["required_power"]).evaluate({})
        for turns, quarter in ((2, False), (4, False), (4, True))
    ]
    assert [outcome.status[0] for outcome in found] == [Verdict.OK] * 3
    powers, errors = (
        [float(values["required_power"][0]) for values in part]
        for part in ([o.summaries for o in found], [o.errors for o in found])
    )
    assert powers[0] < -1e3
    assert all(abs(power - powers[0]) <= error + errors[0] for power, error in zip(powers, errors, strict=True))
