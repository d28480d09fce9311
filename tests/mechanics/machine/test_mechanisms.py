"""Whole mechanisms against the oracle: every point, link and slider, position and both transfer functions.

Tolerances follow the sensitivity of each machine to its own numbers: see `machines.compare`.
"""

import math

import numpy as np
from machines import check, crank, four_bar, frame, on, prp, rpp, rpr, rrp, rrr

from engine import Machine, MovingMachine, Scene, Verdict


def test_whitworth_and_oscillating_cylinder__oracle():
    # D within the crank's circle: the rocker turns fully; outside: it swings. The cylinder's rod hangs on the pin.
    scene = {
        "points": {
            "O": frame(0.0, 0.0),
            "D": frame(0.05, -0.1),
            "G": frame(-1.1, 0.2),
            "C": on("rocker", 0.5, 0.1),
            "E": on("block", 0.05, 0.02),
            "P": on("piston", -0.3, 0.0),
            "T": on("tube", 0.1, 0.2),
        },
        "input": crank(),
        "groups": {"slot": rpr(("block", "A"), ("rocker", "D")), "cylinder": rpr(("tube", "G"), ("piston", "A"), 0.05)},
    }
    check(
        scene,
        points__D__y=[-0.1, -0.9, -0.1, -0.9],
        groups__slot__second__offset=[0.0, 0.0, 0.1, -0.2],
        groups__slot__mode=[1, -1, -1, 1],
        groups__cylinder__mode=[1, -1, 1, -1],
    )


def test_prp_on_swinging_guides__oracle():
    # A crank of limited range carries a guide; a second one is carried by the rocker of a four-bar.
    scene = four_bar()
    scene["input"] = crank(start=-0.6, stop=1.1)
    scene["points"] |= {"C": on("one", 0.2, 0.1), "E": on("two", -0.1, 0.1), "F": on("three", 0.1, 0.2)}
    scene["guides"] = {
        "fixed": {"x": 0.9, "y": 0.3, "angle": 1.8},
        "on_crank": {"link": "crank", "x": 0.1, "y": 0.05, "angle": 0.2},
        "on_rocker": {"link": "rocker", "x": 0.3, "y": -0.1, "angle": -0.4},
    }
    scene["groups"] |= {
        "crossing": prp("Q", ("one", "on_crank", 0.05), ("two", "fixed", -0.1)),
        "both_move": prp("R", ("three", "on_rocker", 0.1), ("four", "on_crank", 0.0)),
    }
    # At 0.2 rad the guides that both move would become parallel within the range.
    check(scene, guides__on_crank__angle=[0.05, -0.1])


def test_sliders_on_moving_guides__oracle():
    # Guides on a rocker, on a coupler, and on a shaft geared to the crank; a Scotch yoke sliding on a rocker.
    scene = four_bar(S=frame(-1.0, 0.4), M=on("gear", 0.1, 0.05), Q=on("on_c", 0.1, 0.1), U=on("yoke", 0.1, 0.1))
    scene["shafts"] = {"gear": {"geared_to": "crank", "ratio": -2.0, "pivot": "S", "phase": 0.3}}
    scene["guides"] = {
        "on_rocker": {"link": "rocker", "x": 0.2, "y": 0.1, "angle": 0.5},
        "on_coupler": {"link": "coupler", "x": 0.3, "y": 0.2, "angle": -0.3},
        "on_gear": {"link": "gear", "x": 0.1, "y": -0.05, "angle": 1.0},
    }
    scene["groups"] |= {
        "r": rrp("X", ("r_rod", "A", 2.0), "on_r", "on_rocker", 0.1),
        "c": rrp("Y", ("c_rod", "D", 2.5), "on_c", "on_coupler", -0.1, -1),
        "g": rrp("Z", ("g_rod", "B", 3.0), "on_g", "on_gear", 0.05),
        "y": rpp(("die", "M"), ("yoke", "on_rocker"), 1.2),
    }
    check(scene, groups__r__mode=[1, -1], groups__c__mode=[-1, 1], groups__g__mode=[1, -1])


def test_sliding_input__oracle():
    # A slider drives an elliptic trammel's rod, a bell crank, and a wedge it carries.
    scene = {
        "points": {
            "D": frame(0.5, 0.9),
            "C": on("beam", 0.25, 0.0),
            "E": on("rocker", 0.3, 0.2),
            "F": on("ram", 0.1, 0.1),
        },
        "guides": {
            "way": {"x": 0.1, "y": 0.2, "angle": 0.3},
            "cross": {"x": 0.05, "y": 0.1, "angle": 1.8},
            "wedge": {"link": "ram", "x": 0.1, "y": 0.1, "angle": 0.5},
        },
        "input": {
            "type": "slider",
            "link": "ram",
            "guide": "way",
            "point": "A",
            "start": 0.1,
            "stop": 0.5,
            "speed": 0.3,
        },
        "groups": {
            "trammel": rrp("B", ("beam", "A", 1.0), "second", "cross"),
            "bell": rrr("K", ("pusher", "A", 0.8), ("rocker", "D", 0.6)),
            "lift": prp("L", ("follower", "cross", 0.1), ("on_wedge", "wedge", 0.05)),
        },
    }
    check(
        scene,
        groups__trammel__mode=[1, -1],
        groups__bell__mode=[1, -1],
        guides__way__angle=[0.3, -0.2],
        input__stop=[0.5, -0.4],
    )


def test_parallel_guides__singular():
    scene = {
        "points": {"O": frame(0.0, 0.0)},
        "guides": {"way": {"angle": 0.6}},
        "input": crank(),
        "groups": {"yoke_group": rpp(("die", "A"), ("yoke", "way"), 0.0)},
    }
    machine = Machine(
        Scene.model_validate(scene),
        fields=["yoke.slide_phi"],
        varied=["groups.yoke_group.second.slot_angle"],
        positions=16,
    )
    outcome = machine.evaluate({"groups.yoke_group.second.slot_angle": np.array([0.0, math.pi, 0.1])})
    assert list(outcome.status) == [Verdict.SINGULAR, Verdict.SINGULAR, Verdict.OK]


def test_pin_near_the_pivot_of_a_slotted_link__turns_it_fast_and_through_the_pivot_without_limit():
    # At the least distance of A from D the slotted link turns at r/(r − e) of the crank's speed.
    away = math.hypot(0.05, 0.1)
    scene = {
        "points": {"O": frame(0.0, 0.0), "D": frame(0.05, -0.1)},
        "input": crank(),
        "groups": {"slot": rpr(("block", "A"), ("rocker", "D"))},
    }
    machine = Machine(Scene.model_validate(scene), "rocker.angular_velocity.peak", varied="input.length")
    lengths = away * np.array([1.0, 1.0 + 1e-9, 1.0 - 1e-9, 1.0 + 1e-5, 1.0 - 1e-5, 2.0])
    outcome = machine.evaluate({"input.length": lengths})
    assert list(outcome.status) == [Verdict.SINGULAR] * 3 + [Verdict.OK] * 3
    assert [machine.groups[k] for k in outcome.status_group[:3]] == ["slot"] * 3
    np.testing.assert_allclose(outcome.status_at[:3], math.tau + math.atan2(-0.1, 0.05), atol=1e-6)
    speed = machine.scene.input.speed
    exact = speed * lengths[3:] / np.abs(lengths[3:] - away)
    # The difference of the lengths is exact to a rounding of one of them.
    rounding = exact * 4e-16 * lengths[3:] / np.abs(lengths[3:] - away)
    off = np.abs(outcome.summaries["rocker.angular_velocity.peak"][3:] - exact)
    assert (off <= outcome.errors["rocker.angular_velocity.peak"][3:] + rounding).all()
    # One machine is judged at equal steps; here one of them meets the pivot.
    for share, verdict in ((1.0, Verdict.SINGULAR), (1.0 + 1e-5, Verdict.OK)):
        scene["points"]["D"] = frame(share * scene["input"]["length"], 0.0)
        assert MovingMachine(Scene.model_validate(scene)).verdict(["rocker.angular_velocity"]) == verdict
